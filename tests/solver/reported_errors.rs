//! Promise: errors, cost, reached flags and blocking limits of a solution match the returned q. The tests recompute
//! them from q alone.

use kinopt::ik::{Restarts, Side};
use kinopt::problem::{Preferences, Problem};
use kinopt::solver::Stopping;
use kinopt::task::{FramePose, Point, Posture, Quantity, Task};
use kinopt::{Solution, Workspace};
use nalgebra as na;
use support::bones::humanoid;
use support::methods::solvers;
use support::placement;
use support::random::{Random, part};
use support::trees::RandomTree;
use support::{Rigid, rigid};

const METRE_WEIGHT: f64 = 2.0;
const RADIAN_WEIGHT: f64 = 0.5;
const POSTURE_WEIGHT: f64 = 0.01;
const POSITION_TOLERANCE: f64 = 1e-5;
const ANGLE_TOLERANCE: f64 = 1e-4;

struct TestCase {
    tree: RandomTree,
    pose: Rigid,
    point: na::Vector3<f64>,
    problem: Problem,
    slots: [usize; 2],
}

/// Pose of one frame, point of another and a posture.
fn random_case(seed: u64, reachable: bool) -> TestCase {
    let tree = RandomTree::new(seed, 14);
    let mut random = Random::new(seed);
    let slots = [13, 12];
    let q = tree.configuration(&mut random);
    let at = tree.frames_at(&q);
    let mut pose = at[slots[0]];
    let mut point = at[slots[1]].translation.vector;
    if !reachable {
        pose = rigid(
            random.rotation(),
            pose.translation.vector + random.vector(2.0),
        );
        point += random.vector(3.0);
    }
    let [a, b] = slots.map(|s| tree.frames[s]);
    let mut builder = Problem::builder(&tree.model);
    builder.add(
        Task::new(FramePose::new(a, placement(&pose)))
            .weight(Quantity::Metres, METRE_WEIGHT)
            .weight(Quantity::Radians, RADIAN_WEIGHT)
            .tolerance(Quantity::Metres, POSITION_TOLERANCE)
            .tolerance(Quantity::Radians, ANGLE_TOLERANCE),
    );
    builder.add(Task::new(Point::new(b, point)).tolerance(Quantity::Metres, POSITION_TOLERANCE));
    if !reachable {
        let rest = vec![0.0; q.len()];
        let pull = Posture::new(&tree.model, &rest);
        builder.add(Task::new(pull).weight(Quantity::JointUnits, POSTURE_WEIGHT));
        // The blocking limits are those of the weighted sum.
        builder.preferences(Preferences::Traded);
    }
    let problem = builder.build().unwrap();
    TestCase {
        tree,
        pose,
        point,
        problem,
        slots,
    }
}

/// Position, orientation, point and posture error.
fn errors(case: &TestCase, q: &[f64]) -> [f64; 4] {
    let at = case.tree.frames_at(q);
    let [a, b] = case.slots.map(|s| at[s]);
    let turn = a.rotation * case.pose.rotation.inverse();
    [
        (a.translation.vector - case.pose.translation.vector).norm(),
        na::UnitQuaternion::from_rotation_matrix(&turn).angle(),
        (b.translation.vector - case.point).norm(),
        q.iter().map(|v| v * v).sum::<f64>().sqrt(),
    ]
}

fn cost(case: &TestCase, q: &[f64], posture: bool) -> f64 {
    let [position, angle, point, pull] = errors(case, q);
    let pull = if posture { POSTURE_WEIGHT * pull } else { 0.0 };
    0.5 * ((METRE_WEIGHT * position).powi(2)
        + (RADIAN_WEIGHT * angle).powi(2)
        + point.powi(2)
        + pull.powi(2))
}

