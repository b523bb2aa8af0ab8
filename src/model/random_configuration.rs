//! A configuration drawn at random.

use super::Model;
use crate::random::RandomStream;

impl Model {
    /// A configuration drawn uniformly within the limits, always the same one for the same seed.
    /// Where a limit is missing, or some turns away, the range ends half a turn (for sliding joints the
    /// model's [`reach`](Self::reach)) away from [`neutral`](Self::neutral).
    #[must_use]
    pub fn random_configuration(&self, seed: u64) -> Vec<f64> {
        // Restarts draw from the streams 1, 2, …; the caller's start is attempt 0.
        let mut random = RandomStream::new(seed, 0);
        let reach = self.reach();
        let moving = self.moving_joints().iter().zip(self.neutral());
        let draw = |(id, neutral): (&super::JointId, f64)| {
            let joint = &self.joints[id.index()];
            let spread = self.sampling_spread(joint, reach);
            let (lower, upper) = joint.limits.sampling_range(neutral, spread);
            let share = random.unit();
            joint.limits.clamp(lower * (1.0 - share) + upper * share)
        };
        moving.map(draw).collect()
    }
}
