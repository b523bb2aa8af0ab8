//! Promise: a run reports its steps, a method can run again, and a checkpoint resumes only with its own problem.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use argmin::core::observers::ObserverMode;
use argmin::core::{Error, Executor, Hessian, IterState, KV, Problem as Counted, Solver, State};
use argmin_checkpointing_file::{CheckpointingFrequency, FileCheckpoint};
use kinopt::Problem;
use kinopt::argmin_bridge::{BoundedProblem, ExecutorMethod, UnboundedProblem};
use kinopt::model::{JointId, Limits, ParameterMap, ParameterMapBuilder};
use kinopt::solver::{GaussNewton, LeastSquares, LevenbergMarquardt, Termination};
use kinopt::task::{Point, Quantity, Task};
use nalgebra::{DMatrix, DVector};

use crate::bent_arm::{arm, point_within_reach, reachable};
use crate::promises::Interruption;

const START: [f64; 7] = [0.1, 0.3, -0.2, -1.0, 0.2, 0.6, 0.05];

/// Reachable point target of the arm; `left` reduces the parameters of the second joint.
fn with_second_joint(
    left: impl Fn(ParameterMapBuilder<'_>, JointId) -> ParameterMapBuilder<'_>,
) -> Problem {
    let model = arm();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(model.frame("tip").unwrap(), [0.5, 0.3, 0.8]));
    let joint = model.joint("joint 2").unwrap();
    let map = left(ParameterMap::builder(&model), joint);
    builder.parameters(map.build().unwrap());
    builder.build().unwrap()
}

#[test]
fn used_method_repeats_its_run() {
    let problem = reachable();
    let bounded = BoundedProblem::new(&problem);
    let run = |solver: ExecutorMethod<LevenbergMarquardt>, start: &[f64]| {
        let start = bounded.start(start).unwrap();
        let run = Executor::new(bounded.clone(), solver)
            .configure(|state| state.param(start).max_iters(60))
            .run()
            .unwrap();
        (bounded.solution(&run).unwrap(), run.solver)
    };
    let fresh = || ExecutorMethod::new(LevenbergMarquardt::default());
    let (_, used) = run(fresh(), &START);
    assert!(used.termination().is_some());
    let other = [0.3, 0.2, 0.1, -0.8, 0.1, 0.4, 0.2];
    let (again, _) = run(used, &other);
    let (first, _) = run(fresh(), &other);
    assert!(first.reached && first.iterations > 1 && first.attempts == 1);
    assert_eq!((again.q, again.iterations), (first.q, first.iterations));
}

#[test]
fn run_of_another_problem_is_rejected() {
    let (problem, other) = (
        reachable(),
        with_second_joint(|map, joint| map.with_locked(joint, 0.1)),
    );
    let (bounded, other) = (BoundedProblem::new(&problem), BoundedProblem::new(&other));
    let start = bounded.start(&START).unwrap();
    let run = Executor::new(bounded.clone(), ExecutorMethod::new(GaussNewton::default()))
        .configure(|state| state.param(start).max_iters(3))
        .run()
        .unwrap();
    assert!(bounded.solution(&run).is_ok());
    let error = other.solution(&run).unwrap_err().to_string();
    assert_eq!(error, "the argmin run has 7 variables, the problem has 6");
}

/// Gradients for argmin's observers and convergence tests.
#[test]
fn state_has_the_gradient_at_its_parameters() {
    let problem = reachable();
    let bounded = BoundedProblem::new(&problem);
    let start = bounded.start(&START).unwrap();
    let method = ExecutorMethod::new(LevenbergMarquardt::default());
    for steps in [1, 3] {
        let run = Executor::new(bounded.clone(), method.clone())
            .configure(|state| state.param(start.clone()).max_iters(steps))
            .run()
            .unwrap();
        let state = run.state();
        let (param, mut copy) = (state.get_param().unwrap(), bounded.clone());
        let mut residual = DVector::zeros(copy.rows());
        let mut jacobian = DMatrix::zeros(copy.rows(), param.len());
        copy.residual(param.as_slice(), residual.as_mut_slice());
        copy.jacobian(param.as_slice(), &mut jacobian);
        let off = jacobian.tr_mul(&residual) - state.get_gradient().unwrap();
        assert!(off.amax() < 1e-12, "{off}");
    }
}

