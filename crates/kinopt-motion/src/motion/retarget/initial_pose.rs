//! Initial pose before the first capture frame is solved.

use super::limbs::Limbs;
use kinopt_kinematics::model::Source;
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::Vector3;
use kinopt_robot::robot::Robot;

impl Limbs {
    /// Returns the neutral configuration, with the base at the root's target position and the best yaw for all targets.
    pub(super) fn initial_configuration(
        &self,
        robot: &Robot,
        targets: &[Vector3<f64>],
    ) -> Vec<f64> {
        let model = robot.model();
        let mut q = model.neutral();
        let Some(base) = model.free_coordinates().next() else {
            return q;
        };
        let mut kinematics = kinopt_kinematics::kinematics::ForwardKinematics::new(model);
        let Ok(placed) = kinematics.place(&q) else {
            return q;
        };
        let points: Vec<_> = self
            .all
            .iter()
            .map(|limb| placed[limb.frame.index()].apply(limb.offset))
            .collect();
        let mean = |targets: &[Vector3<f64>]| {
            let sum = targets
                .iter()
                .fold(Vector3::zero(), |sum, position| sum + *position);
            sum * (1.0 / targets.len() as f64)
        };
        let (from, to) = (mean(&points), mean(targets));
        let (mut sine, mut cosine) = (0.0, 0.0);
        for (a, b) in points.iter().zip(targets) {
            let (a, b) = (*a - from, *b - to);
            sine += a.x * b.y - a.y * b.x;
            cosine += a.x * b.x + a.y * b.y;
        }
        let yaw = elementary::atan2(sine, cosine);
        let (sin, cos) = elementary::sin_cos(0.5 * yaw);
        let fixed =
            |coordinate: usize| matches!(robot.map().sources()[coordinate], Source::Constant(_));
        if base.clone().any(fixed) {
            return q;
        }
        // Rotation about the vertical axis through the mean position.
        let (c, s) = (cos * cos - sin * sin, 2.0 * sin * cos);
        let base_offset = Vector3::new(q[base.start], q[base.start + 1], q[base.start + 2]) - from;
        let base_offset = Vector3::new(
            c * base_offset.x - s * base_offset.y,
            s * base_offset.x + c * base_offset.y,
            base_offset.z,
        );
        q[base.start..base.start + 3].copy_from_slice(&(to + base_offset).to_array());
        q[base.start + 3..base.end].copy_from_slice(&[cos, 0.0, 0.0, sin]);
        q
    }
}
