//! Promise: a solution reports whether the model's loops are closed, and is never reached with an open loop.

use kinopt::model::{Limits, Loop, Model, ParameterMap};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Quantity};
use kinopt::{Problem, Solver};

use crate::loops::mechanisms::{FourBar, along_x};

#[test]
fn open_loop_is_reported_by_name_and_gap() {
    let linkage = FourBar::CRANK_ROCKER;
    let model = linkage.model();
    // Coupler and rocker are locked, so the pin is open by their distance.
    let joint = |name| model.joint(name).unwrap();
    let map = ParameterMap::builder(&model)
        .with_locked(joint("coupler"), 0.0)
        .with_locked(joint("rocker"), 0.0);
    let mut problem = Problem::builder(&model);
    problem.parameters(map.build().unwrap());
    let pen = model.frame("pen").unwrap();
    problem.add(Point::new(pen, [0.0; 3]).at([0.0; 3]));
    let problem = problem.build().unwrap();
    let solution = Solver::default().solve_once(&problem, &[0.0; 3]).unwrap();
    assert!(!solution.reached && !solution.loops_closed());
    let open: Vec<_> = solution.open_loops().collect();
    // Crank and coupler in line, rotated by q, and the rocker's end on the x axis.
    let (sin, cos) = solution.q[0].sin_cos();
    let (length, end) = (
        linkage.crank + linkage.coupler,
        linkage.ground + linkage.rocker,
    );
    let gap = (length * cos - end).hypot(length * sin);
    assert_eq!((open.len(), open[0].name, open[0].angle), (1, "pin", 0.0));
    assert!((open[0].gap - gap).abs() < 1e-12, "{} {gap}", open[0].gap);
    let explanation = solution.explain();
    assert!(
        explanation.contains("loop `pin` is open by"),
        "{explanation}"
    );
    let last = solution.tasks().last().unwrap();
    assert!(last.is_loop && last.name == "loop `pin`");
    assert!(!solution.tasks().next().unwrap().is_loop);
}

#[test]
fn loop_tolerance_is_independent_of_tasks() {
    let model = FourBar::CRANK_ROCKER.model();
    let mut problem = Problem::builder(&model);
    // The rocker at 2.2 rad, which is reachable.
    let (sin, cos) = 2.2_f64.sin_cos();
    let pin = model.frame("rocker end").unwrap();
    problem.add(Point::new(pin, [0.4 + 0.3 * cos, 0.3 * sin, 0.0]));
    problem.tolerance(Quantity::Metres, 0.5);
    let solution = Solver::default().solve_once(&problem.build().unwrap(), &[0.5, 0.5, 1.5]);
    let solution = solution.unwrap();
    assert!(solution.reached, "{}", solution.explain());
    let closing = solution.tasks().last().unwrap();
    assert!(closing.position_error().unwrap() <= Loop::TOLERANCE);
}

#[test]
fn open_weld_reports_gap_and_angle() {
    let z = Vector3::new(0.0, 0.0, 1.0);
    let mut builder = Model::builder("door");
    let hinge = builder.revolute("hinge", None, along_x(0.0), z, Limits::new(0.0, 1.0));
    let slide = builder.prismatic(
        "slide",
        Some(hinge),
        along_x(1.0),
        z,
        Limits::new(-0.1, 0.1),
    );
    let edge = builder.frame("edge", Some(slide), Placement::identity());
    let latch = builder.frame(
        "latch",
        None,
        Placement::new(
            kinopt::spatial::rotation_exp(Vector3::new(0.0, 0.0, 1.5)),
            Vector3::new(1.5_f64.cos(), 1.5_f64.sin(), 0.0),
        ),
    );
    builder.close(Loop::weld("lock", [edge, latch]));
    let model = builder.build().unwrap();
    let problem = Problem::builder(&model).build().unwrap();
    let solution = Solver::default().solve_once(&problem, &[0.2, 0.0]).unwrap();
    assert!(!solution.reached);
    let open = solution.open_loops().next().unwrap();
    assert!((open.angle - 0.5).abs() < 1e-9, "{}", open.angle);
    assert!(
        (open.gap - 2.0 * 0.25_f64.sin()).abs() < 1e-9,
        "{}",
        open.gap
    );
    let limit = solution.active_limits().next().unwrap();
    assert_eq!((limit.joint, limit.value), ("hinge", 1.0));
    let explanation = solution.explain();
    assert!(explanation.contains(" m and 0.5000 rad"), "{explanation}");
}
