//! Promise: a motion of a model with loops keeps them closed to 1e-9 in every frame. It reaches the minimum of the
//! equivalent mechanism without loops, and reports loops that it cannot close.

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{Limits, Loop, Model, ModelBuilder};
use kinopt::motion::Trajectory;
use kinopt::motion::trajectory::{
    MotionProblem, MotionReport, MotionSolver, MotionTermination, RateCost, Windows,
};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::{Point, Posture, Task};
use kinopt::{Problem, Solver, Workspace};
use std::f64::consts::FRAC_PI_2;

const FRAMES: usize = 40;
const STEP: f64 = 1.0 / 30.0;

fn along(length: f64) -> Placement<f64> {
    Placement::translation(Vector3::new(length, 0.0, 0.0))
}

/// A crank and a rocker of equal length, joined by a coupler as long as their distance: the coupler stays level.
fn parallelogram(weld: bool, limits: Limits) -> Model {
    let mut builder = Model::builder("parallelogram");
    add_parallelogram(&mut builder, "", weld, limits);
    builder.build().unwrap()
}

fn add_parallelogram(builder: &mut ModelBuilder, whose: &str, weld: bool, limits: Limits) {
    let named = |name: &str| format!("{whose}{name}");
    let (z, any) = (Vector3::UNITS[2], Limits::new(-3.2, 3.2));
    let crank = builder.revolute(named("crank"), None, Placement::identity(), z, limits);
    let coupler = builder.revolute(named("coupler"), Some(crank), along(0.3), z, any);
    let rocker = builder.revolute(named("rocker"), None, along(0.4), z, any);
    let last = builder.revolute(named("wrist"), Some(rocker), along(0.3), z, any);
    builder.frame(named("tip"), Some(crank), along(0.3));
    let coupler_end = builder.frame(named("coupler end"), Some(coupler), along(0.4));
    let ends = [
        builder.frame(named("rocker end"), Some(rocker), along(0.3)),
        builder.frame(named("wrist"), Some(last), Placement::identity()),
    ];
    builder.close(match weld {
        true => Loop::weld(named("pin"), [coupler_end, ends[1]]),
        false => Loop::connect(named("pin"), [coupler_end, ends[0]]),
    });
}

fn crank_alone(limits: Limits) -> Model {
    let mut builder = Model::builder("crank");
    let z = Vector3::UNITS[2];
    let crank = builder.revolute("crank", None, Placement::identity(), z, limits);
    builder.frame("tip", Some(crank), along(0.3));
    builder.build().unwrap()
}

/// The crank's tip follows a jump within its velocity limit.
fn following(model: &Model, rate: f64) -> MotionProblem {
    let mut motion = MotionProblem::builder(model, FRAMES, STEP);
    let point = motion.add(Point::new(model.frame("tip").unwrap(), [0.3, 0.0, 0.0]));
    motion.follow(point, |frame, point| {
        let angle = if frame < FRAMES / 2 { 0.8 } else { 2.4_f64 };
        point.set_target([0.3 * angle.cos(), 0.3 * angle.sin(), 0.0]);
    });
    motion.rate_cost(RateCost::acceleration(rate));
    motion.max_speed("crank", 3.0);
    motion.build().unwrap()
}

/// Largest distance between two frames and, for a weld, between their axes.
fn gap(model: &Model, solved: &Trajectory<MotionReport>, [a, b]: [&str; 2]) -> f64 {
    let ends = [a, b].map(|end| model.frame(end).unwrap().index());
    let mut kinematics = ForwardKinematics::new(model);
    let mut largest = 0.0_f64;
    for q in solved.rows() {
        let placed = kinematics.place(q).unwrap();
        let [one, other] = ends.map(|end| placed[end]);
        largest = largest.max((one.translation - other.translation).norm());
        if b == "wrist" {
            largest = largest.max((one.rotation.x - other.rotation.x).norm());
        }
    }
    largest
}

