//! Promise: a path has the lowest possible number of reconfigurations, exactly where they are reported, and is short.

use std::f64::consts::{PI, TAU};

use kinopt::Arm;
use kinopt::arm::Base;
use kinopt::model::{Limits, Model};
use kinopt::motion::path::{CartesianPath, PathSolver};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::{distance, planar_with_hand, robot};
use support::random::Random;

/// The tool of a UR5e rotates about its own axis without displacement.
fn screw(arm: &Arm, turns: f64, points: u32) -> CartesianPath {
    let begin = arm
        .base_from_tool(&[0.3, -1.2, 1.4, -1.6, -1.5, 0.0])
        .unwrap();
    let point = |k: u32| {
        let angle = TAU * turns * f64::from(k) / f64::from(points);
        let turned = begin.rotation * rotation_exp(Vector3::new(0.0, 0.0, angle));
        Placement::new(turned, begin.translation)
    };
    CartesianPath::new((0..=points).map(point).collect::<Vec<_>>()).unwrap()
}

/// The last joint has a range of two turns, from −2π to 2π. Every two turns begun after the first need another
/// reconfiguration.
#[test]
fn wound_joint_rewinds_as_rarely_as_possible() {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    for (turns, breaks) in [(0.9, 0), (1.9, 0), (2.5, 1), (3.9, 1), (4.5, 2)] {
        let path = screw(&arm, turns, (turns * 80.0) as u32);
        let solution = PathSolver::new(&arm).solve(&path).unwrap();
        assert!(solution.report.missed.is_empty());
        assert_eq!(solution.jumps.len(), breaks, "{turns} turns");
        for reported in &solution.jumps {
            assert!(reported.distance > 0.2);
        }
    }
}

#[test]
fn reported_length_and_jumps_equal_the_rows() {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let weights = [2.0, 2.0, 1.5, 1.0, 1.0, 0.5];
    let path = screw(&arm, 2.5, 200);
    let solver = PathSolver::new(&arm).with_joint_weights(&weights);
    let solution = solver.solve(&path).unwrap();
    let rows: Vec<&[f64]> = solution.rows().collect();
    let mut length = 0.0;
    for row in 1..rows.len() {
        let squares = rows[row].iter().zip(rows[row - 1]).zip(&weights);
        let squares = squares.map(|((a, b), w)| (w * (a - b)) * (w * (a - b)));
        length += squares.sum::<f64>().sqrt();
        let moves = rows[row].iter().zip(rows[row - 1]);
        let longest = moves.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let reported = solution.jumps.iter().find(|r| r.index == row);
        match reported {
            Some(reported) => assert_eq!(reported.distance, longest),
            None => assert!(longest <= 0.2 + 1e-9),
        }
    }
    assert!((length - solution.report.length).abs() < 1e-9);
}

/// The path of a redundant arm is no longer than that of a follower from the same start. It is also no longer than its
/// own path from that start.
#[test]
fn path_is_shorter_than_that_of_a_follower() {
    let arm = Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let q = [0.3, -0.4, 0.5, -2.0, 0.2, 1.6, 0.8];
    let begin = arm.base_from_tool(&q).unwrap();
    let along = |k: u32| {
        let (sin, cos) = (0.05 * f64::from(k)).sin_cos();
        begin.translation + Vector3::new(-0.05 * sin, 0.05 - 0.05 * cos, 0.0)
    };
    let points: Vec<_> = (0..120)
        .map(|k| Placement::new(begin.rotation, along(k)))
        .collect();
    let track = arm.track(&points, &q).unwrap();
    let rows = track.report.windows(2);
    let followed: f64 = rows.map(|pair| distance(&pair[0].q, &pair[1].q)).sum();
    let path = CartesianPath::new(points).unwrap();
    let from_there = PathSolver::new(&arm).with_start(&q).solve(&path).unwrap();
    let from_anywhere = PathSolver::new(&arm).solve(&path).unwrap();
    for solution in [&from_there, &from_anywhere] {
        assert!(
            solution.reached(),
            "{:?} {:?}",
            solution.jumps,
            solution.report.missed
        );
    }
    assert_eq!(from_there.rows().next().unwrap(), q);
    assert!(
        from_there.report.length < followed,
        "{} {followed}",
        from_there.report.length
    );
    assert!(from_anywhere.report.length <= from_there.report.length * (1.0 + 1e-6));
}

