//! Bounds on any residual.

use super::extensions::TargetFunctions;
use super::residual::error_if;
use super::{
    Description, DifferentiableTarget, Extensions, Inequality, InequalityResidual, Inputs,
    Residual, Role, RowBlock,
};
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::Placement;

/// r_i − min(max(r_i, lower), upper) for each row of another residual r: zero inside an interval.
///
/// The error is the distance beyond the interval. Examples are a floor, and a least or greatest distance. All rows
/// share the interval, in their unit, so the residual should have one quantity. For a pose use
/// [`PoseBounds`](super::PoseBounds). Dual numbers give the derivatives.
///
/// ```
/// # use kinopt::model::{Limits, Model};
/// # use kinopt::spatial::{Placement, Vector3};
/// # use kinopt::task::{Plane, Point, Bounded};
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
/// // The elbow stays at least 10 cm above the floor.
/// let floor = Plane::new(knuckle, [0.0; 3], [0.0, 0.0, 1.0]);
/// tasks.add(Bounded::at_least(floor, 0.1));
/// let solution = Solver::default().solve_once(&tasks.build()?, &[0.8, -1.5])?;
/// assert!(solution.reached, "{}", solution.explain());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// To limit a function of several joints, bound your own residual. Such a limit is a penalty: only joint limits, cones
/// and motion limits are hard constraints, onto which a solver projects. A violated required task is reported. On a
/// [level](super::Task::at_level) above the other tasks, no other required task affects it.
///
/// ```
/// # use kinopt::model::{JointId, Limits, Model};
/// # use kinopt::spatial::{Placement, Vector3};
/// # use kinopt::task::{Bounded, Description, Inputs, Point, Quantity, Residual, RowBlock, Task};
/// # use kinopt::{Problem, Scalar, Solver};
/// /// The angle of a wrist beyond 1.2 rad minus half the angle of the elbow.
/// #[derive(Clone)]
/// struct WristByElbow([JointId; 2]);
///
/// impl Residual for WristByElbow {
///     fn inputs(&self) -> Inputs {
///         Inputs::joints(self.0)
///     }
///     fn rows(&self) -> Vec<RowBlock> {
///         vec![RowBlock::new(Quantity::Radians, 1)]
///     }
///     fn evaluate<S: Scalar>(&self, _: &[Placement<S>], joints: &[S], residual: &mut [S]) {
///         residual[0] = joints[0] + joints[1] * S::constant(0.5) - S::constant(1.2);
///     }
///     fn description(&self) -> Description {
///         Description::new("wrist by elbow")
///     }
/// }
/// # let mut builder = Model::builder("two links");
/// # let link = Placement::translation([1.0, 0.0, 0.0].into());
/// # let turns = Limits::new(-3.0, 3.0);
/// # let y = Vector3::UNITS[1];
/// # let elbow = builder.revolute("elbow", None, Placement::identity(), y, turns);
/// # let wrist = builder.revolute("wrist", Some(elbow), link, y, turns);
/// # let hand = builder.frame("hand", Some(wrist), link);
/// # let model = builder.build()?;
///
/// let mut tasks = Problem::builder(&model);
/// tasks.add(Bounded::at_most(WristByElbow([wrist, elbow]), 0.0));
/// // The hand's position with the elbow at 1 rad and the wrist at 0.9 rad.
/// let place = [1f64.cos() + 1.9f64.cos(), 0.0, -1f64.sin() - 1.9f64.sin()];
/// tasks.add(Task::new(Point::new(hand, place)).at_level(1));
/// let solution = Solver::default().solve_once(&tasks.build()?, &[1.0, 0.7])?;
/// // There the wrist violates the limit by 0.2 rad: the limit holds, and the hand does not reach its target.
/// assert!(solution.q[1] + 0.5 * solution.q[0] < 1.2 + 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounded<R> {
    residual: R,
    lower: f64,
    upper: f64,
}

impl<R: Residual> Bounded<R> {
    /// Bounds the rows to ± `half_width` (at least 0).
    #[must_use]
    pub fn new(residual: R, half_width: f64) -> Self {
        Self::between(residual, -half_width, half_width)
    }

    /// Bounds the rows to at most `upper`.
    #[must_use]
    pub fn at_most(residual: R, upper: f64) -> Self {
        Self::between(residual, f64::NEG_INFINITY, upper)
    }

