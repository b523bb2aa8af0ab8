//! Promise: every method points a stretched arm at a target beyond it. Raw Gauss-Newton steps diverge there; damping or
//! the line search bounds them.

use kinopt::Solver;
use kinopt::ik::Restarts;
use kinopt::problem::{Evaluation, Problem};
use kinopt::solver::{GaussNewton, LeastSquares, LevenbergMarquardt, Stopping};
use kinopt::task::Point;
use nalgebra::{DMatrix, DVector};
use support::{planar_arm, planar_tip};

const LINKS: [f64; 2] = [1.0, 0.8];
/// 0.7 m beyond the stretched arm.
const TARGET_DISTANCE: f64 = 2.5;

fn problem() -> Problem {
    let model = planar_arm(&LINKS, None);
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(
        model.frame("tip").unwrap(),
        [0.0, TARGET_DISTANCE, 0.0],
    ));
    builder.build().unwrap()
}

/// Iterates a ← a − (JᵀJ + λI)⁻¹ Jᵀr. Returns the longest step of the last half and the last distance.
fn raw(damping: f64, steps: usize) -> (f64, f64) {
    let problem = problem();
    let mut scratch = problem.scratch();
    let mut evaluation = Evaluation::new(&problem, &mut scratch);
    let mut x = DVector::from_vec(vec![0.3, 1.0]);
    let mut longest = 0.0_f64;
    for step in 0..steps {
        let (mut r, mut j) = (vec![0.0; 3], DMatrix::zeros(3, 2));
        evaluation.residual(x.as_slice(), &mut r);
        evaluation.jacobian(x.as_slice(), &mut j);
        let normal = j.transpose() * &j + DMatrix::identity(2, 2) * damping;
        let inverse = normal.pseudo_inverse(1e-14).unwrap();
        let taken = inverse * j.transpose() * DVector::from_vec(r);
        if step >= steps / 2 {
            longest = longest.max(taken.amax());
        }
        x -= taken;
    }
    let tip = planar_tip(&LINKS, x.as_slice());
    (
        longest,
        (tip - nalgebra::Vector3::new(0.0, TARGET_DISTANCE, 0.0)).norm(),
    )
}

#[test]
fn only_damped_gauss_newton_steps_converge() {
    let best = TARGET_DISTANCE - 1.8;
    let (longest, _) = raw(0.0, 100);
    assert!(
        longest > 1.0,
        "a step of {longest} rad, long after the arm is stretched"
    );
    let (longest, missed) = raw(1.0, 400);
    assert!(longest < 1e-2 && missed - best < 1e-6, "{longest} {missed}");
}

#[test]
fn every_method_stretches_towards_the_target() {
    let problem = problem();
    let best = TARGET_DISTANCE - 1.8;
    for solver in [
        Solver::new(LevenbergMarquardt::default()),
        Solver::new(GaussNewton::default()),
    ] {
        let name = solver.method();
        let solver = solver.with_restarts(Restarts::none());
        let mut last = f64::INFINITY;
        for steps in [5, 10, 20, 40, 80] {
            let limited = solver
                .clone()
                .with_stopping(Stopping::default().with_max_iterations(steps));
            let solution = limited.solve_once(&problem, &[0.3, 1.0]).unwrap();
            let tip = planar_tip(&LINKS, &solution.q);
            let missed = (tip - nalgebra::Vector3::new(0.0, TARGET_DISTANCE, 0.0)).norm();
            assert!(
                missed <= last && !solution.reached,
                "{name}: {missed} after {last}"
            );
            last = missed;
        }
        assert!(last - best < 1e-9, "{name}: {last}");
    }
}
