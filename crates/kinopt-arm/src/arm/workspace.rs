//! Workspace of one query: the general problem of the chain and scratch memory.

use kinopt_kinematics::clock::Instant;

use nalgebra::DMatrix;

use super::all_solutions::SolutionSet;
use super::options::Options;
use super::pose_problem::PoseProblem;
use super::serial_chain::Serial;
use crate::simd_ik::{PoseOutcome, PoseSolver};
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::Source;
use kinopt_kinematics::spatial::{Placement, resolved, rounding};
use kinopt_solver::ik::{DerivativeWorkspace, Minimiser, Solution};
use kinopt_solver::problem::{Evaluation, ProblemError, Scratch, TaskSubset};
use kinopt_solver::search::{Attempts, Engine};
use kinopt_solver::solver::{
    AnyMethod, LeastSquares, LevenbergMarquardt, Observer, Silent, SolverState, Stopping,
    Termination, negligible_slope,
};

/// Errors of a configuration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Errors {
    /// Position error, metres.
    pub(super) position: f64,
    /// Orientation error, radians.
    pub(super) orientation: f64,
    pub(super) reached: bool,
}

impl Errors {
    /// Errors of the SIMD solver's outcome.
    pub(super) fn of(outcome: &PoseOutcome) -> Self {
        Self {
            position: outcome.position_error,
            orientation: outcome.orientation_error,
            reached: outcome.reached,
        }
    }
}

/// Termination criteria of the general solver.
pub(super) fn stopping() -> Stopping {
    Stopping::default()
        .with_max_iterations(400)
        .with_gradient_tolerance(1e-8)
}

/// Workspace of queries that the general solver takes part in.
#[derive(Clone, Debug)]
pub(super) struct ArmWorkspace {
    pub(super) question: PoseProblem,
    scratch: Scratch,
    pub(super) solver_state: SolverState,
    /// Attempts of the general solver.
    pub(super) attempts: Attempts,
    /// Buffer for solutions of a batch that are solved alone.
    pub(super) batch_solution: Solution,
    /// Buffers of the collision checks.
    #[cfg(feature = "collision")]
    pub(super) collision_workspace:
        Option<super::collision_avoidance::workspace::CollisionWorkspace>,
    /// SIMD solver with the bounds of the query, if motions are bounded.
    pub(super) bounded_simd_solver: Option<PoseSolver>,
    /// Start, clamped to the bounds.
    pub(super) start: Vec<f64>,
    /// Configuration to return.
    pub(super) x: Vec<f64>,
    /// Errors of x at its last evaluation.
    pub(super) errors: Errors,
    pub(super) trial: Vec<f64>,
    pub(super) projected: Vec<f64>,
    pub(super) scratch_motion: Vec<f64>,
    /// Pull to the nominal posture in the null space, radians per joint.
    pub(super) slope: Vec<f64>,
    /// Best of all attempts, if the attempt from the start fails.
    pub(super) best: Vec<f64>,
    /// End of the attempt from the start, while others run.
    pub(super) saved: Vec<f64>,
    /// Configuration from which a descent measures motion.
    pub(super) anchor: Vec<f64>,
    /// Radians that a radian or metre of each joint counts as.
    pub(super) scale: Vec<f64>,
    /// Reciprocal of `scale`.
    pub(super) per_scale: Vec<f64>,
    /// Jacobian at the configuration where it was last computed.
    pub(super) jacobian: DMatrix<f64>,
    /// Configuration of the residual and the Jacobian; NaN if the Jacobian is of another.
    linear_at: Vec<f64>,
    /// Residual at that configuration.
    linear_residual: [f64; 6],
    /// Buffer for a second Jacobian.
    pub(super) second_jacobian: DMatrix<f64>,
    /// Gradient of the cost at the configuration where it was last computed.
    pub(super) gradient: Vec<f64>,
    /// Buffers of complete solution sets.
    pub(super) solution_set: SolutionSet,
    /// Configurations found, in sequence.
    pub(super) attempt_ends: Vec<f64>,
    /// Outcomes of the configurations found.
    pub(super) outcomes: Vec<PoseOutcome>,
    /// (distance from the start, index in `attempt_ends`).
    pub(super) ranking: Vec<(f64, usize)>,
    /// (distance from the target, row of the seed table).
    pub(super) table_rows: Vec<(f64, usize)>,
    /// Configuration of the whole serial model.
    pub(super) q: Vec<f64>,
    pub(super) derivative: DerivativeWorkspace,
    kinematics: ForwardKinematics,
    /// Sum of the lengths of the chain's translations, without prismatic joints, metres.
    extent: f64,
    /// Flags of the coordinates of the serial model that are angles.
    is_angle: Vec<bool>,
    position_tolerance: f64,
    orientation_tolerance: f64,
    metres_per_radian: f64,
}

