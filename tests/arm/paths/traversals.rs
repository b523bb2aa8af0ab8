//! Promise: cyclic paths return to their first configuration. Paths that may be entered anywhere are entered where that
//! saves a reconfiguration. Given ends are kept bitwise. Points may have different tools.

use std::f64::consts::TAU;

use kinopt::Arm;
use kinopt::arm::JointPath;
use kinopt::model::Limits;
use kinopt::motion::path::{CartesianPath, PathError, PathReport, PathSolver, Traversal};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::{planar_with_hand, robot, with_endless_joint};
use support::path_steps::largest_difference;

fn circle(begin: &Placement<f64>, radius: f64, points: u32) -> Vec<Placement<f64>> {
    let point = |k: u32| {
        let (sin, cos) = (TAU * f64::from(k) / f64::from(points)).sin_cos();
        let offset = Vector3::new(0.0, radius * sin, radius * (1.0 - cos));
        Placement::new(begin.rotation, begin.translation + offset)
    };
    (0..points).map(point).collect()
}

#[test]
fn cyclic_path_ends_where_it_begins() {
    for (name, q) in [
        ("franka_panda", vec![0.3, -0.4, 0.5, -2.0, 0.2, 1.6, 0.8]),
        ("universal_ur5e", vec![0.3, -1.2, 1.4, -1.6, -1.5, 0.0]),
    ] {
        let arm = Arm::new(&robot(name), "base", "flange").unwrap();
        let points = circle(&arm.base_from_tool(&q).unwrap(), 0.04, 100);
        let path = CartesianPath::new(points)
            .unwrap()
            .with_traversal(Traversal::Cyclic);
        let solution = PathSolver::new(&arm).solve(&path).unwrap();
        assert!(
            solution.reached(),
            "{name}: {:?} {:?}",
            solution.jumps,
            solution.report.missed
        );
        let rows: Vec<&[f64]> = solution.rows().collect();
        assert_eq!(rows.len(), 100);
        assert!(largest_difference(rows[99], rows[0]) < 0.1, "{name}");
        let from_there = PathSolver::new(&arm).with_start(&q).solve(&path).unwrap();
        assert_eq!(from_there.rows().next().unwrap(), q);
        assert!(from_there.reached(), "{name}");
    }
}

/// A closed path has no seam: a redundant arm follows it with the same length from any starting point.
#[test]
fn cyclic_path_has_equal_length_from_any_point() {
    let arm = Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let down = rotation_exp(Vector3::new(std::f64::consts::PI, 0.0, 0.0));
    let point = |k: u32| {
        let (sin, cos) = (TAU * f64::from(k) / 100.0).sin_cos();
        let at = Vector3::new(0.45 + 0.12 * cos, 0.2 * sin, 0.3);
        Placement::new(down, at)
    };
    let lengths = [0, 25, 50, 75].map(|begin| {
        let points: Vec<_> = (begin..begin + 100).map(point).collect();
        let path = CartesianPath::new(points).unwrap();
        let path = path.with_traversal(Traversal::Cyclic);
        let solution = PathSolver::new(&arm).solve(&path).unwrap();
        assert!(solution.reached(), "{:?}", solution.jumps);
        solution.report.length
    });
    let (shortest, longest) = (lengths.iter())
        .fold((f64::MAX, 0.0_f64), |(shortest, longest), length| {
            (shortest.min(*length), longest.max(*length))
        });
    assert!(longest < shortest * (1.0 + 1e-4), "{lengths:?}");
}

/// The tool makes one full rotation along the path. A last joint with limits has to rewind it.
#[test]
fn rewound_turn_is_reported() {
    let q = [0.3, -1.2, 1.4, -1.6, -1.5, 0.0];
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let begin = arm.base_from_tool(&q).unwrap();
    let turn = |k: u32| {
        let angle = TAU * f64::from(k) / 100.0;
        let turned = begin.rotation * rotation_exp(Vector3::new(0.0, 0.0, angle));
        Placement::new(turned, begin.translation)
    };
    let points: Vec<_> = (0..100).map(turn).collect();
    let path = CartesianPath::new(points).unwrap();
    let cyclic = path.clone().with_traversal(Traversal::Cyclic);
    let solution = PathSolver::new(&arm).solve(&cyclic).unwrap();
    assert_eq!(solution.jumps.len(), 1);
    let anywhere = path.with_traversal(Traversal::AnyStart);
    let solution = PathSolver::new(&arm).solve(&anywhere).unwrap();
    assert!(solution.reached());
    assert_eq!(solution.rows().len(), 101);
}

