//! Promise: non-finite numbers of a target, start or custom residual end a solve with a finite q within its bounds and
//! the right reason.

use kinopt::ik::{
    DerivativeWorkspace, Differentiability, NoDerivative, Restarts, SolutionDerivative, SolveError,
};
use kinopt::model::{FrameId, Model, ParameterMap};
use kinopt::problem::{Derivatives, Problem};
use kinopt::solver::Termination;
use kinopt::spatial::{Matrix3, Placement, Vector3, rotation_exp};
use kinopt::task::{
    FramePose, Inputs, LimitCentring, Orientation, Point, Posture, Quantity, Residual, RowBlock,
};
use kinopt::{Scalar, Solution, Solver, Workspace};
use support::fault_tables::ExpectedError;
use support::methods::solvers;
use support::{planar_arm, planar_tip};

const LINKS: [f64; 3] = [0.5, 0.4, 0.3];
const LIMITS: (f64, f64) = (-1.0, 1.2);

fn arm() -> (Model, FrameId) {
    let model = planar_arm(&LINKS, Some(LIMITS));
    let tip = model.frame("tip").unwrap();
    (model, tip)
}

fn assert_sound(label: &str, solution: &Solution, model: &Model) {
    for (value, limits) in solution.q.iter().zip(model.limits()) {
        assert!(limits.contains(*value), "{label}: {:?}", solution.q);
    }
}

#[test]
fn nan_target_ends_as_non_finite() {
    let (model, tip) = arm();
    let mut builder = Problem::builder(&model);
    let task = builder.add(Point::new(tip, [0.6, 0.6, 0.0]));
    let problem = builder.build().unwrap();
    for invalid in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
        for route in Derivatives::ALL {
            let problem = problem.clone().with_derivatives(route);
            for solver in solvers() {
                let target = [0.6, invalid, 0.0];
                let mut targets = problem.targets();
                targets.get_mut(task).unwrap().set_target(target);
                let mut workspace = Workspace::new();
                let start = [9.0, 0.1, -9.0];
                let question = problem.with_targets(&targets).unwrap();
                let solution = solver.solve(question, &start, &mut workspace).unwrap();
                let label = format!("{invalid}, {}, {route:?}", solver.method());
                assert_sound(&label, solution, &model);
                assert_eq!(solution.termination, Termination::NonFinite, "{label}");
                assert!(!solution.reached, "{label}");
                assert!(solution.explain().contains("not a finite number"));
                // The same workspace recovers.
                let target = [0.6, 0.6, 0.0];
                targets.get_mut(task).unwrap().set_target(target);
                let question = problem.with_targets(&targets).unwrap();
                let solution = solver.solve(question, &start, &mut workspace).unwrap();
                let fresh = solver.solve_once(question, &start).unwrap();
                assert_eq!(solution.q, fresh.q, "{label}");
            }
        }
    }
}

/// Every entry of the rotation counts, also those that the shortest formula of the angle ignores.
#[test]
fn nan_rotation_ends_as_non_finite() {
    let (model, tip) = arm();
    let turned = rotation_exp(Vector3::new(0.0, 0.0, 0.4));
    // The tenth case sets all entries.
    for entry in 0..10 {
        for invalid in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
            let mut columns = [turned.x, turned.y, turned.z].map(Vector3::to_array);
            for k in (0..9).filter(|k| entry == 9 || *k == entry) {
                columns[k / 3][k % 3] = invalid;
            }
            let [x, y, z] = columns.map(Vector3::from);
            let broken = Matrix3::from_columns(x, y, z);
            let mut builder = Problem::builder(&model);
            let orientation = builder.add(Orientation::new(tip, turned));
            let problem = builder.build().unwrap();
            let mut builder = Problem::builder(&model);
            let pose = builder.add(FramePose::new(tip, Placement::new(turned, Vector3::zero())));
            let posed = builder.build().unwrap();
            let mut turn = problem.targets();
            turn.get_mut(orientation).unwrap().set_target(broken);
            let target = Placement::new(broken, Vector3::zero());
            let mut pose_targets = posed.targets();
            pose_targets.get_mut(pose).unwrap().set_target(target);
            for (problem, targets) in [(&problem, &turn), (&posed, &pose_targets)] {
                for route in Derivatives::ALL {
                    let problem = problem.clone().with_derivatives(route);
                    let question = problem.with_targets(targets).unwrap();
                    for solver in solvers() {
                        let solution = solver.solve_once(question, &[0.1, 0.2, 0.3]).unwrap();
                        let label = format!("{entry}: {invalid}, {}, {route:?}", solver.method());
                        assert_sound(&label, &solution, &model);
                        assert_eq!(solution.termination, Termination::NonFinite, "{label}");
                        assert!(!solution.reached, "{label}");
                    }
                }
            }
        }
    }
}

