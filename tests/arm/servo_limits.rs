//! Promise: a servo keeps position, velocity, acceleration and jerk limits in every cycle and reverses no joint between
//! cycles. It follows targets within the limits without lag, and point-to-point motions take the shortest time.
//! `KINOPT_CASES` sets the number of trajectories.

use kinopt::arm::{Arm, HeldBy, Servo, ServoStatus};
use kinopt::ik::Side;
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::{robot, within_limits};
use support::courses::{course, reference, reversals, unexcused};
use support::fault_tables::ExpectedError;
use support::lines::{ROBOTS, robots};
use support::random::{Random, case_count, cases, few};

const CYCLE_RATES: [f64; 3] = [125.0, 250.0, 1000.0];

fn arm(name: &str) -> Arm {
    let (_, base, tip) = ROBOTS.into_iter().find(|(n, ..)| *n == name).unwrap();
    let robot = robot(name);
    let arm = Arm::builder(&robot, base, tip);
    arm.with_atlas(false).build().unwrap()
}

fn panda_with_limits() -> Arm {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../models/franka_panda_limits.yaml"
    );
    let robot = robot("franka_panda").with_joint_limits(path).unwrap();
    let arm = Arm::builder(&robot, "base", "flange");
    arm.with_atlas(false).build().unwrap()
}

/// Finite differences of the commanded positions, checked against the servo's limits.
struct Watch {
    q: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    time_step: f64,
}

impl Watch {
    fn new(q: &[f64], time_step: f64) -> Self {
        Self {
            q: q.to_vec(),
            velocity: vec![0.0; q.len()],
            acceleration: vec![0.0; q.len()],
            time_step,
        }
    }

    fn check(&mut self, servo: &Servo<'_>, what: &str) {
        let t = self.time_step;
        for (i, &q) in servo.q().iter().enumerate() {
            let velocity = (q - self.q[i]) / t;
            let acceleration = (velocity - self.velocity[i]) / t;
            let jerk = (acceleration - self.acceleration[i]) / t;
            let rates = [
                ("velocity", velocity, servo.velocity_limits()[i]),
                ("acceleration", acceleration, servo.acceleration_limits()[i]),
                ("jerk", jerk, servo.jerk_limits()[i]),
            ];
            for (rate, value, limit) in rates {
                assert!(
                    value.abs() <= limit,
                    "{what}: joint {i}: {rate} {value} exceeds {limit}"
                );
            }
            (self.q[i], self.velocity[i], self.acceleration[i]) = (q, velocity, acceleration);
        }
    }
}

/// Servo limits of kind 0, 1 or 2: those of the file, an industrial arm's, and low ones.
fn limited<'a>(servo: Servo<'a>, kind: usize) -> Servo<'a> {
    let n = servo.q().len();
    let [acceleration, jerk] = [[f64::INFINITY; 2], [12.0, 6000.0], [4.0, 80.0]][kind];
    let servo = servo
        .with_acceleration_limits(&vec![acceleration; n])
        .unwrap();
    servo.with_jerk_limits(&vec![jerk; n]).unwrap()
}

#[test]
fn trajectories_keep_limits_without_reversals() {
    for name in robots() {
        let arm = arm(name);
        for (rate, kind) in CYCLE_RATES
            .into_iter()
            .flat_map(|rate| (0..3).map(move |kind| (rate, kind)))
        {
            let time_step = 1.0 / rate;
            // A debug build runs the slow rates only.
            if few() && rate > 500.0 {
                continue;
            }
            for index in cases(200, 8) {
                let course = course(&arm, index);
                let what = format!(
                    "{name} at {rate} Hz, limits {kind}, course {index} ({})",
                    course.kind
                );
                let mut servo = limited(arm.servo(&course.start, time_step).unwrap(), kind);
                let mut watch = Watch::new(&course.start, time_step);
                let mut velocities = Vec::new();
                for cycle in 1..=(course.duration * rate) as usize {
                    let target = course.at(cycle as f64 * time_step);
                    velocities.push(servo.step(target).unwrap().velocity.to_vec());
                    watch.check(&servo, &what);
                    assert!(within_limits(&arm, servo.q()), "{what}");
                }
                let found = reversals(&velocities);
                if !found.is_empty() {
                    let left = unexcused(&found, &reference(&arm, &course, time_step));
                    assert!(left.is_empty(), "{what}: {left:?}");
                }
            }
        }
    }
}

