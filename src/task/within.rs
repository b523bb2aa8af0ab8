//! Any residual may have room.

use super::residual::refuse;
use super::{Residual, Role, Rows};
use crate::model::{FrameId, JointId};
use crate::scalar::Scalar;
use crate::spatial::Placement;

/// r_i − min(max(r_i, lower), upper) for each row of another residual r, which so costs only what lies
/// beyond an interval, its error reported from there: a room, a floor, a least or greatest distance.
///
/// All rows share the interval, in their own unit: for residuals of one quantity (a pose has a
/// [`Goal`](super::Goal) of its own). Derivatives follow by dual numbers.
///
/// ```
/// # use kinopt::model::{Limits, Model};
/// # use kinopt::spatial::{Placement, Vector3};
/// # use kinopt::task::{Plane, Point, Within};
/// # use kinopt::{Problem, Solver};
/// # let mut builder = Model::builder("two links");
/// # let link = Placement::translation([1.0, 0.0, 0.0].into());
/// # let turns = Limits::new(-3.0, 3.0);
/// # let y = Vector3::UNITS[1];
/// # let shoulder = builder.revolute("shoulder", None, Placement::identity(), y, turns);
/// # let elbow = builder.revolute("elbow", Some(shoulder), link, y, turns);
/// # let knuckle = builder.frame("knuckle", Some(elbow), Placement::identity());
/// # let hand = builder.frame("hand", Some(elbow), link);
/// # let model = builder.build()?;
/// let mut tasks = Problem::builder(&model);
/// tasks.add(Point::new(hand, [1.2, 0.0, 0.0]));
/// // The elbow stays 10 cm above the floor or more; how high does not matter.
/// let floor = Plane::new(knuckle, [0.0; 3], [0.0, 0.0, 1.0]);
/// tasks.add(Within::at_least(floor, 0.1));
/// let solution = Solver::default().solve_once(&tasks.build()?, &[0.8, -1.5])?;
/// assert!(solution.reached, "{}", solution.explain());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Within<R> {
    residual: R,
    lower: f64,
    upper: f64,
}

impl<R: Residual> Within<R> {
    /// Rows from −`half_width` to `half_width` (at least 0) cost nothing.
    #[must_use]
    pub fn new(residual: R, half_width: f64) -> Self {
        Self::between(residual, -half_width, half_width)
    }

    /// Rows of at most `upper` cost nothing.
    #[must_use]
    pub fn at_most(residual: R, upper: f64) -> Self {
        Self::between(residual, f64::NEG_INFINITY, upper)
    }

    /// Rows of at least `lower` cost nothing.
    #[must_use]
    pub fn at_least(residual: R, lower: f64) -> Self {
        Self::between(residual, lower, f64::INFINITY)
    }

    /// Rows from `lower` to `upper` cost nothing; either may be infinite.
    #[must_use]
    pub fn between(residual: R, lower: f64, upper: f64) -> Self {
        Self {
            residual,
            lower,
            upper,
        }
    }

    getters! {
        /// What has room.
        pub fn residual(&self) -> &R = &self.residual;
        /// What has room, to move its target.
        pub fn residual_mut(&mut self) -> &mut R = &mut self.residual;
    }
}

impl<R: Residual> Residual for Within<R> {
    const ROLE: Role = R::ROLE;

    fn kind(&self) -> &'static str {
        self.residual.kind()
    }

    fn frames(&self) -> Vec<FrameId> {
        self.residual.frames()
    }

    fn joints(&self) -> Vec<JointId> {
        self.residual.joints()
    }

    fn rows(&self) -> Vec<Rows> {
        self.residual.rows()
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.evaluate_moved(frames, joints, &[], residual);
    }

    fn target_len(&self) -> usize {
        self.residual.target_len()
    }

    fn evaluate_moved<S: Scalar>(
        &self,
        frames: &[Placement<S>],
        joints: &[S],
        step: &[S],
        residual: &mut [S],
    ) {
        self.residual.evaluate_moved(frames, joints, step, residual);
        for row in residual {
            *row = beyond(*row, self.lower, self.upper);
        }
    }

    fn validate(&self) -> Result<(), String> {
        self.residual.validate()?;
        let (lower, upper) = (self.lower, self.upper);
        let holds = lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY;
        refuse(!holds, || {
            format!("its interval from {lower} to {upper} holds no number")
        })
    }
}

/// How far a value lies beyond an interval, with its sign; 0 inside.
#[inline]
pub(super) fn beyond<S: Scalar>(value: S, lower: f64, upper: f64) -> S {
    value - value.max(S::constant(lower)).min(S::constant(upper))
}
