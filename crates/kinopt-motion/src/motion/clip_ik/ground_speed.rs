//! Speed of the ground below a character that walks on the spot.

use glam::{DVec3, Vec3};

use super::ClipIkError;
use super::clip_solver::single;
use super::posed_bones::PosedBones;
use super::sampling::{limb_motions, sample_times};
use kinopt_animation::animation::{Armature, Clip, ClipError};
use kinopt_kinematics::skeleton::BoneId;
use kinopt_kinematics::spatial::Vector3;

/// Largest height of a foot near the ground above its lowest position, as a fraction of its range of heights.
const NEAR_GROUND_RATIO: f64 = 0.2;

/// Returns the travel velocity that keeps the feet of a walk on the spot at rest on the ground. It is perpendicular to
/// `up`, in the armature's unit of length per second. It is opposite to the median velocity of the feet while they are
/// near the ground. Without feet it is zero.
///
/// # Errors
/// Returns an error if `up` has no direction or the rate is not positive. Returns an error if the clip is of another
/// armature, or a bone is not in the armature.
pub fn ground_speed(
    armature: &Armature,
    clip: &Clip,
    feet: &[BoneId],
    up: impl Into<Vector3<f64>>,
    keys_per_second: f64,
) -> Result<Vec3, ClipIkError> {
    let up = single(up);
    let axis = up.try_normalize();
    let up = axis
        .ok_or(ClipError::BadUp { up: up.to_array() })?
        .as_dvec3();
    let (times, rate) = sample_times(clip, keys_per_second, std::iter::empty())?;
    let names = armature.names().len();
    if let Some(bone) = feet.iter().find(|bone| bone.index() >= names) {
        return Err(ClipIkError::UnknownBone {
            bone: bone.index(),
            bones: names,
        });
    }
    let mut posed = PosedBones::new(armature, None, feet, |_| None)?;
    let limbs = limb_motions(armature, clip, &times, feet, &mut posed)?;
    let mut steps: Vec<DVec3> = Vec::new();
    for limb in &limbs {
        let positions = &limb.positions;
        let heights = positions.iter().map(|position| position.dot(up));
        let lowest = heights.clone().fold(f64::INFINITY, f64::min);
        let highest = heights.fold(f64::NEG_INFINITY, f64::max);
        let is_near_ground =
            |position: DVec3| position.dot(up) - lowest <= NEAR_GROUND_RATIO * (highest - lowest);
        let pairs = positions
            .windows(2)
            .filter(|pair| pair.iter().all(|position| is_near_ground(*position)));
        steps.extend(pairs.map(|pair| (pair[1] - pair[0]) * rate));
    }
    let median = |axis: usize| {
        let mut values: Vec<f64> = steps.iter().map(|step| step[axis]).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let ground_velocity = DVec3::new(median(0), median(1), median(2));
    Ok((up * ground_velocity.dot(up) - ground_velocity).as_vec3())
}
