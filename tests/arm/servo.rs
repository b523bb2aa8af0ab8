//! Promise: a servo at 1 kHz keeps velocity and joint limits exactly for any targets. It rests if its target rests,
//! and returns to its start after nearly all lines out of reach. `KINOPT_CASES` sets the number of lines for each robot.

use kinopt::arm::{Arm, HeldBy, PoseBounds, Servo, ServoStatus};
use kinopt::model::Limits;
use kinopt::spatial::{Placement, Vector3};
use support::arms::{distance, planar_with_hand, robot, within_limits};
use support::fault_tables::ExpectedError;
use support::lines::{Line, ROBOTS, STEP, lines, robots};
use support::random::{Random, case_count, cases};

const TICK: f64 = 1e-3;
/// Largest number of cycles until rest, and number of cycles that are watched then.
const REST: usize = 5000;
const WATCHED: usize = 50;

fn arm(name: &str) -> Arm {
    let (_, base, tip) = ROBOTS.into_iter().find(|(n, ..)| *n == name).unwrap();
    let robot = robot(name);
    let arm = Arm::builder(&robot, base, tip);
    arm.with_atlas(false).build().unwrap()
}

/// One checked cycle; returns the joint velocities.
fn tick(arm: &Arm, servo: &mut Servo<'_>, target: &Placement<f64>) -> (ServoStatus, Vec<f64>) {
    let (before, limits) = (servo.q().to_vec(), servo.velocity_limits().to_vec());
    let step = servo.step(*target).unwrap();
    assert!(within_limits(arm, step.q));
    for ((a, b), limit) in before.iter().zip(step.q).zip(limits) {
        let most = if limit.is_finite() { limit * TICK } else { 0.1 };
        assert!((b - a).abs() <= most, "{a} {b} {limit}");
    }
    let found = arm.base_from_tool(step.q).unwrap();
    let off = (found.translation - target.translation).norm();
    assert!((step.position_error - off).abs() < 1e-9 * (1.0 + off));
    assert!(!step.reached() || off <= 1e-6);
    (step.status, step.velocity.to_vec())
}

/// Largest peak-to-peak velocity of a joint with a constant target.
fn chatter(arm: &Arm, servo: &mut Servo<'_>, target: &Placement<f64>) -> (ServoStatus, f64) {
    let mut ticks = Vec::new();
    let mut status = ServoStatus::Settling;
    let mut calm = 0;
    while ticks.len() < REST && calm < WATCHED {
        let (now, velocity) = tick(arm, servo, target);
        status = now;
        let slow = velocity.iter().all(|v| v.abs() < 2e-4);
        calm = if slow { calm + 1 } else { 0 };
        ticks.push(velocity);
    }
    let watched = &ticks[ticks.len() - WATCHED..];
    let spread = |joint: usize| {
        let values = watched.iter().map(|velocity| velocity[joint]);
        let ends = values.fold((f64::MAX, f64::MIN), |(l, u), v| (l.min(v), u.max(v)));
        ends.1 - ends.0
    };
    let widest = (0..arm.joint_count()).map(spread).fold(0.0, f64::max);
    (status, widest)
}

/// Largest number of lines in 1000 after which a robot does not return to its start.
///
/// The branches of an arm meet at its stretched configuration. If that configuration is nearly singular in a second
/// way, or moves faster than the side of the arm is carried, the arm may change its branch. The numbers are those of
/// 1000 lines for each robot.
const CHANGES_IN_1000: [(&str, usize); 7] = [
    ("franka_panda", 13),
    ("universal_ur5e", 10),
    ("kuka_iiwa14", 8),
    ("universal_ur10e", 5),
    ("rethink_baxter", 12),
    ("adept_cobra_s600", 0),
    ("aldebaran_nao", 2),
];

#[test]
fn lines_out_of_reach_and_back_keep_limits() {
    for name in robots() {
        let arm = arm(name);
        let count = case_count(10, 1);
        let mut changed = Vec::new();
        for (k, line) in lines(&arm, &mut Random::split_mix(91), count)
            .iter()
            .enumerate()
        {
            let mut end = out_and_back(&arm, name, line, 1.0);
            // At the stretched configuration a redundant arm's branches meet at a pose that may move faster than its
            // joints. Faster arms return.
            if arm.joint_count() > 6 && end.on_target && !end.is_back() {
                end = out_and_back(&arm, name, line, 10.0);
            }
            if !end.is_back() {
                changed.push((k, end));
            }
        }
        let (_, most) = CHANGES_IN_1000
            .into_iter()
            .find(|(n, _)| *n == name)
            .unwrap();
        let most = (count * most + 500) / 1000;
        assert!(changed.len() <= most, "{name}: {changed:?}");
    }
}