/// From a quarter turn before the start to a turn and three quarters after it, and back. From its first point the last
/// joint reaches its limit; from a suitable entry it does not.
#[test]
fn closed_path_is_entered_at_the_best_point() {
    let arm = Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    // The last joint of a Panda has a range of 5.8 rad; the tool rotates by 6.28 rad.
    let begin = arm
        .base_from_tool(&[0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])
        .unwrap();
    let turn = |k: u32| {
        let angle = TAU * f64::from(k) / 120.0;
        let turned = begin.rotation * rotation_exp(Vector3::new(0.0, 0.0, angle));
        Placement::new(turned, begin.translation)
    };
    let points: Vec<_> = (0..120).map(turn).collect();
    let open = CartesianPath::new(points.clone()).unwrap();
    let anywhere = open.clone().with_traversal(Traversal::AnyStart);
    let [first, best] = [open, anywhere].map(|path| PathSolver::new(&arm).solve(&path).unwrap());
    assert!(best.jumps.len() <= first.jumps.len());
    assert!(best.report.entry < 120 && best.report.missed.is_empty());
    let rows: Vec<&[f64]> = best.rows().collect();
    for (row, q) in rows.iter().enumerate() {
        let at = arm.base_from_tool(q).unwrap();
        let point = &points[(best.report.entry + row) % 120];
        assert!((at.translation - point.translation).norm() < 1.1e-6);
    }
}

/// Two full rotations, for which the last joint of a Panda needs a reconfiguration anywhere. Of all entries with the
/// fewest, the shortest path is taken.
#[test]
fn shortest_of_equally_good_entries_is_taken() {
    let arm = Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let begin = arm
        .base_from_tool(&[0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])
        .unwrap();
    let turn = |k: u32| {
        let angle = 2.0 * TAU * f64::from(k) / 30.0;
        let turned = begin.rotation * rotation_exp(Vector3::new(0.0, 0.0, angle));
        Placement::new(turned, begin.translation)
    };
    let points: Vec<_> = (0..30).map(turn).collect();
    let solver = PathSolver::new(&arm).with_samples(24).with_max_step(0.5);
    let from = |entry: usize| {
        let entered = [&points[entry..], &points[..=entry]].concat();
        let path = CartesianPath::new(entered).unwrap();
        solver.solve(&path).unwrap()
    };
    let first = from(0);
    let rank = |reported: &JointPath<PathReport>| {
        assert!(reported.report.missed.is_empty());
        (reported.jumps.len(), reported.report.length)
    };
    let others = first
        .jumps
        .iter()
        .map(|reported| rank(&from(reported.index)));
    let (fewest, shortest) = others
        .chain([rank(&first)])
        .min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)))
        .unwrap();
    let path = CartesianPath::new(points.clone()).unwrap();
    let anywhere = path.with_traversal(Traversal::AnyStart);
    let best = solver.solve(&anywhere).unwrap();
    assert_eq!(best.jumps.len(), fewest);
    assert!((best.report.length - shortest).abs() < 1e-9);
    assert_ne!(best.report.entry, 0);
}

/// The deviation of a curve from its chord belongs to its own step, for any entry of the path.
#[test]
fn curve_deviation_belongs_to_its_own_step() {
    let arm = Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let begin = arm
        .base_from_tool(&[0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])
        .unwrap();
    // Two full rotations as above, with a sideways offset at one key.
    for key in [5, 14, 23] {
        let turn = |k: u32| {
            let angle = 2.0 * TAU * f64::from(k) / 30.0;
            let turned = begin.rotation * rotation_exp(Vector3::new(0.0, 0.0, angle));
            let aside = if k == key { 0.1 } else { 0.0 };
            Placement::new(turned, begin.translation + Vector3::new(0.0, aside, 0.0))
        };
        let keys: Vec<_> = (0..30).map(turn).collect();
        let path = CartesianPath::spline(keys, None, 1).unwrap();
        let path = path.with_traversal(Traversal::AnyStart);
        let solver = PathSolver::new(&arm).with_samples(24).with_max_step(0.5);
        let reported = solver.solve(&path).unwrap();
        assert_ne!(reported.report.entry, 0);
        let at = (reported.report.entry + reported.report.largest_deviation.metres_at) % 30;
        let near = at.abs_diff(key as usize);
        assert!(
            near < 3,
            "entered at {}, {at} of {key}",
            reported.report.entry
        );
        assert!(reported.report.largest_deviation.metres > 0.01);
    }
}