impl ArmWorkspace {
    pub(super) fn new(serial: &Serial, options: &Options) -> Result<Self, ProblemError> {
        let question = PoseProblem::new(serial, options)?;
        let problem = &question.problem;
        let n = problem.variables();
        let scale = serial.scales(options.metres_per_radian);
        Ok(Self {
            scratch: problem.scratch(),
            solver_state: SolverState::default(),
            attempts: Attempts::default(),
            batch_solution: Solution::default(),
            #[cfg(feature = "collision")]
            collision_workspace: None,
            bounded_simd_solver: None,
            start: vec![0.0; n],
            x: vec![0.0; n],
            errors: Errors::default(),
            trial: vec![0.0; n],
            projected: vec![0.0; n],
            scratch_motion: vec![0.0; n],
            slope: vec![0.0; n],
            best: vec![0.0; n],
            saved: vec![0.0; n],
            anchor: vec![0.0; n],
            per_scale: scale.iter().map(|scale| scale.recip()).collect(),
            scale,
            jacobian: DMatrix::zeros(6, n),
            linear_at: vec![f64::NAN; n],
            linear_residual: [0.0; 6],
            second_jacobian: DMatrix::zeros(6, n),
            gradient: vec![0.0; n],
            solution_set: SolutionSet::default(),
            attempt_ends: Vec::new(),
            outcomes: Vec::new(),
            ranking: Vec::new(),
            table_rows: Vec::new(),
            q: vec![0.0; serial.model.configuration_len()],
            derivative: DerivativeWorkspace::default(),
            kinematics: ForwardKinematics::new(&serial.model),
            extent: serial.extent,
            is_angle: (serial.model.moving_joints().iter())
                .map(|id| !serial.model.joints()[id.index()].kind.slides())
                .collect(),
            position_tolerance: options.position_tolerance,
            orientation_tolerance: options.orientation_tolerance,
            metres_per_radian: options.metres_per_radian,
            question,
        })
    }

    /// Sets the target.
    pub(super) fn set_target(&mut self, target: &Placement<f64>) {
        self.question.set_target(target);
        self.invalidate_jacobian();
    }

    /// Marks the workspace's Jacobian as outdated.
    pub(super) fn invalidate_jacobian(&mut self) {
        self.linear_at.fill(f64::NAN);
    }

    /// Errors at x.
    pub(super) fn judge(&mut self, x: &[f64]) -> Errors {
        let residual = self.residual(x);
        self.errors(&residual, x)
    }

    /// [`judge`](Self::judge) at the workspace's x; keeps the errors.
    pub(super) fn judge_x(&mut self) -> Errors {
        let x = std::mem::take(&mut self.x);
        self.errors = self.judge(&x);
        self.x = x;
        self.errors
    }

    /// Errors by a weighted residual at x.
    fn errors(&self, residual: &[f64; 6], x: &[f64]) -> Errors {
        // Errors that overflow are infinite.
        let norm = |rows: &[f64]| {
            let norm = rows.iter().map(|v| v * v).sum::<f64>().sqrt();
            if norm.is_nan() { f64::INFINITY } else { norm }
        };
        let position = norm(&residual[..3]);
        let turn = norm(&residual[3..]) / self.metres_per_radian;
        let (metres, radians) = self.resolution(x);
        let orientation = self.question.angle(turn);
        let position = resolved(position, metres, self.position_tolerance);
        let orientation = resolved(orientation, radians, self.orientation_tolerance);
        Errors {
            position,
            orientation,
            reached: position <= self.position_tolerance
                && orientation <= self.orientation_tolerance,
        }
    }

    /// Rounding error of the pose at x, metres and radians.
    fn resolution(&self, x: &[f64]) -> (f64, f64) {
        let (mut angles, mut lengths) = (0.0, 0.0);
        let sources = self.question.problem.parameters().sources();
        for (source, is_angle) in sources.iter().zip(&self.is_angle) {
            // A mimic joint has the rounding of both of its parts, which may cancel.
            let size = match *source {
                Source::Constant(value) => value.abs(),
                Source::Rotation { .. } => 0.0,
                Source::Variable {
                    variable,
                    ratio,
                    offset,
                } => (ratio * x[variable]).abs() + offset.abs(),
            };
            *(if *is_angle { &mut angles } else { &mut lengths }) += size;
        }
        rounding(self.is_angle.len(), angles, self.extent + lengths)
    }

    /// Weighted residual at x.
    pub(super) fn residual(&mut self, x: &[f64]) -> [f64; 6] {
        let mut residual = [0.0; 6];
        Evaluation::new(self.question.instance(), &mut self.scratch).residual(x, &mut residual);
        residual
    }