/// Lines along which an arm stretches out and then bends again.
///
/// A UR5e ended on the other side of its elbow. A Panda rested 0.7 to 2.4 mm from its start, with its elbow at a limit.
#[test]
fn stretched_arm_returns_on_its_side() {
    let cases: [(&str, &[f64], [f64; 3]); 3] = [
        (
            "universal_ur5e",
            &[-1.885, -0.123, 0.527, 2.572, 0.843, -2.032],
            [0.482867, 0.714803, -0.505861],
        ),
        (
            "franka_panda",
            &[-0.511, 0.715, -0.93, -0.827, 1.448, 1.259, -0.189],
            [0.980331, -0.093031, -0.174059],
        ),
        (
            "franka_panda",
            &[-0.41, 0.426, 1.303, -0.798, -1.393, 1.908, -1.69],
            [0.42207, -0.799132, 0.428071],
        ),
    ];
    for (name, start, direction) in cases {
        let arm = arm(name);
        let first = arm.base_from_tool(start).unwrap();
        let at = |metres: f64| {
            let by = Vector3::from(direction) * metres;
            Placement::new(first.rotation, first.translation + by)
        };
        let line = Line {
            start: start.to_vec(),
            out: (0..200).map(|k| at(STEP * f64::from(k))).collect(),
        };
        let end = out_and_back(&arm, name, &line, 1.0);
        assert!(end.is_back() && !end.held, "{name}: {end:?}");
    }
}

/// Largest distance of a returned arm from its start, radians.
const BACK: f64 = 1e-3;

/// End of a line out and back.
#[derive(Debug)]
struct End {
    /// True if the arm reached its first target again.
    on_target: bool,
    /// True if it stayed near its outward path all the way back.
    on_branch: bool,
    /// True if it was at a position limit, or did not leave its reach.
    held: bool,
    /// Distance from the start, radians.
    off: f64,
}

impl End {
    fn is_back(&self) -> bool {
        self.on_target && self.on_branch && (self.held || self.off < BACK)
    }
}

/// Moves along a line out and back, with scaled velocity limits.
fn out_and_back(arm: &Arm, name: &str, Line { start, out }: &Line, faster: f64) -> End {
    let speeds: Vec<f64> = arm.velocity_limits().iter().map(|v| v * faster).collect();
    let servo = arm.servo(start, TICK).unwrap();
    let mut servo = servo.with_velocity_limits(&speeds).unwrap();
    let (mut held, mut on_branch) = (false, true);
    let mut path = Vec::new();
    for target in out {
        let (status, _) = tick(arm, &mut servo, target);
        path.push((servo.q().to_vec(), status));
        held |= held_by_limits(arm, servo.q());
    }
    let (status, widest) = chatter(arm, &mut servo, out.last().unwrap());
    assert!(widest < 1e-3, "{name}: {widest} {status:?}");
    // A long way around may continue from the end of the short one.
    held |= held_by_limits(arm, servo.q()) || status == ServoStatus::OnTarget;
    for (target, (there, before)) in out.iter().zip(&path).rev() {
        let (status, _) = tick(arm, &mut servo, target);
        held |= held_by_limits(arm, servo.q());
        // Near the edge the null space may lag, as may joints at their velocity limits.
        let lags = [status, *before].contains(&ServoStatus::SpeedLimited);
        if !held && !lags && arm.joint_count() <= 6 {
            on_branch &= distance(servo.q(), there) < 0.3;
        }
    }
    let (status, widest) = chatter(arm, &mut servo, &out[0]);
    assert!(widest < 1e-3, "{name}: {widest}");
    End {
        on_target: status == ServoStatus::OnTarget,
        on_branch,
        held,
        off: distance(servo.q(), &path[0].0),
    }
}

fn held_by_limits(arm: &Arm, q: &[f64]) -> bool {
    arm.limits()
        .zip(q)
        .any(|(l, q)| *q <= l.lower || *q >= l.upper)
}

