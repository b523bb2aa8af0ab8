//! Promise: the reported largest deviation is an upper bound. According to nalgebra's kinematics no pose between two
//! points is farther from the path, and the bound is close. A spline's bound refers to the curve itself.

use kinopt::Arm;
use kinopt::arm::{Axis, JointPath, PoseBounds};
use kinopt::model::{Limits, Model};
use kinopt::motion::path::{CartesianPath, PathReport, PathSolver};
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use nalgebra::{Isometry3, Translation3};
use support::arms::{apart, base_from_tip, robot, within_limits};
use support::random::Random;

/// Straight segments between poses, with a number of points.
fn path(arm: &Arm, random: &mut Random, points: usize) -> Vec<Placement<f64>> {
    let near = |q: &[f64], random: &mut Random| -> Vec<f64> {
        let moves = q.iter().zip(arm.limits());
        moves
            .map(|(q, limits)| limits.clamp(q + 0.4 * (random.unit() - 0.5)))
            .collect()
    };
    let q = random.configuration(arm);
    let q: Vec<f64> = q.iter().map(|q| 0.5 * q).collect();
    let ends = [
        arm.base_from_tool(&q),
        arm.base_from_tool(&near(&q, random)),
    ];
    let [from, to] = ends.map(|end| Isometry3::from(&end.unwrap()));
    (0..points)
        .map(|k| {
            let share = k as f64 / (points - 1) as f64;
            let at = from.translation.vector.lerp(&to.translation.vector, share);
            let turned = from.rotation.slerp(&to.rotation, share);
            Placement::from(&Isometry3::from_parts(Translation3::from(at), turned))
        })
        .collect()
}

/// Largest deviation found between the rows, in metres and radians.
fn sampled(
    name: &str,
    (base, tip): (&str, &str),
    arm: &Arm,
    points: &[Placement<f64>],
    solution: &JointPath<PathReport>,
) -> (f64, f64) {
    let robot = robot(name);
    let rows: Vec<&[f64]> = solution.rows().collect();
    let mut farthest = (0.0_f64, 0.0_f64);
    for (rows, ends) in rows.windows(2).zip(points.windows(2)) {
        let [from, to] = [&ends[0], &ends[1]].map(Isometry3::from);
        for k in 0..=40 {
            let share = f64::from(k) / 40.0;
            let q: Vec<f64> = rows[0]
                .iter()
                .zip(rows[1])
                .map(|(a, b)| a + share * (b - a))
                .collect();
            let at = base_from_tip(robot.model(), arm, &q, base, tip);
            let expected = Isometry3::from_parts(
                Translation3::from(from.translation.vector.lerp(&to.translation.vector, share)),
                from.rotation.slerp(&to.rotation, share),
            );
            let (metres, radians) = apart(&at, &expected);
            farthest = (farthest.0.max(metres), farthest.1.max(radians));
        }
    }
    farthest
}

#[test]
fn deviation_between_points_is_tightly_bounded() {
    let mut random = Random::split_mix(5);
    for (name, base, tip) in [
        ("universal_ur5e", "base", "flange"),
        ("franka_panda", "base", "flange"),
        ("adept_cobra_s600", "base", "flange"),
    ] {
        let arm = Arm::new(&robot(name), base, tip).unwrap();
        for points in [3, 9, 40] {
            let path = path(&arm, &mut random, points);
            let reachable = path.iter().all(|point| {
                arm.solve(*point, &vec![0.1; arm.joint_count()])
                    .unwrap()
                    .reached
            });
            if !reachable {
                continue;
            }
            let given = CartesianPath::new(path.clone()).unwrap();
            let solution = PathSolver::new(&arm).solve(&given).unwrap();
            assert!(
                solution.report.missed.is_empty(),
                "{name}: {:?}",
                solution.report.missed
            );
            assert!(solution.rows().all(|q| within_limits(&arm, q)));
            if !solution.jumps.is_empty() {
                continue;
            }
            let found = sampled(name, (base, tip), &arm, &path, &solution);
            let reported = solution.report.largest_deviation;
            let text = format!("{name}, {points} points: {found:?}, {reported:?}");
            assert!(
                found.0 <= reported.metres + 1e-9 && found.1 <= reported.radians + 1e-7,
                "{text}"
            );
            assert!(reported.metres <= 1.3 * found.0 + 1e-8, "{text}");
            assert!(reported.radians <= 1.6 * found.1 + 1e-6, "{text}");
        }
    }
}

