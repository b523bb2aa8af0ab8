//! Angles of bones from rotations, within limits and near the angles before.

use std::f64::consts::TAU;

use glam::DQuat;

use kinopt_animation::animation::{bone_angles, bone_rotation};
use kinopt_kinematics::model::Limits;

/// Bend in radians below which only the sum of both twists is defined.
const MIN_BEND: f64 = 1e-7;

/// Returns the angles (first twist, bend, second twist, radians) of a rotation from rest.
///
/// Of all angles of the rotation these violate the limits least, and are then nearest to `previous`. The result is
/// within the limits.
pub(super) fn angles_near(
    rotation: DQuat,
    limits: &[Limits; 3],
    previous: Option<[f64; 3]>,
) -> [f64; 3] {
    let angles = bone_angles(rotation, limits);
    let Some(previous) = previous else {
        return clamped(angles, limits);
    };
    let [first, bend, second] = angles;
    if bend.abs() < MIN_BEND {
        let second_before = previous[2];
        let first = near(first + second - second_before, previous[0]);
        return clamped([first, bend, second_before], limits);
    }
    let half = 0.5 * TAU;
    let pair = [[first, bend, second], [first + half, -bend, second + half]];
    let [a, b] = pair
        .map(|[first, bend, second]| [near(first, previous[0]), bend, near(second, previous[2])]);
    let violation = |angles: &[f64; 3]| -> f64 {
        let parts = angles.iter().zip(limits);
        parts
            .map(|(angle, limits)| (limits.lower - angle).max(angle - limits.upper).max(0.0))
            .sum()
    };
    let distance = |angles: &[f64; 3]| -> f64 {
        angles
            .iter()
            .zip(previous)
            .map(|(a, b)| (a - b).abs())
            .sum()
    };
    const VIOLATION_TOLERANCE: f64 = 1e-9;
    let difference = violation(&a) - violation(&b);
    let second_is_better = match difference.abs() > VIOLATION_TOLERANCE {
        true => difference > 0.0,
        false => distance(&a) > distance(&b),
    };
    clamped(if second_is_better { b } else { a }, limits)
}

/// Returns the rotation of angles.
pub(super) fn rotation_of(angles: [f64; 3]) -> DQuat {
    bone_rotation(angles)
}

fn clamped(angles: [f64; 3], limits: &[Limits; 3]) -> [f64; 3] {
    let [a, b, c] = angles;
    let clamp = |angle: f64, limits: &Limits| angle.max(limits.lower).min(limits.upper);
    [
        clamp(a, &limits[0]),
        clamp(b, &limits[1]),
        clamp(c, &limits[2]),
    ]
}

/// Adds whole turns to an angle so that it is next to another one.
fn near(angle: f64, to: f64) -> f64 {
    angle - TAU * ((angle - to) / TAU).round()
}
