//! What holds a figure while it is dragged, as tasks.

use crate::skeleton::{BallSkeleton, Holds, Skeleton};
use crate::task::{Posture, Task};

/// How much more a back keeps to its posture than limbs do.
const STIFF: f64 = 5.0;

impl Holds {
    /// The same for bones on ball joints, in one task: `q` is a configuration of theirs. A free root keeps upright as a
    /// back does, and a way of a quarter of the figure's reach counts as a radian.
    #[must_use]
    pub fn posture_of_balls(&self, figure: &BallSkeleton, q: &[f64]) -> Task<Posture> {
        let model = figure.model();
        let bones = figure.skeleton().bone_ids();
        let weights = bones.flat_map(|bone| {
            let joints = figure.joints(bone);
            let stiff = self.back.contains(&bone) || figure.is_free(bone);
            let (ball, slide) = (if stiff { STIFF } else { 1.0 }, 4.0 / model.reach());
            let slides = joints.len().saturating_sub(1);
            std::iter::repeat_n(slide, slides).chain((!joints.is_empty()).then_some(ball))
        });
        let posture = Posture::new(model, q).with_weights(weights.collect::<Vec<_>>());
        Task::new(posture).named("posture")
    }

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
