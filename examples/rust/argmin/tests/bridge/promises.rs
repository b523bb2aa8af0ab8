//! Promise: argmin's solvers keep the limits of kinopt's problems. kinopt's methods give equal results alone and
//! under argmin's executor.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::{Arc, Mutex};

use crate::bent_arm::{
    arm, configurations, held_by_limits, point_within_reach, reachable, two_tips,
};
use argmin::core::checkpointing::Checkpoint;
use argmin::core::observers::{Observe, ObserverMode};
use argmin::core::{
    CostFunction, Error, Executor, Gradient, Hessian, IterState, Jacobian, KV, Operator, State,
};
use argmin::solver::gradientdescent::SteepestDescent;
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::neldermead::NelderMead;
use argmin::solver::newton::NewtonCG;
use argmin::solver::particleswarm::ParticleSwarm;
use argmin::solver::quasinewton::LBFGS;
use argmin::solver::trustregion::{Dogleg, Steihaug, TrustRegion};
use argmin_checkpointing_file::{CheckpointingFrequency, FileCheckpoint};
use kinopt::argmin_bridge::{
    BoundedProblem, BridgeError, ExecutorMethod, MethodState, UnboundedProblem,
};
use kinopt::ik::{Restarts, Solution};
use kinopt::solver::{
    Damping, FirstStep, GaussNewton, LevenbergMarquardt, Method, ProjectedGradient, Silent,
    SolverState, Stopping, Termination, minimise,
};
use kinopt::task::{Posture, Quantity, Task};
use kinopt::{Problem, Solver};
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand::rngs::StdRng;
use serde::Serialize;
use serde::de::DeserializeOwned;

const fn value<T: Clone + std::fmt::Debug + Send + Sync>() {}

const _: () = value::<BoundedProblem<'static>>();
const _: () = value::<UnboundedProblem<'static>>();
const _: () = value::<ExecutorMethod<LevenbergMarquardt>>();
const _: () = value::<BridgeError>();

const START: [f64; 7] = [0.1, 0.3, -0.2, -1.0, 0.2, 0.6, 0.05];

fn within_limits(problem: &Problem, q: &[f64]) -> bool {
    let bounds = problem.lower().iter().zip(problem.upper());
    q.len() == problem.variables()
        && q.iter()
            .zip(bounds)
            .all(|(q, (low, up))| low <= q && q <= up)
}

/// Checks one of kinopt's methods under the executor.
fn runs_the_same<M>(method: M)
where
    M: Method<State: Serialize + DeserializeOwned> + Clone + Serialize + DeserializeOwned,
{
    let sixty = Stopping::default().with_max_iterations(60);
    // With tolerance zero, the last step detects convergence by the slope of the previous one.
    let exact = sixty.with_gradient_tolerance(0.0);
    let problems = [reachable(), held_by_limits(), two_tips(), held_by_limits()];
    for (problem, stopping) in problems.into_iter().zip([sixty, sixty, sixty, exact]) {
        let mut bounded = BoundedProblem::new(&problem);
        let start = bounded.start(&START).unwrap();

        let mut memory = SolverState::default();
        let direct = minimise(
            &mut bounded,
            &method,
            start.as_slice(),
            &stopping,
            &mut Silent,
            &mut memory,
        )
        .unwrap();

        let solver = ExecutorMethod::new(method.clone()).with_tolerances_of(&stopping);
        let run = Executor::new(bounded.clone(), solver.clone())
            .configure(|state| state.param(start.clone()).max_iters(60))
            .run()
            .unwrap();
        let solution = bounded.solution(&run).unwrap();
        assert_eq!(solution.q, memory.x(), "{}", method.name());
        assert_eq!(solution.cost, memory.cost(), "{}", method.name());
        assert_eq!(solution.iterations, direct.iterations, "{}", method.name());
        assert_eq!(
            solution.termination,
            direct.termination,
            "{}",
            method.name()
        );
        assert!(within_limits(&problem, &solution.q));

        // Halfway, and before its last step.
        let interrupted = [direct.iterations / 2, direct.iterations - 1];
        for at in interrupted.into_iter().filter(|at| *at > 0) {
            let resumed = interrupted_and_resumed(&bounded, &solver, &start, at);
            assert_eq!(resumed.q, solution.q, "{}", method.name());
            assert_eq!(resumed.iterations, solution.iterations);
            assert_eq!(resumed.termination, solution.termination);
        }
    }
}

