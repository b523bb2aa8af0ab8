//! Promise: trajectories along paths keep all limits at every time, and are the fastest that do.

use kinopt::Arm;
use kinopt::arm::{JointJump, JointPath};
use kinopt::motion::Trajectory;
use kinopt::motion::path::{
    CartesianPath, PathError, PathReport, PathSolver, TimedSpline, TimingLimits,
};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::random::Random;

/// Samples of a trajectory in a check.
const SAMPLES: u32 = 20_000;
/// Largest excess over a velocity or acceleration limit that rounding explains.
const ROUNDING: f64 = 1e-9;
/// Largest excess over a jerk limit by finite differences.
const JERK_EXCESS: f64 = 1e-4;

/// Joint values on a smooth closed curve of seven joints, in even steps.
fn smooth_rows(count: u32) -> Vec<f64> {
    let row = |k: u32| {
        let share = f64::from(k) / f64::from(count - 1);
        (0..7).map(move |joint| {
            let joint = f64::from(joint);
            0.8 * ((5.2 + 1.48 * joint) * share + joint).sin()
        })
    };
    (0..count).flat_map(row).collect()
}

/// Two straight segments of half a radian that meet at a right angle, `count` steps each.
fn right_angle(count: u32) -> Vec<f64> {
    let step = 0.5 / f64::from(count);
    let first = (0..=count).map(|k| [step * f64::from(k), 0.0]);
    let second = (1..=count).map(|k| [0.5, step * f64::from(k)]);
    first.chain(second).flatten().collect()
}

/// Joint path without jumps.
fn joint_path(q: &[f64], nq: usize) -> JointPath<()> {
    JointPath {
        q: q.to_vec(),
        nq,
        ..JointPath::default()
    }
}

fn through(q: &[f64], limits: &TimingLimits<'_>, joints: usize) -> Trajectory<TimedSpline> {
    joint_path(q, joints).trajectory(limits).unwrap()
}

/// Largest shares of the limits that a trajectory uses: velocity, acceleration and jerk.
fn largest_shares(
    trajectory: &Trajectory<TimedSpline>,
    [velocity, acceleration, jerk]: [f64; 3],
) -> [f64; 3] {
    let step = trajectory.duration() / f64::from(SAMPLES);
    let mut largest = [0.0_f64; 3];
    let mut last = trajectory.report.at(0.0);
    for k in 1..=SAMPLES {
        let point = trajectory.report.at(step * f64::from(k));
        for joint in 0..trajectory.nq {
            largest[0] = largest[0].max(point.velocity[joint].abs() / velocity);
            largest[1] = largest[1].max(point.acceleration[joint].abs() / acceleration);
            let change = (point.acceleration[joint] - last.acceleration[joint]) / step;
            largest[2] = largest[2].max(change.abs() / jerk);
            // Velocities are those of the joint values.
            let moved = (point.q[joint] - last.q[joint]) / step;
            let mean = 0.5 * (point.velocity[joint] + last.velocity[joint]);
            assert!((moved - mean).abs() <= acceleration * step, "{k} {joint}");
            let gained = (point.velocity[joint] - last.velocity[joint]) / step;
            assert!(gained.abs() <= acceleration * (1.0 + 1e-6), "{k} {joint}");
        }
        last = point;
    }
    largest
}

#[test]
fn smooth_paths_keep_limits_at_all_times() {
    for (velocity, acceleration) in [(2.0, 6.0), (0.5, 20.0), (f64::INFINITY, 3.0)] {
        let limits = TimingLimits::new(&[velocity; 7], &[acceleration; 7]);
        let trajectory = through(&smooth_rows(200), &limits, 7);
        let [fastest, largest, _] = largest_shares(&trajectory, [velocity, acceleration, 1.0]);
        assert!(fastest <= 1.0 + ROUNDING, "{fastest}");
        assert!(largest <= 1.0 + ROUNDING, "{largest}");
        assert!(fastest.max(largest) > 0.999, "{fastest} {largest}");
    }
}