#[test]
fn free_directions_do_not_count_as_deviation() {
    let robot = robot("universal_ur5e");
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let arm = arm.with_goal(PoseBounds::free_about(Axis::Z)).unwrap();
    let begin = arm
        .base_from_tool(&[0.3, -1.2, 1.4, -1.6, -1.5, 0.4])
        .unwrap();
    let along = |k: u32| begin.translation + Vector3::new(0.0, 0.002 * f64::from(k), 0.0);
    let points: Vec<_> = (0..60)
        .map(|k| Placement::new(begin.rotation, along(k)))
        .collect();
    let path = CartesianPath::new(points.clone()).unwrap();
    let solution = PathSolver::new(&arm).solve(&path).unwrap();
    assert!(solution.reached());
    let exact = Arm::new(&robot, "base", "flange").unwrap();
    let turned = solution.rows().zip(&points).map(|(q, point)| {
        let at = Isometry3::from(&exact.base_from_tool(q).unwrap());
        apart(&at, &Isometry3::from(point)).1
    });
    // The tool rotates about its axis by far more than it deviates.
    assert!(turned.fold(0.0, f64::max) > 1e-3);
    assert!(solution.report.largest_deviation.radians < 1e-4);
    assert!(solution.report.largest_deviation.metres < 1e-4);
}

#[test]
fn spline_deviation_is_bounded_from_its_curve() {
    let arm = Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let begin = arm
        .base_from_tool(&[0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])
        .unwrap();
    let corners = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.2, 0.15]];
    let keys: Vec<_> = corners
        .iter()
        .map(|[y, z]| {
            Placement::new(
                begin.rotation,
                begin.translation + Vector3::new(0.0, *y, *z),
            )
        })
        .collect();
    let times = [0.0, 1.0, 1.5, 3.0];
    let coarse = CartesianPath::spline(keys.clone(), Some(&times), 12).unwrap();
    let fine = CartesianPath::spline(keys, Some(&times), 12 * 20).unwrap();
    assert_eq!(coarse.points().len(), 37);
    assert_eq!(coarse.times().unwrap()[36], 3.0);
    let solution = PathSolver::new(&arm).solve(&coarse).unwrap();
    assert!(solution.reached());
    let rows: Vec<&[f64]> = solution.rows().collect();
    let mut farthest = 0.0_f64;
    for (index, point) in fine.points().iter().enumerate() {
        let (row, share) = (index / 20, (index % 20) as f64 / 20.0);
        let (from, to) = (rows[row], rows[(row + 1).min(36)]);
        let q: Vec<f64> = from
            .iter()
            .zip(to)
            .map(|(a, b)| a + share * (b - a))
            .collect();
        let at = arm.base_from_tool(&q).unwrap();
        farthest = farthest.max((at.translation - point.translation).norm());
    }
    let reported = solution.report.largest_deviation.metres;
    assert!(
        farthest <= reported + 1e-9 && reported <= 4.0 * farthest,
        "{farthest} {reported}"
    );
}

/// Placement of a tool at 0.1 m on a hand, which rotates at the end of a prismatic joint on a revolute joint.
fn tool_of_polar(q: &[f64]) -> Placement<f64> {
    let ((sin, cos), out) = (q[0].sin_cos(), q[1]);
    let wrist = Vector3::new(out * cos, out * sin, 0.0);
    let (sin, cos) = (q[0] + q[2]).sin_cos();
    let rotation = Matrix3::identity().rotated_about_z((sin, cos));
    Placement::new(rotation, wrist + Vector3::new(0.1 * cos, 0.1 * sin, 0.0))
}

/// The same arm as a robot.
fn polar() -> Robot {
    let mut builder = Model::builder("polar");
    let at = Placement::identity();
    let [x, _, z] = Vector3::UNITS;
    let turns = Limits::new(-3.0, 3.0);
    builder.frame("base", None, at);
    let turn = builder.revolute("turn", None, at, z, turns);
    let out = builder.prismatic("out", Some(turn), at, x, Limits::new(-2.0, 2.0));
    let hand = builder.revolute("hand", Some(out), at, z, turns);
    builder.frame("tool", Some(hand), Placement::translation(x * 0.1));
    Robot::new(builder.build().unwrap(), Vec::new()).unwrap()
}