    /// Computes residual and Jacobian at x, unless they are known; the Jacobian stays in the workspace.
    pub(super) fn linearise(&mut self, x: &[f64]) -> [f64; 6] {
        if self.linear_at != x {
            self.linear_residual = self.residual(x);
            Evaluation::new(self.question.instance(), &mut self.scratch)
                .jacobian(x, &mut self.jacobian);
            self.linear_at.copy_from_slice(x);
        }
        self.linear_residual
    }

    /// Computes the Jacobian at x, while the current one is in [`second_jacobian`](Self::second_jacobian).
    pub(super) fn overwrite_jacobian(&mut self, x: &[f64]) {
        Evaluation::new(self.question.instance(), &mut self.scratch)
            .jacobian(x, &mut self.jacobian);
    }

    /// Computes the gradient at the workspace's x. Returns the slope that the general solver counts as none there.
    pub(super) fn compute_gradient(&mut self) -> f64 {
        let x = std::mem::take(&mut self.x);
        let residual = self.linearise(&x);
        self.x = x;
        for (slope, column) in self.gradient.iter_mut().zip(self.jacobian.column_iter()) {
            *slope = column.iter().zip(&residual).map(|(j, r)| j * r).sum();
        }
        let cost = 0.5 * residual.iter().map(|v| v * v).sum::<f64>();
        let columns = self.jacobian.column_iter().map(|column| column.norm());
        negligible_slope(columns.fold(0.0, f64::max), cost, &stopping())
    }

    /// ‖proj(x − g) − x‖∞ by the current gradient g.
    pub(super) fn projected_gradient(&self, x: &[f64]) -> f64 {
        let joints = x.iter().zip(&self.gradient).enumerate();
        let moves = joints.map(|(i, (x, g))| (self.question.clamp(i, x - g) - x).abs());
        moves.fold(0.0, f64::max)
    }

    /// Minimiser of the query by a method of the general solver.
    pub(super) fn minimiser<'a>(
        &'a mut self,
        method: &'a dyn AnyMethod,
        deadline: Option<Instant>,
        observer: &'a mut dyn Observer,
    ) -> Minimiser<'a> {
        Minimiser {
            instance: self.question.instance(),
            subset: TaskSubset::All,
            method,
            deadline,
            observer,
            scratch: &mut self.scratch,
            memory: &mut self.solver_state,
            guard: None,
            moved: None,
        }
    }

    /// Descends from x to a local minimum by the general Levenberg-Marquardt method.
    ///
    /// Returns the termination and the number of steps. If nothing is finite, x stays.
    pub(super) fn converge(&mut self, deadline: Option<Instant>) -> (Termination, usize) {
        self.converge_within(&stopping(), deadline)
    }

    /// Descends as [`converge`](Self::converge) does, with other termination criteria.
    pub(super) fn converge_within(
        &mut self,
        stopping: &Stopping,
        deadline: Option<Instant>,
    ) -> (Termination, usize) {
        let x = std::mem::take(&mut self.x);
        let method = LevenbergMarquardt::default();
        let attempt = self
            .minimiser(&method, deadline, &mut Silent)
            .attempt(&x, stopping);
        self.x = x;
        if attempt.termination != Termination::NonFinite {
            self.x.copy_from_slice(self.solver_state.x());
        }
        (attempt.termination, attempt.iterations)
    }

    /// One of the configurations found.
    pub(super) fn attempt_end(&self, index: usize) -> &[f64] {
        let n = self.x.len();
        &self.attempt_ends[index * n..(index + 1) * n]
    }

    /// Moves x to one of the configurations found.
    pub(super) fn move_to_attempt_end(&mut self, index: usize) {
        let n = self.x.len();
        self.x
            .copy_from_slice(&self.attempt_ends[index * n..(index + 1) * n]);
    }

    /// Target of the query.
    pub(super) fn target(&self) -> Placement<f64> {
        self.question.target()
    }

    /// Error far within the tolerances, metres.
    pub(super) fn negligible_error(&self) -> f64 {
        let orientation_length = self.orientation_tolerance * self.metres_per_radian;
        1e-3 * self.position_tolerance.min(orientation_length)
    }

    /// Pose of the tool in the base frame.
    pub(super) fn base_from_tool(&mut self, serial: &Serial, x: &[f64]) -> Placement<f64> {
        serial.map.scatter(x, &mut self.q);
        // The configuration has the model's length, so this cannot fail.
        let placements = self.kinematics.place(&self.q).unwrap_or(&[]);
        let tool = placements.get(serial.tool.index()).copied();
        tool.unwrap_or_else(Placement::identity)
    }
}