/// Targets that jump within and beyond reach, then rest.
#[test]
fn jumping_targets_keep_limits() {
    for name in ["franka_panda", "universal_ur5e", "adept_cobra_s600"] {
        let arm = arm(name);
        let mut random = Random::split_mix(92);
        let mut servo = arm.servo(&random.configuration(&arm), TICK).unwrap();
        for k in cases(40, 4) {
            let mut target = arm.base_from_tool(&random.configuration(&arm)).unwrap();
            if k % 3 == 1 {
                target.translation = target.translation * 1.5;
            }
            for _ in 0..30 {
                tick(&arm, &mut servo, &target);
            }
        }
        // At its own pose: reached at once.
        let here = arm.base_from_tool(servo.q()).unwrap();
        let (status, widest) = chatter(&arm, &mut servo, &here);
        assert!(status == ServoStatus::OnTarget && widest < 1e-3, "{widest}");
    }
}

/// The damping decreases at a constant target, so an arm that is stretched towards a slightly unreachable target
/// converges fast. Its final error is the distance of the target beyond the reach.
#[test]
fn closest_pose_is_reached_in_few_cycles() {
    let arm = arm("universal_ur5e");
    let start = [0.3, -1.2, 1e-3, -1.0, 0.5, 0.2];
    let first = arm.base_from_tool(&start).unwrap();
    let direction = first.translation * (1.0 / first.translation.norm());
    for over in [1e-5, 3e-5, 1e-4] {
        let target = Placement::new(first.rotation, first.translation + direction * over);
        let mut servo = arm.servo(&start, TICK).unwrap();
        let mut ticks = 0;
        let (mut status, mut error) = (ServoStatus::Settling, f64::INFINITY);
        while status != ServoStatus::Nearest && ticks < 200 {
            let step = servo.step(target).unwrap();
            (status, error) = (step.status, step.position_error);
            ticks += 1;
        }
        assert!(ticks <= 25, "{over}: {ticks} ticks");
        assert!(error < over, "{over}: {error}");
    }
}

/// Far beyond reach the cost is flat near its minimum. At a constant target the arm still converges, with more steps
/// per cycle.
#[test]
fn flat_minimum_is_reached_in_bounded_cycles() {
    let arm = arm("universal_ur5e");
    for seed in 24..33 {
        let mut random = Random::split_mix(seed + 1);
        let start = random.configuration(&arm);
        let first = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        let far = [0.9, 1.2, 2.0][(seed % 3) as usize] / first.translation.norm();
        let target = Placement::new(first.rotation, first.translation * far);
        let mut servo = arm.servo(&start, 10.0 * TICK).unwrap();
        let moves = [ServoStatus::Settling, ServoStatus::SpeedLimited];
        let ends = |_: &usize| !moves.contains(&servo.step(target).unwrap().status);
        let ticks = (1..400).find(ends);
        assert!(ticks.is_some_and(|ticks| ticks < 220), "{seed}: {ticks:?}");
    }
}

/// A stretched arm, straight or bent by a tiny angle, reaches a target within reach and keeps the side of its bend.
#[test]
fn stretched_arm_bends_to_a_reachable_target() {
    let arm = planar_with_hand(Limits::new(-3.0, 3.0));
    let x = Vector3::UNITS[0];
    for goal in [PoseBounds::pose(), PoseBounds::position()] {
        let arm = arm.with_goal(goal).unwrap();
        for bend in [0.0, 1e-10, 1e-8, -1e-8, 1e-6, -1e-6, 1e-4] {
            let start = [-0.5 * bend, bend, -0.5 * bend];
            for nearer in [1e-3, 0.1, 0.8] {
                let target = Placement::translation(x * (2.0 - nearer));
                let mut servo = arm.servo(&start, TICK).unwrap();
                let mut ticks = 0;
                while tick(&arm, &mut servo, &target).0 != ServoStatus::OnTarget {
                    ticks += 1;
                    assert!(ticks < 100, "{bend} {nearer}: {:?}", servo.q());
                }
                assert!(
                    servo.q()[1] * bend >= 0.0,
                    "{bend} {nearer}: {:?}",
                    servo.q()
                );
            }
            // Beyond its reach it stays straight.
            let target = Placement::translation(x * 2.1);
            let mut servo = arm.servo(&start, TICK).unwrap();
            for _ in 0..50 {
                tick(&arm, &mut servo, &target);
            }
            assert!(
                servo.q().iter().all(|q| q.abs() < 5e-3),
                "{bend}: {:?}",
                servo.q()
            );
        }
    }
}