#[test]
fn linkage_stays_closed_at_the_minimum_of_its_crank() {
    let limits = Limits::new(0.5, 2.2);
    let crank = crank_alone(limits);
    // Crank, coupler, rocker and wrist move equally, and the motion of each adds to the cost.
    for (weld, end, moving) in [(false, "rocker end", 3.0_f64), (true, "wrist", 4.0)] {
        let alone = following(&crank, 1e-4 * moving.sqrt());
        let alone = MotionSolver::default().solve(&alone, &[0.8]).unwrap();
        let model = parallelogram(weld, limits);
        check(&model, &following(&model, 1e-4), end, alone.report.cost());
    }
}

/// Each of several loops is closed, and moves as it would on its own.
#[test]
fn two_linkages_both_stay_closed() {
    let limits = Limits::new(0.5, 2.2);
    let mut builder = Model::builder("two parallelograms");
    for whose in ["", "other "] {
        add_parallelogram(&mut builder, whose, false, limits);
    }
    let both = builder.build().unwrap();
    let one = parallelogram(false, limits);
    let solved = [&one, &both].map(|model| {
        let mut motion = MotionProblem::builder(model, FRAMES, STEP);
        for tip in ["tip", "other tip"].into_iter().take(model.loops().len()) {
            let point = motion.add(Point::new(model.frame(tip).unwrap(), [0.3, 0.0, 0.0]));
            motion.follow(point, |frame, point| {
                let angle = if frame < FRAMES / 2 { 0.8 } else { 2.0_f64 };
                point.set_target([0.3 * angle.cos(), 0.3 * angle.sin(), 0.0]);
            });
        }
        motion.rate_cost(RateCost::acceleration(1e-4));
        let start = [0.8, -0.8, 0.8, -0.8].repeat(model.loops().len());
        let motion = motion.build().unwrap();
        MotionSolver::default().solve(&motion, &start).unwrap()
    });
    for whose in ["", "other "] {
        let ends = ["coupler end", "rocker end"].map(|end| format!("{whose}{end}"));
        let gap = gap(&both, &solved[1], [&ends[0], &ends[1]]);
        assert!(gap <= 1e-9, "{whose}: {gap}");
    }
    assert!(solved[1].report.loop_gap() <= 1e-9);
    for (one, both) in solved[0].rows().zip(solved[1].rows()) {
        let moves = one.iter().cycle().zip(both);
        let apart = moves.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-4, "{apart}");
    }
}

fn check(model: &Model, motion: &MotionProblem, end: &str, cost: f64) {
    let start = [0.8, -0.8, 0.8, -0.8];
    let solved = MotionSolver::default().solve(motion, &start).unwrap();
    assert_eq!(solved.report.termination(), MotionTermination::Stationary);
    let gap = gap(model, &solved, ["coupler end", end]);
    assert!(
        gap <= 1e-9 && solved.report.loop_gap() <= 1e-9,
        "{gap} {}",
        solved.report.loop_gap()
    );
    assert!(
        (solved.report.cost() / cost - 1.0).abs() < 1e-6,
        "{} and {cost}",
        solved.report.cost()
    );
    assert!((0..FRAMES).all(|frame| {
        solved
            .report
            .missed(frame)
            .all(|miss| !miss.task.contains("loop"))
    }));
    for pair in solved.rows().collect::<Vec<_>>().windows(2) {
        assert!((pair[1][0] - pair[0][0]).abs() <= 3.0 * STEP);
    }
    assert!(solved.rows().all(|q| model.is_within_limits(q)));
    let windows = Windows::new(15, 10);
    let solver = MotionSolver::default().with_windows(Some(windows));
    assert!(solver.solve(motion, &start).unwrap().report.loop_gap() <= 1e-9);
}

