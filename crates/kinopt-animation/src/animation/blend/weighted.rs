//! Weighted mean of poses.

use glam::{Quat, Vec3A, Vec4};

use crate::animation::{LayerError, Pose};

/// Writes the weighted mean of poses into `out`; the weights need not sum to one. Rotations are summed as quaternions
/// on the hemisphere of the pose with the largest weight, then normalised. The result does not depend on the order of
/// the poses.
///
/// # Errors
/// - A weight is negative or not finite, or none is above 0.
/// - The poses are of different armatures.
pub fn blend_poses(poses: &[(&Pose, f32)], out: &mut Pose) -> Result<(), LayerError> {
    for (pose, &(_, weight)) in poses.iter().enumerate() {
        if !(weight.is_finite() && weight >= 0.0) {
            return Err(LayerError::BadWeight { pose, weight });
        }
    }
    let total: f64 = poses.iter().map(|(_, weight)| f64::from(*weight)).sum();
    let heaviest = poses
        .iter()
        .reduce(|best, entry| if entry.1 > best.1 { entry } else { best });
    let Some((heaviest, _)) = heaviest.filter(|_| total > 0.0) else {
        return Err(LayerError::NoWeight);
    };
    for (pose, _) in poses {
        out.check_same_size(pose)?;
    }
    out.translations.fill(Vec3A::ZERO);
    out.scales.fill(Vec3A::ZERO);
    out.morph_weights.fill(0.0);
    out.rotations.fill(Quat::from_vec4(Vec4::ZERO));
    for (pose, weight) in poses.iter().filter(|(_, weight)| *weight > 0.0) {
        let fraction = (f64::from(*weight) / total) as f32;
        let add = |sums: &mut [Vec3A], values: &[Vec3A]| {
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += *value * fraction;
            }
        };
        add(&mut out.translations, &pose.translations);
        add(&mut out.scales, &pose.scales);
        for (sum, weight) in out.morph_weights.iter_mut().zip(&pose.morph_weights) {
            *sum += weight * fraction;
        }
        let rotations = pose.rotations.iter().zip(&heaviest.rotations);
        for (sum, (rotation, reference)) in out.rotations.iter_mut().zip(rotations) {
            let signed_fraction = if rotation.dot(*reference) < 0.0 {
                -fraction
            } else {
                fraction
            };
            *sum += *rotation * signed_fraction;
        }
    }
    for (sum, reference) in out.rotations.iter_mut().zip(&heaviest.rotations) {
        let unit = Vec4::from(*sum).try_normalize();
        *sum = unit.map_or(*reference, Quat::from_vec4);
    }
    Ok(())
}