/// Null-space motion of a Baxter on a reachable line: each joint changes direction a few times at most.
#[test]
fn null_space_motion_does_not_oscillate() {
    let arm = arm("rethink_baxter");
    let start = [
        0.505938669117768,
        -0.0982855995024964,
        0.8667051552494474,
        1.9277617898950536,
        -1.5413375800725824,
        -0.1942831713110183,
        0.8856220394562403,
    ];
    let direction = Vector3::new(0.1907308792720345, 0.7828287659402171, -0.5922844375033277);
    let first = arm.base_from_tool(&start).unwrap();
    let mut servo = arm.servo(&start, 1.0 / 250.0).unwrap();
    let mut velocities: Vec<Vec<f64>> = Vec::new();
    for k in (0..750)
        .chain(std::iter::repeat_n(750, 125))
        .chain((0..750).rev())
    {
        let target = Placement::new(
            first.rotation,
            first.translation + direction * (0.3 * f64::from(k) / 750.0),
        );
        let step = servo.step(target).unwrap();
        assert!(step.position_error < 1e-4, "{}", step.position_error);
        velocities.push(step.velocity.to_vec());
    }
    assert!(reversals(&velocities).is_empty());
    for joint in 0..7 {
        let signs = velocities
            .iter()
            .map(|v| v[joint])
            .filter(|v| v.abs() > 0.1);
        let signs: Vec<bool> = signs.map(|v| v > 0.0).collect();
        let changes = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!(
            changes <= 3,
            "joint {joint} changes its direction {changes} times"
        );
    }
}

/// Angle of a circle whose speed rises smoothly to `rate` in the first second (its derivative is a quintic smooth
/// step).
fn angle(time: f64, rate: f64) -> f64 {
    match time < 1.0 {
        true => rate * time.powi(4) * (2.5 - 3.0 * time + time * time),
        false => rate * (time - 0.5),
    }
}

#[test]
fn circles_within_limits_are_followed_without_lag() {
    let arm = panda_with_limits();
    let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let first = arm.base_from_tool(&start).unwrap();
    for (rate, share) in CYCLE_RATES
        .into_iter()
        .flat_map(|rate| [(rate, 1.0), (rate, 0.05)])
    {
        for (radius, speed) in [(0.1, 0.3), (0.05, 0.2)] {
            let at = |time: f64| {
                let angle = angle(time, speed / radius);
                let direction = Vector3::new(0.0, angle.sin(), 1.0 - angle.cos());
                Placement::new(first.rotation, first.translation + direction * radius)
            };
            let servo = arm.servo(&start, 1.0 / rate).unwrap();
            let jerks: Vec<f64> = servo
                .jerk_limits()
                .iter()
                .map(|jerk| jerk * share)
                .collect();
            let mut servo = servo.with_jerk_limits(&jerks).unwrap();
            let mut watch = Watch::new(&start, 1.0 / rate);
            for cycle in 1..=(4.0 * rate) as usize {
                let time = cycle as f64 / rate;
                let error = servo.step(at(time)).unwrap().position_error;
                watch.check(&servo, "circle");
                assert!(error < 1e-3, "{rate} Hz, {radius} m, {time} s: {error} m");
                let tool_position = arm.base_from_tool(servo.q()).unwrap().translation;
                let velocity = (at(time + 1e-4).translation - at(time - 1e-4).translation) * 5e3;
                let lag = (at(time).translation - tool_position).dot(velocity)
                    / velocity.dot(velocity).max(1e-4);
                assert!(
                    lag.abs() < 0.01,
                    "{rate} Hz, {radius} m, {time} s: lags {lag} s"
                );
            }
        }
    }
}

/// Shortest time of a motion from rest to rest with bounded velocity, acceleration and jerk, seconds.
fn shortest_time(distance: f64, velocity: f64, acceleration: f64, jerk: f64) -> f64 {
    let ramp = |v: f64| match v * jerk <= acceleration * acceleration {
        true => 2.0 * (v / jerk).sqrt(),
        false => v / acceleration + acceleration / jerk,
    };
    if ramp(velocity) * velocity <= distance {
        return 2.0 * ramp(velocity) + (distance - ramp(velocity) * velocity) / velocity;
    }
    let (mut low, mut high) = (0.0, velocity);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        match ramp(middle) * middle < distance {
            true => low = middle,
            false => high = middle,
        }
    }
    2.0 * ramp(low)
}