/// Observer that fails at one iteration, so that the checkpoint of the previous one remains.
pub(crate) struct Interruption(pub(crate) usize);

impl Observe<MethodState> for Interruption {
    fn observe_iter(&mut self, state: &MethodState, seen: &KV) -> Result<(), Error> {
        assert!(seen.get("control").and_then(|v| v.get_float()).unwrap() > 0.0);
        if state.get_iter() as usize >= self.0 {
            return Err(Error::msg("interrupted"));
        }
        Ok(())
    }
}

fn interrupted_and_resumed<M>(
    bounded: &BoundedProblem<'_>,
    solver: &ExecutorMethod<M>,
    start: &DVector<f64>,
    at: usize,
) -> Solution
where
    M: Method<State: Serialize + DeserializeOwned> + Clone + Serialize + DeserializeOwned,
{
    let name = format!(
        "kinopt-{}-{}-{at}",
        std::process::id(),
        solver.method().name()
    );
    let folder = std::env::temp_dir().join(name);
    let path = folder.to_str().unwrap();
    let executor = || {
        Executor::new(bounded.clone(), solver.clone())
            .configure(|state| state.param(start.clone()).max_iters(60))
            .checkpointing(FileCheckpoint::new(
                path,
                "search",
                CheckpointingFrequency::Always,
            ))
    };
    let failed = executor()
        .add_observer(Interruption(at), ObserverMode::Always)
        .run();
    assert!(failed.is_err());
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    // A loaded checkpoint is saved unchanged before the run continues.
    let kept = FileCheckpoint::new(path, "search", CheckpointingFrequency::Always);
    let read: Option<(ExecutorMethod<M>, MethodState)> = kept.load().unwrap();
    let (search, state) = read.unwrap();
    kept.save(&search, &state).unwrap();
    let resumed = executor().run().unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    bounded.solution(&resumed).unwrap()
}

#[test]
fn projected_gradient_runs_the_same_and_resumes() {
    runs_the_same(ProjectedGradient::default());
}

#[test]
fn spectral_gradient_runs_the_same_and_resumes() {
    runs_the_same(ProjectedGradient::new(FirstStep::BarzilaiBorwein));
}

#[test]
fn gauss_newton_runs_the_same_and_resumes() {
    runs_the_same(GaussNewton::default());
}

#[test]
fn levenberg_marquardt_runs_the_same_and_resumes() {
    runs_the_same(LevenbergMarquardt::default());
    runs_the_same(LevenbergMarquardt::new(Damping::ErrorProportional));
}

/// Records ‖Δ‖∞ of every step.
#[derive(Clone, Default)]
struct Steps(Arc<Mutex<Vec<f64>>>);

impl Observe<MethodState> for Steps {
    fn observe_iter(&mut self, _state: &MethodState, seen: &KV) -> Result<(), Error> {
        let step = seen.get("step").and_then(|v| v.get_float()).unwrap();
        self.0.lock().unwrap().push(step);
        Ok(())
    }
}

/// The tolerance of a step is relative to the joint's value, or absolute for values below 1.
fn ends_with_the_first_small_step<M>(method: M)
where
    M: Method<State: Serialize + DeserializeOwned> + Clone + Serialize + DeserializeOwned,
{
    let problem = held_by_limits();
    let bounded = BoundedProblem::new(&problem);
    let start = bounded.start(&START).unwrap();
    let mut counts = Vec::new();
    for tolerance in [3e-2, 1e-3, 1e-5] {
        let stopping = Stopping::default()
            .with_gradient_tolerance(0.0)
            .with_step_tolerance(tolerance);
        let steps = Steps::default();
        let solver = ExecutorMethod::new(method.clone()).with_tolerances_of(&stopping);
        let run = Executor::new(bounded.clone(), solver)
            .configure(|state| state.param(start.clone()).max_iters(1000))
            .add_observer(steps.clone(), ObserverMode::Always)
            .run()
            .unwrap();
        let solution = bounded.solution(&run).unwrap();
        let largest = solution.q.iter().fold(1.0_f64, |max, q| max.max(q.abs()));
        let steps = steps.0.lock().unwrap();
        let (last, before) = steps.split_last().unwrap();
        let name = method.name();
        assert!(
            *last <= tolerance * largest,
            "{name} {tolerance}: {steps:?}"
        );
        // A rejected step does not count.
        let small = before
            .iter()
            .find(|step| **step != 0.0 && **step <= tolerance);
        assert_eq!(small, None, "{name} {tolerance}");
        assert!(!solution.reached && solution.iterations < 1000);
        counts.push(solution.iterations);
    }
    assert!(counts.is_sorted() && counts[0] < counts[2], "{counts:?}");
}