#[test]
fn active_limits_are_reported() {
    let arm = arm("franka_panda");
    let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let mut servo = arm.servo(&start, TICK).unwrap();
    let far = arm
        .base_from_tool(&[1.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])
        .unwrap();
    let step = servo.step(far).unwrap();
    assert_eq!(step.status, ServoStatus::SpeedLimited);
    let held: Vec<_> = step.held().collect();
    assert!(held.iter().any(|(_, by)| matches!(by, HeldBy::Speed(_))));
    assert!(!held.iter().any(|(_, by)| matches!(by, HeldBy::Limit(_))));
    // The last joint beyond its limit: the servo ends there and reports it.
    let arm = self::arm("universal_ur5e");
    let upper = arm.limits().last().unwrap().upper;
    let turned = [0.2, -1.4, 1.3, -1.0, -1.2, upper];
    let mut target = arm.base_from_tool(&turned).unwrap();
    let spin = kinopt::spatial::Matrix3::identity().rotated_about_z(0.3_f64.sin_cos());
    target.rotation = target.rotation * spin;
    let mut servo = arm.servo(&turned, TICK).unwrap();
    let mut last = Vec::new();
    for _ in 0..150 {
        let step = servo.step(target).unwrap();
        last = step
            .held()
            .map(|(name, by)| (name.to_owned(), by))
            .collect();
    }
    let at_limit = |(name, by): &(String, HeldBy)| {
        name == "joint6" && *by == HeldBy::Limit(kinopt::ik::Side::Upper)
    };
    assert!(last.iter().any(at_limit), "{last:?}");
}

/// A fast prismatic motion is a jump, weighted by metres per radian. Velocities of prismatic joints are in m/s.
#[test]
fn prismatic_jumps_and_velocities_are_in_metres() {
    let robot = robot("adept_cobra_s600");
    let arm = Arm::builder(&robot, "base", "flange");
    let arm = arm.with_atlas(false).with_metres_per_radian(0.1);
    let arm = arm.build().unwrap();
    let slide = 2;
    let mut from = vec![0.2, 0.6, 0.05, 0.1];
    let mut follower = arm.follower(&from).unwrap();
    let mut solution = kinopt::Solution::default();
    let target = arm.base_from_tool(&from).unwrap();
    assert_eq!(follower.advance(target, &mut solution).unwrap(), None);
    from[slide] += 0.1;
    let target = arm.base_from_tool(&from).unwrap();
    let jump = follower.advance(target, &mut solution).unwrap().unwrap();
    assert!(!jump.reconfiguration && jump.joint == slide, "{jump:?}");
    assert!((jump.distance - 1.0).abs() < 1e-3, "{jump:?}");
    // A short one is no jump.
    from[slide] -= 0.019;
    let target = arm.base_from_tool(&from).unwrap();
    assert_eq!(follower.advance(target, &mut solution).unwrap(), None);
    // Without velocity limits a prismatic joint moves at most a tenth of the metres per radian.
    let mut servo = arm.servo(&from, TICK).unwrap();
    servo = servo.with_velocity_limits(&[f64::INFINITY; 4]).unwrap();
    from[slide] += 0.05;
    let target = arm.base_from_tool(&from).unwrap();
    let step = servo.step(target).unwrap();
    let moved = step.q[slide] - (from[slide] - 0.05);
    assert!(moved > 0.005 && moved <= 0.01, "{moved}");
}

#[test]
fn invalid_servo_options_are_named() {
    let arm = arm("universal_ur5e");
    let start = [0.1; 6];
    for bad in [0.0, -1.0, 1000.0, f64::NAN, f64::INFINITY] {
        arm.servo(&start, bad).says("time step");
    }
    assert!(arm.servo(&[0.0; 5], TICK).is_err());
    let servo = || arm.servo(&start, TICK).unwrap();
    for limits in [&[1.0; 5][..], &[-1.0; 6], &[f64::NAN; 6]] {
        servo().with_velocity_limits(limits).says("velocity_limits");
    }
    assert!(servo().with_damping(-1.0).is_err() && servo().with_damping(0.0).is_ok());
    let mut servo = servo();
    let mut bent = Placement::identity();
    bent.rotation.x.x = 2.0;
    assert!(servo.step(bent).is_err() && servo.q() == start);
    // A joint with velocity limit 0 does not move.
    let mut limits = [1.0; 6];
    limits[2] = 0.0;
    let mut servo = servo.with_velocity_limits(&limits).unwrap();
    let target = arm.base_from_tool(&[0.3; 6]).unwrap();
    for _ in 0..20 {
        assert_eq!(servo.step(target).unwrap().q[2], 0.1);
    }
}
