//! Easing: how far along a motion is at a share of its time.
//!
//! Every easing maps 0 to 0 and 1 to 1; values outside [0, 1] are taken to the nearer end.

use super::curve::CubicBezier;

/// A named easing.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "snake_case")]
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
    /// t³.
    CubicIn,
    /// 1 − (1 − t)³.
    CubicOut,
    /// 4 t³, then its point reflection 1 − (2 − 2t)³ / 2.
    CubicInOut,
}

impl Easing {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Linear,
        Self::QuadraticIn,
        Self::QuadraticOut,
        Self::QuadraticInOut,
        Self::CubicIn,
        Self::CubicOut,
        Self::CubicInOut,
    ];

    /// The share of the way at a share `t` of the time; NaN counts as 0.
    #[must_use]
    pub fn at(self, t: f32) -> f32 {
        let t = share(t);
        let rest = 1.0 - t;
        match self {
            Self::Linear => t,
            Self::QuadraticIn => t * t,
            Self::QuadraticOut => t * (2.0 - t),
            Self::QuadraticInOut if t < 0.5 => 2.0 * t * t,
            Self::QuadraticInOut => 1.0 - 2.0 * rest * rest,
            Self::CubicIn => t * t * t,
            Self::CubicOut => 1.0 - rest * rest * rest,
            Self::CubicInOut if t < 0.5 => 4.0 * t * t * t,
            Self::CubicInOut => 1.0 - 4.0 * rest * rest * rest,
        }
    }
}

/// The nearest number within [0, 1]; 0 for NaN.
fn share(t: f32) -> f32 {
    if t > 0.0 { t.min(1.0) } else { 0.0 }
}

/// An easing drawn by two handles, as f-curve editors and CSS's `cubic-bezier` have it: the Bézier
/// curve from (0, 0) to (1, 1) in the plane of time and value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BezierEasing {
    time: CubicBezier<f64>,
    value: CubicBezier<f64>,
}

/// A handle whose time would let the curve run backwards.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the handle ({time}, {value}) must be finite with a time within [0, 1]")]
pub struct HandleError {
    /// The handle's time.
    pub time: f32,
    /// The handle's value.
    pub value: f32,
}

impl BezierEasing {
    /// The easing with these `[time, value]` handles; values may leave [0, 1], times may not.
    ///
    /// # Errors
    /// A handle that is not finite or whose time is outside [0, 1].
    pub fn new(first: [f32; 2], second: [f32; 2]) -> Result<Self, HandleError> {
        for [time, value] in [first, second] {
            if !((0.0..=1.0).contains(&time) && value.is_finite()) {
                return Err(HandleError { time, value });
            }
        }
        let along =
            |k: usize| CubicBezier::new([0.0, f64::from(first[k]), f64::from(second[k]), 1.0]);
        Ok(Self {
            time: along(0),
            value: along(1),
        })
    }

    /// The value at a time within [0, 1]: the curve's parameter is solved for, by Newton's method
    /// kept within a bracket that halves when a step leaves it.
    #[must_use]
    pub fn at(&self, time: f32) -> f32 {
        let time = f64::from(share(time));
        let (mut low, mut high, mut u) = (0.0, 1.0, time);
        for _ in 0..60 {
            let miss = self.time.position(u) - time;
            if miss.abs() < 1e-12 {
                break;
            }
            if miss > 0.0 {
                high = u;
            } else {
                low = u;
            }
            let newton = u - miss / self.time.tangent(u);
            u = if low < newton && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
        }
        self.value.position(u) as f32
    }
}
