//! Bounds on the components of a pose.

use std::f64::consts::PI;

use super::quantity::chord_of;

/// An axis of the target frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// The x axis.
    X,
    /// The y axis.
    Y,
    /// The z axis.
    Z,
}

/// Pose bounds: largest offset of each component of a pose from its target, in the target's axes.
///
/// Tolerances are added to the bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseBounds {
    half_widths: [f64; 6],
    /// Half widths in the measure of the rows: angles as chords 2 sin(θ/2); infinite for a free component.
    bands: [f64; 6],
}

impl Default for PoseBounds {
    /// Bounds of zero on all six components.
    fn default() -> Self {
        Self::pose()
    }
}

impl PoseBounds {
    /// Exact position and orientation. The default.
    #[must_use]
    pub fn pose() -> Self {
        Self::within([0.0; 6])
    }

    /// Exact position, any orientation.
    #[must_use]
    pub fn position() -> Self {
        Self::within([0.0, 0.0, 0.0, PI, PI, PI])
    }

    /// Exact pose except for a free rotation about one axis of the frame: a drill, a pen, a suction cup.
    #[must_use]
    pub fn free_about(axis: Axis) -> Self {
        Self::free(3 + axis as usize)
    }

    /// Exact pose except for a free translation along one axis of the frame.
    #[must_use]
    pub fn free_along(axis: Axis) -> Self {
        Self::free(axis as usize)
    }

    fn free(component: usize) -> Self {
        let mut half_widths = [0.0; 6];
        half_widths[component] = f64::INFINITY;
        Self::within(half_widths)
    }

    /// Bounds of ± a half width for each component: three in metres along x, y, z, three in radians about them.
    ///
    /// 0 is exact; infinity (π or more for angles) is free. A negative or NaN half width is an error when the problem
    /// or the arm is built. Angles are measured by 2 asin(v_x), 2 asin(v_y) and 2 asin(v_z). Here v is the vector part
    /// of the relative rotation's quaternion with w ≥ 0. For a rotation about one axis this is its angle.
    #[must_use]
    pub fn within(half_widths: [f64; 6]) -> Self {
        let [px, py, pz, rx, ry, rz] = half_widths;
        let chord = |h: f64| if h >= PI { f64::INFINITY } else { chord_of(h) };
        Self {
            half_widths,
            bands: [px, py, pz, chord(rx), chord(ry), chord(rz)],
        }
    }

    /// The half widths: three in metres, three in radians.
    #[must_use]
    pub fn half_widths(&self) -> [f64; 6] {
        self.half_widths
    }

    /// Half widths in the measure of the rows: metres, then chords; infinite for a free component.
    #[must_use]
    pub(crate) fn bands(&self) -> [f64; 6] {
        self.bands
    }

    /// The first half width that is negative or NaN, with the name of its component.
    pub(crate) fn invalid_half_width(&self) -> Option<(&'static str, f64)> {
        let names = ["x", "y", "z", "rx", "ry", "rz"];
        let mut named = names.into_iter().zip(self.half_widths);
        named.find(|(_, h)| h.is_nan() || *h < 0.0)
    }

    /// True if all components are exact.
    pub(crate) fn is_full_pose(&self) -> bool {
        self.half_widths == [0.0; 6]
    }

    /// Number of components that are not free.
    pub(crate) fn rows(&self) -> usize {
        self.bands
            .iter()
            .filter(|band| **band < f64::INFINITY)
            .count()
    }

    /// True if some component is bounded or free.
    pub(crate) fn has_bounds(&self) -> bool {
        self.half_widths.iter().any(|h| *h > 0.0)
    }

    /// True if some component of the position is not free.
    pub(crate) fn has_position(&self) -> bool {
        self.bands[..3].iter().any(|band| *band < f64::INFINITY)
    }

    /// True if the position is exact.
    pub(crate) fn is_exact_in_position(&self) -> bool {
        self.half_widths[..3]
            .iter()
            .all(|half_width| *half_width == 0.0)
    }

    /// True if some component of the orientation is not free.
    pub(crate) fn has_orientation(&self) -> bool {
        self.bands[3..].iter().any(|band| *band < f64::INFINITY)
    }
}
