//! Promise: residuals, tasks and methods from outside the library have the features of built-in ones: exact
//! derivatives, bounds, restarts, reports and soft tasks.

use std::ops::ControlFlow;

use kinopt::ik::Restarts;
use kinopt::model::{FrameId, Model};
use kinopt::solver::{
    AnyMethod, Iterate, Iteration, LeastSquares, LevenbergMarquardt, Method, SolverState, Step,
    Stopping, minimise,
};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{self, Description, Inputs, Posture, Quantity, Residual, RowBlock, Task};
use kinopt::{Problem, Scalar, Solver};
use nalgebra::DMatrix;
use support::classics::{Bounded, Rosenbrock};
use support::fault_tables::ExpectedError;
use support::planar_arm;

/// Residual: distance of a frame's origin from a circle in the xy plane, metres.
#[derive(Clone)]
struct OnCircle {
    frame: FrameId,
    centre: Vector3<f64>,
    radius: f64,
}

impl Residual for OnCircle {
    fn inputs(&self) -> Inputs {
        Inputs::frames([self.frame])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        let out = frames[0].translation - Vector3::constant(self.centre);
        residual[0] = (out.x * out.x + out.y * out.y).sqrt() - S::constant(self.radius);
    }

    fn description(&self) -> Description {
        Description::default().with_validity(self.validate())
    }
}

impl OnCircle {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        match self.radius > 0.0 {
            true => Ok(()),
            false => Err(format!("its radius {} m is not positive", self.radius)),
        }
    }
}

/// Method: steepest descent whose step length is halved until the cost falls and doubled afterwards.
struct Halving;

impl Method for Halving {
    type State = f64;

    fn name(&self) -> &'static str {
        "halving"
    }

    fn needs_jacobian(&self) -> bool {
        false
    }

    fn begin(&self, length: &mut f64, at: &SolverState) {
        *length = at.column_norm().powi(-2);
    }

    fn step(&self, length: &mut f64, at: &mut Iterate<'_>) -> Step {
        for j in 0..at.x().len() {
            at.step_mut()[j] = -*length * at.gradient()[j];
        }
        at.project_step();
        if at.evaluate_trial() < at.cost() {
            *length *= 2.0;
            at.accept();
            return Step::Taken;
        }
        *length *= 0.5;
        Step::Refused
    }

    fn control(&self, length: &f64) -> f64 {
        *length
    }
}

fn arm() -> (Model, OnCircle) {
    let model = planar_arm(&[1.0, 0.7, 0.4], Some((-2.0, 2.0)));
    let circle = OnCircle {
        frame: model.frame("tip").unwrap(),
        centre: Vector3::new(0.2, 0.1, 0.0),
        radius: 0.5,
    };
    (model, circle)
}

#[test]
fn invalid_residual_error_uses_its_own_message() {
    let (model, circle) = arm();
    let mut tasks = Problem::builder(&model);
    let flat = OnCircle {
        radius: -1.0,
        ..circle
    };
    tasks.add(Task::new(flat).named("hand on the ring"));
    tasks.build().says("hand on the ring | radius -1");
}

#[test]
fn bounded_task_leaves_freedom_to_soft_tasks() {
    let (model, circle) = arm();
    let (reference, centre, frame) = ([0.2, 0.3, -0.2], circle.centre, circle.frame);
    let mut tasks = Problem::builder(&model);
    // Ring of ±10 cm about the circle.
    let ring = Task::new(task::Bounded::new(circle, 0.1)).named("hand on the ring");
    tasks.add(ring.tolerance(Quantity::Metres, 1e-9));
    tasks.add(Posture::new(&model, &reference));
    let problem = tasks.build().unwrap();
    let solution = Solver::default().solve_once(&problem, &[0.0; 3]).unwrap();
    assert!(solution.reached, "{}", solution.explain());
    assert_eq!(solution.tasks().next().unwrap().name, "hand on the ring");
    // The posture is farther out and pulls the hand to the ring's outer edge.
    let mut kinematics = kinopt::kinematics::ForwardKinematics::new(&model);
    let tip = kinematics.place(&solution.q).unwrap()[frame.index()].translation - centre;
    assert!((0.59..0.6 + 1e-8).contains(&tip.norm()), "{}", tip.norm());
}

