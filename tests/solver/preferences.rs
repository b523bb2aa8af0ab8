//! Promise: preferences act in what the goals leave free: a goal within reach is reached whatever they
//! weigh, one out of reach is missed by no more than without them, and within that they are at a
//! minimum; unless they are traded off against the goals, which a solution then tells.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::ops::ControlFlow;
use std::time::Duration;

use kinopt::model::{FrameId, JointId, Model, ParameterMap};
use kinopt::problem::{Evaluation, Preferences, Problem, ProblemBuilder};
use kinopt::solver::{Iteration, LeastSquares, Stopping, Termination};
use kinopt::spatial::Placement;
use kinopt::task::{
    LimitCentring, LookAt, Orientation, Point, Pose, Posture, Quantity, Residual, Role, Rows,
    Smoothness, Task,
};
use kinopt::{Scalar, Solution, Solver, Workspace};
use nalgebra::{DMatrix, DVector};
use support::arms::{panda, robot};
use support::bones::RandomRig;
use support::planar_arm;
use support::random::Random;
use support::trees::configuration_of;

/// A variable as near to a bound as this has no way to go there, in radians or metres.
const AT_BOUND: f64 = 1e-4;

type Add<'a> = &'a dyn Fn(&mut ProblemBuilder<'_>);

/// A problem of the same model with the tasks that `adds` add.
fn problem(model: &Model, map: &ParameterMap, adds: &[Add<'_>]) -> Problem {
    let mut builder = Problem::builder(model);
    builder.parameters(map.clone());
    for add in adds {
        add(&mut builder);
    }
    builder.build().unwrap()
}

/// Residual and Jacobian at q.
fn linearised(problem: &Problem, x: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
    let mut scratch = problem.scratch();
    let mut evaluation = Evaluation::new(problem, &mut scratch);
    let mut residual = vec![0.0; problem.rows()];
    let mut jacobian = DMatrix::zeros(problem.rows(), problem.variables());
    evaluation.residual(x, &mut residual);
    evaluation.jacobian(x, &mut jacobian);
    (DVector::from_vec(residual), jacobian)
}

/// How much of the pulls' steepest descent the goals and the bounds leave, as a share of it: ‖g + Cᵀy‖
/// without what pushes out of a bound, which is no less than that for any multipliers y; they come from
/// nalgebra's singular values, Newton's steps with halvings.
fn left_over(goals: &Problem, pulls: &Problem, q: &[f64]) -> f64 {
    let mut x = vec![0.0; goals.variables()];
    goals.parameters().reduce(q, &mut x);
    let (_, held) = linearised(goals, &x);
    let (residual, jacobian) = linearised(pulls, &x);
    let slope = jacobian.transpose() * residual;
    let left = |multipliers: &DVector<f64>| {
        let mut left = &slope + held.transpose() * multipliers;
        for (j, left) in left.iter_mut().enumerate() {
            let pinned = (x[j] <= goals.lower()[j] + AT_BOUND && *left > 0.0)
                || (x[j] >= goals.upper()[j] - AT_BOUND && *left < 0.0);
            *left = if pinned { 0.0 } else { *left };
        }
        left
    };
    let mut multipliers = DVector::zeros(held.nrows());
    for _ in 0..60 {
        let now = left(&multipliers);
        let mut free = held.clone();
        for (mut column, left) in free.column_iter_mut().zip(&now) {
            if *left == 0.0 {
                column.fill(0.0);
            }
        }
        let newton = -free.transpose().svd(true, true).solve(&now, 1e-9).unwrap();
        let shares = (0..30).map(|halvings| 0.5_f64.powi(halvings));
        let trials = shares.map(|share| &multipliers + &newton * share);
        let lower = |trial: &DVector<f64>| left(trial).norm() < now.norm();
        let Some(better) = trials.into_iter().find(lower) else {
            break;
        };
        multipliers = better;
    }
    left(&multipliers).norm() / slope.norm().max(1e-9)
}

fn within_limits(problem: &Problem, q: &[f64]) -> bool {
    let mut x = vec![0.0; problem.variables()];
    problem.parameters().reduce(q, &mut x);
    let bounds = problem.lower().iter().zip(problem.upper());
    x.iter().zip(bounds).all(|(x, (l, u))| l <= x && x <= u)
}

/// ½ Σ ‖W r‖² of the preferences of a solution whose rows all weigh 1.
fn pull_of(solution: &Solution) -> f64 {
    let preferences = solution.tasks().filter(|t| t.role == Role::Preference);
    let rows = preferences.flat_map(|task| task.rows);
    0.5 * rows.map(|rows| rows.error * rows.error).sum::<f64>()
}

#[test]
fn a_panda_on_its_target_with_preferences_at_their_default_weights() {
    let (robot, base, tool) = panda();
    assert_eq!(base, "base");
    let (model, map) = (robot.model(), robot.map());
    let frame = model.frame(tool).unwrap();
    let kinds = ["posture", "limit centring", "smoothness"];
    let (mut left, mut steps) = (Vec::new(), [0; 3]);
    let cases = support::arms::cases(60, 12);
    for (k, kind) in kinds.iter().enumerate() {
        for seed in 0..cases as u64 {
            let mut random = Random::new(seed);
            let [there, start, other] = [(); 3].map(|()| configuration_of(model, &mut random));
            let target = placement_of(model, tool, &there);
            let goal: Add<'_> = &|builder| {
                builder.add(Pose::new(frame, target));
            };
            let pull: Add<'_> = &|builder| match k {
                0 => {
                    builder.add(Posture::new(model, &other));
                }
                1 => {
                    builder.add(LimitCentring::new(model));
                }
                _ => {
                    builder.add(Smoothness::new(model, &start, 0.01));
                }
            };
            let [goals, pulls] = [goal, pull].map(|add| problem(model, map, &[add]));
            let both = problem(model, map, &[goal, pull]);
            let alone = Solver::default().solve_once(&goals, &start).unwrap();
            let solution = Solver::default().solve_once(&both, &start).unwrap();
            assert!(
                alone.reached && solution.reached,
                "{kind} {seed}: {}",
                solution.explain()
            );
            assert_eq!(solution.termination, Termination::Reached);
            assert!(within_limits(&both, &solution.q));
            steps[k] += solution.iterations - alone.iterations;
            left.push(left_over(&goals, &pulls, &solution.q));
        }
    }
    left.sort_by(f64::total_cmp);
    let settled = left.iter().filter(|left| **left < 3e-3).count();
    assert!(settled * 100 >= 95 * left.len(), "{settled}: {left:?}");
    assert!(
        steps.iter().all(|s| *s < 30 * cases),
        "{steps:?} of {cases}"
    );
}

