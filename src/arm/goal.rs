//! Which components of the tool's pose matter, and how exactly.

use std::f64::consts::PI;

use crate::lanes::AxisGoal;
use crate::scalar::elementary;

/// An axis of the tool frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// Its x axis.
    X,
    /// Its y axis.
    Y,
    /// Its z axis.
    Z,
}

/// How far each component of the tool's pose may be from the target, in the target's axes (where
/// the tool's own axes come to lie). The tolerances of the arm come on top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    half_widths: [f64; 6],
}

impl Default for Goal {
    /// The full pose.
    fn default() -> Self {
        Self::pose()
    }
}

impl Goal {
    /// Position and orientation, exactly. The default.
    #[must_use]
    pub fn pose() -> Self {
        Self::within([0.0; 6])
    }

    /// Position alone, any orientation.
    #[must_use]
    pub fn position() -> Self {
        Self::within([0.0, 0.0, 0.0, PI, PI, PI])
    }

    /// The full pose but for turns about one axis of the tool, which are free: a drill, a pen, a
    /// suction cup.
    #[must_use]
    pub fn free_about(axis: Axis) -> Self {
        let mut goal = Self::pose();
        goal.half_widths[3 + axis as usize] = f64::INFINITY;
        goal
    }

    /// The full pose but for slides along one axis of the tool, which are free.
    #[must_use]
    pub fn free_along(axis: Axis) -> Self {
        let mut goal = Self::pose();
        goal.half_widths[axis as usize] = f64::INFINITY;
        goal
    }

    /// An interval of ± a half width for each component: three in metres along the axes x, y, z,
    /// three in radians about them. 0 is exact, infinity (for angles π or more) is free; negative
    /// or NaN is an error when the arm is built. Turns are measured by 2 asin(v_x), 2 asin(v_y) and
    /// 2 asin(v_z), v the vector part of the relative rotation's quaternion with w ≥ 0: for a turn
    /// about one axis its angle.
    #[must_use]
    pub fn within(half_widths: [f64; 6]) -> Self {
        Self { half_widths }
    }

    /// The half widths: three in metres, three in radians.
    #[must_use]
    pub fn half_widths(&self) -> [f64; 6] {
        self.half_widths
    }

    /// The first half width that is no number of at least 0.
    pub(super) fn defect(&self) -> Option<f64> {
        // `>= 0` is false for NaN.
        self.half_widths
            .into_iter()
            .find(|h| h.is_nan() || *h < 0.0)
    }

    /// In the lane engine's terms: free components have weight 0, angles become chords 2 sin(θ/2).
    pub(super) fn axes(&self) -> AxisGoal {
        let [px, py, pz, rx, ry, rz] = self.half_widths;
        let weight = |free: bool| if free { 0.0 } else { 1.0 };
        let (position, turn) = ([px, py, pz], [rx, ry, rz]);
        AxisGoal {
            position_weights: position.map(|h| weight(h == f64::INFINITY)),
            orientation_weights: turn.map(|h| weight(h >= PI)),
            position_half_widths: position.map(|h| if h.is_finite() { h } else { 0.0 }),
            orientation_half_widths: turn.map(|h| {
                if h < PI {
                    2.0 * elementary::sin(0.5 * h)
                } else {
                    0.0
                }
            }),
        }
    }

    /// Whether all components count and none has room.
    pub(super) fn is_full_pose(&self) -> bool {
        self.half_widths == [0.0; 6]
    }

    /// How many components count.
    pub(super) fn rows(&self) -> usize {
        let (position, turn) = self.half_widths.split_at(3);
        let position = position.iter().filter(|h| **h < f64::INFINITY);
        position.count() + turn.iter().filter(|h| **h < PI).count()
    }

    /// Whether some component that counts has room.
    pub(super) fn has_room(&self) -> bool {
        self.half_widths.iter().any(|h| *h > 0.0)
    }

    /// Whether the position counts at all.
    pub(super) fn has_position(&self) -> bool {
        self.half_widths[..3].iter().any(|h| *h < f64::INFINITY)
    }

    /// Whether the whole position is asked for, with no room.
    pub(super) fn is_exact_in_position(&self) -> bool {
        self.half_widths[..3]
            .iter()
            .all(|half_width| *half_width == 0.0)
    }

    /// Whether the orientation counts at all.
    pub(super) fn has_orientation(&self) -> bool {
        self.half_widths[3..].iter().any(|h| *h < PI)
    }
}
