//! Angles that run on from frame to frame.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DQuat;

use crate::animation::rotation::EulerOrder;

/// How rotations are written: the order of the first files.
pub(super) const ORDER: EulerOrder = EulerOrder::Zxy;

/// So near to a quarter turn, in radians, the middle angle's rounding in single precision decides
/// over the outer two.
const LOCKED: f64 = 1e-6;

/// The angles of a unit quaternion, in radians, that are nearest to those of the frame before: other
/// programs run straight from angle to angle.
pub(super) fn nearest(rotation: DQuat, before: [f64; 3]) -> [f64; 3] {
    let [mut first, middle, mut last] = ORDER.from_quaternion(rotation).angles;
    if FRAC_PI_2 - middle.abs() < LOCKED {
        // Only the sum counts, or for a quarter turn back the difference; the last stays.
        first += (last - before[2]) * middle.signum();
        last = before[2];
    }
    // The two triples of a rotation, each up to whole turns.
    let both = [[first, middle, last], [first + PI, PI - middle, last + PI]];
    let [one, other] = both.map(|angles| near(angles, before));
    if distance(one, before) <= distance(other, before) {
        one
    } else {
        other
    }
}

/// The same angles but for whole turns, each at most half a turn from the one before.
fn near(mut angles: [f64; 3], before: [f64; 3]) -> [f64; 3] {
    for (angle, before) in angles.iter_mut().zip(before) {
        *angle -= TAU * ((*angle - before) / TAU).round();
    }
    angles
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum()
}