/// A rail of five centimetres soon reaches its limit. The null space that remains still shortens the path, which is at
/// most as long as with a fixed rail.
#[test]
fn joint_at_its_limit_leaves_the_null_space_usable() {
    let on_rail = |lower: f64, upper: f64| {
        let base = BaseJoint::Sliding {
            axis: Vector3::UNITS[2],
            limits: Limits::new(lower, upper),
        };
        let robot = robot("franka_panda").with_base_joint(base).unwrap();
        Arm::builder(&robot, Base::World, "flange").build().unwrap()
    };
    let arm = on_rail(0.0, 0.05);
    let q = [0.02, 0.3, -0.4, 0.5, -2.0, 0.2, 1.6, 0.8];
    let begin = arm.base_from_tool(&q).unwrap();
    let points = (0..100).map(|k| {
        let (sin, cos) = (0.0628 * f64::from(k)).sin_cos();
        let away = Vector3::new(-0.05 * sin, 0.05 - 0.05 * cos, 0.12 * sin);
        Placement::new(begin.rotation, begin.translation + away)
    });
    let path = CartesianPath::new(points.collect::<Vec<_>>()).unwrap();
    let length = |arm: &Arm| {
        let solution = PathSolver::new(arm).solve(&path).unwrap();
        assert!(solution.reached());
        solution.report.length
    };
    let shortest = length(&arm);
    for stand in [0.0, 0.025, 0.05] {
        let still = length(&on_rail(stand - 1e-9, stand + 1e-9));
        assert!(shortest < still, "{shortest} {still}");
    }
}

/// Segments between distant points are solved in parts: the arm does not change its branch within them.
#[test]
fn coarse_paths_stay_on_their_branch() {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let begin = arm
        .base_from_tool(&[0.3, -1.2, 1.4, -1.6, -1.5, 0.0])
        .unwrap();
    let corners = [[0.0, 0.0], [0.25, 0.0], [0.25, 0.2], [0.0, 0.2]];
    let points: Vec<_> = corners
        .iter()
        .map(|[y, z]| {
            Placement::new(
                begin.rotation,
                begin.translation + Vector3::new(0.0, *y, *z),
            )
        })
        .collect();
    let path = CartesianPath::new(points).unwrap();
    let solution = PathSolver::new(&arm).solve(&path).unwrap();
    assert_eq!(solution.rows().len(), 4);
    assert!(solution.reached());
    // Interpolation of the joints between corners deviates from the straight segment by millimetres, which is reported.
    assert!(solution.report.largest_deviation.metres > 1e-3);
}

/// The tool rotates further than the last joint's limits allow from the start, so this joint begins a turn earlier.
/// After the change of tools it continues from its current value, not from a value a turn away.
#[test]
fn joint_continues_from_the_nearest_turn_after_jump() {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let same = arm.with_tool(Placement::identity()).unwrap();
    let start = [0.3, -1.2, 1.4, -1.6, -1.5, -5.28];
    let begin = arm.base_from_tool(&start).unwrap();
    let turned = |angle: f64| {
        let rotation = begin.rotation * rotation_exp(Vector3::new(0.0, 0.0, angle));
        Placement::new(rotation, begin.translation)
    };
    let up = (0..=88).map(|k| 0.1 * f64::from(k));
    let down = (1..=56).map(|k| 8.8 - 0.1 * f64::from(k));
    let angles: Vec<f64> = up.chain(down).collect();
    let mut points: Vec<_> = angles.iter().map(|angle| turned(*angle)).collect();
    // The second tool begins with the arm rotated about its base.
    let other_q = [1.5, -1.2, 1.4, -1.6, -1.5, -2.08];
    points.extend([arm.base_from_tool(&other_q).unwrap(); 10]);
    let changes = points.len() - 10;
    let tools: Vec<usize> = (0..points.len())
        .map(|k| usize::from(k >= changes))
        .collect();
    let path = CartesianPath::new(points)
        .unwrap()
        .with_tools(tools)
        .unwrap();
    let solver = PathSolver::new(&arm).with_tools([&same]).with_start(&start);
    let solution = solver.solve(&path).unwrap();
    assert!(
        solution.report.missed.is_empty(),
        "{:?}",
        solution.report.missed
    );
    let rows: Vec<&[f64]> = solution.rows().collect();
    for (row, pair) in rows.windows(2).enumerate() {
        let moved: Vec<f64> = pair[0]
            .iter()
            .zip(pair[1])
            .map(|(a, b)| (a - b).abs())
            .collect();
        assert!(moved[5] < PI + 0.1, "{row}: {moved:?}");
        assert!(
            row + 1 == changes || moved.iter().all(|moved| *moved < 0.2),
            "{row}: {moved:?}"
        );
    }
    assert!(rows[changes - 1][5] < -PI / 2.0);
}