#[test]
fn run_ends_at_the_first_step_within_the_tolerance() {
    ends_with_the_first_small_step(ProjectedGradient::default());
    ends_with_the_first_small_step(GaussNewton::default());
    ends_with_the_first_small_step(LevenbergMarquardt::default());
}

/// Asserts that an unbounded solver never evaluates a joint outside its limits.
struct WithinLimits<'p>(UnboundedProblem<'p>, &'p Problem);

impl<H> Observe<IterState<DVector<f64>, DVector<f64>, (), H, (), f64>> for WithinLimits<'static> {
    fn observe_iter(
        &mut self,
        state: &IterState<DVector<f64>, DVector<f64>, (), H, (), f64>,
        _seen: &KV,
    ) -> Result<(), Error> {
        if let Some(y) = &state.param {
            assert!(within_limits(self.1, &self.0.variables_at(y)));
        }
        Ok(())
    }
}

/// Solutions of L-BFGS and of the trust region with both subproblem solvers.
fn by_unbounded_solvers(problem: Problem, start: &[f64]) -> [Solution; 3] {
    // Observers of an executor must be 'static.
    let problem: &'static Problem = Box::leak(Box::new(problem));
    let unbounded = UnboundedProblem::new(problem);
    let y = unbounded.start(start).unwrap();
    let watch = || WithinLimits(unbounded.clone(), problem);
    let lbfgs = LBFGS::new(MoreThuenteLineSearch::new(), 7);
    let lbfgs = Executor::new(unbounded.clone(), lbfgs)
        .configure(|state| state.param(y.clone()).max_iters(500).target_cost(1e-16))
        .add_observer(watch(), ObserverMode::Always)
        .run();
    let steihaug = TrustRegion::new(Steihaug::new().with_max_iters(20));
    let steihaug = Executor::new(unbounded.clone(), steihaug)
        .configure(|state| state.param(y.clone()).max_iters(200).target_cost(1e-16))
        .add_observer(watch(), ObserverMode::Always)
        .run();
    let dogleg = Executor::new(unbounded.clone(), TrustRegion::new(Dogleg::new()))
        .configure(|state| state.param(y.clone()).max_iters(200).target_cost(1e-16))
        .add_observer(watch(), ObserverMode::Always)
        .run();
    [
        unbounded.solution_from(&y, lbfgs).unwrap(),
        unbounded.solution_from(&y, steihaug).unwrap(),
        unbounded.solution_from(&y, dogleg).unwrap(),
    ]
}

#[test]
fn gradient_solvers_reach_the_target_within_limits() {
    // From inside, and with four joints on a limit, where x(y) is flat.
    let cornered = [-2.9, -1.0, 0.0, -0.1, 0.2, 0.5, 0.0];
    for start in [START, cornered] {
        for solution in by_unbounded_solvers(reachable(), &start) {
            assert!(solution.reached, "{}", solution.explain());
            assert_eq!(solution.termination, Termination::Reached);
            assert!(within_limits(&reachable(), &solution.q));
            assert!(solution.iterations > 0 && solution.counts.gradients > 0);
        }
    }
}

#[test]
fn gradient_solvers_find_the_minimum_at_limits() {
    let problem = held_by_limits();
    let ours = Solver::default().solve_once(&problem, &START).unwrap();
    assert!(!ours.reached && ours.active_limits().count() > 0);
    let once = Solver::default().with_restarts(Restarts::none());
    let [lbfgs, steihaug, dogleg] = by_unbounded_solvers(held_by_limits(), &START);
    // argmin 0.11's dogleg makes no progress if the steepest-descent step is longer than the radius, as it is here.
    // Only its limits are checked.
    assert!(!dogleg.reached && within_limits(&problem, &dogleg.q));
    for solution in [lbfgs, steihaug] {
        assert!(!solution.reached);
        assert!(within_limits(&problem, &solution.q));
        // There can be several minima: kinopt, started at each solution, finds nothing better nearby.
        let polished = once.solve_once(&problem, &solution.q).unwrap();
        assert!(
            solution.cost - polished.cost < 1e-6 * ours.cost && solution.cost < 1.5 * ours.cost,
            "{}, from there {}, ours {}",
            solution.cost,
            polished.cost,
            ours.cost
        );
    }
}

