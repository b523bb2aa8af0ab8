//! Promise: errors are zero within an interval and are measured from its end, in metres and radians. A target relative
//! to a frame that the same joints move is met in that frame, and is never taken for a world target.

use kinopt::geometric::{Ccd, Geometric};
use kinopt::model::{FrameId, Limits, Masses, Model, PointMass};
use kinopt::problem::Evaluation;
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::{
    Axis, Bounded, CentreOfMass, Distance, FramePose, Orientation, Plane, Point, PoseBounds,
    Quantity, Residual, Task,
};
use kinopt::{Problem, Solution, Solver};
use nalgebra as na;
use support::fault_tables::ExpectedError;
use support::planar_tip;

const LINKS: [f64; 3] = [1.0, 0.8, 0.5];
const Z: Vector3<f64> = Vector3::<f64>::UNITS[2];

/// Planar arm about z with limits, with frames at the first link's end and at the tip.
fn arm(limit: f64) -> (Model, FrameId, FrameId) {
    let mut builder = Model::builder("arm");
    let limits = Limits::new(-limit, limit);
    let along = |length: f64| Placement::translation([length, 0.0, 0.0].into());
    let shoulder = builder.revolute("shoulder", None, along(0.0), Z, limits);
    let elbow = builder.revolute("elbow", Some(shoulder), along(LINKS[0]), Z, limits);
    let wrist = builder.revolute("wrist", Some(elbow), along(LINKS[1]), Z, limits);
    let base = builder.frame("upper arm", Some(shoulder), along(LINKS[0]));
    let tip = builder.frame("tip", Some(wrist), along(LINKS[2]));
    (builder.build().unwrap(), base, tip)
}

fn problem<R: Residual>(model: &Model, task: impl Into<Task<R>>) -> Problem {
    let mut builder = Problem::builder(model);
    builder.add(task);
    builder.build().unwrap()
}

fn solve<R: Residual>(model: &Model, task: impl Into<Task<R>>, start: &[f64]) -> Solution {
    let problem = problem(model, task);
    Solver::default().solve_once(&problem, start).unwrap()
}

/// Placement of the tip.
fn placed(q: &[f64]) -> Placement<f64> {
    let at = planar_tip(&LINKS, q);
    Placement::new(rotation_exp(Z * q.iter().sum::<f64>()), at.into())
}

#[test]
fn task_within_its_interval_costs_nothing() {
    let (model, base, tip) = arm(3.0);
    let q = [0.3, 0.9, -0.4];
    let near = placed(&[0.31, 0.88, -0.35]);
    let bounds = PoseBounds::within([0.1, 0.1, 0.0, 0.0, 0.0, 0.1]);
    let low = Plane::new(tip, [0.0; 3], [0.0, 1.0, 0.0]);
    let tip_distance = planar_tip(&LINKS[1..], &q[1..]).norm();
    for problem in [
        problem(&model, FramePose::new(tip, near).with_goal(bounds)),
        problem(&model, Bounded::at_least(low, 0.5)),
        problem(
            &model,
            Bounded::new(Distance::new(tip, base, tip_distance + 0.1), 0.2),
        ),
    ] {
        let mut scratch = problem.scratch();
        let mut evaluation = Evaluation::new(&problem, &mut scratch);
        let mut residual = vec![f64::NAN; problem.rows()];
        evaluation.residual(&q, &mut residual);
        assert!(residual.iter().all(|r| *r == 0.0), "{residual:?}");
        let mut jacobian = na::DMatrix::from_element(problem.rows(), 3, f64::NAN);
        evaluation.jacobian(&q, &mut jacobian);
        let slope = jacobian.transpose() * na::DVector::from_vec(residual);
        assert_eq!(slope.amax(), 0.0);
        let solution = Solver::default().solve_once(&problem, &q).unwrap();
        assert!(solution.reached && solution.q == q);
    }
}

/// Rotations are reported as angles, although bounded rows are chords, and metres beyond the interval.
#[test]
fn errors_are_measured_from_the_interval() {
    let mut builder = Model::builder("slide and hinge");
    let still = Placement::identity();
    let x = Vector3::UNITS[0];
    let slide = builder.prismatic("slide", None, still, x, Limits::new(-1.0, 1.0));
    let hinge = builder.revolute("hinge", Some(slide), still, Z, Limits::new(-0.5, 0.5));
    let tip = builder.frame("tip", Some(hinge), still);
    let model = builder.build().unwrap();
    let target = Placement::new(rotation_exp(Z * 2.5), x * 2.0);
    // In the target's axes its x is rotated by 2.5 rad, so the whole position counts.
    let goal = PoseBounds::within([0.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0]);
    let solution = solve(
        &model,
        FramePose::new(tip, target).with_goal(goal),
        &[0.0; 2],
    );
    let task = solution.tasks().next().unwrap();
    assert!((task.position_error().unwrap() - 1.0).abs() < 1e-6);
    assert!((task.orientation_error().unwrap() - 2.0).abs() < 1e-6);

    let floor = Bounded::at_least(Plane::new(tip, [0.0; 3], [1.0, 0.0, 0.0]), 1.25);
    let solution = solve(&model, floor, &[0.0; 2]);
    let task = solution.tasks().next().unwrap();
    assert!((task.position_error().unwrap() - 0.25).abs() < 1e-9);
}

