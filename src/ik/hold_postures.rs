//! Posture tasks of a dragged skeleton.

use crate::model::{ModelError, check_configuration};
use crate::skeleton::{Holds, Skeleton};
use crate::task::{Posture, Task};

/// Weight of the spine relative to limbs.
const SPINE_WEIGHT: f64 = 5.0;

/// Creates soft tasks that keep a skeleton near the posture `q` (stacked angles, radians).
///
/// The spine has five times the weight of the other bones. A dragged hand then moves the arm rather than the spine,
/// and a skeleton without limits does not twist.
///
/// # Errors
/// Returns an error if `q` has the wrong length or a number that is not finite.
pub fn hold_postures(
    holds: &Holds,
    skeleton: &Skeleton,
    q: &[f64],
) -> Result<Vec<Task<Posture>>, ModelError> {
    let model = skeleton.model();
    check_configuration(model, q)?;
    let spine = holds.back.iter();
    let spine: Vec<_> = spine.flat_map(|&bone| skeleton.joints(bone)).collect();
    let (spine, limbs): (Vec<_>, Vec<_>) = (model.moving_joints().iter().copied())
        .zip(q.iter().copied())
        .partition(|(joint, _)| spine.contains(joint));
    let tasks = [
        ("posture", limbs, 1.0),
        ("posture of the back", spine, SPINE_WEIGHT),
    ]
    .into_iter()
    .filter(|(_, joints, _)| !joints.is_empty())
    .map(|(name, joints, weight)| {
        Task::new(Posture::of_joints(joints))
            .scale(weight)
            .named(name)
    });
    Ok(tasks.collect())
}