#[test]
fn loop_that_cannot_close_is_reported() {
    let mut builder = Model::builder("stiff");
    let z = Vector3::UNITS[2];
    let any = Limits::new(-0.3, 0.3);
    let one = builder.revolute("one", None, Placement::identity(), z, any);
    // Long enough, but only at angles beyond the limits.
    let other = builder.revolute("other", None, along(0.8), z, any);
    let ends = [
        builder.frame("tip", Some(one), along(0.3)),
        builder.frame("end", Some(other), along(-0.6)),
    ];
    builder.close(Loop::connect("pin", ends));
    let model = builder.build().unwrap();
    let mut motion = MotionProblem::builder(&model, 5, STEP);
    motion.add(Point::new(ends[0], [0.3, 0.0, 0.0]));
    let motion = motion.build().unwrap();
    let solved = MotionSolver::default().solve(&motion, &[0.1, 0.1]).unwrap();
    assert!(
        solved.report.loop_gap() > 0.01,
        "{}",
        solved.report.loop_gap()
    );
    assert!(solved.rows().all(|q| model.is_within_limits(q)));
    assert!(!solved.report.reached());
    assert!((0..5).all(|frame| {
        solved
            .report
            .missed(frame)
            .any(|miss| miss.task == "loop `pin`")
    }));
}

/// Both hands of a Baxter hold a box, which the left hand lifts by 15 cm. `apart` is the requested distance of the
/// right hand from the left one in metres, which the box does not allow.
fn lift(rest: f64, apart: Option<f64>) -> (Trajectory<MotionReport>, Robot) {
    let robot = Robot::read("../models/rethink_baxter.urdf").unwrap();
    let tools = ["left_tool", "right_tool"].map(|tool| robot.model().frame(tool).unwrap());
    let places = [1.0, -1.0].map(|side| {
        let turn = rotation_exp(Vector3::new(side * FRAC_PI_2, 0.0, 0.0));
        Placement::new(turn, Vector3::new(0.0, 0.0, 0.2))
    });
    let robot = robot
        .with_loop(Loop::weld("box", tools).at(places))
        .unwrap();
    let model = robot.model();
    let [x, y, z] = [0.7, 0.2, 0.3];
    let mut problem = Problem::builder(model);
    problem.add(Point::new(tools[0], [x, y, z]));
    let problem = problem.build().unwrap();
    let mut workspace = Workspace::new();
    let start = Solver::default().solve(&problem, &model.neutral(), &mut workspace);
    let start = start.unwrap().q.clone();
    let mut motion = MotionProblem::builder(model, FRAMES, STEP);
    let hand = motion.add(Point::new(tools[0], [x, y, z]));
    motion.follow(hand, move |frame, point| {
        let share = frame as f64 / (FRAMES - 1) as f64;
        point.set_target([x, y, z + 0.15 * share]);
    });
    motion.add(Task::new(Posture::new(model, &start)).scale(rest));
    if let Some(apart) = apart {
        motion.add(Point::new(tools[1], [x, y - apart, z]));
    }
    motion.rate_cost(RateCost::acceleration(1e-4));
    motion.first(&start);
    let motion = motion.build().unwrap();
    let solved = MotionSolver::default().solve(&motion, &start).unwrap();
    (solved, robot)
}

#[test]
fn two_hands_hold_a_box_in_every_frame() {
    // With soft tasks of low weight the hands have to move far along the curve of the constraint.
    for (rest, apart) in [(0.01, None), (0.001, None), (0.1, None), (0.01, Some(0.8))] {
        let (solved, robot) = lift(rest, apart);
        assert_eq!(solved.report.termination(), MotionTermination::Stationary);
        assert!(
            solved.report.loop_gap() <= 1e-9,
            "{rest}: {}",
            solved.report.loop_gap()
        );
        let mut kinematics = ForwardKinematics::new(robot.model());
        let tools = ["left_tool", "right_tool"].map(|tool| robot.model().frame(tool).unwrap());
        for q in solved.rows() {
            let placed = kinematics.place(q).unwrap();
            // The box extends 20 cm along z of both tools, which face each other.
            let [one, other] = tools.map(|tool| placed[tool.index()].translation);
            assert!(((one - other).norm() - 0.4).abs() < 1e-8);
            assert!(robot.model().is_within_limits(q));
        }
    }
}
