//! Promise: a point that cannot be reached is reported with the reason, and all other points are reached.

use kinopt::Arm;
use kinopt::arm::PoseBounds;
use kinopt::motion::path::{CartesianPath, MissReason, PathSolver};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::{robot, within_limits};
use support::random::{Random, cases};
use support::vector;

#[test]
fn path_leaving_the_workspace_reports_where() {
    for (name, q) in [
        ("universal_ur5e", vec![0.3, -1.2, 1.4, -1.6, -1.5, 0.0]),
        ("franka_panda", vec![0.3, -0.4, 0.5, -2.0, 0.2, 1.6, 0.8]),
    ] {
        let arm = Arm::new(&robot(name), "base", "flange").unwrap();
        let begin = arm.base_from_tool(&q).unwrap();
        // Along x to a distance of two metres and back.
        let points: Vec<_> = (0..=80)
            .map(|k: i32| {
                let out = 0.05 * f64::from(40 - (k - 40).abs());
                Placement::new(
                    begin.rotation,
                    begin.translation + Vector3::new(out, 0.0, 0.0),
                )
            })
            .collect();
        let path = CartesianPath::new(points.clone()).unwrap();
        let solution = PathSolver::new(&arm).solve(&path).unwrap();
        assert_eq!(solution.rows().len(), 81);
        // Between unreached points the tool does not follow the path, so no deviation counts.
        let deviation = solution.report.largest_deviation.metres;
        assert!(deviation < 5e-3, "{name}: {deviation}");
        let missed: Vec<usize> = solution
            .report
            .missed
            .iter()
            .map(|missed| missed.index)
            .collect();
        assert!(
            missed.contains(&40) && !missed.contains(&0) && !missed.contains(&80),
            "{name}"
        );
        let farthest = solution
            .report
            .missed
            .iter()
            .find(|missed| missed.index == 40)
            .unwrap();
        assert!(
            matches!(farthest.reason, MissReason::BeyondReach { distance, reach } if distance > reach)
        );
        for (row, (q, point)) in solution.rows().zip(&points).enumerate() {
            assert!(within_limits(&arm, q));
            let away = (arm.base_from_tool(q).unwrap().translation - point.translation).norm();
            match solution
                .report
                .missed
                .iter()
                .find(|missed| missed.index == row)
            {
                Some(reported) => assert!((reported.position_error - away).abs() < 1e-9),
                None => assert!(away < 1.1e-6),
            }
        }
    }
}

#[test]
fn one_point_and_equal_points_are_solved() {
    let arm = Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let point = arm
        .base_from_tool(&[0.3, -0.4, 0.5, -2.0, 0.2, 1.6, 0.8])
        .unwrap();
    for count in [1, 2, 50] {
        let path = CartesianPath::new(vec![point; count]).unwrap();
        let solution = PathSolver::new(&arm).solve(&path).unwrap();
        assert!(solution.reached());
        assert_eq!(solution.rows().len(), count);
        assert!(solution.report.length < 1e-4);
    }
}

/// With a free position no point is beyond reach, however far it is: the orientation is not reached.
#[test]
fn free_position_is_never_beyond_reach() {
    let inf = f64::INFINITY;
    let robot = robot("franka_panda");
    let q = [0.3, -0.4, 0.5, -2.0, 0.2, 1.6, 0.8];
    let mut whole = robot.model().neutral();
    whole[..7].copy_from_slice(&q);
    let arm = Arm::builder(&robot, "base", "flange");
    let arm = arm.with_only(["joint1"], &whole);
    let arm = arm
        .with_goal(PoseBounds::within([inf, inf, inf, 0.0, 0.0, 0.0]))
        .build()
        .unwrap();
    let begin = arm.base_from_tool(&[0.3]).unwrap();
    let position = begin.translation + Vector3::new(30.0, 0.0, 0.0);
    // Tilted increasingly, which the first joint cannot follow.
    let points: Vec<_> = (0..8)
        .map(|k| {
            let tilt = rotation_exp(Vector3::new(0.1 * f64::from(k), 0.0, 0.0));
            Placement::new(tilt * begin.rotation, position)
        })
        .collect();
    let path = CartesianPath::new(points).unwrap();
    let solution = PathSolver::new(&arm).solve(&path).unwrap();
    assert!(solution.report.missed.len() > 5);
    for missed in &solution.report.missed {
        assert!(matches!(missed.reason, MissReason::NotFound), "{missed:?}");
    }
}