#[test]
fn derivative_free_solvers_come_close_within_limits() {
    for problem in [point_within_reach(), held_by_limits()] {
        let once = Solver::default().with_restarts(Restarts::none());
        let ours = once.solve_once(&problem, &START).unwrap();
        let bounded = BoundedProblem::new(&problem);
        let simplex = bounded.simplex(&START).unwrap();
        assert!(
            simplex
                .iter()
                .all(|x| within_limits(&problem, x.as_slice()))
        );
        let run = Executor::new(bounded.clone(), NelderMead::new(simplex))
            .configure(|state| state.max_iters(5000).target_cost(1e-12))
            .run()
            .unwrap();
        let nelder_mead = bounded.solution(&run).unwrap();

        let window = bounded.search_box(&START).unwrap();
        let swarm = ParticleSwarm::new(window, 150).with_rng_generator(StdRng::seed_from_u64(3));
        let run = Executor::new(bounded.clone(), swarm)
            .configure(|state| state.max_iters(500).target_cost(1e-12))
            .run()
            .unwrap();
        let swarm = bounded.solution(&run).unwrap();

        for (name, solution) in [("Nelder-Mead", nelder_mead), ("swarm", swarm)] {
            assert!(within_limits(&problem, &solution.q), "{name}");
            assert!(
                solution.cost < 1.01 * ours.cost + 1e-9,
                "{name}: {} against {}",
                solution.cost,
                ours.cost
            );
            assert_eq!(solution.counts.gradients, 0);
            assert!(solution.counts.residuals > 100);
        }
    }
}

#[test]
fn cost_outside_limits_is_that_of_the_limit() {
    let problem = held_by_limits();
    let bounded = BoundedProblem::new(&problem);
    for x in configurations(&problem, 12) {
        for k in 0..x.len() {
            let bounds = [problem.lower()[k] - 0.4, problem.upper()[k] + 0.4];
            for beyond in bounds.into_iter().filter(|bound| bound.is_finite()) {
                let (mut outside, mut at_limit) = (x.clone(), x.clone());
                outside[k] = beyond;
                at_limit[k] = beyond.clamp(problem.lower()[k], problem.upper()[k]);
                let cost = |x: Vec<f64>| bounded.cost(&DVector::from_vec(x)).unwrap();
                assert_eq!(cost(outside), cost(at_limit), "{k}");
            }
        }
    }
}

#[test]
fn solutions_report_errors_of_their_configuration() {
    let problem = reachable();
    for solution in by_unbounded_solvers(reachable(), &START) {
        // Gauss-Newton, stopped before its first step, measures the given configuration.
        let looked = Solver::new(GaussNewton::default())
            .with_restarts(Restarts::none())
            .with_stopping(Stopping::default().with_max_iterations(0))
            .solve_once(&problem, &solution.q)
            .unwrap();
        assert_eq!(looked.q, solution.q);
        assert_eq!(looked.cost, solution.cost);
        let errors = |s: &Solution| {
            let rows: Vec<f64> = s
                .tasks()
                .flat_map(|t| t.rows.to_vec())
                .map(|r| r.error)
                .collect();
            rows
        };
        assert_eq!(errors(&looked), errors(&solution));
    }
}

