//! Promise: a frame that looks exactly away from its target rotates towards it.

use kinopt::problem::{Evaluation, Problem};
use kinopt::solver::LeastSquares;
use kinopt::spatial::Vector3;
use kinopt::task::LookAt;
use kinopt::{Model, Solver};
use nalgebra::DMatrix;
use std::f64::consts::PI;
use support::methods::solvers;

/// A ball of three revolute joints at the origin, about z, y and x.
fn eye() -> Model {
    use kinopt::spatial::Placement;
    let mut builder = Model::builder("eye");
    let mut parent = None;
    for (name, axis) in ["z", "y", "x"].iter().zip(Vector3::UNITS.into_iter().rev()) {
        parent = Some(builder.continuous(*name, parent, Placement::identity(), axis));
    }
    builder.frame("eye", parent, Placement::identity());
    builder.build().unwrap()
}

fn problem(model: &Model, axis: Vector3<f64>, target: Vector3<f64>) -> Problem {
    let mut builder = Problem::builder(model);
    builder.add(LookAt::new(model.frame("eye").unwrap(), axis, target));
    builder.build().unwrap()
}

#[test]
fn every_solver_rotates_to_the_target() {
    let model = eye();
    let skew = Vector3::new(0.6, -0.48, 0.64);
    for axis in [
        Vector3::UNITS[0],
        Vector3::UNITS[1],
        Vector3::UNITS[2],
        skew,
    ] {
        let problem = problem(&model, axis, -axis * 2.5);
        for solver in solvers().into_iter().chain([Solver::default()]) {
            let solution = solver.solve_once(&problem, &[0.0; 3]).unwrap();
            let name = solver.method();
            assert!(solution.reached, "{name}, {axis:?}: {}", solution.explain());
        }
    }
}

#[test]
fn gradient_opposite_the_target_is_exact() {
    let model = eye();
    let axis = Vector3::UNITS[0];
    let problem = problem(&model, axis, -axis);
    let mut scratch = problem.scratch();
    let mut evaluation = Evaluation::new(&problem, &mut scratch);
    let weight = {
        let mut r = [0.0; 3];
        evaluation.residual(&[0.0; 3], &mut r);
        r.iter().map(|v| v * v).sum::<f64>().sqrt() / PI
    };
    let mut gradient = [0.0; 3];
    let mut r = [0.0; 3];
    evaluation.residual(&[0.0; 3], &mut r);
    evaluation.gradient(&[0.0; 3], &r, &mut gradient, &mut DMatrix::zeros(3, 3));
    // ½ w² θ² falls by w² π per radian about some axis perpendicular to the line of sight.
    let steepest = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
    assert!((steepest - weight * weight * PI).abs() < 1e-12 * steepest);
}