/// A point that the arm reaches from its configuration at a neighbouring point is not reported as unreached. Unreached
/// points cost at most one reconfiguration.
#[test]
fn points_reachable_from_a_neighbour_are_reached() {
    let mut random = Random::new(7);
    let mut bordering = 0;
    for (name, tool) in [
        ("franka_panda", "flange"),
        ("universal_ur5e", "flange"),
        ("kuka_iiwa14", "flange"),
    ] {
        let arm = Arm::new(&robot(name), "base", tool).unwrap();
        for case in cases(60, 12) {
            // Lines past the base, where the workspace has a hole.
            let mut near = || Vector3::new(0.0, 0.0, 0.3) + vector(random.vector(0.3));
            let (middle, towards) = (near(), near() - near());
            let turn = rotation_exp(vector(random.vector(3.0)));
            let points: Vec<_> = (0..=200)
                .map(|k| {
                    let along = f64::from(k - 100) / 100.0 * 0.6 / towards.norm();
                    Placement::new(turn, middle + towards * along)
                })
                .collect();
            let path = CartesianPath::new(points.clone()).unwrap();
            let solution = PathSolver::new(&arm).solve(&path).unwrap();
            let missed = |row: usize| {
                solution
                    .report
                    .missed
                    .iter()
                    .any(|missed| missed.index == row)
            };
            let rows: Vec<&[f64]> = solution.rows().collect();
            // A stretch of unreached points has at most one reconfiguration.
            let jumps = |stretch: &[usize]| {
                let (from, to) = (stretch[0], stretch[stretch.len() - 1] + 1);
                let reported = solution.jumps.iter();
                reported
                    .filter(|jump| (from..=to).contains(&jump.index))
                    .count()
            };
            let all_missed: Vec<usize> = (0..rows.len()).filter(|&row| missed(row)).collect();
            for stretch in all_missed.chunk_by(|a, b| a + 1 == *b) {
                let jumps = jumps(stretch);
                assert!(jumps <= 1, "{name}, {case}: {jumps} leaps over {stretch:?}");
            }
            for row in (0..rows.len()).filter(|&row| missed(row)) {
                for neighbour in [row.wrapping_sub(1), row + 1] {
                    if neighbour < rows.len() && !missed(neighbour) {
                        bordering += 1;
                        let tried = arm.solve(points[row], rows[neighbour]).unwrap();
                        assert!(
                            !tried.goals_reached(),
                            "{name}, {case}: point {row} is reached from {neighbour}"
                        );
                    }
                }
            }
        }
    }
    assert!(bordering > 20, "{bordering}");
}

/// If joints have narrow limits, not every segment between two configurations of a point is feasible. Points reported
/// as reached are reached.
#[test]
fn shortened_path_still_reaches_its_points() {
    let whole = robot("franka_panda");
    for (q, low, high, displacement, turn) in [
        (
            [
                0.261878, 1.238528, -1.773319, -0.473370, 2.438892, 1.791326, -0.811011,
            ],
            [
                0.028696, 0.836832, -1.773319, -0.716780, 1.949183, 1.563625, -1.134103,
            ],
            [
                0.637441, 1.383773, -1.268140, -0.412828, 2.452355, 2.035399, -0.798644,
            ],
            [-0.0414226, -0.0083487, -0.0516888],
            [-0.1372834, 0.0668517, 0.0668295],
        ),
        (
            [
                2.258280, -1.636299, -2.374528, -0.305755, 2.701696, 1.537500, -1.813487,
            ],
            [
                1.487223, -1.636299, -2.654579, -0.462867, 2.167886, 0.811908, -2.605508,
            ],
            [
                2.380062, -1.119653, -2.027474, -0.069800, 2.897300, 2.172094, -1.424098,
            ],
            [-0.0318106, 0.0516569, -0.0363880],
            [0.1626424, 0.1357640, -0.0094559],
        ),
    ] {
        let mut text = "joint_limits:\n".to_owned();
        for (k, (low, high)) in low.into_iter().zip(high).enumerate() {
            let joint = k + 1;
            text += &format!("  joint{joint}: {{min_position: {low}, max_position: {high}}}\n");
        }
        let narrow = whole
            .clone()
            .with_joint_limits_of(text.as_bytes(), "limits");
        let narrow = narrow.unwrap();
        let [base, flange] = ["base", "flange"].map(|name| narrow.model().frame(name).unwrap());
        let arm = Arm::builder(&narrow, base, flange).with_atlas(false);
        let arm = arm.build().unwrap();
        let begin = arm.base_from_tool(&q).unwrap();
        let points = (0..25).map(|k| {
            let share = f64::from(k) / 24.0;
            let turned = rotation_exp(Vector3::from(turn) * share) * begin.rotation;
            Placement::new(
                turned,
                begin.translation + Vector3::from(displacement) * share,
            )
        });
        let points: Vec<_> = points.collect();
        let path = CartesianPath::new(points.clone()).unwrap();
        let reported = PathSolver::new(&arm).with_samples(24).solve(&path).unwrap();
        let missed: Vec<usize> = reported
            .report
            .missed
            .iter()
            .map(|missed| missed.index)
            .collect();
        for (k, (q, point)) in reported.rows().zip(&points).enumerate() {
            let at = arm.base_from_tool(q).unwrap();
            let deviation = (at.translation - point.translation).norm();
            assert!(
                missed.contains(&k) || deviation < 1.1e-6,
                "point {k}: {deviation}"
            );
        }
    }
}
