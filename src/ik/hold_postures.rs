//! What holds a figure while it is dragged, as tasks.

use crate::skeleton::{Holds, Skeleton};
use crate::task::{Posture, Task};

/// How much more a back keeps to its posture than limbs do.
const STIFF: f64 = 5.0;

impl Holds {
    /// Preferences that keep a figure near the posture `q` (stacked angles, radians; missing ones count as 0)
    /// where its targets leave room, its back five times more than the rest: so a hand is followed by its
    /// arm, and a figure without limits does not twist.
    #[must_use]
    pub fn postures(&self, skeleton: &Skeleton, q: &[f64]) -> Vec<Task<Posture>> {
        let model = skeleton.model();
        let back = self.back.iter();
        let back: Vec<_> = back.flat_map(|&bone| skeleton.joints(bone)).collect();
        let q = q.iter().copied().chain(std::iter::repeat(0.0));
        let (back, limbs): (Vec<_>, Vec<_>) = (model.moving_joints().iter().copied())
            .zip(q)
            .partition(|(joint, _)| back.contains(joint));
        [
            ("posture", limbs, 1.0),
            ("posture of the back", back, STIFF),
        ]
        .into_iter()
        .filter(|(_, joints, _)| !joints.is_empty())
        .map(|(name, joints, weight)| {
            Task::new(Posture::of_joints(joints))
                .times(weight)
                .named(name)
        })
        .collect()
    }
}
