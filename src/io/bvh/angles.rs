//! Rotation channels of a written joint: continuous angles about given axes.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DQuat, DVec3};

use crate::animation::rotation::EulerOrder;
use crate::animation::rotation::exponential::turn_about_exactly;
use crate::scalar::elementary;

/// Axes of the rotation channels that are written without given channels: z, x, y.
const DEFAULT_AXES: [usize; 3] = [2, 0, 1];
/// Distance of the middle angle from gimbal lock, in radians, below which its rounding in single precision determines the
/// outer angles.
const LOCKED: f64 = 1e-6;
/// Rotation angle, in radians, that counts as rounding of single precision.
pub(super) const STILL: f64 = 1e-6;

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
                let order = EulerOrder::ALL.into_iter().find(|own| own.axes() == axes);
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
    pub(super) fn reproduce(&self, rotation: DQuat) -> bool {
        let angles = self.nearest(rotation, [0.0; 3]);
        let own = self.to_vec().into_iter().zip(angles);
        let reproduced = own.fold(DQuat::IDENTITY, |turned, (axis, angle)| {
            turned * turn_about_exactly(DVec3::AXES[axis], angle)
        });
        // Half of the sine of the angle between both.
        (reproduced.conjugate() * rotation).xyz().length() <= 0.5 * STILL
    }

    /// The angles of a unit quaternion, in radians, nearest to those of the previous frame, for interpolation by other
    /// programs. Missing axes have zeros.
    pub(super) fn nearest(&self, rotation: DQuat, before: [f64; 3]) -> [f64; 3] {
        let angles = match *self {
            Self::Fixed => [0.0; 3],
            Self::One(axis) => [angle_about(rotation, axis), 0.0, 0.0],
            Self::Two([first, second]) => {
                // Only the first rotation moves the second axis.
                let [a, b] = [first, second].map(|axis| DVec3::AXES[axis]);
                let moved = rotation * b;
                let angle = elementary::atan2(moved.dot(a.cross(b)), moved.dot(b));
                let left = turn_about_exactly(a, -angle) * rotation;
                [angle, angle_about(left, second), 0.0]
            }
            Self::Three(order) => return of_order(order, rotation, before),
        };
        near(angles, before)
    }
}

/// Angle of the rotation about one axis that is nearest to a unit quaternion.
fn angle_about(rotation: DQuat, axis: usize) -> f64 {
    2.0 * elementary::atan2(rotation.xyz()[axis], rotation.w)
}

fn of_order(order: EulerOrder, rotation: DQuat, before: [f64; 3]) -> [f64; 3] {
    let [mut first, middle, mut last] = order.from_quaternion(rotation).angles;
    let [i, j, _] = order.axes();
    let is_proper = order.is_proper();
    // In gimbal lock the last rotation is about the first axis or its opposite.
    let (to_lock, direction) = if is_proper {
        let sign = if middle < FRAC_PI_2 { 1.0 } else { -1.0 };
        (middle.min(PI - middle), sign)
    } else {
        let is_even = (i + 1) % 3 == j;
        let parity = if is_even { 1.0 } else { -1.0 };
        (FRAC_PI_2 - middle.abs(), middle.signum() * parity)
    };
    if to_lock < LOCKED {
        first += (last - before[2]) * direction;
        last = before[2];
    }
    // The two angle triples of a rotation, each up to full turns.
    let other_middle = if is_proper { -middle } else { PI - middle };
    let both = [[first, middle, last], [first + PI, other_middle, last + PI]];
    let [one, other] = both.map(|angles| near(angles, before));
    if distance(one, before) <= distance(other, before) {
        one
    } else {
        other
    }
}

/// The angles plus full turns, each at most half a turn from the angle in `before`; radians.
fn near(mut angles: [f64; 3], before: [f64; 3]) -> [f64; 3] {
    for (angle, before) in angles.iter_mut().zip(before) {
        *angle -= TAU * ((*angle - before) / TAU).round();
    }
    angles
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum()
}
