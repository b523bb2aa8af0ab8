//! Which components of a pose matter, and how exactly.

use std::f64::consts::PI;

use super::quantity::chord_of;

/// An axis of the frame that is placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// Its x axis.
    X,
    /// Its y axis.
    Y,
    /// Its z axis.
    Z,
}

/// How far each component of a pose may be from its target, in the target's axes (where the placed
/// frame's own axes come to lie). Tolerances come on top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    half_widths: [f64; 6],
    /// The same as rows are measured: turns as chords 2 sin(θ/2), infinite where a component is free.
    bands: [f64; 6],
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

    /// The full pose but for turns about one axis of the frame, which are free: a drill, a pen, a
    /// suction cup.
    #[must_use]
    pub fn free_about(axis: Axis) -> Self {
        Self::free(3 + axis as usize)
    }

    /// The full pose but for slides along one axis of the frame, which are free.
    #[must_use]
    pub fn free_along(axis: Axis) -> Self {
        Self::free(axis as usize)
    }

    fn free(component: usize) -> Self {
        let mut half_widths = [0.0; 6];
        half_widths[component] = f64::INFINITY;
        Self::within(half_widths)
    }

    /// An interval of ± a half width for each component: three in metres along the axes x, y, z,
    /// three in radians about them. 0 is exact, infinity (for angles π or more) is free; negative
    /// or NaN is an error when the problem or the arm is built. Turns are measured by 2 asin(v_x), 2 asin(v_y) and
    /// 2 asin(v_z), v the vector part of the relative rotation's quaternion with w ≥ 0: for a turn
    /// about one axis its angle.
    #[must_use]
    pub fn within(half_widths: [f64; 6]) -> Self {
        let [px, py, pz, rx, ry, rz] = half_widths;
        let chord = |h: f64| if h >= PI { f64::INFINITY } else { chord_of(h) };
        Self {
            half_widths,
            bands: [px, py, pz, chord(rx), chord(ry), chord(rz)],
        }
    }

    getters! {
        /// The half widths: three in metres, three in radians.
        pub fn half_widths(&self) -> [f64; 6] = self.half_widths;
        /// Half widths as rows are measured: metres, then chords; infinite where a component is free.
        pub(crate) fn bands(&self) -> [f64; 6] = self.bands;
    }

    /// The first half width that is no number of at least 0, by the component's name.
    pub(crate) fn bad_half_width(&self) -> Option<(&'static str, f64)> {
        let names = ["x", "y", "z", "rx", "ry", "rz"];
        let mut named = names.into_iter().zip(self.half_widths);
        named.find(|(_, h)| h.is_nan() || *h < 0.0)
    }

    /// Whether all components count and none has room.
    pub(crate) fn is_full_pose(&self) -> bool {
        self.half_widths == [0.0; 6]
    }

    /// How many components count.
    pub(crate) fn rows(&self) -> usize {
        self.bands
            .iter()
            .filter(|band| **band < f64::INFINITY)
            .count()
    }

    /// Whether some component has room, or is free.
    pub(crate) fn has_room(&self) -> bool {
        self.half_widths.iter().any(|h| *h > 0.0)
    }

    /// Whether the position counts at all.
    pub(crate) fn has_position(&self) -> bool {
        self.bands[..3].iter().any(|band| *band < f64::INFINITY)
    }

    /// Whether the whole position is asked for, with no room.
    pub(crate) fn is_exact_in_position(&self) -> bool {
        self.half_widths[..3]
            .iter()
            .all(|half_width| *half_width == 0.0)
    }

    /// Whether the orientation counts at all.
    pub(crate) fn has_orientation(&self) -> bool {
        self.bands[3..].iter().any(|band| *band < f64::INFINITY)
    }
}