fn placement_of(model: &Model, frame: &str, q: &[f64]) -> Placement<f64> {
    let mut kinematics = kinopt::kinematics::ForwardKinematics::new(model);
    let placements = kinematics.place(q).unwrap();
    placements[model.frame(frame).unwrap().index()]
}

/// A rig whose tips are dragged, and what else is wanted of it.
struct Drag {
    rig: RandomRig,
    map: ParameterMap,
    rest: Vec<f64>,
    start: Vec<f64>,
    targets: Vec<nalgebra::Vector3<f64>>,
}

fn drag(seed: u64) -> Drag {
    let rig = RandomRig::new(seed);
    let model = rig.skeleton.model();
    let mut random = Random::new(seed);
    let start = configuration_of(model, &mut random);
    let there = configuration_of(model, &mut random);
    let at = rig.transforms(&there);
    Drag {
        map: ParameterMap::free(model),
        rest: model.neutral(),
        targets: rig.tips.iter().map(|&tip| rig.tip(&at, tip)).collect(),
        start,
        rig,
    }
}

impl Drag {
    fn add_goals(&self, builder: &mut ProblemBuilder<'_>, farther: f64) {
        for (&tip, target) in self.rig.tips.iter().zip(&self.targets) {
            builder.add(Point::new(self.rig.skeleton.tip(tip), target * farther));
        }
    }

    /// A posture, a gaze and an upright bone.
    fn add_pulls(&self, builder: &mut ProblemBuilder<'_>) {
        let skeleton = &self.rig.skeleton;
        builder.add(Posture::new(skeleton.model(), &self.rest));
        let gaze = LookAt::new(
            skeleton.tail(self.rig.tips[0]),
            nalgebra::Vector3::x(),
            [3.0, 1.0, 0.5],
        );
        builder.add(Task::new(gaze).weight(Quantity::Radians, 1.0).preference());
        let upright = nalgebra::Matrix3::identity();
        let upright = Orientation::new(skeleton.tail(self.rig.tips[1]), upright);
        builder.add(
            Task::new(upright)
                .weight(Quantity::Radians, 1.0)
                .preference(),
        );
    }
}

