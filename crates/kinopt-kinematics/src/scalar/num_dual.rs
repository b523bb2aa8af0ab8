//! num-dual's `DualSVec64` as a scalar (feature `num-dual`).
//!
//! Sums, products and quotients are num-dual's. Elementary functions are bitwise reproducible, unlike num-dual's.

use ::num_dual::DualSVec64;

use super::{Scalar, elementary};

/// Dual numbers of the crate num-dual: a value `re` and its derivatives `eps` along `N` directions.
///
/// Rotations of [`spatial`](crate::spatial) over this type have exact derivatives at the identity. nalgebra's rotations
/// over this type do not.
///
/// ```
/// use kinopt::kinematics::ForwardKinematics;
/// use kinopt::model::{Limits, Model};
/// use kinopt::nalgebra::Vector2;
/// use kinopt::num_dual::jacobian;
/// use kinopt::spatial::{Placement, Vector3};
///
/// // Two links of one metre in the xy plane.
/// let mut arm = Model::builder("two links");
/// let (x, z) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
/// let (link, limits) = (Placement::translation(x), Limits::new(-2.5, 2.5));
/// let shoulder = arm.revolute("shoulder", None, Placement::identity(), z, limits);
/// let elbow = arm.revolute("elbow", Some(shoulder), link, z, limits);
/// let tip = arm.frame("tip", Some(elbow), link);
/// let arm = arm.build()?;
///
/// let position = |q: Vector2<_>| {
///     let mut kinematics = ForwardKinematics::of_frames(&arm, &[tip]).unwrap();
///     let tip = kinematics.place(q.as_slice()).unwrap()[0].translation;
///     Vector2::new(tip.x, tip.y)
/// };
/// let (tip, derivatives) = jacobian(position, &Vector2::new(0.0, 0.0));
/// assert_eq!(tip, Vector2::new(2.0, 0.0));
/// assert_eq!(derivatives.row(1), kinopt::nalgebra::RowVector2::new(2.0, 1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
impl<const N: usize> Scalar for DualSVec64<N> {
    type Mask = bool;

    #[inline(always)]
    fn is_finite(self) -> bool {
        self.re.is_finite()
    }

    #[inline(always)]
    fn as_f64(self) -> Option<f64> {
        Some(self.re)
    }

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::from_re(value)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        chain(self, root, 0.5 / root)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = elementary::sin_cos(self.re);
        (chain(self, sin, cos), chain(self, cos, -sin))
    }

    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        // d atan2(y, x) = (x dy − y dx) / (x² + y²), also at x = 0.
        let squared = self.re * self.re + x.re * x.re;
        let by_y = self.eps * (x.re / squared);
        let by_x = x.eps * -(self.re / squared);
        Self::new(elementary::atan2(self.re, x.re), by_y + by_x)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let exp = elementary::exp(self.re);
        chain(self, exp, exp)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        chain(self, elementary::ln(self.re), 1.0 / self.re)
    }

    #[inline(always)]
    fn less_than(self, other: Self) -> bool {
        self.re < other.re
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
}

/// A function of `x`, from the function's value and derivative (chain rule).
#[inline(always)]
fn chain<const N: usize>(x: DualSVec64<N>, value: f64, slope: f64) -> DualSVec64<N> {
    DualSVec64::new(value, x.eps * slope)
}