fn check(label: &str, case: &TestCase, solution: &Solution, posture: bool) {
    let expected = errors(case, &solution.q);
    let tasks: Vec<_> = solution.tasks().collect();
    assert_eq!(tasks.len(), case.problem.tasks());
    let ours = [
        tasks[0].position_error().unwrap(),
        tasks[0].orientation_error().unwrap(),
        tasks[1].position_error().unwrap(),
    ];
    for (ours, theirs) in ours.iter().zip(&expected) {
        assert!((ours - theirs).abs() < 1e-12, "{label}: {ours} is {theirs}");
    }
    if posture {
        let pull = tasks[2].error(Quantity::JointUnits).unwrap();
        assert!((pull - expected[3]).abs() < 1e-12);
    }
    let own_cost = cost(case, &solution.q, posture);
    assert!(
        (solution.cost - own_cost).abs() <= 1e-12 * own_cost.max(1e-3),
        "{label}"
    );

    let [position, angle, point, _] = expected;
    let pose_met = position <= POSITION_TOLERANCE && angle <= ANGLE_TOLERANCE;
    let reached = pose_met && point <= POSITION_TOLERANCE;
    assert_eq!(solution.reached, reached, "{label}: {expected:?}");
    assert_eq!(tasks[0].reached, pose_met, "{label}");
    assert_eq!(tasks[1].reached, point <= POSITION_TOLERANCE, "{label}");
    assert!(
        solution
            .explain()
            .starts_with(if reached { "Reached" } else { "Not reached" })
    );
    check_limits(label, case, solution, posture);
}

/// Every named limit is active and the cost falls beyond it. No blocking joint is left unnamed.
fn check_limits(label: &str, case: &TestCase, solution: &Solution, posture: bool) {
    let model = &case.tree.model;
    let step = 1e-5;
    let mut named = Vec::new();
    for limit in solution.active_limits() {
        assert!(!solution.reached, "{label}");
        let joint = model.joint(limit.joint).unwrap();
        let c = model.coordinate(joint).unwrap();
        let range = model.joints()[joint.index()].limits;
        let (end, outward) = match limit.side {
            Side::Lower => (range.lower, -1.0),
            Side::Upper => (range.upper, 1.0),
        };
        assert_eq!(
            solution.q[c].to_bits(),
            end.to_bits(),
            "{label}: not on its limit"
        );
        assert_eq!(limit.value.to_bits(), end.to_bits());
        let shifted = |change: f64| {
            let mut q = solution.q.clone();
            q[c] += change;
            cost(case, &q, posture)
        };
        let fall = (shifted(-outward * step) - shifted(outward * step)) / (2.0 * step);
        let close = (fall - limit.push).abs() <= 1e-6 * (1.0 + fall.abs());
        assert!(
            limit.push > 0.0 && close,
            "{label}: push {} is {fall}",
            limit.push
        );
        named.push(c);
    }
    if solution.reached {
        return;
    }
    for (c, range) in model.limits().enumerate() {
        let outward = if solution.q[c] == range.lower {
            -1.0
        } else if solution.q[c] == range.upper {
            1.0
        } else {
            continue;
        };
        let mut q = solution.q.clone();
        q[c] += outward * step;
        let falls = cost(case, &q, posture) < solution.cost - 1e-3 * step;
        assert!(
            !falls || named.contains(&c),
            "{label}: joint {c} blocks but is not named"
        );
    }
}

#[test]
fn reports_match_the_returned_configuration() {
    let mut seen = [0; 2];
    let mut workspace = Workspace::new();
    for seed in part(0..12, 2) {
        for reachable in [true, false] {
            let case = random_case(seed, reachable);
            let start = case.tree.configuration(&mut Random::new(seed + 100));
            for solver in solvers() {
                for iterations in [0, 3, 100] {
                    let solver = solver
                        .clone()
                        .with_stopping(Stopping::default().with_max_iterations(iterations))
                        .with_restarts(Restarts::default().with_attempts(3));
                    let solution = solver.solve(&case.problem, &start, &mut workspace).unwrap();
                    let label = format!("tree {seed}, {}, {iterations}", solver.method());
                    check(&label, &case, solution, !reachable);
                    seen[usize::from(solution.reached)] += 1;
                }
            }
        }
    }
    assert!(
        seen[0] > 25 && seen[1] > 10,
        "both outcomes must occur: {seen:?}"
    );
}

#[test]
fn lengths_are_reported_in_the_models_unit() {
    let rig = humanoid();
    let hand = rig.skeleton.tip(rig.skeleton.bone("left_hand").unwrap());
    let mut builder = Problem::builder(rig.skeleton.model());
    builder.add(Point::new(hand, [0.0, 50.0, 0.0]));
    let problem = builder.build().unwrap();
    let rest = rig.skeleton.model().neutral();
    let text = kinopt::Solver::default().solve_once(&problem, &rest);
    let text = text.unwrap().explain();
    assert!(text.contains(" units.") && !text.contains(" m."), "{text}");

    let case = random_case(1, false);
    let start = case.tree.model.neutral();
    let text = kinopt::Solver::default().solve_once(&case.problem, &start);
    let text = text.unwrap().explain();
    assert!(text.contains(" m") && !text.contains("units"), "{text}");
}