#[test]
fn a_figure_of_many_bones_with_preferences_of_every_kind() {
    let (mut left, mut steps) = (Vec::new(), 0);
    for seed in 0..6 {
        let drag = drag(seed);
        let model = drag.rig.skeleton.model();
        let goal: Add<'_> = &|builder| drag.add_goals(builder, 1.0);
        let pull: Add<'_> = &|builder| drag.add_pulls(builder);
        let [goals, pulls] = [goal, pull].map(|add| problem(model, &drag.map, &[add]));
        let both = problem(model, &drag.map, &[pull, goal]);
        let alone = Solver::default().solve_once(&goals, &drag.start).unwrap();
        let solution = Solver::default().solve_once(&both, &drag.start).unwrap();
        assert_eq!(alone.reached, solution.reached);
        assert!(solution.reached, "{seed}: {}", solution.explain());
        assert!(within_limits(&both, &solution.q));
        let again = Solver::default().solve_once(&both, &drag.start).unwrap();
        assert_eq!(again.q, solution.q);
        left.push(left_over(&goals, &pulls, &solution.q));
        steps += solution.iterations - alone.iterations;
    }
    assert!(left.iter().all(|left| *left < 1e-3), "{left:?}");
    assert!(steps < 6 * 50, "{steps}");
}

#[test]
fn a_drag_with_a_posture_takes_few_steps_more_a_frame() {
    let mut drag = drag(3);
    drag.start = drag.rest.clone();
    let model = drag.rig.skeleton.model();
    let at = drag.rig.transforms(&drag.rest);
    let tips = drag.rig.tips.iter().map(|&tip| drag.rig.tip(&at, tip));
    drag.targets = tips.map(|tip| tip * 0.9).collect();
    let mut total = [0; 2];
    for (with, total) in total.iter_mut().enumerate() {
        let mut builder = Problem::builder(model);
        let tip = drag.rig.skeleton.tip(drag.rig.tips[0]);
        let task = builder.add(Point::new(tip, drag.targets[0]));
        for (&tip, target) in drag.rig.tips.iter().zip(&drag.targets).skip(1) {
            builder.add(Point::new(drag.rig.skeleton.tip(tip), *target));
        }
        if with == 1 {
            builder.add(Posture::new(model, &drag.rest));
        }
        let mut problem = builder.build().unwrap();
        let mut workspace = Workspace::new();
        let mut q = drag.rest.clone();
        let frames = 60;
        for frame in 0..frames {
            let turn = 0.05 * f64::from(frame);
            let sway = nalgebra::Vector3::new(turn.sin(), 1.0 - turn.cos(), 0.0) * 0.05;
            let target = drag.targets[0] + sway;
            problem.residual_mut(task).unwrap().set_target(target);
            let solution = Solver::default()
                .solve(&problem, &q, &mut workspace)
                .unwrap();
            assert!(solution.reached, "{}", solution.explain());
            if frame > 0 {
                *total += solution.iterations;
            }
            q.copy_from_slice(&solution.q);
        }
    }
    assert!(total[1] < total[0] + 60 * 20, "{total:?}");
}

#[test]
fn a_goal_out_of_reach_is_missed_by_no_more() {
    for seed in 0..4 {
        let drag = drag(seed);
        let model = drag.rig.skeleton.model();
        let goal: Add<'_> = &|builder| drag.add_goals(builder, 4.0);
        let pull: Add<'_> = &|builder| {
            builder.add(Posture::new(model, &drag.rest));
        };
        let goals = problem(model, &drag.map, &[goal]);
        let both = problem(model, &drag.map, &[goal, pull]);
        let alone = Solver::default().solve_once(&goals, &drag.start).unwrap();
        let solution = Solver::default().solve_once(&both, &drag.start).unwrap();
        assert!(!alone.reached && !solution.reached);
        let missed = solution.cost - pull_of(&solution);
        assert!(
            missed <= alone.cost * (1.0 + 2e-9),
            "{seed}: {missed} {}",
            alone.cost
        );
        let pull = |q: &[f64]| {
            let off = q.iter().zip(&drag.rest).map(|(a, b)| (a - b).powi(2));
            0.5 * off.sum::<f64>()
        };
        assert!(
            pull(&solution.q) < pull(&alone.q),
            "{seed}: no nearer to rest"
        );
        assert!(within_limits(&both, &solution.q));
        assert_eq!(solution.pulling_preferences().count(), 0);
    }
}

