//! A hand of the figure that goes round a circle while the other tips hold.

use kinopt::Skeleton;
use kinopt::model::Limits;
use kinopt::skeleton::BoneId;
use kinopt::spatial::Vector3;

/// The figure with every bend a little off zero: a pose in which a body stands at ease.
#[must_use]
pub fn at_ease(skeleton: &Skeleton) -> Vec<f64> {
    let limits: Vec<Limits> = skeleton.model().limits().collect();
    let bent = |(k, limits): (usize, &Limits)| limits.clamp(if k % 3 == 1 { 0.3 } else { 0.0 });
    limits.iter().enumerate().map(bent).collect()
}

/// Where the tips should be in one frame: all where the pose `q` has them, but the second, a
/// hand, on a circle of 5 cm beside its place, 240 frames a turn.
#[must_use]
pub fn drag_targets(
    skeleton: &Skeleton,
    tips: &[BoneId],
    q: &[f64],
    frame: u32,
) -> Vec<Vector3<f64>> {
    let pose = skeleton.pose(q);
    let mut targets: Vec<_> = tips.iter().map(|&tip| pose.tip(skeleton, tip)).collect();
    let angle = f64::from(frame % 240) * std::f64::consts::TAU / 240.0;
    targets[1] += Vector3::new(-0.1 + 0.05 * angle.cos(), 0.05 * angle.sin(), 0.05);
    targets
}