/// A straight joint motion is as fast as the trapezoid of the joint that takes longest.
#[test]
fn straight_lines_take_the_analytic_time() {
    let q: Vec<f64> = (0..=10)
        .flat_map(|k| [0.1, 0.05].map(|by| by * f64::from(k)))
        .collect();
    for (velocity, acceleration) in [(1.0, 2.0), (10.0, 2.0), (f64::INFINITY, 0.5)] {
        let limits = TimingLimits::new(&[velocity; 2], &[acceleration; 2]);
        let duration = through(&q, &limits, 2).duration();
        let expected: f64 = match velocity * velocity / acceleration < 1.0 {
            true => 1.0 / velocity + velocity / acceleration,
            false => 2.0 * (1.0 / acceleration).sqrt(),
        };
        assert!(
            (duration / expected - 1.0).abs() < 1e-5,
            "{duration} {expected}"
        );
    }
}

#[test]
fn denser_rows_take_the_same_time() {
    let limits = TimingLimits::new(&[2.0; 7], &[6.0; 7]);
    let expected = through(&smooth_rows(100), &limits, 7).duration();
    for count in [60, 300, 1000, 5000] {
        let duration = through(&smooth_rows(count), &limits, 7).duration();
        assert!(
            (duration / expected - 1.0).abs() < 2e-3,
            "{count}: {duration} {expected}"
        );
    }
    for tolerance in [0.0, 1e-3, 1e-2] {
        let limits = TimingLimits::new(&[2.0; 2], &[6.0; 2]).with_corner_tolerance(tolerance);
        let expected = through(&right_angle(100), &limits, 2).duration();
        for count in [10, 30, 1000, 5000] {
            let duration = through(&right_angle(count), &limits, 2).duration();
            assert!(
                (duration / expected - 1.0).abs() < 2e-3,
                "{count}: {duration} {expected}"
            );
        }
    }
}

/// Rows of a solver are off by its tolerance. Their second differences are not.
#[test]
fn rows_with_solver_noise_take_the_same_time() {
    let limits = TimingLimits::new(&[2.0; 7], &[6.0; 7]);
    let expected = through(&smooth_rows(100), &limits, 7).duration();
    let mut random = Random::split_mix(3);
    let mut q = smooth_rows(20_000);
    q.iter_mut()
        .for_each(|q| *q += 1e-6 * (2.0 * random.unit() - 1.0));
    let duration = through(&q, &limits, 7).duration();
    assert!(
        (duration / expected - 1.0).abs() < 5e-3,
        "{duration} {expected}"
    );
}

#[test]
fn corners_without_tolerance_stop_the_arm() {
    let limits = TimingLimits::new(&[2.0; 2], &[6.0; 2]).with_corner_tolerance(0.0);
    let trajectory = through(&right_angle(50), &limits, 2);
    let corner = trajectory.report.at(trajectory.times[50]);
    assert_eq!(corner.q, [0.5, 0.0]);
    assert!(corner.velocity.iter().all(|v| v.abs() < 1e-9));
    let [fastest, largest, _] = largest_shares(&trajectory, [2.0, 6.0, 1.0]);
    assert!(fastest <= 1.0 + ROUNDING && largest <= 1.0 + ROUNDING);
}

#[test]
fn blended_corners_stay_within_the_tolerance() {
    let stopped = TimingLimits::new(&[2.0; 2], &[6.0; 2]).with_corner_tolerance(0.0);
    let mut last = through(&right_angle(50), &stopped, 2).duration();
    for tolerance in [1e-4, 1e-3, 1e-2, 0.05] {
        let limits = stopped.clone().with_corner_tolerance(tolerance);
        let trajectory = through(&right_angle(50), &limits, 2);
        assert!(trajectory.duration() < last);
        last = trajectory.duration();
        let mut farthest = 0.0_f64;
        for k in 0..=SAMPLES {
            let q = trajectory
                .report
                .at(last * f64::from(k) / f64::from(SAMPLES))
                .q;
            // Distance from the two segments.
            farthest = farthest.max(q[1].abs().min((q[0] - 0.5).abs()));
        }
        assert!(
            farthest <= tolerance * (1.0 + ROUNDING),
            "{tolerance}: {farthest}"
        );
        assert!(farthest > 0.3 * tolerance, "{tolerance}: {farthest}");
        let [fastest, largest, _] = largest_shares(&trajectory, [2.0, 6.0, 1.0]);
        assert!(fastest <= 1.0 + ROUNDING && largest <= 1.0 + ROUNDING);
    }
}