#[test]
fn what_a_miss_leaves_free_is_used() {
    // A stretched arm of ball joints may still roll about its own line, and a joint beside it turn.
    let (robot, _, tool) = panda();
    let (model, map) = (robot.model(), robot.map());
    let frame = model.frame(tool).unwrap();
    let mut random = Random::new(5);
    let start = configuration_of(model, &mut random);
    let other = configuration_of(model, &mut random);
    let goal: Add<'_> = &|builder| {
        builder.add(Point::new(frame, [2.0, 1.0, 0.4]));
    };
    let pull: Add<'_> = &|builder| {
        builder.add(Posture::new(model, &other));
    };
    let goals = problem(model, map, &[goal]);
    let both = problem(model, map, &[goal, pull]);
    let alone = Solver::default().solve_once(&goals, &start).unwrap();
    let solution = Solver::default().solve_once(&both, &start).unwrap();
    let missed = |s: &Solution| s.tasks().next().unwrap().position_error().unwrap();
    assert!((missed(&alone) - missed(&solution)).abs() < 1e-8);
    // The last joint turns about the tool's own line: nothing keeps it from its value.
    let last = 6;
    assert!(
        (solution.q[last] - other[last]).abs() < 1e-4,
        "{solution:?}"
    );
    assert!(solution.is_out_of_reach());
    assert!(
        solution.explain().contains("Out of reach: point of"),
        "{}",
        solution.explain()
    );
}

#[test]
fn traded_preferences_pull_goals_away_and_are_named() {
    let (robot, _, tool) = panda();
    let (model, map) = (robot.model(), robot.map());
    let frame = model.frame(tool).unwrap();
    let mut random = Random::new(2);
    let [there, other] = [(); 2].map(|()| configuration_of(model, &mut random));
    let target = placement_of(model, tool, &there);
    for weight in [1.0, 1e-2] {
        let mut builder = Problem::builder(model);
        builder.parameters(map.clone());
        builder.add(Pose::new(frame, target));
        builder.add(
            Task::new(Posture::new(model, &other))
                .weight(Quantity::JointUnits, weight)
                .named("my posture"),
        );
        builder.add(Task::new(Posture::new(model, &there)).weight(Quantity::JointUnits, 1e-9));
        builder.preferences(Preferences::Traded);
        let problem = builder.build().unwrap();
        assert_eq!(problem.preferences(), Preferences::Traded);
        let solution = Solver::default().solve_once(&problem, &there).unwrap();
        assert!(!solution.reached);
        let named: Vec<&str> = solution.pulling_preferences().collect();
        assert_eq!(named, ["my posture"]);
        let words = solution.explain();
        assert!(
            words.contains("my posture pulls against the goals"),
            "{words}"
        );
        assert!(words.contains("sum of goals and preferences"), "{words}");
    }
}

/// The strongest first, whatever the order in which they were added.
#[test]
fn of_several_that_pull_the_strongest_is_named_first() {
    let model = planar_arm(&[1.0, 0.8], Some((-2.5, 2.5)));
    let tip = model.frame("tip").unwrap();
    for weights in [[0.3, 0.5, 0.2], [0.5, 0.2, 0.3]] {
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, [0.9, 0.9, 0.0]));
        for weight in weights {
            let posture = Task::new(Posture::new(&model, &[-1.0, 0.5]));
            let posture = posture.weight(Quantity::JointUnits, weight);
            builder.add(posture.named(format!("{weight}")));
        }
        builder.preferences(Preferences::Traded);
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[0.2, 0.9]).unwrap();
        let named: Vec<&str> = solution.pulling_preferences().collect();
        assert_eq!(named, ["0.5", "0.3", "0.2"]);
    }
}