#[test]
fn custom_method_solves_with_bounds_and_restarts() {
    let (model, circle) = arm();
    let solver = Solver::new(Halving).with_restarts(Restarts::default().with_attempts(4));
    let mut tasks = Problem::builder(&model);
    tasks.add(circle);
    let problem = tasks.build().unwrap();
    let solution = solver.solve_once(&problem, &[0.1, 0.2, 0.3]).unwrap();
    assert!(solution.reached, "{}", solution.explain());
    assert!(solution.q.iter().all(|q| q.abs() <= 2.0));
}

/// The state of a method is independent: other methods in the same memory neither read nor change it.
#[test]
fn methods_share_memory_but_no_state() {
    let mut valley = Bounded::within(Rosenbrock, &[-2.0; 2], &[0.9, 2.0]);
    let stopping = Stopping::default().with_max_iterations(50_000);
    let mut search = |method: &dyn AnyMethod, state: &mut SolverState| {
        let mut lengths = Vec::new();
        let mut watch = |seen: &Iteration<'_>| {
            lengths.push(seen.control);
            ControlFlow::Continue(())
        };
        minimise(
            &mut valley,
            method,
            &[-1.2, 1.0],
            &stopping,
            &mut watch,
            state,
        )
        .unwrap();
        (state.x().to_vec(), lengths)
    };
    let mut state = SolverState::default();
    let first = search(&Halving, &mut state);
    let exact = search(&LevenbergMarquardt::default(), &mut state);
    assert_eq!(search(&Halving, &mut state), first);
    assert_eq!(
        search(&LevenbergMarquardt::default(), &mut state.clone()),
        exact
    );
    // On the bound x₀ = 0.9 the minimum is at x₁ = 0.81.
    for (x, expected) in first.0.iter().zip([0.9, 0.81]) {
        assert!((x - expected).abs() < 1e-5, "{x}");
    }
}

/// r = x₁ for any x₀.
struct Gutter;

impl LeastSquares for Gutter {
    fn variables(&self) -> usize {
        2
    }

    fn rows(&self) -> usize {
        1
    }

    fn lower(&self) -> &[f64] {
        &[-100.0; 2]
    }

    fn upper(&self) -> &[f64] {
        &[100.0; 2]
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        residual[0] = x[1];
    }

    fn jacobian(&mut self, _x: &[f64], jacobian: &mut DMatrix<f64>) {
        jacobian.copy_from_slice(&[0.0, 1.0]);
    }
}

/// Method that always steps by one along x₀.
struct Onwards;

impl Method for Onwards {
    type State = ();

    fn name(&self) -> &'static str {
        "onwards"
    }

    fn needs_jacobian(&self) -> bool {
        false
    }

    fn begin(&self, _: &mut (), _: &SolverState) {}

    fn step(&self, _: &mut (), at: &mut Iterate<'_>) -> Step {
        at.step_mut().copy_from_slice(&[1.0, 0.0]);
        at.project_step();
        at.evaluate_trial();
        at.accept();
        Step::Taken
    }

    fn control(&self, _: &()) -> f64 {
        0.0
    }
}

/// The first of equally good iterates is returned.
#[test]
fn first_of_equal_iterates_is_returned() {
    let stopping = Stopping::default().with_max_iterations(5);
    let mut state = SolverState::default();
    let mut seen = 0.0_f64;
    let mut watch = |iteration: &Iteration<'_>| {
        seen = seen.max(iteration.x[0]);
        ControlFlow::Continue(())
    };
    minimise(
        &mut Gutter,
        &Onwards,
        &[0.0, 1.0],
        &stopping,
        &mut watch,
        &mut state,
    )
    .unwrap();
    assert!(seen > 1.0, "it went on to {seen}");
    assert_eq!(state.x(), [0.0, 1.0]);
}
