//! Bounded variables as smooth functions x(y) of unbounded ones, one by one.
//!
//! The sine and square-root forms are those of MINUIT (James & Roos 1975, "Minuit: a system for function minimization",
//! Comput. Phys. Commun. 10). They are scaled so that away from the bounds a step in y is about the same step in x.

use kinopt_kinematics::scalar::elementary;

/// Smallest distance of a start from a bound: on it dx/dy is 0, and no gradient leads away.
///
/// It is a fraction of half the range, or in the variable's unit if only one side is bounded.
const MIN_BOUND_DISTANCE: f64 = 0.01;

/// Bounded variable as a function of one unbounded y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum BoundsTransform {
    /// No bounds: x = y.
    Identity,
    /// lower = upper: x does not move.
    Locked { value: f64 },
    /// Two bounds: x = mid + half · sin(y / half).
    Sine { lower: f64, upper: f64 },
    /// Only a lower bound: x = lower − 1 + √(y² + 1).
    Above { lower: f64 },
    /// Only an upper bound: x = upper + 1 − √(y² + 1).
    Below { upper: f64 },
}

/// x, dx/dy and d²x/dy² at one y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Image {
    pub(super) value: f64,
    pub(super) slope: f64,
    pub(super) curvature: f64,
}

impl BoundsTransform {
    pub(super) fn new(lower: f64, upper: f64) -> Self {
        match (lower.is_finite(), upper.is_finite()) {
            (true, true) if lower >= upper => Self::Locked { value: lower },
            (true, true) => Self::Sine { lower, upper },
            (true, false) => Self::Above { lower },
            (false, true) => Self::Below { upper },
            (false, false) => Self::Identity,
        }
    }

    /// Image of y, exactly within the bounds; NaN for a y that is not finite.
    pub(super) fn image(self, y: f64) -> Image {
        let image = match self {
            Self::Identity => Image {
                value: y,
                slope: 1.0,
                curvature: 0.0,
            },
            Self::Locked { value } => Image {
                value: value + 0.0 * y,
                slope: 0.0,
                curvature: 0.0,
            },
            Self::Sine { lower, upper } => {
                let (mid, half) = mid_and_half(lower, upper);
                let (sin, cos) = elementary::sin_cos(y / half);
                Image {
                    value: within(mid + half * sin, lower, upper),
                    slope: cos,
                    curvature: -sin / half,
                }
            }
            Self::Above { lower } => {
                let root = elementary::hypot(y, 1.0);
                Image {
                    value: (lower + rise(y)).max(lower),
                    slope: y / root,
                    curvature: 1.0 / (root * root * root),
                }
            }
            Self::Below { upper } => {
                let root = elementary::hypot(y, 1.0);
                Image {
                    value: (upper - rise(y)).min(upper),
                    slope: -y / root,
                    curvature: -1.0 / (root * root * root),
                }
            }
        };
        if y.is_finite() {
            image
        } else {
            Image {
                value: f64::NAN,
                slope: f64::NAN,
                curvature: f64::NAN,
            }
        }
    }

    /// A y whose image is `x`, after `x` is moved off the bounds by at least `MIN_BOUND_DISTANCE`.
    pub(super) fn start(self, x: f64) -> f64 {
        let side = |bound_distance: f64| {
            let bound_distance = bound_distance.max(MIN_BOUND_DISTANCE);
            (bound_distance * (bound_distance + 2.0)).sqrt()
        };
        match self {
            Self::Identity => x,
            Self::Locked { .. } => 0.0,
            Self::Sine { lower, upper } => {
                let (mid, half) = mid_and_half(lower, upper);
                half * elementary::asin(within(
                    (x - mid) / half,
                    MIN_BOUND_DISTANCE - 1.0,
                    1.0 - MIN_BOUND_DISTANCE,
                ))
            }
            Self::Above { lower } => side(x - lower),
            Self::Below { upper } => side(upper - x),
        }
    }
}

fn mid_and_half(lower: f64, upper: f64) -> (f64, f64) {
    (0.5 * lower + 0.5 * upper, 0.5 * upper - 0.5 * lower)
}

/// √(y² + 1) − 1 without cancellation near 0.
fn rise(y: f64) -> f64 {
    y * (y / (elementary::hypot(y, 1.0) + 1.0))
}

/// Clamps a value; NaN stays NaN.
fn within(value: f64, lower: f64, upper: f64) -> f64 {
    if value < lower {
        lower
    } else if value > upper {
        upper
    } else {
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INFINITY: f64 = f64::INFINITY;

    const RANGES: [(f64, f64); 7] = [
        (-INFINITY, INFINITY),
        (-2.9, 1.7),
        (0.0, 1e-3),
        (-1e6, 5.0),
        (0.3, INFINITY),
        (-INFINITY, -0.2),
        (0.7, 0.7),
    ];

    #[test]
    fn images_are_within_the_bounds_to_the_bit() {
        for (lower, upper) in RANGES {
            let transform = BoundsTransform::new(lower, upper);
            let (_, half) = mid_and_half(lower, upper);
            let quarter_turn = half * std::f64::consts::FRAC_PI_2;
            let near = [-3.0, -1.0, 0.0, 1.0, 5.0].map(|turns| turns * quarter_turn);
            let far = (-400..400).map(|k| f64::from(k) * 0.37);
            for y in near.into_iter().chain(far).chain([1e9, -1e300, 1e-300]) {
                if y.is_finite() {
                    let x = transform.image(y).value;
                    assert!(lower <= x && x <= upper, "{transform:?} at {y}: {x}");
                }
            }
            assert!(transform.image(f64::NAN).value.is_nan());
            assert!(transform.image(INFINITY).value.is_nan());
        }
    }

    #[test]
    fn slope_and_curvature_are_the_derivatives() {
        for (lower, upper) in RANGES {
            let transform = BoundsTransform::new(lower, upper);
            let scale = match transform {
                BoundsTransform::Sine { lower, upper } => mid_and_half(lower, upper).1,
                _ => 1.0,
            };
            for k in -20..20 {
                let y = scale * (0.1 + 0.23 * f64::from(k));
                let h = scale * 1e-5;
                let (ahead, behind) = (transform.image(y + h), transform.image(y - h));
                let at = transform.image(y);
                let slope = (ahead.value - behind.value) / (2.0 * h);
                let curvature = (ahead.slope - behind.slope) / (2.0 * h);
                assert!((at.slope - slope).abs() < 1e-8, "{transform:?} at {y}");
                assert!(
                    (at.curvature - curvature).abs() * scale < 1e-8,
                    "{transform:?} at {y}"
                );
            }
        }
    }

    #[test]
    fn start_keeps_its_value_and_leaves_the_bounds() {
        for (lower, upper) in RANGES {
            let transform = BoundsTransform::new(lower, upper);
            let middle = match transform {
                BoundsTransform::Sine { lower, upper } => 0.3 * lower + 0.7 * upper,
                BoundsTransform::Above { lower } => lower + 4.0,
                BoundsTransform::Below { upper } => upper - 4.0,
                BoundsTransform::Locked { value } => value,
                BoundsTransform::Identity => 17.0,
            };
            let back = transform.image(transform.start(middle)).value;
            assert!((back - middle).abs() <= 1e-12 * middle.abs().max(1.0));
            for bound in [lower, upper] {
                if bound.is_finite() && lower < upper {
                    let slope = transform.image(transform.start(bound)).slope;
                    assert!(slope.abs() > 0.1, "{transform:?} from {bound}");
                }
            }
        }
    }
}