#[test]
fn given_ends_are_kept() {
    let arm = Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let (start, end) = (
        [0.3, -0.4, 0.5, -2.0, 0.2, 1.6, 0.8],
        [0.5, -0.2, 0.3, -1.8, 0.1, 1.7, 0.6],
    );
    let ends = [start, end].map(|q| arm.base_from_tool(&q).unwrap());
    let path = CartesianPath::spline(ends.to_vec(), None, 60).unwrap();
    let solver = PathSolver::new(&arm).with_start(&start).with_end(&end);
    let solution = solver.solve(&path).unwrap();
    assert!(solution.reached(), "{:?}", solution.jumps);
    let rows: Vec<&[f64]> = solution.rows().collect();
    assert_eq!((rows[0], rows[60]), (&start[..], &end[..]));
    let from_end = PathSolver::new(&arm).with_start(&end).solve(&path);
    assert!(matches!(
        from_end,
        Err(PathError::End { which: "start", .. })
    ));
}

/// The elbow's rotation is distributed over all steps: none exceeds the maximum step.
#[test]
fn motion_to_a_given_end_is_distributed() {
    let arm = Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let (start, end) = (
        [0.3, -0.4, 0.5, -2.0, 0.2, 1.6, 0.8],
        [1.0, -0.4, -0.6, -1.9, 0.1, 1.7, 0.6],
    );
    let ends = [start, end].map(|q| arm.base_from_tool(&q).unwrap());
    for count in [12, 24, 48] {
        let path = CartesianPath::spline(ends.to_vec(), None, count).unwrap();
        let solver = PathSolver::new(&arm).with_start(&start).with_end(&end);
        let solution = solver.solve(&path).unwrap();
        let rows: Vec<&[f64]> = solution.rows().collect();
        let steps: Vec<f64> = rows
            .windows(2)
            .map(|pair| largest_difference(pair[0], pair[1]))
            .collect();
        assert_eq!((rows[0], rows[count]), (&start[..], &end[..]));
        assert!(solution.reached());
        assert!(steps.iter().all(|step| *step <= 0.2), "{steps:?}");
    }
}

#[test]
fn points_for_two_tools_are_reached() {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let drill = arm
        .with_tool(Placement::translation(Vector3::new(0.0, 0.1, 0.05)))
        .unwrap();
    let q = [0.3, -1.2, 1.4, -1.6, -1.5, 0.0];
    let begin = arm.base_from_tool(&q).unwrap();
    let points: Vec<_> = (0..40)
        .map(|k| {
            let offset = Vector3::new(0.0, 0.003 * f64::from(k), 0.0);
            Placement::new(begin.rotation, begin.translation + offset)
        })
        .collect();
    let tools: Vec<usize> = (0..40).map(|k| usize::from(k >= 20)).collect();
    let path = CartesianPath::new(points.clone()).unwrap();
    let path = path.with_tools(tools.clone()).unwrap();
    let alone = PathSolver::new(&arm).solve(&path);
    assert!(matches!(
        alone,
        Err(PathError::Tool {
            index: 20,
            tool: 1,
            tools: 1
        })
    ));
    let solution = PathSolver::new(&arm)
        .with_tools([&drill])
        .solve(&path)
        .unwrap();
    assert!(solution.report.missed.is_empty());
    for ((q, point), tool) in solution.rows().zip(&points).zip(&tools) {
        let at = [&arm, &drill][*tool].base_from_tool(q).unwrap();
        assert!((at.translation - point.translation).norm() < 1.1e-6);
    }
    // A given end is checked for the last point's tool.
    let end = solution.rows().last().unwrap().to_vec();
    let with_tools = PathSolver::new(&arm).with_tools([&drill]);
    let again = with_tools.clone().with_end(&end).solve(&path).unwrap();
    assert_eq!(again.rows().last().unwrap(), end);
    let by_flange = arm.solve(points[39], &end).unwrap().q;
    let refused = with_tools.with_end(&by_flange).solve(&path);
    assert!(matches!(refused, Err(PathError::End { which: "end", .. })));
    // The change of tools is the only long step.
    assert!(solution.jumps.iter().all(|reported| reported.index == 20));
}