/// A reversed path comes to its last row before the reversal, whatever the tolerance.
#[test]
fn reversals_are_reached_and_stopped_at() {
    let outbound = (0..=20).map(|k| 0.02 * f64::from(k));
    let q: Vec<f64> = outbound
        .clone()
        .chain(outbound.rev().skip(1))
        .flat_map(|q| [q, 0.5 * q])
        .collect();
    let limits = TimingLimits::new(&[2.0; 2], &[6.0; 2]).with_corner_tolerance(0.05);
    let trajectory = through(&q, &limits, 2);
    let turn = trajectory.report.at(trajectory.times[20]);
    assert!((turn.q[0] - 0.4).abs() < 1e-12);
    assert!(turn.velocity[0].abs() < 1e-9);
}

#[test]
fn jerk_limits_hold_and_lines_are_fastest() {
    for jerk in [20.0, 200.0] {
        let limits = TimingLimits::new(&[2.0; 7], &[6.0; 7]);
        let unbounded = through(&smooth_rows(150), &limits, 7);
        let limits = limits.with_jerk_limits(&[jerk; 7]);
        let trajectory = through(&smooth_rows(150), &limits, 7);
        let [fastest, largest, jerkiest] = largest_shares(&trajectory, [2.0, 6.0, jerk]);
        assert!(fastest <= 1.0 + ROUNDING && largest <= 1.0 + ROUNDING);
        assert!(jerkiest <= 1.0 + JERK_EXCESS, "{jerkiest}");
        assert!(trajectory.duration() > unbounded.duration());
        for point in [
            trajectory.report.at(0.0),
            trajectory.report.at(trajectory.duration()),
        ] {
            assert!(
                point.acceleration.iter().all(|a| a.abs() < 1e-6),
                "{point:?}"
            );
        }
        // A line takes the time of its acceleration and jerk phases more.
        let line = [0.0, 0.5, 1.0];
        let limits = TimingLimits::new(&[1.0], &[2.0]).with_jerk_limits(&[jerk]);
        let duration = through(&line, &limits, 1).duration();
        let expected = 1.0 + 0.5 + 2.0 / jerk;
        assert!(
            (duration / expected - 1.0).abs() < 2e-3,
            "{duration} {expected}"
        );
    }
}

#[test]
fn jerk_limits_hold_at_blended_corners() {
    for tolerance in [0.0, 1e-3, 1e-2] {
        let limits = TimingLimits::new(&[2.0; 2], &[6.0; 2]).with_corner_tolerance(tolerance);
        let limits = limits.with_jerk_limits(&[60.0; 2]);
        let trajectory = through(&right_angle(100), &limits, 2);
        let [fastest, largest, jerkiest] = largest_shares(&trajectory, [2.0, 6.0, 60.0]);
        assert!(fastest <= 1.0 + ROUNDING && largest <= 1.0 + ROUNDING);
        assert!(jerkiest <= 1.0 + JERK_EXCESS, "{tolerance}: {jerkiest}");
    }
}

fn ur5e() -> (Robot, Arm) {
    let robot = robot("universal_ur5e");
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    (robot, arm)
}

/// Joints for a pick and place of the UR5e: down, up, aside, down and up, in rows of a given distance in metres.
fn pick_and_place(arm: &Arm, row_distance: f64) -> JointPath<PathReport> {
    let start = [0.3, -1.2, 1.4, -1.6, -1.5, 0.0];
    let begin = arm.base_from_tool(&start).unwrap();
    let stops = [
        [0.0; 3],
        [0.0, 0.0, -0.15],
        [0.0; 3],
        [0.0, 0.3, 0.0],
        [0.0, 0.3, -0.15],
        [0.0, 0.3, 0.0],
    ];
    let mut points = vec![begin];
    for pair in stops.windows(2) {
        let [from, to] = [pair[0], pair[1]].map(Vector3::from);
        let steps = ((to - from).norm() / row_distance).round() as u32;
        points.extend((1..=steps).map(|k| {
            let offset = from + (to - from) * (f64::from(k) / f64::from(steps));
            Placement::new(begin.rotation, begin.translation + offset)
        }));
    }
    let path = CartesianPath::new(points).unwrap();
    let solution = PathSolver::new(arm)
        .with_start(&start)
        .solve(&path)
        .unwrap();
    assert!(solution.reached());
    solution
}

