//! Easing functions.
//!
//! Every easing maps 0 to 0 and 1 to 1. Arguments are clamped to [0, 1].

use super::{CubicBezier, Real};

/// Easing function of a motion between two ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Easing {
    /// Constant speed.
    #[default]
    Linear,
    /// t²: starts slowly.
    QuadraticIn,
    /// t (2 − t): stops slowly.
    QuadraticOut,
    /// 2 t², then its point reflection.
    QuadraticInOut,
    /// t³: starts slowly.
    CubicIn,
    /// 1 − (1 − t)³: stops slowly.
    CubicOut,
    /// 4 t³, then its point reflection 1 − (2 − 2t)³ / 2.
    CubicInOut,
    /// Bézier curve with two handles.
    Bezier(BezierEasing),
}

impl Easing {
    /// All easings with a closed form.
    pub const ALL: [Self; 7] = [
        Self::Linear,
        Self::QuadraticIn,
        Self::QuadraticOut,
        Self::QuadraticInOut,
        Self::CubicIn,
        Self::CubicOut,
        Self::CubicInOut,
    ];

    /// Value at `t` in [0, 1]; NaN counts as 0.
    #[must_use]
    pub fn at<R: Real>(self, t: R) -> R {
        let [half, one, two, four] = [0.5, 1.0, 2.0, 4.0].map(R::from);
        let t = clamped(t);
        let rest = one - t;
        match self {
            Self::Linear => t,
            Self::QuadraticIn => t * t,
            Self::QuadraticOut => t * (two - t),
            Self::QuadraticInOut if t < half => two * t * t,
            Self::QuadraticInOut => one - two * rest * rest,
            Self::CubicIn => t * t * t,
            Self::CubicOut => one - rest * rest * rest,
            Self::CubicInOut if t < half => four * t * t * t,
            Self::CubicInOut => one - four * rest * rest * rest,
            Self::Bezier(bezier) => R::from_f64(bezier.value(t.as_f64())),
        }
    }

    /// Derivative of [`at`](Self::at) by t, one-sided at the ends; NaN counts as 0. Very large if a Bézier easing is
    /// vertical at t.
    #[must_use]
    pub fn rate<R: Real>(self, t: R) -> R {
        let [half, one, two, three, four] = [0.5, 1.0, 2.0, 3.0, 4.0].map(R::from);
        let t = clamped(t);
        let rest = one - t;
        match self {
            Self::Linear => one,
            Self::QuadraticIn => two * t,
            Self::QuadraticOut => two * rest,
            Self::QuadraticInOut if t < half => four * t,
            Self::QuadraticInOut => four * rest,
            Self::CubicIn => three * t * t,
            Self::CubicOut => three * rest * rest,
            Self::CubicInOut if t < half => four * three * t * t,
            Self::CubicInOut => four * three * rest * rest,
            Self::Bezier(bezier) => R::from_f64(bezier.slope(t.as_f64())),
        }
    }
}

/// Clamps to [0, 1]; 0 for NaN.
fn clamped<R: Real>(t: R) -> R {
    let [zero, one] = [0.0, 1.0].map(R::from);
    match (t > zero, t < one) {
        (true, true) => t,
        (true, false) => one,
        _ => zero,
    }
}

/// Easing by two handles, as in f-curve editors and CSS's `cubic-bezier`. It is the Bézier curve from (0, 0) to (1, 1)
/// in the plane of time and value. In JSON it is the two handles: `{"bezier": [[0.42, 0], [0.58, 1]]}`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(try_from = "[[f32; 2]; 2]", into = "[[f32; 2]; 2]")]
pub struct BezierEasing {
    handles: [[f32; 2]; 2],
}

/// Error of a handle that is not finite or has a time outside [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("easing handle ({time}, {value}): both numbers must be finite and the time within [0, 1]")]
#[non_exhaustive]
pub struct HandleError {
    /// Time of the handle.
    pub time: f32,
    /// Value of the handle.
    pub value: f32,
}

impl BezierEasing {
    /// Easing with these `[time, value]` handles. Values may be outside [0, 1], times may not.
    ///
    /// # Errors
    /// A handle is not finite or its time is outside [0, 1].
    pub fn new(first: [f32; 2], second: [f32; 2]) -> Result<Self, HandleError> {
        for [time, value] in [first, second] {
            if !((0.0..=1.0).contains(&time) && value.is_finite()) {
                return Err(HandleError { time, value });
            }
        }
        let handles = [first, second];
        Ok(Self { handles })
    }

    /// The `[time, value]` handles.
    #[must_use]
    pub fn handles(&self) -> [[f32; 2]; 2] {
        self.handles
    }

    /// Times or values of the four control points.
    fn along(&self, axis: usize) -> CubicBezier<f64> {
        let [first, second] = self.handles.map(|handle| f64::from(handle[axis]));
        CubicBezier::new([0.0, first, second, 1.0])
    }

    fn value(&self, time: f64) -> f64 {
        self.along(1).position(self.along(0).parameter_at(time))
    }

    fn slope(&self, time: f64) -> f64 {
        let times = self.along(0);
        times.slope_of(&self.along(1), times.parameter_at(time))
    }
}

impl TryFrom<[[f32; 2]; 2]> for BezierEasing {
    type Error = HandleError;

    fn try_from([first, second]: [[f32; 2]; 2]) -> Result<Self, HandleError> {
        Self::new(first, second)
    }
}

impl From<BezierEasing> for [[f32; 2]; 2] {
    fn from(easing: BezierEasing) -> Self {
        easing.handles
    }
}

impl From<BezierEasing> for Easing {
    fn from(easing: BezierEasing) -> Self {
        Self::Bezier(easing)
    }
}