/// Rows for which any error will do hold nothing: a pose whose orientation is free leaves as much to a
/// posture as a point does.
#[test]
fn rows_that_cannot_be_missed_hold_nothing() {
    let (robot, _, tool) = panda();
    let (model, map) = (robot.model(), robot.map());
    let frame = model.frame(tool).unwrap();
    let mut left = Vec::new();
    for seed in 0..4 {
        let mut random = Random::new(seed);
        let [there, start, other] = [(); 3].map(|()| configuration_of(model, &mut random));
        let target = placement_of(model, tool, &there);
        let pose: Add<'_> = &|builder| {
            let pose = Task::new(Pose::new(frame, target));
            builder.add(pose.tolerance(Quantity::Radians, f64::INFINITY));
        };
        let point: Add<'_> = &|builder| {
            builder.add(Point::new(frame, target.translation));
        };
        let pull: Add<'_> = &|builder| {
            builder.add(Posture::new(model, &other));
        };
        let both = problem(model, map, &[pose, pull]);
        let [goals, pulls] = [point, pull].map(|add| problem(model, map, &[add]));
        let solution = Solver::default().solve_once(&both, &start).unwrap();
        assert!(solution.reached, "{seed}: {}", solution.explain());
        left.push(left_over(&goals, &pulls, &solution.q));
    }
    assert!(left.iter().all(|left| *left < 3e-3), "{left:?}");
}

/// A goal that misses by 1 where its joint is below 0.3 and by 1.2 beyond 0.5, flat on both sides.
struct Terrace(JointId);

impl Residual for Terrace {
    fn frames(&self) -> Vec<FrameId> {
        Vec::new()
    }

    fn joints(&self) -> Vec<JointId> {
        vec![self.0]
    }

    fn rows(&self) -> Vec<Rows> {
        vec![Rows::new(Quantity::Ratio, 1)]
    }

    fn evaluate<S: Scalar>(&self, _: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        let c = S::constant;
        let way = ((joints[0] - c(0.3)) * c(5.0)).max(c(0.0)).min(c(1.0));
        residual[0] = c(1.0) + c(0.2) * way * way * (c(3.0) - c(2.0) * way);
    }
}

/// A step over an edge ends where no slope leads back, and is not taken.
#[test]
fn a_miss_does_not_grow_for_a_preference_s_sake() {
    let model = planar_arm(&[1.0], Some((-2.0, 2.0)));
    let joint = model.joint("joint 0").unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Task::new(Terrace(joint)).tolerance(Quantity::Ratio, 1e-6));
    builder.add(Posture::new(&model, &[1.5]));
    let problem = builder.build().unwrap();
    let solution = Solver::default().solve_once(&problem, &[0.0]).unwrap();
    assert!(!solution.reached);
    let missed = solution
        .tasks()
        .next()
        .unwrap()
        .error(Quantity::Ratio)
        .unwrap();
    assert!(missed < 1.0 + 1e-6, "{missed} at {:?}", solution.q);
    assert!(solution.q[0] > 0.1, "{:?}", solution.q);
}

/// What a task measures in one unit in several places is one error.
struct Split(JointId);

impl Residual for Split {
    fn frames(&self) -> Vec<FrameId> {
        Vec::new()
    }

    fn joints(&self) -> Vec<JointId> {
        vec![self.0]
    }

    fn rows(&self) -> Vec<Rows> {
        let metres = || Rows::new(Quantity::Metres, 1);
        vec![metres(), Rows::new(Quantity::Radians, 1), metres()]
    }

    fn evaluate<S: Scalar>(&self, _: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        residual[0] = S::constant(3.0);
        residual[1] = joints[0];
        residual[2] = S::constant(-4.0);
    }
}

#[test]
fn the_error_of_rows_apart_is_that_of_all_of_them() {
    let model = planar_arm(&[1.0], Some((-2.0, 2.0)));
    let mut builder = Problem::builder(&model);
    builder.add(Split(model.joint("joint 0").unwrap()));
    let problem = builder.build().unwrap();
    let solution = Solver::default().solve_once(&problem, &[0.4]).unwrap();
    let task = solution.tasks().next().unwrap();
    let errors = [Quantity::Metres, Quantity::Ratio].map(|quantity| task.error(quantity));
    assert!((errors[0].unwrap() - 5.0).abs() < 1e-12 && errors[1].is_none());
}

/// Beyond the chain's length by less than its tolerance a goal is not out of reach, whatever else keeps
/// it from its place.
#[test]
fn out_of_reach_is_beyond_the_tolerance() {
    let model = planar_arm(&[1.0, 0.4], Some((-1.0, 1.0)));
    let tip = model.frame("tip").unwrap();
    for (x, beyond) in [(-1.45, false), (-1.55, true)] {
        let mut builder = Problem::builder(&model);
        builder.add(Task::new(Point::new(tip, [x, 0.0, 0.0])).tolerance(Quantity::Metres, 0.1));
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[0.3, 0.2]).unwrap();
        assert!(
            !solution.reached && solution.is_out_of_reach() == beyond,
            "{x}"
        );
    }
}