#[test]
fn derivatives_by_changed_variables_are_exact() {
    for problem in [reachable(), held_by_limits(), two_tips()] {
        let unbounded = UnboundedProblem::new(&problem);
        for q in configurations(&problem, 6) {
            let y = unbounded.start(&q).unwrap();
            let at = |k: usize, step: f64| {
                let mut moved = y.clone();
                moved[k] += step;
                moved
            };
            let jacobian = unbounded.jacobian(&y).unwrap();
            let gradient = unbounded.gradient(&y).unwrap();
            let residual = unbounded.apply(&y).unwrap();
            let cost = unbounded.cost(&y).unwrap();
            assert!((0.5 * residual.norm_squared() - cost).abs() < 1e-14);
            assert!((jacobian.tr_mul(&residual) - &gradient).amax() < 1e-13);
            let h = 1e-5;
            for k in 0..y.len() {
                let (ahead, behind) = (at(k, h), at(k, -h));
                let ahead_r = unbounded.apply(&ahead).unwrap();
                let column = (ahead_r - unbounded.apply(&behind).unwrap()) / (2.0 * h);
                assert!((column - jacobian.column(k)).amax() < 1e-7);
                let rise = unbounded.cost(&ahead).unwrap() - unbounded.cost(&behind).unwrap();
                assert!((rise / (2.0 * h) - gradient[k]).abs() < 1e-7);
            }
            let hessian = unbounded.hessian(&y).unwrap();
            assert_eq!(hessian, hessian.transpose());
            assert!(hessian.cholesky().is_some());
        }
    }
}

#[test]
fn hessian_is_exact_at_zero_residual() {
    let problem = reachable();
    let unbounded = UnboundedProblem::new(&problem);
    let ours = Solver::default().solve_once(&problem, &START).unwrap();
    let y = unbounded.start(&ours.q).unwrap();
    let hessian = unbounded.hessian(&y).unwrap();
    let h = 1e-5;
    let mut differences = DMatrix::zeros(y.len(), y.len());
    for k in 0..y.len() {
        let (mut ahead, mut behind) = (y.clone(), y.clone());
        ahead[k] += h;
        behind[k] -= h;
        let rise = unbounded.gradient(&ahead).unwrap() - unbounded.gradient(&behind).unwrap();
        differences.set_column(k, &(rise / (2.0 * h)));
    }
    assert!((hessian - differences).amax() < 1e-6);
}

/// The Hessian includes ∂cost/∂x · d²x/dy² only if that is not negative.
#[test]
fn hessian_includes_the_curvature_of_the_variables() {
    let problem = held_by_limits();
    let unbounded = UnboundedProblem::new(&problem);
    let mut bends = 0;
    for q in configurations(&problem, 6) {
        let y = unbounded.start(&q).unwrap();
        let jacobian = unbounded.jacobian(&y).unwrap();
        let left = unbounded.hessian(&y).unwrap() - jacobian.tr_mul(&jacobian);
        let gradient = unbounded.gradient(&y).unwrap();
        let h = 3e-5;
        let mut expected = DMatrix::zeros(y.len(), y.len());
        for k in 0..y.len() {
            let at = |step: f64| {
                let mut moved = y.clone();
                moved[k] += step;
                unbounded.variables_at(&moved)[k]
            };
            let (behind, here, ahead) = (at(-h), at(0.0), at(h));
            let slope = (ahead - behind) / (2.0 * h);
            let curvature = (ahead - 2.0 * here + behind) / (h * h);
            expected[(k, k)] = (gradient[k] / slope * curvature).max(0.0);
            bends += usize::from(expected[(k, k)] > 1e-2);
        }
        let off = (left - expected).amax();
        assert!(off < 1e-5, "{off:e}");
    }
    assert!(bends > 5, "{bends}");
}

#[test]
fn failed_line_search_at_the_optimum_is_a_success() {
    let problem = reachable();
    let unbounded = UnboundedProblem::new(&problem);
    let precise = Stopping::default().with_step_tolerance(0.0);
    let first = Solver::default()
        .with_stopping(precise)
        .solve_once(&problem, &START)
        .unwrap();
    assert!(first.reached);
    let y = unbounded.start(&first.q).unwrap();

    let steepest = SteepestDescent::new(MoreThuenteLineSearch::new());
    let run = Executor::new(unbounded.clone(), steepest)
        .configure(|state| state.param(y.clone()).max_iters(50))
        .run();
    let newton = NewtonCG::new(MoreThuenteLineSearch::new());
    let newton = Executor::new(unbounded.clone(), newton)
        .configure(|state| state.param(y.clone()).max_iters(50))
        .run();
    let lbfgs = LBFGS::new(MoreThuenteLineSearch::new(), 7)
        .with_tolerance_grad(0.0)
        .unwrap();
    let lbfgs = Executor::new(unbounded.clone(), lbfgs)
        .configure(|state| state.param(y.clone()).max_iters(50))
        .run();
    for solution in [
        unbounded.solution_from(&y, run).unwrap(),
        unbounded.solution_from(&y, newton).unwrap(),
        unbounded.solution_from(&y, lbfgs).unwrap(),
    ] {
        assert!(solution.reached, "{}", solution.explain());
    }
}