#[test]
fn steps_take_the_shortest_time_without_overshoot() {
    let arm = arm("universal_ur5e");
    let start = [0.2, -1.4, 1.3, -1.0, -1.2, 0.3];
    let ends = [
        [1.2, -1.4, 1.3, -1.0, -1.2, 0.3],
        [0.5, -0.8, 0.9, -0.5, -0.7, 0.6],
        [-0.4, -1.0, 1.8, -1.6, -0.9, 1.3],
    ];
    for (rate, end) in CYCLE_RATES
        .into_iter()
        .flat_map(|rate| ends.map(|end| (rate, end)))
    {
        let (acceleration, jerk) = (10.0, 500.0);
        let servo = arm.servo(&start, 1.0 / rate).unwrap();
        let servo = servo.with_acceleration_limits(&[acceleration; 6]).unwrap();
        let mut servo = servo.with_jerk_limits(&[jerk; 6]).unwrap();
        let target = arm.base_from_tool(&end).unwrap();
        let mut rows = Vec::new();
        let mut cycles = 0;
        while !(servo.step(target).unwrap().reached()
            && servo.velocity().iter().all(|v| v.abs() < 1e-3))
        {
            rows.push(servo.q().to_vec());
            cycles += 1;
            assert!(cycles < 5000);
        }
        let last = servo.q().to_vec();
        let each = start.iter().zip(&last).zip(servo.velocity_limits());
        let times = each.map(|((a, b), v)| shortest_time((b - a).abs(), *v, acceleration, jerk));
        let shortest = times.fold(0.0, f64::max);
        let time = f64::from(cycles) / rate;
        assert!(
            time <= 1.05 * shortest + 2.0 / rate,
            "{rate} Hz: {time} s, {shortest} s"
        );
        for (row, joint) in rows
            .iter()
            .flat_map(|row| (0..6).map(move |joint| (row, joint)))
        {
            let beyond = (row[joint] - last[joint]) * (last[joint] - start[joint]).signum();
            // A thousandth of a step, because the goal's path is not straight in joint space.
            assert!(beyond < 5e-3, "{rate} Hz, joint {joint}: {beyond}");
        }
    }
}

/// Largest distance of the tool from the straight line to a target that jumps, metres, and the number of cycles.
fn line_deviation(arm: &Arm, start: &[f64], offset: Vector3<f64>, straight: bool) -> (f64, usize) {
    let n = start.len();
    let servo = arm.servo(start, 1e-3).unwrap();
    let servo = servo.with_acceleration_limits(&vec![10.0; n]).unwrap();
    let servo = servo.with_jerk_limits(&vec![500.0; n]).unwrap();
    let mut servo = servo.with_straight_line(straight);
    let mut watch = Watch::new(start, 1e-3);
    let first = arm.base_from_tool(start).unwrap();
    let target = Placement::new(first.rotation, first.translation + offset);
    let along = offset * offset.norm().recip();
    let (mut worst, mut cycles) = (0.0_f64, 0);
    while !servo.step(target).unwrap().reached() {
        watch.check(&servo, "straight line");
        let tool_offset = arm.base_from_tool(servo.q()).unwrap().translation - first.translation;
        worst = worst.max((tool_offset - along * tool_offset.dot(along)).norm());
        assert!(
            !straight || tool_offset.dot(along) < offset.norm() + 1e-4,
            "runs past the target"
        );
        cycles += 1;
        assert!(cycles < 5000);
    }
    (worst, cycles)
}

#[test]
fn straight_lines_are_kept_to_targets_that_jump() {
    let ur5e = [0.2, -1.4, 1.3, -1.0, -1.2, 0.3];
    let panda = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let lines = [
        ("universal_ur5e", &ur5e[..], [0.0, 0.3, 0.1]),
        ("universal_ur5e", &ur5e, [0.05, 0.02, -0.1]),
        ("franka_panda", &panda, [0.0, 0.0, 0.2]),
        ("franka_panda", &panda, [-0.15, -0.25, 0.1]),
        ("franka_panda", &panda, [0.05, 0.02, -0.1]),
    ];
    for (name, start, offset) in lines {
        let (arm, offset) = (arm(name), Vector3::from(offset));
        let (bent, shortest) = line_deviation(&arm, start, offset, false);
        let (straight, cycles) = line_deviation(&arm, start, offset, true);
        assert!(
            straight < 1e-3 && straight < bent,
            "{name}: {straight} {bent} m"
        );
        assert!(cycles < 3 * shortest, "{name}: {cycles} {shortest} cycles");
    }
}

/// Start of the Panda from which targets at 30 cm lead past singular configurations.
const START_NEAR_SINGULARITY: [f64; 7] = [0.0, -0.8, 0.0, -2.4, 0.0, 1.6, 0.8];