    /// Bounds the rows to at least `lower`.
    #[must_use]
    pub fn at_least(residual: R, lower: f64) -> Self {
        Self::between(residual, lower, f64::INFINITY)
    }

    /// Bounds the rows to `lower` … `upper`; both may be infinite.
    #[must_use]
    pub fn between(residual: R, lower: f64, upper: f64) -> Self {
        Self {
            residual,
            lower,
            upper,
        }
    }

    /// Number of slacks of one row; an interval that is infinite on both sides has one, which stays infinite.
    fn edges(&self) -> usize {
        let bounds = [self.lower, self.upper];
        bounds
            .iter()
            .filter(|bound| bound.is_finite())
            .count()
            .max(1)
    }

    /// The bounded residual.
    #[must_use]
    pub fn residual(&self) -> &R {
        &self.residual
    }

    /// The bounded residual, to change its target.
    #[must_use]
    pub fn residual_mut(&mut self) -> &mut R {
        &mut self.residual
    }
}

impl<R: Residual> Residual for Bounded<R> {
    const ROLE: Role = R::ROLE;

    const EXTENSIONS: Extensions<Self> = Extensions {
        target: Some(Self::TARGET),
        ..Extensions::NONE.with_inequalities()
    };

    fn inputs(&self) -> Inputs {
        self.residual.inputs()
    }

    fn rows(&self) -> Vec<RowBlock> {
        self.residual.rows()
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.residual.evaluate(frames, joints, residual);
        self.apply_bounds(residual);
    }

    fn description(&self) -> Description {
        let description = self.residual.description();
        description.with_validity(self.validate())
    }
}

impl<R: Residual> Bounded<R> {
    /// The target of the bounded residual, which may have none.
    const TARGET: TargetFunctions<Self> = TargetFunctions {
        target_len: |bounded| Extensions::target_len(&bounded.residual),
        evaluate_moved: |bounded, frames, joints, step, rows| {
            Extensions::evaluate_moved(&bounded.residual, frames, joints, step, rows);
            bounded.apply_bounds(rows);
        },
        add_target_slopes: |_, _, _, _, _| false,
        has_edges: |_| true,
    };

    /// Replaces values of the bounded residual by their signed distances beyond the interval.
    fn apply_bounds<S: Scalar>(&self, rows: &mut [S]) {
        for row in rows {
            *row = beyond(*row, self.lower, self.upper);
        }
    }

    /// Returns the defect of the interval.
    fn validate(&self) -> Result<(), String> {
        let (lower, upper) = (self.lower, self.upper);
        let is_valid = lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY;
        error_if(!is_valid, || {
            format!("its interval from {lower} to {upper} holds no number")
        })
    }
}

impl<R: Residual> InequalityResidual for Bounded<R> {
    /// One inequality for each row, if the interval is more than a number.
    fn inequalities(&self) -> Vec<Inequality> {
        let edges = self.edges();
        let rows: usize = self.residual.rows().iter().map(|rows| rows.count).sum();
        let rows = if self.lower < self.upper { rows } else { 0 };
        (0..rows)
            .map(|row| Inequality::new(row..row + 1, edges))
            .collect()
    }

    fn slacks<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], slacks: &mut [S]) {
        let edges = self.edges();
        let rows = slacks.len() / edges;
        self.residual.evaluate(frames, joints, &mut slacks[..rows]);
        // Backwards, so that no slack overwrites a row that is still needed.
        for row in (0..rows).rev() {
            let value = slacks[row];
            let row_slacks = &mut slacks[row * edges..(row + 1) * edges];
            if self.lower.is_finite() {
                row_slacks[0] = value - S::constant(self.lower);
            }
            if self.upper.is_finite() {
                row_slacks[edges - 1] = S::constant(self.upper) - value;
            }
        }
    }
}

impl<R: DifferentiableTarget> DifferentiableTarget for Bounded<R> {
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
        self.apply_bounds(residual);
    }
}

/// Signed distance of a value beyond an interval; 0 inside.
#[inline]
pub(super) fn beyond<S: Scalar>(value: S, lower: f64, upper: f64) -> S {
    value - value.max(S::constant(lower)).min(S::constant(upper))
}
