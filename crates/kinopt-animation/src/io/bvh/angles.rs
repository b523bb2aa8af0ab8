//! Rotation channels of a written joint: continuous angles about given axes.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DQuat, DVec3};

use crate::animation::rotation::EulerOrder;
use crate::animation::rotation::exponential::rotation_about_f64;
use kinopt_kinematics::scalar::elementary;

/// Axes of the rotation channels that are written without given channels: z, x, y.
const DEFAULT_AXES: [usize; 3] = [2, 0, 1];
/// Distance of the middle angle from gimbal lock, in radians, below which its rounding in single precision determines the
/// outer angles.
const GIMBAL_LOCK_TOLERANCE: f64 = 1e-6;
/// Rotation angle, in radians, that counts as rounding of single precision.
pub(super) const ROTATION_TOLERANCE: f64 = 1e-6;

/// Rotation axes in their order; x is 0, y 1, z 2.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Axes {
    Fixed,
    One(usize),
    Two([usize; 2]),
    Three(EulerOrder),
}

impl Axes {
    /// Axes in the order of a file: none to three, of which neighbours differ.
    pub(super) fn new(axes: &[usize]) -> Self {
        match *axes {
            [] => Self::Fixed,
            [axis] => Self::One(axis),
            [first, second] => Self::Two([first, second]),
            _ => {
                let order = EulerOrder::ALL
                    .into_iter()
                    .find(|candidate| candidate.axes() == axes);
                Self::Three(order.unwrap_or(EulerOrder::Zxy))
            }
        }
    }

    /// The axes that all rotations need, beginning with these.
    pub(super) fn completed(&self) -> Self {
        match *self {
            Self::Fixed => Self::new(&DEFAULT_AXES),
            Self::One(axis) => Self::new(&[axis, (axis + 1) % 3, (axis + 2) % 3]),
            Self::Two([first, second]) => Self::new(&[first, second, 3 - first - second]),
            Self::Three(order) => Self::Three(order),
        }
    }

    pub(super) fn to_vec(&self) -> Vec<usize> {
        match self {
            Self::Fixed => Vec::new(),
            Self::One(axis) => vec![*axis],
            Self::Two(axes) => axes.to_vec(),
            Self::Three(order) => order.axes().to_vec(),
        }
    }

    /// Returns true if angles about these axes reproduce a unit quaternion.
    pub(super) fn can_represent(&self, rotation: DQuat) -> bool {
        let angles = self.nearest(rotation, [0.0; 3]);
        let axes_and_angles = self.to_vec().into_iter().zip(angles);
        let reproduced = axes_and_angles.fold(DQuat::IDENTITY, |product, (axis, angle)| {
            product * rotation_about_f64(DVec3::AXES[axis], angle)
        });
        // Half of the sine of the angle between both.
        (reproduced.conjugate() * rotation).xyz().length() <= 0.5 * ROTATION_TOLERANCE
    }

    /// The angles of a unit quaternion, in radians, nearest to those of the previous frame, for interpolation by other
    /// programs. Missing axes have zeros.
    pub(super) fn nearest(&self, rotation: DQuat, previous: [f64; 3]) -> [f64; 3] {
        let angles = match *self {
            Self::Fixed => [0.0; 3],
            Self::One(axis) => [angle_about(rotation, axis), 0.0, 0.0],
            Self::Two([first, second]) => {
                // Only the first rotation moves the second axis.
                let [a, b] = [first, second].map(|axis| DVec3::AXES[axis]);
                let moved = rotation * b;
                let angle = elementary::atan2(moved.dot(a.cross(b)), moved.dot(b));
                let remainder = rotation_about_f64(a, -angle) * rotation;
                [angle, angle_about(remainder, second), 0.0]
            }
            Self::Three(order) => return angles_of_order(order, rotation, previous),
        };
        nearest_turns(angles, previous)
    }
}

/// Angle of the rotation about one axis that is nearest to a unit quaternion.
fn angle_about(rotation: DQuat, axis: usize) -> f64 {
    2.0 * elementary::atan2(rotation.xyz()[axis], rotation.w)
}

fn angles_of_order(order: EulerOrder, rotation: DQuat, previous: [f64; 3]) -> [f64; 3] {
    let [mut first, middle, mut last] = order.from_quaternion(rotation).angles;
    let [i, j, _] = order.axes();
    let is_proper = order.is_proper();
    // In gimbal lock the last rotation is about the first axis or its opposite.
    let (lock_distance, direction) = if is_proper {
        let sign = if middle < FRAC_PI_2 { 1.0 } else { -1.0 };
        (middle.min(PI - middle), sign)
    } else {
        let is_even = (i + 1) % 3 == j;
        let parity = if is_even { 1.0 } else { -1.0 };
        (FRAC_PI_2 - middle.abs(), middle.signum() * parity)
    };
    if lock_distance < GIMBAL_LOCK_TOLERANCE {
        first += (last - previous[2]) * direction;
        last = previous[2];
    }
    // The two angle triples of a rotation, each up to full turns.
    let other_middle = if is_proper { -middle } else { PI - middle };
    let candidates = [[first, middle, last], [first + PI, other_middle, last + PI]];
    let [one, other] = candidates.map(|angles| nearest_turns(angles, previous));
    if distance(one, previous) <= distance(other, previous) {
        one
    } else {
        other
    }
}

/// The angles plus full turns, each at most half a turn from the angle in `previous`; radians.
fn nearest_turns(mut angles: [f64; 3], previous: [f64; 3]) -> [f64; 3] {
    for (angle, previous) in angles.iter_mut().zip(previous) {
        *angle -= TAU * ((*angle - previous) / TAU).round();
    }
    angles
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum()
}