#[test]
fn straight_line_servo_stays_at_a_reached_target() {
    let arm = panda_with_limits();
    let first = arm.base_from_tool(&START_NEAR_SINGULARITY).unwrap();
    let mut random = Random::new(17);
    let mut reached = 0;
    for case in cases(100, 12) {
        let mut vector = |size: f64| {
            let v = Vector3::from([(); 3].map(|()| random.within(-1.0, 1.0)));
            v * (size / v.norm())
        };
        let (offset, turn) = (vector(0.3), vector(0.8));
        // A target from which the tool drifted by 5 mm.
        let (offset, turn) = match case {
            0 => (Vector3::new(0.1, -0.2, 0.2), Vector3::new(0.8, 0.0, 0.0)),
            _ => (offset, turn),
        };
        let target = Placement::new(
            first.rotation * rotation_exp(turn),
            first.translation + offset,
        );
        let servo = arm.servo(&START_NEAR_SINGULARITY, 1e-3).unwrap();
        let mut servo = servo.with_straight_line(true);
        let (mut arrived, mut worst) = (false, 0.0_f64);
        for _ in 0..2500 {
            let step = servo.step(target).unwrap();
            if arrived {
                worst = worst.max(step.position_error);
            }
            arrived |= step.reached();
        }
        reached += usize::from(arrived);
        assert!(worst < 1e-4, "case {case}: {worst} m");
    }
    assert!(reached * 2 > case_count(100, 12), "{reached}");
}

/// A circle of 0.1 m whose speed rises to 0.5 m/s, within the joint limits.
#[test]
fn straight_line_servo_follows_a_circle_within_limits() {
    let arm = panda_with_limits();
    let first = arm.base_from_tool(&START_NEAR_SINGULARITY).unwrap();
    let servo = arm.servo(&START_NEAR_SINGULARITY, 1e-3).unwrap();
    let mut servo = servo.with_straight_line(true);
    let (mut phase, mut worst) = (0.0_f64, 0.0_f64);
    for cycle in 0..6000 {
        phase += 5.0 * (f64::from(cycle) / 2000.0).min(1.0) * 1e-3;
        let offset = Vector3::new(0.0, 0.1 * phase.sin(), 0.1 * (1.0 - phase.cos()));
        let target = Placement::new(first.rotation, first.translation + offset);
        worst = worst.max(servo.step(target).unwrap().position_error);
    }
    assert!(worst < 1e-3, "{worst} m");
}

#[test]
fn limits_of_files_hold_by_default() {
    let arm = panda_with_limits();
    let servo = arm
        .servo(&[0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8], 1e-3)
        .unwrap();
    assert_eq!(servo.acceleration_limits(), arm.acceleration_limits());
    assert_eq!(servo.jerk_limits()[0], 7500.0);
}

#[test]
fn stop_comes_to_rest_within_all_limits() {
    let arm = panda_with_limits();
    let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let unreachable = arm
        .base_from_tool(&[1.2, 0.2, 0.4, -1.2, 0.3, 2.2, 1.4])
        .unwrap();
    let mut servo = arm.servo(&start, 1e-3).unwrap();
    let mut watch = Watch::new(&start, 1e-3);
    for _ in 0..200 {
        servo.step(unreachable).unwrap();
        watch.check(&servo, "before the stop");
    }
    assert!(servo.velocity().iter().any(|v| v.abs() > 0.5));
    let mut cycles = 0;
    while servo.stop().status != ServoStatus::Stopped {
        watch.check(&servo, "stop");
        cycles += 1;
        assert!(cycles < 1000);
    }
    let rest = servo.q().to_vec();
    assert_eq!(servo.stop().q, rest);
    // The servo continues from there.
    for _ in 0..2000 {
        servo.step(unreachable).unwrap();
        watch.check(&servo, "after the stop");
    }
    assert!(servo.step(unreachable).unwrap().reached());
}

#[test]
fn moving_start_continues_its_motion() {
    let arm = panda_with_limits();
    let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let target = arm.base_from_tool(&start).unwrap();
    let velocity = [0.5, 0.0, -0.3, 0.0, 0.0, 0.2, 0.0];
    let acceleration = [1.0, 0.0, 0.0, 0.0, 0.0, -2.0, 0.0];
    let servo = arm.servo(&start, 1e-3).unwrap();
    let mut servo = servo.with_motion(&velocity, &acceleration).unwrap();
    let mut watch = Watch::new(&start, 1e-3);
    watch.velocity = velocity.to_vec();
    watch.acceleration = acceleration.to_vec();
    for _ in 0..2000 {
        servo.step(target).unwrap();
        watch.check(&servo, "moving start");
    }
    assert!(servo.step(target).unwrap().reached());
}