#[test]
fn failed_run_at_a_stationary_point_is_a_solution() {
    let model = arm();
    let turning = model.joint("joint 2").unwrap();
    for (pulls, preferred, termination) in [
        (vec![0.25], None, Termination::Reached),
        // Opposite pulls of equal weight.
        (vec![-0.75, 1.25], None, Termination::Stationary),
        // Target reached, and the soft task has no error left.
        (vec![0.25], Some(0.25), Termination::Stationary),
    ] {
        let mut builder = Problem::builder(&model);
        for pull in pulls {
            let pull = Task::new(Posture::of_joints([(turning, pull)])).goal();
            builder.add(pull.tolerance(Quantity::JointUnits, 1e-6));
        }
        if let Some(preferred) = preferred {
            builder.add(Task::new(Posture::of_joints([(turning, preferred)])).preference());
        }
        let reachable = termination == Termination::Reached || preferred.is_some();
        let problem = builder.build().unwrap();
        let unbounded = UnboundedProblem::new(&problem);
        let mut q = START;
        q[2] = 0.25;
        let y = unbounded.start(&q).unwrap();
        assert_eq!(unbounded.gradient(&y).unwrap().amax(), 0.0);
        let steepest = SteepestDescent::new(MoreThuenteLineSearch::new());
        let run = Executor::new(unbounded.clone(), steepest)
            .configure(|state| state.param(y.clone()).max_iters(50))
            .run();
        assert!(run.is_err(), "argmin has learnt to start at an optimum");
        let solution = unbounded.solution_from(&y, run).unwrap();
        assert_eq!(solution.termination, termination);
        assert_eq!(solution.reached, reachable);
        assert_eq!(solution.q[2], 0.25);
    }
}

#[test]
fn failures_away_from_an_optimum_are_errors() {
    let problem = reachable();
    let unbounded = UnboundedProblem::new(&problem);
    let y = unbounded.start(&START).unwrap();
    let steepest = SteepestDescent::new(MoreThuenteLineSearch::new());
    // Without a start argmin returns an error.
    let run = Executor::new(unbounded.clone(), steepest).run();
    let failure = unbounded.solution_from(&y, run).unwrap_err();
    assert!(matches!(failure, BridgeError::Argmin(_)), "{failure}");
    assert!(
        failure.to_string().contains("initial parameter"),
        "{failure}"
    );

    let short = DVector::from_element(3, 0.0);
    let message = unbounded.cost(&short).unwrap_err().to_string();
    assert!(message.contains('3') && message.contains('7'), "{message}");
    assert!(unbounded.start(&[0.0; 3]).is_err());
    assert!(unbounded.start(&[f64::NAN; 7]).is_err());

    let bounded = BoundedProblem::new(&problem);
    for start in [
        DVector::from_element(3, 0.0),
        DVector::from_element(7, f64::NAN),
    ] {
        let run = Executor::new(bounded.clone(), ExecutorMethod::new(GaussNewton::default()))
            .configure(|state| state.param(start))
            .run();
        assert!(run.err().unwrap().to_string().contains("7 finite numbers"));
    }
}

#[test]
fn problem_serves_many_threads() {
    let problem = two_tips();
    let unbounded = UnboundedProblem::new(&problem);
    let points: Vec<DVector<f64>> = configurations(&problem, 40)
        .iter()
        .map(|q| unbounded.start(q).unwrap())
        .collect();
    let sequential: Vec<DVector<f64>> = points
        .iter()
        .map(|y| unbounded.gradient(y).unwrap())
        .collect();
    let parallel = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..4)
            .map(|_| {
                scope.spawn(|| {
                    points
                        .iter()
                        .map(|y| unbounded.gradient(y).unwrap())
                        .collect()
                })
            })
            .collect();
        let results: Vec<Vec<DVector<f64>>> = workers
            .into_iter()
            .map(|worker| worker.join().unwrap())
            .collect();
        results
    });
    assert!(parallel.iter().all(|gradients| *gradients == sequential));
    assert_eq!(arm().degrees_of_freedom(), problem.variables());
}