/// A prismatic joint on a revolute joint deviates from the straight segment by the Coriolis term, the largest of this
/// path. The first step only rotates, and its initial bound is larger. With a larger rotation it deviates by three
/// quarters of that.
#[test]
fn coriolis_deviation_of_a_prismatic_joint_counts() {
    for first in [0.1, 0.16] {
        check_coriolis_deviation(first);
    }
}

/// Checks a path whose first step rotates by this angle in radians.
fn check_coriolis_deviation(first: f64) {
    let robot = polar();
    let arm = Arm::builder(&robot, "base", "tool").with_atlas(false);
    let arm = arm.build().unwrap();
    let rows = [[0.0, 0.5, 0.0], [first, 0.5, 0.0], [first + 0.02, 1.0, 0.0]];
    let points = rows.map(|q| tool_of_polar(&q));
    for (row, point) in rows.iter().zip(&points) {
        let at = arm.base_from_tool(row).unwrap();
        assert!((at.translation - point.translation).norm() < 1e-12);
    }
    let path = CartesianPath::new(points.to_vec()).unwrap();
    let solver = PathSolver::new(&arm)
        .with_max_step(10.0)
        .with_start(&rows[0]);
    let solution = solver.solve(&path).unwrap();
    assert!(solution.reached(), "{:?}", solution.jumps);
    let mut farthest = 0.0_f64;
    for (ends, rows) in points.windows(2).zip(rows.windows(2)) {
        for k in 0..=40 {
            let share = f64::from(k) / 40.0;
            let q = [0, 1, 2].map(|i| rows[0][i] + share * (rows[1][i] - rows[0][i]));
            let displacement = ends[1].translation - ends[0].translation;
            let expected = ends[0].translation + displacement * share;
            farthest = farthest.max((tool_of_polar(&q).translation - expected).norm());
        }
    }
    let reported = solution.report.largest_deviation;
    assert_eq!(reported.metres_at, 2);
    assert!(
        farthest > 2e-3 && farthest <= reported.metres && reported.metres < 1.2 * farthest,
        "{farthest} {reported:?}"
    );
}

/// Goal bounds along the tool's own axis rotate with the target. A tool within them at both ends of a step, on either
/// side of the middle, moves straight. In between it exceeds the bounds by the distance from the rotated line.
#[test]
fn rotating_goal_bounds_are_exceeded_between_points() {
    let mut builder = Model::builder("table");
    let origin = Placement::identity();
    let [x, y, z] = Vector3::UNITS;
    let slide = Limits::new(-2.0, 2.0);
    builder.frame("base", None, origin);
    let along = builder.prismatic("along", None, origin, x, slide);
    let across = builder.prismatic("across", Some(along), origin, y, slide);
    let hand = builder.revolute("hand", Some(across), origin, z, Limits::new(-3.0, 3.0));
    builder.frame("tool", Some(hand), origin);
    let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
    let goal = PoseBounds::within([0.4, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let arm = Arm::builder(&robot, "base", "tool").with_atlas(false);
    let arm = arm.build().unwrap().with_goal(goal).unwrap();
    for turn in [0.3_f64, 0.6] {
        let (sin, cos) = turn.sin_cos();
        let (start, end) = ([0.4, 0.0, 0.0], [-0.4 * cos, -0.4 * sin, turn]);
        let turned = Matrix3::identity().rotated_about_z((sin, cos));
        let points = vec![origin, Placement::new(turned, Vector3::zero())];
        let path = CartesianPath::new(points).unwrap();
        let solver = PathSolver::new(&arm).with_max_step(10.0);
        let solver = solver.with_start(&start).with_end(&end);
        let solution = solver.solve(&path).unwrap();
        assert!(solution.reached(), "{:?}", solution.jumps);
        let deviation_of = |share: f64| {
            let [x, y] = [0, 1].map(|k| start[k] + share * (end[k] - start[k]));
            let (sin, cos) = (turn * share).sin_cos();
            let along = (cos * x + sin * y).abs() - 0.4;
            along.max(0.0).hypot(cos * y - sin * x)
        };
        let most = (0..=1000).map(|k| deviation_of(f64::from(k) / 1000.0));
        let largest = most.fold(0.0, f64::max);
        let reported = solution.report.largest_deviation.metres;
        assert!(
            largest > 0.01 && largest <= reported && reported < 1.05 * largest + 1e-6,
            "{largest} {reported}"
        );
    }
}