/// The floor of the Hessian is a fraction of its largest entry.
#[test]
fn hessian_scales_with_squared_weights() {
    let model = arm();
    let hessian = |weight: f64| {
        let mut builder = Problem::builder(&model);
        let tip = Point::new(model.frame("tip").unwrap(), [0.5, 0.3, 0.8]);
        builder.add(Task::new(tip).weight(Quantity::Metres, weight));
        let problem = builder.build().unwrap();
        let unbounded = UnboundedProblem::new(&problem);
        let y = unbounded.start(&START).unwrap();
        unbounded.hessian(&y).unwrap() / (weight * weight)
    };
    let reference = hessian(1.0);
    for weight in [1e-6, 1e3] {
        let off = (hessian(weight) - &reference).amax();
        assert!(off < 1e-13 * reference.amax(), "{weight}: {off:e}");
    }
}

#[test]
fn checkpoint_of_another_problem_is_rejected() {
    let folder = std::env::temp_dir().join(format!("kinopt-other-{}", std::process::id()));
    let checkpoint = || {
        let path = folder.to_str().unwrap();
        FileCheckpoint::new(path, "search", CheckpointingFrequency::Always)
    };
    let problem = reachable();
    let bounded = BoundedProblem::new(&problem);
    let start = bounded.start(&START).unwrap();
    let stopped = Executor::new(bounded, ExecutorMethod::new(GaussNewton::default()))
        .configure(|state| state.param(start))
        .checkpointing(checkpoint())
        .add_observer(Interruption(1), ObserverMode::Always)
        .run();
    assert!(stopped.is_err());

    // One problem has fewer joints; the other excludes the configuration of the checkpoint.
    for other in [
        with_second_joint(|map, joint| map.with_locked(joint, 0.1)),
        with_second_joint(|map, joint| map.with_narrowed(joint, Limits::new(1.0, 1.2))),
    ] {
        let other = BoundedProblem::new(&other);
        let start = other.start(&START).unwrap();
        let resumed = Executor::new(other, ExecutorMethod::new(GaussNewton::default()))
            .configure(|state| state.param(start))
            .checkpointing(checkpoint())
            .run();
        let error = resumed.err().unwrap().to_string();
        assert!(error.contains("of another problem"), "{error}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn non_finite_numbers_end_a_run_at_its_start() {
    let model = arm();
    let mut builder = Problem::builder(&model);
    // The square of this number overflows.
    builder.add(Point::new(model.frame("tip").unwrap(), [1e200, 0.0, 0.0]));
    let problem = builder.build().unwrap();
    let bounded = BoundedProblem::new(&problem);
    let start = bounded.start(&START).unwrap();
    let run = Executor::new(bounded.clone(), ExecutorMethod::new(GaussNewton::default()))
        .configure(|state| state.param(start))
        .run()
        .unwrap();
    assert_eq!(run.solver.termination(), Some(Termination::NonFinite));
    let solution = bounded.solution(&run).unwrap();
    assert_eq!(solution.iterations, 0);
    assert_eq!(solution.termination, Termination::NonFinite);
}

/// Solver that evaluates every function at its start.
struct EachOnce;

type Everything = IterState<DVector<f64>, DVector<f64>, DMatrix<f64>, DMatrix<f64>, (), f64>;

impl Solver<UnboundedProblem<'_>, Everything> for EachOnce {
    fn name(&self) -> &str {
        "each"
    }

    fn next_iter(
        &mut self,
        problem: &mut Counted<UnboundedProblem<'_>>,
        state: Everything,
    ) -> Result<(Everything, Option<KV>), Error> {
        let y = state.param.clone().unwrap();
        for _ in 0..2 {
            problem.apply(&y)?;
        }
        for _ in 0..3 {
            problem.jacobian(&y)?;
        }
        for _ in 0..4 {
            problem.hessian(&y)?;
        }
        for _ in 0..5 {
            problem.gradient(&y)?;
        }
        let cost = problem.cost(&y)?;
        Ok((state.param(y).cost(cost), None))
    }
}

#[test]
fn solution_counts_all_evaluations() {
    let problem = point_within_reach();
    let unbounded = UnboundedProblem::new(&problem);
    let y = unbounded.start(&START).unwrap();
    let run = Executor::new(unbounded.clone(), EachOnce)
        .configure(|state| state.param(y).max_iters(2))
        .run()
        .unwrap();
    let counts = unbounded.solution(&run).unwrap().counts;
    let evaluations = (counts.residuals, counts.jacobians, counts.gradients);
    assert_eq!(evaluations, (2 * (1 + 2), 2 * (3 + 4), 2 * 5));
}