#[test]
fn pick_and_place_is_independent_of_row_distance() {
    let (_, arm) = ur5e();
    for tolerance in [0.0, 1e-3] {
        let durations = [0.05, 0.01, 0.001].map(|row_distance| {
            let limits = TimingLimits::of(&arm).with_acceleration_limits(&[5.0; 6]);
            let limits = limits.with_corner_tolerance(tolerance);
            let solution = pick_and_place(&arm, row_distance);
            solution.trajectory(&limits).unwrap().duration()
        });
        let [sparse, middle, dense] = durations;
        assert!((sparse / dense - 1.0).abs() < 0.01, "{durations:?}");
        assert!((middle / dense - 1.0).abs() < 0.01, "{durations:?}");
    }
}

#[test]
fn tool_limits_hold_and_bind() {
    let (_, arm) = ur5e();
    let solution = pick_and_place(&arm, 0.01);
    let mut jacobian = arm.jacobian().unwrap();
    for jerk in [None, Some([500.0; 6])] {
        let limits = TimingLimits::of(&arm)
            .with_acceleration_limits(&[20.0; 6])
            .with_tool_linear_limits(0.2, 0.5)
            .with_tool_angular_limits(1.0, 3.0);
        let limits = match &jerk {
            Some(jerk) => limits.with_jerk_limits(jerk),
            None => limits,
        };
        let trajectory = solution.trajectory(&limits).unwrap();
        let step = 1e-5;
        let mut twist = |time: f64| {
            let point = trajectory.report.at(time);
            let j = jacobian.at(&point.q).unwrap();
            std::array::from_fn::<f64, 3, _>(|row| {
                let moves = point.velocity.iter().enumerate();
                moves.map(|(joint, v)| j[(row, joint)] * v).sum()
            })
        };
        let norm = |v: [f64; 3]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let (mut speed, mut acceleration) = (0.0_f64, 0.0_f64);
        for k in 0..5000 {
            let time = trajectory.duration() * f64::from(k) / 5000.0;
            let (before, after) = (twist(time), twist(time + step));
            speed = speed.max(norm(before));
            let change = std::array::from_fn(|row| (after[row] - before[row]) / step);
            acceleration = acceleration.max(norm(change));
        }
        assert!(speed <= 0.2 * 1.001 && speed > 0.19, "{speed}");
        assert!(
            acceleration <= 0.5 * 1.01 && acceleration > 0.4,
            "{acceleration}"
        );
    }
}

#[test]
fn reconfigurations_begin_and_end_at_rest() {
    let first = (0..20).flat_map(|k| [0.02 * f64::from(k), 0.0]);
    let second = (0..20).flat_map(|k| [2.0, 1.0 + 0.02 * f64::from(k)]);
    let q: Vec<f64> = first.chain(second).collect();
    let mut solution = joint_path(&q, 2);
    solution.jumps.push(JointJump {
        index: 20,
        joint: 0,
        distance: 1.62,
        reconfiguration: true,
    });
    let limits = TimingLimits::new(&[1.0; 2], &[2.0; 2]);
    let trajectory = solution.trajectory(&limits).unwrap();
    for row in [0, 19, 20, 39] {
        let point = trajectory.report.at(trajectory.times[row]);
        assert!(
            point.velocity.iter().all(|v| v.abs() < 1e-9),
            "{row}: {point:?}"
        );
        let q = &solution.q[2 * row..2 * row + 2];
        assert!(
            q.iter().zip(&point.q).all(|(a, b)| (a - b).abs() < 1e-9),
            "{row}"
        );
    }
    // The step itself is straight, from rest to rest.
    let time = trajectory.times[20] - trajectory.times[19];
    let expected = 1.62 + 0.5;
    assert!((time / expected - 1.0).abs() < 1e-4, "{time}");
}