#[test]
fn non_finite_start_error_names_the_joint() {
    let (model, tip) = arm();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [0.6, 0.6, 0.0]));
    let problem = builder.build().unwrap();
    for invalid in [f64::NAN, f64::INFINITY] {
        let error = Solver::default().solve_once(&problem, &[0.0, invalid, 0.0]);
        error.says("joint 1");
        // The first of several is named.
        let error = Solver::default().solve_once(&problem, &[0.0, invalid, invalid]);
        error.says("joint 1");
    }
    let error = Solver::default().solve_once(&problem, &[0.0]).unwrap_err();
    assert!(matches!(
        error,
        SolveError::StartLength {
            given: 1,
            expected: 3,
            ..
        }
    ));
}

/// Point residual that is NaN while the tip is above y = 0.3.
#[derive(Clone)]
struct Cliff {
    tip: FrameId,
    x: f64,
    y: f64,
}

impl Residual for Cliff {
    fn inputs(&self) -> Inputs {
        Inputs::frames([self.tip])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 2)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], r: &mut [S]) {
        let at = frames[0].translation;
        let above = S::constant(0.3).less_than(at.y);
        r[0] = at.x - S::constant(self.x);
        r[1] = S::select(above, S::constant(f64::NAN), at.y - S::constant(self.y));
    }
}

#[test]
fn nan_region_of_a_residual_is_avoided() {
    let (model, tip) = arm();
    for (x, y) in [(0.7, 0.8), (0.9, 0.2)] {
        let mut builder = Problem::builder(&model);
        builder.add(Cliff { tip, x, y });
        let problem = builder.build().unwrap();
        for solver in solvers() {
            let solution = solver.solve_once(&problem, &[-0.2, 0.1, 0.1]).unwrap();
            let label = format!("{y}, {}", solver.method());
            assert_sound(&label, &solution, &model);
            assert!(solution.cost.is_finite(), "{label}");
            let at = planar_tip(&LINKS, &solution.q);
            assert!(at.y <= 0.3 + 1e-12, "{label}: it fell off the cliff");
            assert_eq!(solution.reached, y < 0.3, "{label}: {solution:?}");
        }
    }
}

#[test]
fn restart_leaves_a_nan_region() {
    // The first attempt is NaN. Any attempt with a finite end is better, also one that misses.
    let (model, tip) = arm();
    let mut builder = Problem::builder(&model);
    builder.add(Cliff {
        tip,
        x: 5.0,
        y: 0.1,
    });
    let problem = builder.build().unwrap();
    for solver in solvers() {
        let solution = solver.solve_once(&problem, &[1.0, 0.5, 0.5]).unwrap();
        let name = solver.method();
        assert_sound(name, &solution, &model);
        assert!(solution.cost.is_finite(), "{name}: {solution:?}");
        assert_ne!(solution.termination, Termination::NonFinite, "{name}");
    }
}

/// Finite value with a NaN derivative: the plain length of a vector that is zero at rest.
#[derive(Clone)]
struct CarelessLength {
    tip: FrameId,
}

impl Residual for CarelessLength {
    fn inputs(&self) -> Inputs {
        Inputs::frames([self.tip])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], r: &mut [S]) {
        let at = frames[0].translation;
        r[0] = (at.y * at.y + at.z * at.z).sqrt() - S::constant(0.2);
    }
}

