//! Rotations of body parts from positions alone: limb directions and the planes in which limbs bend.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};

use super::super::BodyPart;
use super::rotation::{arc, axes};

/// Weight of the anatomical bend plane, relative to the sine of the bend. It defines the plane of a straight limb.
const ANATOMICAL_WEIGHT: f64 = 0.15;

/// Length of the trunk below and above the chest, relative to the trunk, up to which the chest is no bend.
const MIN_TRUNK_SHARE: f64 = 0.15;

/// Returns the rotation of the axes of each part that its positions determine, with z up.
///
/// x is along the limb; y is the axis about which knee or elbow bends. For the trunk x points to the left and y up. A
/// hand has the axes of its forearm.
pub(super) fn part_rotations(at: &dyn Fn(BodyPart) -> Option<DVec3>) -> BTreeMap<BodyPart, DQuat> {
    use BodyPart::*;
    let between = |from: BodyPart, to: BodyPart| Some(at(to)? - at(from)?);
    let middle = |a: BodyPart, b: BodyPart| Some(0.5 * (at(a)? + at(b)?));
    let mut rotations = BTreeMap::new();
    let hips = middle(LeftHip, RightHip).or_else(|| at(Pelvis));
    let shoulders = middle(LeftShoulder, RightShoulder).or_else(|| at(Chest));
    let left = between(RightHip, LeftHip).or_else(|| between(RightShoulder, LeftShoulder));
    let left_of_shoulders = between(RightShoulder, LeftShoulder).or(left);
    let trunk = hips
        .zip(shoulders)
        .map_or(DVec3::Z, |(hips, shoulders)| shoulders - hips);
    // The bend of the trunk is at the chest, if it is between hips and shoulders.
    let parts = hips
        .zip(shoulders)
        .zip(at(Chest))
        .map(|((hips, shoulders), chest)| [chest - hips, shoulders - chest]);
    let is_long = |part: &DVec3| part.length() > MIN_TRUNK_SHARE * trunk.length();
    let parts = parts.filter(|parts| parts.iter().all(is_long));
    let [lower, upper] = parts.unwrap_or([trunk, trunk]);
    let pelvis = left.and_then(|left| axes(left, lower));
    let chest = left_of_shoulders.and_then(|left| axes(left, upper));
    if let Some(rotation) = pelvis {
        rotations.insert(Pelvis, rotation);
    }
    if let Some(rotation) = chest {
        rotations.insert(Chest, rotation);
        let neck = shoulders.and_then(|shoulders| Some(at(Head)? - shoulders));
        let towards_head = neck.map(|neck| arc(rotation * DVec3::Y, neck) * rotation);
        rotations.insert(Head, towards_head.unwrap_or(rotation));
    }
    for [upper, lower, end, toe] in [
        [LeftHip, LeftKnee, LeftAnkle, LeftToe],
        [RightHip, RightKnee, RightAnkle, RightToe],
    ] {
        let (Some(thigh), Some(shin), Some(pelvis)) =
            (between(upper, lower), between(lower, end), pelvis)
        else {
            continue;
        };
        // A knee bends backwards, about the axis to the left.
        let hinge = hinge(thigh, shin, pelvis * DVec3::X);
        rotations.extend(axes(thigh, hinge).map(|rotation| (upper, rotation)));
        rotations.extend(axes(shin, hinge).map(|rotation| (lower, rotation)));
        let foot = between(end, toe).and_then(|foot| axes(foot, hinge));
        if let Some(rotation) = foot.or_else(|| axes(shin, hinge)) {
            rotations.insert(end, rotation);
            rotations.insert(toe, rotation);
        }
    }
    for ([upper, lower, end], side) in [
        ([LeftShoulder, LeftElbow, LeftHand], 1.0),
        ([RightShoulder, RightElbow, RightHand], -1.0),
    ] {
        let (Some(arm), Some(forearm), Some(chest)) =
            (between(upper, lower), between(lower, end), chest)
        else {
            continue;
        };
        // An elbow bends forwards: with the arm to the side, about the vertical.
        let to_side = chest * (DVec3::X * side);
        let anatomical = arc(to_side, arm) * (chest * (DVec3::NEG_Y * side));
        let hinge = hinge(arm, forearm, anatomical);
        rotations.extend(axes(arm, hinge).map(|rotation| (upper, rotation)));
        if let Some(rotation) = axes(forearm, hinge) {
            rotations.insert(lower, rotation);
            rotations.insert(end, rotation);
        }
    }
    rotations
}

/// Axis about which a limb of two segments is bent.
fn hinge(upper: DVec3, lower: DVec3, anatomical: DVec3) -> DVec3 {
    let (upper, lower) = (upper.normalize_or_zero(), lower.normalize_or_zero());
    upper.cross(lower) + anatomical * ANATOMICAL_WEIGHT
}