#[test]
fn rows_are_passed_at_their_times() {
    let q = smooth_rows(300);
    let limits = TimingLimits::new(&[2.0; 7], &[6.0; 7]);
    for limits in [limits.clone(), limits.with_jerk_limits(&[100.0; 7])] {
        let trajectory = through(&q, &limits, 7);
        let times = &trajectory.times;
        assert_eq!((times.len(), times[0]), (300, 0.0));
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(times[299], trajectory.duration());
        for (row, time) in q.chunks(7).zip(times) {
            let at = trajectory.report.at(*time).q;
            assert!(at.iter().zip(row).all(|(a, b)| (a - b).abs() <= 1.1e-5));
        }
    }
}

#[test]
fn times_outside_the_trajectory_are_rest() {
    let q = smooth_rows(50);
    let limits = TimingLimits::new(&[2.0; 7], &[6.0; 7]);
    let trajectory = through(&q, &limits, 7);
    for (time, row) in [
        (-1.0, &q[..7]),
        (f64::NAN, &q[..7]),
        (f64::INFINITY, &q[343..]),
    ] {
        let point = trajectory.report.at(time);
        assert!(
            point.q.iter().zip(row).all(|(a, b)| (a - b).abs() < 1e-9),
            "{time}"
        );
        assert!(point.velocity.iter().all(|v| *v == 0.0));
        assert!(time.is_nan() || point.acceleration.iter().all(|a| *a == 0.0));
    }
}

#[test]
fn few_or_equal_rows_are_no_motion() {
    let limits = TimingLimits::new(&[1.0; 2], &[2.0; 2]);
    for q in [vec![], vec![0.1, 0.2], [0.1, 0.2].repeat(5)] {
        let trajectory = through(&q, &limits, 2);
        assert_eq!(trajectory.times, vec![0.0; q.len() / 2]);
        assert_eq!(trajectory.duration(), 0.0);
        let point = trajectory.report.at(1.0);
        assert_eq!(point.velocity, [0.0; 2]);
        assert!(q.is_empty() || point.q == [0.1, 0.2]);
    }
    // Two rows are a line; equal rows have one time.
    let two = through(&[0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0], &limits, 2);
    let times = &two.times;
    assert!(times[1] == 0.0 && times[2] == times[3]);
    assert!((two.duration() - 1.5).abs() < 1e-4);
}

#[test]
fn joints_without_limits_follow_the_others() {
    let infinity = f64::INFINITY;
    let q: Vec<f64> = (0..=10)
        .flat_map(|k| [0.1, 0.3].map(|by| by * f64::from(k)))
        .collect();
    for jerk in [None, Some([50.0, infinity])] {
        let limits = TimingLimits::new(&[1.0, infinity], &[2.0, infinity]);
        let (limits, expected) = match jerk {
            Some(jerk) => (limits.with_jerk_limits(&jerk), 1.54),
            None => (limits, 1.5),
        };
        let duration = through(&q, &limits, 2).duration();
        assert!((duration / expected - 1.0).abs() < 1e-3, "{duration}");
    }
    // Nothing bounds a step that only they make.
    let limits = TimingLimits::new(&[1.0, infinity], &[2.0, infinity]);
    let error = joint_path(&[0.0, 0.0, 0.0, 1.0], 2)
        .trajectory(&limits)
        .unwrap_err();
    assert!(
        matches!(error, PathError::Unbounded { row: 1, .. }),
        "{error}"
    );
    assert!(error.to_string().contains("joint 1"), "{error}");
}