#[test]
fn without_goals_that_can_be_missed_the_sum_is_minimised() {
    let model = planar_arm(&[0.5, 0.4, 0.3], Some((-2.0, 2.0)));
    let tip = model.frame("tip").unwrap();
    let solve = |goal: bool| {
        let mut builder = Problem::builder(&model);
        let point = Task::new(Point::new(tip, [0.5, 0.5, 0.0]));
        builder.add(match goal {
            true => point.tolerance(Quantity::Metres, f64::INFINITY),
            false => point.preference(),
        });
        builder.add(Posture::new(&model, &[0.3, 0.3, 0.3]));
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[0.1; 3]).unwrap();
        let (residual, jacobian) = linearised(&problem, &solution.q);
        assert!((jacobian.transpose() * residual).amax() < 1e-7);
        assert!(solution.reached);
        solution.q
    };
    assert_eq!(solve(true), solve(false));
}

#[test]
fn a_preference_that_is_cut_short_or_not_finite_is_told() {
    let (robot, _, tool) = panda();
    let (model, map) = (robot.model(), robot.map());
    let frame = model.frame(tool).unwrap();
    let mut random = Random::new(4);
    let [there, other] = [(); 2].map(|()| configuration_of(model, &mut random));
    let mut builder = Problem::builder(model);
    builder.parameters(map.clone());
    builder.add(Pose::new(frame, placement_of(model, tool, &there)));
    let task = builder.add(Posture::new(model, &other));
    let mut problem = builder.build().unwrap();
    for (cancels, ended) in [
        (true, Termination::Cancelled),
        (false, Termination::TimeLimit),
    ] {
        let limit = Duration::from_millis(200);
        let solver = Solver::default().with_stopping(Stopping::default().with_time_limit(limit));
        let mut seen = 0;
        let mut watch = |_: &Iteration<'_>| {
            seen += 1;
            match (seen, cancels) {
                (3, true) => return ControlFlow::Break(()),
                (3, false) => std::thread::sleep(limit),
                _ => {}
            }
            ControlFlow::Continue(())
        };
        let mut workspace = Workspace::new();
        // The goals are met at the start.
        let solution = solver.solve_observed(&problem, &there, &mut workspace, &mut watch);
        let solution = solution.unwrap();
        assert!(solution.reached);
        assert_eq!(solution.termination, ended);
        assert!(solution.explain().contains("pull of the preferences early"));
    }
    let posture = problem.residual_mut(task).unwrap();
    posture.set_reference(&vec![f64::NAN; other.len()]);
    let solution = Solver::default().solve_once(&problem, &there).unwrap();
    assert_eq!(solution.termination, Termination::NonFinite);
    assert!(solution.q.iter().all(|v| v.is_finite()));
}

#[test]
fn a_task_of_weight_nothing_still_tells_its_error() {
    let robot = robot("universal_ur5e");
    let model = robot.model();
    let tool = model.frame("flange").unwrap();
    let mut random = Random::new(1);
    let [there, start] = [(); 2].map(|()| configuration_of(model, &mut random));
    let target = placement_of(model, "flange", &there);
    for weight in [0.0, 1e-300, 1e-160] {
        let mut builder = Problem::builder(model);
        builder.parameters(robot.map().clone());
        builder.add(Task::new(Pose::new(tool, target)).weight(Quantity::Radians, weight));
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &start).unwrap();
        let now = placement_of(model, "flange", &solution.q);
        let between = |a: [f64; 3], b: [f64; 3]| -> f64 { (0..3).map(|k| a[k] * b[k]).sum() };
        let columns = |p: &Placement<f64>| [p.rotation.x, p.rotation.y, p.rotation.z];
        let traces = columns(&now).into_iter().zip(columns(&target));
        let trace: f64 = traces
            .map(|(a, b)| between(a.to_array(), b.to_array()))
            .sum();
        let angle = ((trace - 1.0) / 2.0).acos();
        let task = solution.tasks().next().unwrap();
        assert!(angle > 0.1, "{angle}");
        assert!(
            (task.orientation_error().unwrap() - angle).abs() < 1e-6,
            "{weight:e}: {task:?}"
        );
        // Nobody asked for it.
        assert!(solution.reached && task.reached);
        assert!(task.position_error().unwrap() <= 1e-6);
    }
}