/// After a change of tools there are two branches. Keeping the elbow is short, but soon needs the hand to rewind;
/// changing it is long and needs nothing later.
#[test]
fn fewer_reconfigurations_precede_shorter_length() {
    let mut builder = Model::builder("planar");
    let (identity, [x, _, z]) = (Placement::identity(), Vector3::UNITS);
    let mut last = None;
    builder.frame("base", None, identity);
    for (name, at, lower) in [
        ("shoulder", identity, -3.0),
        ("elbow", Placement::translation(x), -3.0),
        ("hand", Placement::translation(x), -3.25),
    ] {
        last = Some(builder.revolute(name, last, at, z, Limits::new(lower, 3.0)));
    }
    builder.frame("tool", last, identity);
    let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
    let arm = Arm::builder(&robot, "base", "tool").with_atlas(false);
    let arm = arm.build().unwrap();
    let same = arm.with_tool(identity).unwrap();
    let start = [0.2, 1.0, 1.5];
    let hands = [1.5].into_iter();
    let hands = hands.chain((0..=20).map(|k| 2.9 + 0.05 * f64::from(k)));
    let points = hands.map(|hand| arm.base_from_tool(&[0.2, 1.0, hand]).unwrap());
    let path = CartesianPath::new(points.collect::<Vec<_>>()).unwrap();
    let tools: Vec<usize> = (0..22).map(|point| point.min(1)).collect();
    let path = path.with_tools(tools).unwrap();
    let solver = PathSolver::new(&arm).with_tools([&same]).with_start(&start);
    let solver = solver.with_joint_weights(&[1.0, 1.0, 0.01]);
    let solution = solver.solve(&path).unwrap();
    assert!(solution.report.missed.is_empty());
    let breaks = solution.jumps.iter().map(|reported| reported.index);
    assert_eq!(breaks.collect::<Vec<_>>(), [1]);
    // The other choice has about a hundredth of the length of two turns of the hand.
    assert!(solution.report.length > 2.0);
}

/// Between two tools the path defines no motion. Each tool's points are solved as on their own, and a large joint
/// motion at the change is reported.
#[test]
fn change_of_tools_is_not_interpolated() {
    let arm = planar_with_hand(Limits::new(-3.0, 3.0));
    let turned = rotation_exp(Vector3::new(0.0, 0.0, 0.3));
    let tool = Placement::new(turned, Vector3::new(0.1, 0.05, 0.0));
    let other = arm.with_tool(tool).unwrap();
    let mut random = Random::split_mix(5);
    let mut reported = 0;
    for case in 0..30 {
        let ends = [(); 2].map(|()| random.configuration(&arm));
        let count = 12;
        let points = (0..=count).map(|k| {
            let share = 0.4 * k as f64 / count as f64;
            let between = ends[0]
                .iter()
                .zip(&ends[1])
                .map(|(a, b)| a + share * (b - a));
            arm.base_from_tool(&between.collect::<Vec<_>>()).unwrap()
        });
        let points: Vec<_> = points.collect();
        let tools: Vec<usize> = (0..=count).map(|k| usize::from(k >= 6)).collect();
        let path = CartesianPath::new(points.clone()).unwrap();
        let path = path.with_tools(tools).unwrap();
        let solver = PathSolver::new(&arm).with_tools([&other]);
        let solution = solver.with_max_step(0.3).solve(&path).unwrap();
        let rows: Vec<&[f64]> = solution.rows().collect();
        for (point, (row, aim)) in rows.iter().zip(&points).enumerate() {
            let at = [&arm, &other][usize::from(point >= 6)]
                .base_from_tool(row)
                .unwrap();
            let deviation = (at.translation - aim.translation).norm();
            let missed = solution
                .report
                .missed
                .iter()
                .any(|missed| missed.index == point);
            assert!(missed || deviation < 1e-5, "{case}, {point}: {deviation} m");
        }
        let breaks = solution.jumps.iter().map(|reported| reported.index);
        let breaks: Vec<usize> = breaks.collect();
        let goes_far = |row: &usize| {
            let moves = rows[*row].iter().zip(rows[row - 1]);
            moves.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) > 0.3 + 1e-9
        };
        let jumps: Vec<usize> = (1..rows.len()).filter(goes_far).collect();
        assert!(
            !solution.report.missed.is_empty() || jumps == breaks,
            "{case}: {jumps:?} {breaks:?}"
        );
        reported += usize::from(breaks.contains(&6));
    }
    assert!(reported > 5, "{reported}");
}

/// Near an unreachable point two branches almost coincide. Where intermediate points do not connect them, the branch is
/// chosen again, and no reconfiguration results.
#[test]
fn nearly_equal_branches_are_chosen_again() {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let (middle, displacement) = (
        Vector3::new(0.0312, 0.113, 0.1166),
        Vector3::new(-0.3624, -1.0638, 0.4206),
    );
    let (turn, spin) = (
        Vector3::new(-1.1186, -0.1067, -2.284),
        Vector3::new(1.0199, 0.841, 0.8852),
    );
    let point = |k: u32| {
        let share = f64::from(k) / 200.0 - 0.5;
        let turned = rotation_exp(turn) * rotation_exp(spin * share);
        Placement::new(turned, middle + displacement * share)
    };
    let path = CartesianPath::new((0..=100).map(point).collect::<Vec<_>>()).unwrap();
    let solution = PathSolver::new(&arm).solve(&path).unwrap();
    assert!(!solution.report.missed.is_empty());
    assert!(solution.jumps.is_empty(), "{:?}", solution.jumps);
}