#[test]
fn limits_out_of_range_name_option_and_joint() {
    let (_, arm) = ur5e();
    let q = [0.0; 12];
    let error = |limits: TimingLimits<'_>| {
        let error = joint_path(&q, 6).trajectory(&limits).unwrap_err();
        error.to_string()
    };
    let limits = TimingLimits::of(&arm).with_acceleration_limits(&[5.0; 6]);
    let joint = arm.joints().nth(2).unwrap();
    for invalid in [0.0, -1.0, f64::NAN] {
        let invalid = [1.0, 1.0, invalid, 1.0, 1.0, 1.0];
        for (reported, option) in [
            (
                error(limits.clone().with_velocity_limits(&invalid)),
                "velocity_limits",
            ),
            (
                error(limits.clone().with_acceleration_limits(&invalid)),
                "acceleration_limits",
            ),
            (
                error(limits.clone().with_jerk_limits(&invalid)),
                "jerk_limits",
            ),
        ] {
            assert!(
                reported.contains(option) && reported.contains(joint),
                "{reported}"
            );
        }
    }
    let reported = error(limits.clone().with_jerk_limits(&[1.0; 5]));
    assert!(
        reported.contains("jerk_limits") && reported.contains('5'),
        "{reported}"
    );
    for (limits, option) in [
        (
            limits.clone().with_tool_linear_limits(0.0, 1.0),
            "tool_linear_speed",
        ),
        (
            limits.clone().with_tool_angular_limits(1.0, f64::NAN),
            "tool_angular_acceleration",
        ),
        (
            limits.clone().with_corner_tolerance(-1.0),
            "corner_tolerance",
        ),
        (limits.clone().with_grid_points(0), "grid_points"),
    ] {
        let reported = error(limits);
        assert!(reported.contains(option), "{reported}");
    }
    let without_arm = TimingLimits::new(&[1.0; 6], &[1.0; 6]).with_tool_linear_limits(1.0, 1.0);
    assert!(error(without_arm).contains("with_arm"));
    let limits = TimingLimits::new(&[1.0], &[1.0]);
    for (q, row) in [
        ([0.0, f64::NAN], 1),
        ([f64::INFINITY, 0.0], 0),
        ([-1e308, 1e308], 1),
    ] {
        let error = joint_path(&q, 1).trajectory(&limits);
        assert_eq!(error, Err(PathError::Row { row }));
    }
    // Rows without joints are no rows.
    let none = joint_path(&[1.0, 2.0, 3.0], 0).trajectory(&TimingLimits::new(&[], &[]));
    assert!(none.unwrap().times.is_empty());
}

/// Rows without any order, from far apart to nearly equal, and limits that differ by orders of magnitude.
#[test]
fn random_rows_keep_all_limits() {
    let mut random = Random::split_mix(11);
    let mut spread = |low: f64, high: f64| low * (high / low).powf(random.unit());
    for case in 0..40 {
        let joints = 1 + case % 5;
        let scale = spread(1e-5, 5.0);
        let mut row = vec![0.0; joints];
        let mut q = Vec::new();
        for _ in 0..2 + case {
            row.iter_mut()
                .for_each(|q| *q += scale * (spread(1.0, 3.0) - 2.0));
            q.extend_from_slice(&row);
        }
        let mut limits =
            |low: f64, high: f64| -> Vec<f64> { (0..joints).map(|_| spread(low, high)).collect() };
        let [velocities, accelerations] = [limits(0.05, 20.0), limits(0.1, 100.0)];
        let jerks = limits(1.0, 1e4);
        let limits = TimingLimits::new(&velocities, &accelerations)
            .with_corner_tolerance([0.0, 1e-4, 1e-2][case % 3])
            .with_grid_points(300);
        let limits = match case % 2 {
            0 => limits,
            _ => limits.with_jerk_limits(&jerks),
        };
        let trajectory = through(&q, &limits, joints);
        let step = trajectory.duration() / 2000.0;
        let mut last = trajectory.report.at(0.0);
        for k in 0..=2000 {
            let point = trajectory.report.at(step * f64::from(k));
            for joint in 0..joints {
                let velocity = point.velocity[joint].abs() / velocities[joint];
                let acceleration = point.acceleration[joint].abs() / accelerations[joint];
                let excess = velocity.max(acceleration) - 1.0;
                assert!(excess <= ROUNDING, "{case}: {excess:e}");
                let change = (point.acceleration[joint] - last.acceleration[joint]) / step;
                let jerk = change.abs() / jerks[joint] - 1.0;
                assert!(
                    case % 2 == 0 || k == 0 || jerk <= JERK_EXCESS,
                    "{case}: {jerk:e}"
                );
            }
            last = point;
        }
    }
}
