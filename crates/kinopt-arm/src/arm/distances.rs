//! Distances of configurations and of poses.

use super::arm::Arm;
use kinopt_kinematics::spatial::Placement;

/// Joint motion beyond which a step is a jump, radians; prismatic joints count by the metres that weigh as much.
pub(super) const MAX_JOINT_STEP: f64 = 0.2;

/// Index of the joint that moves farthest and its motion, radians (see `MAX_JOINT_STEP` for prismatic joints).
pub(super) fn largest_joint_move(arm: &Arm, from: &[f64], to: &[f64]) -> (usize, f64) {
    let mut largest = (0, 0.0);
    for (i, ((a, b), scale)) in from.iter().zip(to).zip(&arm.scale).enumerate() {
        let moved = (a - b).abs() * scale;
        if moved > largest.1 {
            largest = (i, moved);
        }
    }
    largest
}

/// Distance of two poses in radians; metres convert by the weight of the cost.
pub(super) fn pose_distance(arm: &Arm, a: &Placement<f64>, b: &Placement<f64>) -> f64 {
    let translation = (a.translation - b.translation) * arm.options.metres_per_radian.recip();
    let (r, s) = (&a.rotation, &b.rotation);
    let rotation =
        (r.x - s.x).norm_squared() + (r.y - s.y).norm_squared() + (r.z - s.z).norm_squared();
    (translation.norm_squared() + 0.5 * rotation).sqrt()
}

/// Weighted distance of two configurations.
pub(super) fn weighted_distance(arm: &Arm, a: &[f64], b: &[f64]) -> f64 {
    let weighted = a.iter().zip(b).zip(&arm.options.weights);
    let squares = weighted.map(|((a, b), w)| (w * (a - b)) * (w * (a - b)));
    squares.sum::<f64>().sqrt()
}
