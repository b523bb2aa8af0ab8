//! Range of accurate sines and cosines, and an approximate arctangent.

use kinopt_kinematics::scalar::Scalar;
pub(crate) use kinopt_kinematics::scalar::trigonometry::ROUNDER;

/// Largest |angle| in radians for which the sine and cosine of lanes keep their accuracy.
pub const MAX_ANGLE: f64 = kinopt_kinematics::scalar::trigonometry::MAX_ANGLE;

/// Angle of the point (x, y) in radians, to 1e-7: for initial configurations, not for results.
///
/// The polynomial is Abramowitz and Stegun 4.4.49.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn rough_atan2<S: Scalar>(y: S, x: S) -> S {
    const ATAN: [f64; 9] = [
        1.0,
        -0.333_331_452_8,
        0.199_935_508_5,
        -0.142_088_994_4,
        0.106_562_639_3,
        -0.075_289_640_0,
        0.042_909_613_8,
        -0.016_165_736_7,
        0.002_866_225_7,
    ];
    let c = S::constant;
    let (ax, ay) = (x.abs(), y.abs());
    let t = ax.min(ay) / ax.max(ay).max(c(1e-300));
    let z = t * t;
    let mut sum = c(ATAN[8]);
    for k in (0..8).rev() {
        sum = sum.mul_add(z, c(ATAN[k]));
    }
    let octant = sum * t;
    let quadrant = S::select(
        ax.less_than(ay),
        c(std::f64::consts::FRAC_PI_2) - octant,
        octant,
    );
    let half = S::select(
        x.less_than(S::zero()),
        c(std::f64::consts::PI) - quadrant,
        quadrant,
    );
    S::select(y.less_than(S::zero()), -half, half)
}