/// The same rotation with a last joint without limits: it continues, and nothing is rewound.
#[test]
fn joint_without_limits_never_rewinds() {
    let robot = with_endless_joint("universal_ur5e", "joint6");
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let q = [0.3, -1.2, 1.4, -1.6, -1.5, 0.0];
    let begin = arm.base_from_tool(&q).unwrap();
    let turn = |k: u32| {
        let angle = TAU * f64::from(k) / 100.0;
        let turned = begin.rotation * rotation_exp(Vector3::new(0.0, 0.0, angle));
        Placement::new(turned, begin.translation)
    };
    let path = CartesianPath::new((0..100).map(turn).collect::<Vec<_>>()).unwrap();
    let cyclic = path.with_traversal(Traversal::Cyclic);
    for solver in [PathSolver::new(&arm), PathSolver::new(&arm).with_start(&q)] {
        let solution = solver.solve(&cyclic).unwrap();
        assert!(solution.reached(), "{:?}", solution.jumps);
        let rows: Vec<&[f64]> = solution.rows().collect();
        // The step from the last point to the first is as long as the others.
        let gone = rows[99][5] - rows[0][5];
        assert!((gone.abs() - 0.99 * TAU).abs() < 1e-3, "{gone}");
        assert!(largest_difference(&rows[99][..5], &rows[0][..5]) < 1e-3);
    }
}

/// A spline along evenly spaced keys of a line is that line, with even spacing from its first to its last point.
#[test]
fn spline_of_a_line_is_evenly_spaced() {
    for keys in [2, 3, 5] {
        let at = |x: f64| Placement::translation(Vector3::new(x, 2.0 * x, -x));
        let line: Vec<_> = (0..keys).map(|k| at(f64::from(k))).collect();
        let path = CartesianPath::spline(line, None, 4).unwrap();
        assert_eq!(path.points().len() as i32, 4 * (keys - 1) + 1);
        for (k, point) in path.points().iter().enumerate() {
            let expected = at(k as f64 / 4.0).translation;
            assert!((point.translation - expected).norm() < 1e-12, "{keys}: {k}");
        }
    }
}

/// One elbow branch reaches its limit just before the change of tools, within less than the distance at which branches
/// are compared. The other one reaches a limit after it. So the first tool uses the other branch, and the elbow changes
/// once after the change of tools.
#[test]
fn branch_ending_before_the_tool_change_is_avoided() {
    let wide = planar_with_hand(Limits::new(-3.0, 3.0));
    // The wrist is 1.2 m from the shoulder in the direction of an angle. The elbow bends by twice the shoulder's offset
    // from it, in the opposite direction.
    let off = 0.6_f64.acos();
    let up = |angle: f64| [angle + off, -2.0 * off, off - angle];
    let down = |angle: f64| [angle - off, 2.0 * off, -off - angle];
    let at = |angle: f64| wide.base_from_tool(&up(angle)).unwrap();
    let both = wide.base_from_tool(&down(0.3)).unwrap();
    assert!((both.translation - at(0.3).translation).norm() < 1e-12);
    let arm = planar_with_hand(Limits::new(-off - 0.05, off + 0.004));
    let other = arm.with_tool(Placement::identity()).unwrap();
    let first = (0..10).map(|k| at(0.001 * f64::from(k)));
    let second = (0..30).map(|k| at(0.001 - 0.02 * f64::from(k)));
    let points: Vec<_> = first.chain(second).collect();
    let tools = (0..40).map(|k| usize::from(k >= 10));
    let path = CartesianPath::new(points).unwrap();
    let path = path.with_tools(tools.collect::<Vec<_>>()).unwrap();
    let solver = PathSolver::new(&arm).with_tools([&other]);
    let solution = solver.solve(&path).unwrap();
    assert!(
        solution.report.missed.is_empty(),
        "{:?}",
        solution.report.missed
    );
    assert_eq!(solution.jumps.len(), 1);
    let rows: Vec<&[f64]> = solution.rows().collect();
    assert!(rows[..10].iter().all(|q| q[1] > 0.0) && rows[39][1] < 0.0);
}