#[test]
fn attempts_that_agree_are_counted_and_told() {
    let model = planar_arm(&[1.0, 0.4], Some((-2.5, 2.5)));
    let tip = model.frame("tip").unwrap();
    let solve = |target: [f64; 3], attempts: usize| {
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, target));
        let problem = builder.build().unwrap();
        let restarts = kinopt::ik::Restarts::default().with_attempts(attempts);
        let solver = Solver::default().with_restarts(restarts);
        solver.solve_once(&problem, &[0.3, 0.2]).unwrap()
    };
    // In the hole that the long link leaves: nothing proves it, but attempts agree.
    let hole = solve([0.2, 0.1, 0.0], 32);
    assert!(!hole.reached && hole.agreeing >= 3 && !hole.is_out_of_reach());
    let told = format!(
        "{} of {} attempts ended at this same miss",
        hole.agreeing, hole.attempts
    );
    assert!(hole.explain().contains(&told), "{}", hole.explain());
    let alone = solve([0.2, 0.1, 0.0], 1);
    assert_eq!(alone.agreeing, 1);
    assert!(
        alone.explain().contains("Only one attempt"),
        "{}",
        alone.explain()
    );
    let far = solve([3.0, 0.0, 0.0], 32);
    assert!(far.is_out_of_reach());
    let words = far.explain();
    assert!(
        words.contains("3.000 m from `joint 0`") && words.contains("reaches 1.400 m"),
        "{words}"
    );
    assert_eq!(solve([1.0, 0.5, 0.0], 32).agreeing, 0);
}

/// Two joints that should sum to a half.
struct Sum([JointId; 2]);

impl Residual for Sum {
    fn frames(&self) -> Vec<FrameId> {
        Vec::new()
    }

    fn joints(&self) -> Vec<JointId> {
        self.0.to_vec()
    }

    fn rows(&self) -> Vec<Rows> {
        vec![Rows::new(Quantity::Ratio, 1)]
    }

    fn evaluate<S: Scalar>(&self, _: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        residual[0] = joints[0] + joints[1] - S::constant(0.5);
    }
}

/// Pulls of any shape count: on one joint a row, on two, on many.
#[test]
fn a_pull_on_two_joints_pulls_both() {
    let mut builder = Model::builder("three joints at one place");
    let z = kinopt::spatial::Vector3::new(0.0, 0.0, 1.0);
    let (here, link) = (
        Placement::identity(),
        Placement::translation([1.0, 0.0, 0.0].into()),
    );
    let [a, b, c] = ["a", "b", "c"].map(|name| builder.continuous(name, None, here, z));
    let tip = builder.frame("tip", Some(c), link);
    let model = builder.build().unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [0.6, 0.8, 0.0]));
    builder.add(Task::new(Sum([a, b])).preference());
    let problem = builder.build().unwrap();
    let solution = Solver::default()
        .solve_once(&problem, &[0.0, 0.1, 0.5])
        .unwrap();
    assert!(solution.reached);
    assert!(
        (solution.q[0] + solution.q[1] - 0.5).abs() < 1e-4,
        "{:?}",
        solution.q
    );
}

/// A task is reached where all its rows are.
#[test]
fn a_task_half_reached_is_not_reached() {
    let model = planar_arm(&[1.0, 0.4], Some((-1.0, 1.0)));
    let tip = model.frame("tip").unwrap();
    // About x no joint turns it.
    let turned = nalgebra::Rotation3::from_euler_angles(0.7, 0.0, 0.0).into_inner();
    let target = Placement::new(turned.into(), [1.2, 0.3, 0.0].into());
    for (free, reached) in [
        (Quantity::Metres, [true, false]),
        (Quantity::Radians, [false, true]),
    ] {
        let away = Placement::new(turned.into(), [1.2, 0.3, 0.5].into());
        let pose = Pose::new(
            tip,
            if free == Quantity::Metres {
                target
            } else {
                away
            },
        );
        let mut builder = Problem::builder(&model);
        builder.add(Task::new(pose).tolerance(free, f64::INFINITY));
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[0.3, 0.2]).unwrap();
        let task = solution.tasks().next().unwrap();
        let rows: Vec<bool> = task.rows.iter().map(|rows| rows.reached).collect();
        assert_eq!(rows, reached);
        assert!(!task.reached && !solution.reached);
    }
}
