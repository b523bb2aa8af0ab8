//! Promise: a path's times keep all joints within their velocity and acceleration limits, from rest to rest.

use kinopt::Arm;
use kinopt::arm::JointPath;
use kinopt::motion::path::{CartesianPath, PathError, PathReport, PathSolver};
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::fault_tables::ExpectedError;
use support::random::Random;

/// Largest excess of finite differences over a limit. Rows have the error of their solver's tolerance, which the
/// trajectory smooths.
const ROW_NOISE: f64 = 0.01;

fn solved() -> JointPath<PathReport> {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let begin = arm
        .base_from_tool(&[0.3, -1.2, 1.4, -1.6, -1.5, 0.0])
        .unwrap();
    let point = |k: u32| {
        let (sin, cos) = (0.05 * f64::from(k)).sin_cos();
        let offset = Vector3::new(0.0, 0.08 * sin, 0.08 * (1.0 - cos));
        Placement::new(begin.rotation, begin.translation + offset)
    };
    let path = CartesianPath::new((0..120).map(point).collect::<Vec<_>>()).unwrap();
    PathSolver::new(&arm).solve(&path).unwrap()
}

#[test]
fn velocities_and_accelerations_stay_within_limits() {
    let solution = solved();
    assert!(solution.reached());
    for (speed, acceleration) in [(1.0, 2.0), (0.2, 20.0), (f64::INFINITY, 0.5)] {
        let times = solution.times(&[speed; 6], &[acceleration; 6]).unwrap();
        let rows: Vec<&[f64]> = solution.rows().collect();
        assert_eq!((times.len(), times[0]), (rows.len(), 0.0));
        let mut top = 0.0_f64;
        for joint in 0..6 {
            let mut last = (0.0, 0.0);
            for row in 1..rows.len() {
                let step = times[row] - times[row - 1];
                assert!(step > 0.0);
                let velocity = (rows[row][joint] - rows[row - 1][joint]) / step;
                assert!(velocity.abs() <= speed * (1.0 + ROW_NOISE));
                if row > 1 {
                    let change = (velocity - last.0) / (0.5 * (step + last.1));
                    assert!(change.abs() <= acceleration * (1.0 + ROW_NOISE), "{change}");
                    top = top.max(change.abs());
                }
                last = (velocity, step);
            }
        }
        assert!(top > 0.1 * acceleration.min(2.0), "{top}");
    }
}

#[test]
fn invalid_limits_are_named() {
    let solution = solved();
    let few = solution.times(&[1.0; 5], &[1.0; 6]);
    assert!(matches!(
        few,
        Err(PathError::Limits {
            option: "velocity_limits",
            given: 5,
            joints: 6
        })
    ));
    solution
        .times(&[1.0; 6], &[0.0; 6])
        .says("acceleration_limits");
}

/// With fixed times, a step that is too fast for the joints is reported. All other steps are within the velocity
/// limits.
#[test]
fn step_too_fast_for_its_time_is_reported() {
    let robot = robot("franka_panda");
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let q = [0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8];
    let begin = arm.base_from_tool(&q).unwrap();
    let point = |k: u32| {
        let offset = Vector3::new(0.0, 0.005 * f64::from(k), 0.0);
        Placement::new(begin.rotation, begin.translation + offset)
    };
    let points: Vec<_> = (0..=40).map(point).collect();
    for hasty in [7, 20, 21, 40] {
        // At most a hundredth of the time that a joint needs for 5 mm.
        let mut time = 0.0;
        let times = (0..=40).map(|k| {
            time += if k == hasty { 2e-5 } else { 0.1 };
            time
        });
        let path = CartesianPath::new(points.clone()).unwrap();
        let path = path.with_times(times.collect::<Vec<_>>()).unwrap();
        let solve = |keep_times: bool| {
            let solver = PathSolver::new(&arm).with_times_kept(keep_times);
            solver.solve(&path).unwrap()
        };
        assert!(solve(false).reached());
        let solution = solve(true);
        let reported: Vec<usize> = solution
            .jumps
            .iter()
            .map(|reported| reported.index)
            .collect();
        assert_eq!(reported, [hasty]);
        let rows: Vec<&[f64]> = solution.rows().collect();
        for (step, pair) in rows
            .windows(2)
            .enumerate()
            .filter(|(step, _)| step + 1 != hasty)
        {
            for ((a, b), speed) in pair[0].iter().zip(pair[1]).zip(arm.velocity_limits()) {
                assert!((a - b).abs() <= 0.1 * speed * (1.0 + 1e-6), "{step}");
            }
        }
    }
}

