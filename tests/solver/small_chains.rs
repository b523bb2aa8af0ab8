//! Promise: chains of one and two joints converge, also for overdetermined tasks and joint values far outside (−π, π].

use kinopt::model::{Limits, Model};
use kinopt::problem::Problem;
use kinopt::solver::{FirstStep, GaussNewton, LevenbergMarquardt, ProjectedGradient, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, Orientation, Point, Quantity, Task};
use kinopt::{Solver, Workspace};
use nalgebra as na;
use support::methods::solvers;
use support::{placement, planar_arm, planar_tip, rigid};

fn patient(solver: Solver) -> Solver {
    solver.with_stopping(Stopping::default().with_max_iterations(2_000))
}

#[test]
fn two_joints_reach_a_full_pose() {
    // A reachable pose.
    let links = [0.6, 0.5];
    let model = planar_arm(&links, Some((-2.5, 2.5)));
    let tip = model.frame("tip").unwrap();
    let q: [f64; 2] = [0.8, -1.3];
    let turn = na::Rotation3::from_axis_angle(&na::Vector3::z_axis(), q[0] + q[1]);
    let target = rigid(turn, planar_tip(&links, &q));
    let mut builder = Problem::builder(&model);
    builder.add(FramePose::new(tip, placement(&target)));
    let problem = builder.build().unwrap();
    for solver in solvers().into_iter().map(patient) {
        let solution = solver.solve_once(&problem, &[0.1, 0.2]).unwrap();
        assert!(
            solution.reached,
            "{}: {}",
            solver.method(),
            solution.explain()
        );
        for (ours, theirs) in solution.q.iter().zip(&q) {
            assert!((ours - theirs).abs() < 1e-4);
        }
    }
}

#[test]
fn one_joint_weighs_two_orientations() {
    // Orientations 0.4 with weight 2 and 1.0 with weight 1: (4 · 0.4 + 1 · 1.0) / 5 = 0.52.
    let model = planar_arm(&[1.0], Some((-3.0, 3.0)));
    let tip = model.frame("tip").unwrap();
    let turn =
        |angle: f64| na::Rotation3::from_axis_angle(&na::Vector3::z_axis(), angle).into_inner();
    let mut builder = Problem::builder(&model);
    let wish = |angle, weight| {
        Task::new(Orientation::new(tip, turn(angle))).weight(Quantity::Radians, weight)
    };
    builder.add(wish(0.4, 2.0));
    builder.add(wish(1.0, 1.0));
    let problem = builder.build().unwrap();
    let quick = [
        Solver::new(LevenbergMarquardt::default()),
        Solver::new(GaussNewton::default()),
        Solver::new(ProjectedGradient::new(FirstStep::BarzilaiBorwein)),
    ];
    for solver in quick {
        let solution = solver.solve_once(&problem, &[0.0]).unwrap();
        assert!((solution.q[0] - 0.52).abs() < 1e-8, "{}", solver.method());
        assert!(!solution.reached);
        let missed = solution.tasks().map(|t| t.orientation_error().unwrap());
        for (ours, theirs) in missed.zip([0.12, 0.48]) {
            assert!((ours - theirs).abs() < 1e-8);
        }
    }
}

#[test]
fn prismatic_values_are_not_wrapped() {
    // Metres beyond π must not be wrapped as an angle.
    let mut builder = Model::builder("gantry");
    let slide = builder.prismatic(
        "slide",
        None,
        Placement::identity(),
        Vector3::UNITS[0],
        Limits::new(-100.0, 100.0),
    );
    let tip = builder.frame("tip", Some(slide), Placement::identity());
    let model = builder.build().unwrap();
    let mut workspace = Workspace::new();
    for x in [42.0, -99.0, 3.0] {
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, [x, 0.0, 0.0]));
        let problem = builder.build().unwrap();
        for solver in solvers().into_iter().map(patient) {
            let solution = solver.solve(&problem, &[7.0], &mut workspace).unwrap();
            assert!((solution.q[0] - x).abs() <= 1e-6, "{}", solver.method());
        }
    }
}