/// Bounds change neither the name nor the frame of a task.
#[test]
fn bounded_task_keeps_its_name() {
    let (model, _, tip) = arm(3.0);
    let mass = PointMass {
        frame: tip,
        at: Vector3::zero(),
        mass: 1.0,
    };
    let masses = Masses::new(&model, [mass]).unwrap();
    let task = CentreOfMass::new(&masses, [1.0; 3]);
    let name = |problem: &Problem| problem.task_name(0).unwrap().to_owned();
    let plain = name(&problem(&model, task.clone()));
    assert_eq!(name(&problem(&model, Bounded::new(task, 0.1))), plain);
}

#[test]
fn target_in_a_moving_frame_is_met() {
    let (model, base, tip) = arm(3.0);
    let reference = [0.4, 0.7, -1.2];
    let at = planar_tip(&LINKS[1..], &reference[1..]);
    let turn = rotation_exp(Z * (reference[1] + reference[2]));
    let relative = Placement::new(turn, at.into());
    let mut builder = Problem::builder(&model);
    builder.add(FramePose::new(tip, relative).relative_to(base));
    builder.add(Orientation::new(tip, turn).relative_to(base));
    // And at a point where the same joints bring both together.
    let world = Vector3::from(planar_tip(&LINKS, &reference));
    builder.add(Point::new(tip, world));
    let problem = builder.build().unwrap();
    let solution = Solver::default().solve_once(&problem, &[0.0; 3]).unwrap();
    assert!(solution.reached, "{}", solution.explain());
    for (q, reference) in solution.q.iter().zip(reference) {
        assert!((q - reference).abs() < 1e-5, "{q} {reference}");
    }
    assert_eq!(solution.tasks().next().unwrap().frame, Some("tip"));
}

/// Positions in a moving frame are not compared with the chain's reach in the world.
#[test]
fn far_target_in_a_base_is_not_out_of_reach() {
    let (model, base, tip) = arm(0.5);
    let unreachable = [0.0, 9.0, 0.0];
    assert!(solve(&model, Point::new(tip, unreachable), &[0.0; 3]).is_out_of_reach());
    let relative = solve(
        &model,
        Point::new(tip, unreachable).relative_to(base),
        &[0.0; 3],
    );
    assert!(!relative.reached && !relative.is_out_of_reach());
    let at = Placement::translation(unreachable.into());
    assert!(solve(&model, FramePose::new(tip, at), &[0.0; 3]).is_out_of_reach());
    let slides = FramePose::new(tip, at).with_goal(PoseBounds::free_along(Axis::Y));
    let slides = solve(&model, slides, &[0.0; 3]);
    assert!(!slides.reached && !slides.is_out_of_reach());
    // A tool of that length could reach.
    let tool = Placement::translation([0.0, 8.0, 0.0].into());
    let tooled = solve(&model, FramePose::new(tip, at).with_tool(tool), &[0.1; 3]);
    assert!(!tooled.is_out_of_reach());
}

#[test]
fn geometric_solvers_reject_bounds_and_bases() {
    let (model, base, tip) = arm(3.0);
    let target = placed(&[0.5, 0.4, 0.3]);
    let tool = Placement::new(rotation_exp(Z * 0.3), Vector3::new(0.2, 0.1, 0.0));
    let tooled = FramePose::new(tip, target * tool).with_tool(tool);
    let tooled = Task::new(tooled).tolerance(Quantity::Metres, 1e-3);
    let tooled = tooled.tolerance(Quantity::Radians, 1e-3);
    let ccd = Ccd::default();
    let solution = ccd.solve(&problem(&model, tooled), &[0.1; 3]).unwrap();
    assert!(solution.reached, "{}", solution.explain());

    let pose = FramePose::new(tip, target);
    for refused in [
        problem(&model, pose.relative_to(base)),
        problem(&model, pose.with_goal(PoseBounds::free_about(Axis::Z))),
        problem(&model, Bounded::new(Point::new(tip, [1.0; 3]), 0.1)),
        problem(
            &model,
            Orientation::new(tip, target.rotation).relative_to(base),
        ),
    ] {
        ccd.solve(&refused, &[0.1; 3])
            .says("of `tip` | without goal bounds");
    }
}