/// Fixed times long enough for every joint change nothing: the other bounds of a step still apply.
#[test]
fn ample_times_change_nothing() {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let mut random = Random::split_mix(7);
    let mut broken = 0;
    for _ in 0..5 {
        let ends: Vec<Vec<f64>> = (0..5).map(|_| random.configuration(&arm)).collect();
        let points: Vec<_> = ends
            .iter()
            .flat_map(|q| {
                let end = arm.base_from_tool(q).unwrap();
                (0..4).map(move |k| {
                    let offset = Vector3::new(0.0, 0.0, 0.002 * f64::from(k));
                    Placement::new(end.rotation, end.translation + offset)
                })
            })
            .collect();
        let times: Vec<f64> = (0..points.len()).map(|k| 1e6 * k as f64).collect();
        let path = CartesianPath::new(points).unwrap();
        let timed = path.clone().with_times(times).unwrap();
        let plain = PathSolver::new(&arm).solve(&path).unwrap();
        let solver = PathSolver::new(&arm).with_times_kept(true);
        let timed = solver.solve(&timed).unwrap();
        assert_eq!(plain.q, timed.q);
        assert_eq!(plain.jumps, timed.jumps);
        broken += plain.jumps.len();
    }
    assert!(broken > 3, "{broken}");
}

/// Between distant points long steps are allowed, but not beyond the velocity limits.
#[test]
fn too_fast_step_between_distant_points_is_reported() {
    let arm = Arm::new(&robot("universal_ur5e"), "base", "flange").unwrap();
    let point = |k: u32| {
        let turned = 0.04 * f64::from(k);
        let q = [0.3 + turned, -1.2, 1.4, -1.6 - 0.5 * turned, -1.5, 0.0];
        arm.base_from_tool(&q).unwrap()
    };
    let points: Vec<_> = (0..15).map(point).collect();
    for (step, whole) in [(0.2, true), (0.012, false), (1e-3, false)] {
        let times: Vec<f64> = (0..15).map(|k| step * f64::from(k)).collect();
        let path = CartesianPath::new(points.clone()).unwrap();
        let path = path.with_times(times).unwrap();
        let solver = PathSolver::new(&arm).with_times_kept(true);
        let solution = solver.solve(&path).unwrap();
        let reported: Vec<usize> = (solution.jumps.iter())
            .map(|reported| reported.index)
            .collect();
        let rows: Vec<&[f64]> = solution.rows().collect();
        let too_fast = (1..15).filter(|&row| {
            let moves = rows[row - 1].iter().zip(rows[row]);
            let mut moves = moves.zip(arm.velocity_limits());
            moves.any(|((a, b), speed)| (a - b).abs() > step * speed * (1.0 + 1e-6))
        });
        assert_eq!(reported, too_fast.collect::<Vec<_>>(), "{step} s");
        assert_eq!(solution.reached(), whole, "{step} s");
    }
}

/// A path that the joints can follow at half their velocity limits is whole with fixed times, and no step exceeds its
/// time. Points may be denser than those at which branches are compared. The time of a single step may be too short for
/// the distance of two compared points.
#[test]
fn dense_path_may_use_the_time_of_all_its_steps() {
    let arm = Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let q = [0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8];
    let begin = arm.base_from_tool(&q).unwrap();
    let point = |k: u32| {
        let offset = Vector3::new(0.0, 0.002 * f64::from(k), 0.0);
        Placement::new(begin.rotation, begin.translation + offset)
    };
    let points: Vec<_> = (0..=150).map(point).collect();
    let path = CartesianPath::new(points).unwrap();
    let solver = PathSolver::new(&arm).with_start(&q);
    let plain = solver.solve(&path).unwrap();
    assert!(plain.reached());
    // Shares of a joint's velocity limit for steps of one second.
    let shares = |row: &[f64], next: &[f64]| {
        let moves = row.iter().zip(next).zip(arm.velocity_limits());
        moves.fold(0.0_f64, |largest, ((a, b), speed)| {
            largest.max((a - b).abs() / speed)
        })
    };
    let rows: Vec<&[f64]> = plain.rows().collect();
    let largest = (rows.windows(2)).fold(0.0_f64, |largest, pair| {
        largest.max(shares(pair[0], pair[1]))
    });
    let step = 2.0 * largest;
    let times: Vec<f64> = (0..=150).map(|k| step * f64::from(k)).collect();
    let timed = path.with_times(times).unwrap();
    let solution = solver.with_times_kept(true).solve(&timed).unwrap();
    assert!(solution.reached(), "{:?}", solution.jumps);
    for (k, pair) in solution.rows().collect::<Vec<_>>().windows(2).enumerate() {
        assert!(shares(pair[0], pair[1]) <= step * (1.0 + 1e-6), "{k}");
    }
}
