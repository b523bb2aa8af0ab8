//! Person without a capture: the default skeleton of SMPL at rest.

use super::Capture;
use kinopt_animation::io::smpl::{DEFAULT_HEIGHT, default_joints};

/// Capture of one frame with the joints of SMPL, y up. A map from it to a model names the model's body parts.
pub(in crate::motion) fn stick_person() -> Option<Capture> {
    let (names, positions): (Vec<_>, Vec<_>) = default_joints(DEFAULT_HEIGHT).into_iter().unzip();
    Capture::new(names, positions.as_flattened(), 1.0).ok()
}
