//! Bones as segments from tail to tip.

use glam::DVec3;

use crate::skinning::SkinningError;
use kinopt_kinematics::skeleton::Skeleton;

/// Tail and tip of a bone; equal for a bone of length 0.
pub(super) type BoneSegment = [DVec3; 2];

/// The bones of a skeleton at rest.
pub(super) fn of_skeleton(skeleton: &Skeleton) -> Vec<BoneSegment> {
    let end = |v: kinopt_kinematics::spatial::Vector3<f64>| DVec3::from_array(v.to_array());
    let bones = skeleton.bones().iter();
    let ends = bones.map(|bone| [end(bone.rest_tail()), end(bone.rest_tip())]);
    ends.collect()
}

/// Checks that there are bones, that their ends are finite, and that `max_influences` is at least 1.
pub(super) fn check(segments: &[BoneSegment], max_influences: usize) -> Result<(), SkinningError> {
    if max_influences == 0 {
        return Err(SkinningError::NoInfluences);
    }
    let is_not_finite = |[tail, tip]: &BoneSegment| !(tail.is_finite() && tip.is_finite());
    match segments.iter().position(is_not_finite) {
        Some(bone) => Err(SkinningError::NonFiniteBone { bone }),
        None if segments.is_empty() => Err(SkinningError::NoBones),
        None => Ok(()),
    }
}

/// The point of a segment that is nearest to a given point.
pub(super) fn nearest_point(point: DVec3, [tail, tip]: &BoneSegment) -> DVec3 {
    let along = *tip - *tail;
    let squared = along.length_squared();
    let fraction = if squared > 0.0 {
        ((point - *tail).dot(along) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    *tail + fraction * along
}

/// Distance of a point from a segment.
pub(super) fn distance(point: DVec3, segment: &BoneSegment) -> f64 {
    point.distance(nearest_point(point, segment))
}