#[test]
fn nan_derivative_is_not_stationary() {
    let (model, tip) = arm();
    let mut builder = Problem::builder(&model);
    builder.add(CarelessLength { tip });
    let problem = builder.build().unwrap();
    for route in [Derivatives::Analytic, Derivatives::Dual] {
        let problem = problem.clone().with_derivatives(route);
        for solver in solvers() {
            let alone = solver.with_restarts(Restarts::none());
            let solution = alone.solve_once(&problem, &[0.0; 3]).unwrap();
            let label = format!("{}, {route:?}", alone.method());
            assert_eq!(solution.termination, Termination::NonFinite, "{label}");
            assert_eq!(solution.iterations, 0, "{label}");
            assert_sound(&label, &solution, &model);
            // A start elsewhere has a finite derivative.
            let restarts = alone.with_restarts(Restarts::default());
            assert!(restarts.solve_once(&problem, &[0.0; 3]).unwrap().reached);
        }
    }
}

/// A derivative of the solution needs the residual's derivatives; a NaN among them is reported.
#[test]
fn nan_derivative_gives_no_solution_derivative() {
    let (model, tip) = arm();
    let mut builder = Problem::builder(&model);
    builder.add(CarelessLength { tip });
    let problem = builder.build().unwrap();
    let mut workspace = DerivativeWorkspace::default();
    let derivative = SolutionDerivative::new(&problem, &[0.0; 3], &mut workspace).unwrap();
    let none = Differentiability::DoesNotExist(NoDerivative::NotFinite);
    assert_eq!(*derivative.differentiability(), none);
}

#[test]
fn residual_without_rows_does_not_panic() {
    // Continuous joints have no middle, so limit centring has no rows.
    let model = planar_arm(&LINKS, None);
    let tip = model.frame("tip").unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(LimitCentring::new(&model));
    builder.add(Posture::of_joints([]));
    builder.add(Point::new(tip, [0.6, 0.6, 0.0]));
    let problem = builder.build().unwrap();
    for route in Derivatives::ALL {
        let problem = problem.clone().with_derivatives(route);
        for solver in solvers() {
            let solution = solver.solve_once(&problem, &[0.1; 3]).unwrap();
            assert!(solution.q.iter().all(|v| v.is_finite()));
        }
    }
    assert!(
        Solver::default()
            .solve_once(&problem, &[0.1; 3])
            .unwrap()
            .reached
    );
}

/// A locked joint before it is no variable.
#[test]
fn non_finite_start_error_reports_the_value() {
    let (model, tip) = arm();
    let [first, second, third] = [0, 1, 2].map(|k| model.moving_joints()[k]);
    for (held, invalid) in [(first, second), (first, third), (second, third)] {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let map = ParameterMap::builder(&model).with_locked(held, 0.2);
            let mut builder = Problem::builder(&model);
            builder.parameters(map.build().unwrap());
            builder.add(Point::new(tip, [0.6, 0.6, 0.0]));
            let problem = builder.build().unwrap();
            let mut start = [0.1; 3];
            start[model.coordinate(invalid).unwrap()] = value;
            let error = Solver::default().solve_once(&problem, &start).unwrap_err();
            let SolveError::StartNotFinite {
                joint,
                value: reported,
            } = error
            else {
                panic!("{error}")
            };
            assert_eq!(joint, model.joints()[invalid.index()].name);
            assert_eq!(reported.to_bits(), value.to_bits());
        }
    }
}

/// The error over several tasks is the largest, and NaN if any of them is.
#[test]
fn nan_error_of_a_task_is_reported() {
    let (model, tip) = arm();
    for nan_first in [false, true] {
        let mut builder = Problem::builder(&model);
        // NaN at every configuration.
        let nowhere = Cliff {
            tip,
            x: 0.1,
            y: f64::NAN,
        };
        if nan_first {
            builder.add(nowhere.clone());
        }
        builder.add(Point::new(tip, [0.5, 0.2, 0.0]));
        if !nan_first {
            builder.add(nowhere);
        }
        let problem = builder.build().unwrap();
        let solution = Solver::default()
            .solve_once(&problem, &[-0.2, 0.1, 0.1])
            .unwrap();
        let error = solution.error(Quantity::Metres).unwrap();
        assert!(error.is_nan() && !solution.reached, "{error}");
    }
}