#[test]
fn start_that_cannot_brake_is_named() {
    let arm = panda_with_limits();
    let mut start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let upper = arm.limits().nth(2).unwrap().upper;
    start[2] = upper - 0.01;
    let servo = || arm.servo(&start, 1e-3).unwrap();
    let mut velocity = [0.0; 7];
    velocity[2] = 1.0;
    let error = servo()
        .with_motion(&velocity, &[0.0; 7])
        .unwrap_err()
        .to_string();
    // 1 rad/s at 10 rad/s² and 5000 rad/s³ needs 0.051 rad, of which 0.01 are available.
    assert!(
        error.contains("`joint3`") && error.contains("0.04"),
        "{error}"
    );
    velocity[2] = 3.0;
    servo()
        .with_motion(&velocity, &[0.0; 7])
        .says("`joint3` | velocity");
    velocity[2] = -1.0;
    assert!(servo().with_motion(&velocity, &[0.0; 7]).is_ok());
}

/// 15 rad/s² end at 7 500 rad/s³ after two cycles of 1 ms, after another 0.0075 rad/s.
#[test]
fn start_that_will_exceed_velocity_is_named() {
    let arm = panda_with_limits();
    let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let servo = || arm.servo(&start, 1e-3).unwrap();
    let [mut velocity, mut acceleration] = [[0.0; 7]; 2];
    (velocity[0], acceleration[0]) = (2.17, 15.0);
    servo()
        .with_motion(&velocity, &acceleration)
        .says("`joint1` | 2.1775 | 2.175");
    velocity[0] = 2.15;
    assert!(servo().with_motion(&velocity, &acceleration).is_ok());
    (velocity[0], acceleration[0]) = (-2.17, -15.0);
    assert!(servo().with_motion(&velocity, &acceleration).is_err());
    acceleration[0] = 15.0;
    assert!(servo().with_motion(&velocity, &acceleration).is_ok());
}

#[test]
fn start_outside_returns_at_velocity_limit() {
    let arm = arm("universal_ur5e");
    let start = [6.9, -1.0, 1.0, -0.5, 0.5, 0.2];
    let target = arm.base_from_tool(&start).unwrap();
    let mut servo = arm.servo(&start, 0.008).unwrap();
    assert_eq!(servo.q(), start);
    let max_velocity = servo.velocity_limits()[0];
    let upper = arm.limits().next().unwrap().upper;
    let mut cycles = 0;
    while servo.q()[0] > upper {
        let before = servo.q()[0];
        let step = servo.step(target).unwrap();
        let velocity = (step.q[0] - before) / 0.008;
        assert!(velocity < 0.0 && velocity >= -max_velocity, "{velocity}");
        assert!((velocity - step.velocity[0]).abs() < 1e-9);
        assert!(
            step.held()
                .any(|(joint, cause)| joint == "joint1" && cause == HeldBy::Outside(Side::Upper))
        );
        cycles += 1;
    }
    // 0.617 rad at 3.14 rad/s.
    assert!((24..=26).contains(&cycles), "{cycles}");
}

#[test]
fn limits_out_of_range_are_named() {
    let arm = arm("universal_ur5e");
    let servo = || arm.servo(&[0.1; 6], 1e-3).unwrap();
    for limits in [&[1.0; 5][..], &[0.0; 6], &[-1.0; 6], &[f64::NAN; 6]] {
        servo()
            .with_acceleration_limits(limits)
            .says("acceleration_limits");
        servo().with_jerk_limits(limits).says("jerk_limits");
    }
}

#[test]
fn motion_not_finite_names_its_argument() {
    let arm = panda_with_limits();
    let start = arm.default_start().to_vec();
    let motion = |velocity: f64, acceleration: f64| {
        let servo = arm.servo(&start, 0.004).unwrap();
        let error = servo.with_motion(&[velocity; 7], &[acceleration; 7]);
        error.unwrap_err().to_string()
    };
    let wrong = motion(f64::NAN, 0.0);
    assert!(
        wrong.starts_with("the velocity: joint `joint1` is NaN"),
        "{wrong}"
    );
    let wrong = motion(0.0, f64::INFINITY);
    assert!(
        wrong.starts_with("the acceleration: joint `joint1` is inf"),
        "{wrong}"
    );
}
