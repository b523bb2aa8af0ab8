//! What holds a figure while it is dragged, as tasks.

use crate::model::{ModelError, check_configuration};
use crate::skeleton::{Holds, Skeleton};
use crate::task::{Posture, Task};

/// How much more a back keeps to its posture than limbs do.
const STIFF: f64 = 5.0;

impl Holds {
    /// Preferences that keep a figure near the posture `q` (stacked angles, radians)
    /// where its targets leave room, its back five times more than the rest: so a hand is followed by its
    /// arm, and a figure without limits does not twist.
    ///
    /// # Errors
    /// Another number of angles than the skeleton has, or one that is not finite.
    pub fn postures(
        &self,
        skeleton: &Skeleton,
        q: &[f64],
    ) -> Result<Vec<Task<Posture>>, ModelError> {
        let model = skeleton.model();
        check_configuration(model, q)?;
        let back = self.back.iter();
        let back: Vec<_> = back.flat_map(|&bone| skeleton.joints(bone)).collect();
        let (back, limbs): (Vec<_>, Vec<_>) = (model.moving_joints().iter().copied())
            .zip(q.iter().copied())
            .partition(|(joint, _)| back.contains(joint));
        let tasks = [
            ("posture", limbs, 1.0),
            ("posture of the back", back, STIFF),
        ]
        .into_iter()
        .filter(|(_, joints, _)| !joints.is_empty())
        .map(|(name, joints, weight)| {
            Task::new(Posture::of_joints(joints))
                .times(weight)
                .named(name)
        });
        Ok(tasks.collect())
    }
}
