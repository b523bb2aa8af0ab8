//! Promise: so it is for an arm's other doors: its numbers within the whole robot's, how its tool and its answers move, whole
//! batches, other tools, goals and searches of one arm, and all that is refused.
#![allow(clippy::unwrap_used)]

use kinopt::Solution;
use kinopt::arm::{Arm, ArmBuilder, Axis, PoseBounds, Search};
use kinopt::robot::Robot;
use kinopt::simd_ik::PoseOutcome;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::arms::robot;

use crate::arms::turned;
use crate::digest::{Digest, Value, check};
use support::random::Random;

/// Seven free joints: a slide, a joint that follows the one before it, one without ends, one of several turns, and a locked one.
const MIXED: &str = r#"<robot name="m"><link name="base"/><link name="l1"/><link name="l2"/><link name="l3"/><link name="l4"/>
<link name="l5"/><link name="l6"/><link name="l7"/><link name="l8"/><link name="tip"/><link name="aside"/>
<joint name="j1" type="prismatic"><parent link="base"/><child link="l1"/><axis xyz="0 1 0"/><limit lower="-0.4" upper="0.6" effort="1" velocity="0.3"/></joint>
<joint name="j2" type="continuous"><parent link="l1"/><child link="l2"/><origin xyz="0 0 0.3"/><axis xyz="0 0 1"/><limit effort="1" velocity="2"/></joint>
<joint name="j3" type="revolute"><parent link="l2"/><child link="l3"/><origin xyz="0 0.05 0.1" rpy="0.2 0 0"/><axis xyz="0 1 0"/><limit lower="-2" upper="1.5" effort="1" velocity="1"/></joint>
<joint name="j4" type="revolute"><parent link="l3"/><child link="l4"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0.1"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
<joint name="j5" type="revolute"><parent link="l4"/><child link="l5"/><origin xyz="0.1 0 0"/><axis xyz="1 0 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/><mimic joint="j4" multiplier="-0.5" offset="0.1"/></joint>
<joint name="j6" type="revolute"><parent link="l5"/><child link="l6"/><origin xyz="0.2 0 0"/><axis xyz="0 0 1"/><limit lower="-1" upper="2.5" effort="1" velocity="0.5"/></joint>
<joint name="j7" type="revolute"><parent link="l6"/><child link="l7"/><origin xyz="0.1 0 0"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="4"/></joint>
<joint name="j8" type="revolute"><parent link="l7"/><child link="l8"/><origin xyz="0.05 0 0.02"/><axis xyz="1 0 0"/><limit lower="-3" upper="3" effort="1" velocity="4"/></joint>
<joint name="j9" type="fixed"><parent link="l8"/><child link="tip"/><origin xyz="0.1 0 0" rpy="0 0.3 0"/></joint>
<joint name="j0" type="revolute"><parent link="l3"/><child link="aside"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"#;

fn mixed() -> Robot {
    Robot::reader().parse(MIXED, "m.urdf").unwrap()
}

/// What an arm tells of itself and of its answers at some of its configurations.
fn told(digest: &mut Digest, robot: &Robot, arm: &Arm, random: &mut Random) {
    digest.bytes(format!(
        "{:?} {:?} {}",
        arm.joints().collect::<Vec<_>>(),
        arm.joint_ids(),
        arm.joint_count()
    ));
    digest.doubles(arm.limits().flat_map(|limits| [limits.lower, limits.upper]));
    digest.doubles(
        arm.velocity_limits()
            .iter()
            .chain(arm.acceleration_limits())
            .copied(),
    );
    let mut jacobian = arm.jacobian().unwrap();
    for k in 0..3 {
        let q = random.configuration(arm);
        let mut whole = robot.model().neutral();
        arm.configuration(&q, &mut whole).unwrap();
        digest.doubles(whole.iter().copied());
        let mut own = Vec::new();
        arm.joint_values(&whole, &mut own).unwrap();
        digest.doubles(own);
        let there = arm.base_from_tool(&q).unwrap();
        digest.placement(&there);
        let matrix = jacobian.at(&q).unwrap();
        digest.doubles(matrix.iter().copied());
        // On a target, beside one, and far from any.
        let mut target = there;
        target.translation += Vector3::new(0.0, 0.01, 0.0) * f64::from(k);
        let derivative = arm.derivative(target, &q).unwrap();
        digest.text(derivative.differentiability.name());
        digest.doubles(derivative.by_target.iter().copied());
        let ends: Vec<f64> = arm.limits().map(|limits| limits.upper.min(3.0)).collect();
        let derivative = arm.derivative(target, &ends).unwrap();
        digest.doubles(derivative.by_target.iter().copied());
        let mut solution = Solution::default();
        for start in [&ends, &q] {
            arm.solve_into(there, start, &mut solution).unwrap();
            digest.solution(&solution);
        }
    }
}

fn of_themselves() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::split_mix(71));
    let (panda, mixed) = (robot("franka_panda"), mixed());
    let builder = |robot, base, tip| Arm::builder(robot, base, tip).with_atlas(false);
    let rest = [0.1, 0.4, -0.2, 0.3, -0.05, 0.2, 0.5, -0.3, 0.1];
    let arms = [
        (&panda, builder(&panda, "base", "tool")),
        (&panda, builder(&panda, "link2", "link6")),
        (
            &panda,
            builder(&panda, "base", "tool").with_locked("joint3", 0.4),
        ),
        (&mixed, builder(&mixed, "base", "tip")),
        (&mixed, builder(&mixed, "tip", "base")),
        (
            &mixed,
            builder(&mixed, "aside", "tip").with_goal(PoseBounds::position()),
        ),
        (
            &mixed,
            builder(&mixed, "base", "tip")
                .with_locked("j4", -0.4)
                .with_locked("j2", 7.0),
        ),
        (
            &mixed,
            builder(&mixed, "base", "tip").with_only(["j2", "j3", "j6", "j7"], &rest),
        ),
    ];
    for (robot, builder) in arms {
        digest.bytes(format!("{:?}", builder.joints().unwrap()));
        let arm = builder.with_attempts(8).build().unwrap();
        told(&mut digest, robot, &arm, &mut random);
    }
    digest.value()
}

/// One arm, given other tools, goals and searches one after the other.
fn given_others() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::split_mix(72));
    let (ur, mixed) = (robot("universal_ur5e"), mixed());
    for (robot, base, tip) in [(&ur, "base", "flange"), (&mixed, "base", "tip")] {
        let arm = Arm::builder(robot, base, tip)
            .with_attempts(9)
            .with_atlas(false);
        let arm = arm.with_position_tolerance(1e-5).build().unwrap();
        let tool = Placement::new(turned(|| random.unit()), Vector3::new(0.02, -0.1, 0.15));
        let tooled = arm.with_tool(tool).unwrap();
        let all = [
            tooled.with_tool(Placement::identity()).unwrap(),
            tooled.with_goal(PoseBounds::free_about(Axis::X)).unwrap(),
            tooled.with_goal(PoseBounds::free_along(Axis::Y)).unwrap(),
            tooled.with_goal(PoseBounds::position()).unwrap(),
            tooled
                .with_goal(PoseBounds::within([0.3, 0.3, 0.3, 0.0, 0.0, 0.1]))
                .unwrap(),
            arm.with_goal(PoseBounds::within([0.0, 0.03, 0.0, 0.0, 0.4, 0.0]))
                .unwrap(),
            arm.with_search(Search::First).unwrap(),
            arm.with_search(Search::Nearest).unwrap(),
            arm.with_search(Search::Distinct {
                k: 3,
                distance: 0.2,
            })
            .unwrap()
            .with_tool(tool)
            .unwrap(),
            tooled,
            arm,
        ];
        for arm in &all {
            let n = arm.joint_count();
            let starts: Vec<f64> = (0..3).flat_map(|_| random.configuration(arm)).collect();
            let targets: Vec<_> = (0..3)
                .map(|_| arm.base_from_tool(&random.configuration(arm)).unwrap())
                .collect();
            let (mut q, mut outcomes) = (vec![0.0; 3 * n], vec![PoseOutcome::default(); 3]);
            arm.solve_batch_into(&targets, &starts, &mut q, &mut outcomes)
                .unwrap();
            digest.doubles(q);
            digest.bytes(format!("{outcomes:?}"));
            for solution in arm.solve_batch(&targets, &starts).unwrap() {
                digest.solution(&solution);
            }
            for solution in arm.solve_all(targets[1], &starts[n..2 * n]).unwrap() {
                digest.solution(&solution);
            }
            let mut follower = arm.follower(&starts[..n]).unwrap();
            let mut found = Solution::default();
            follower.advance(targets[0], &mut found).unwrap();
            digest.doubles(follower.q().iter().copied());
            let servo = arm.servo(&starts[..n], 0.01).unwrap();
            let limits = vec![0.5; n];
            let mut servo = servo
                .with_velocity_limits(&limits)
                .unwrap()
                .with_damping(0.2)
                .unwrap();
            for _ in 0..4 {
                digest.doubles(servo.step(targets[2]).unwrap().velocity.iter().copied());
            }
            digest.doubles(servo.q().iter().chain(servo.velocity_limits()).copied());
        }
    }
    digest.value()
}

pub(crate) fn refused<T, E: ToString>(digest: &mut Digest, found: Result<T, E>) {
    digest.text(found.map_or_else(|error| error.to_string(), |_| "taken".to_owned()));
}

fn refusals_of_arms() -> Value {
    let mut digest = Digest::new();
    let (panda, mixed) = (robot("franka_panda"), mixed());
    let builder = || Arm::builder(&panda, "base", "tool").with_atlas(false);
    let bent = Placement::new(
        Matrix3::from_columns(
            Vector3::UNITS[0],
            Vector3::UNITS[1],
            Vector3::UNITS[2] * 1.1,
        ),
        Vector3::zero(),
    );
    let lost = Placement::translation(Vector3::new(f64::NAN, 0.0, 0.0));
    let refuse = |digest: &mut Digest, builder: ArmBuilder<'_>| refused(digest, builder.build());
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300] {
        refuse(&mut digest, builder().with_position_tolerance(value));
        refuse(&mut digest, builder().with_orientation_tolerance(value));
        refuse(&mut digest, builder().with_metres_per_radian(value));
        refuse(&mut digest, builder().with_limit_avoidance(value));
        let mut seven = [1.0; 7];
        seven[6] = value;
        refuse(&mut digest, builder().with_joint_weights(&seven));
        refuse(&mut digest, builder().with_max_move(&seven));
        refuse(&mut digest, builder().with_posture(&seven));
        let mut six = [0.0; 6];
        six[4] = value;
        refuse(&mut digest, builder().with_goal(PoseBounds::within(six)));
        refuse(&mut digest, builder().with_locked("joint2", value));
        refuse(
            &mut digest,
            builder().with_search(Search::Distinct {
                k: 2,
                distance: value,
            }),
        );
    }
    refuse(&mut digest, builder().with_attempts(0));
    refuse(&mut digest, builder().with_iterations(0));
    refuse(
        &mut digest,
        builder().with_search(Search::Distinct {
            k: 0,
            distance: 0.1,
        }),
    );
    refuse(
        &mut digest,
        builder()
            .with_posture(&[0.0; 7])
            .with_search(Search::Nearest),
    );
    refuse(
        &mut digest,
        builder().with_goal(PoseBounds::within([f64::INFINITY; 6])),
    );
    refuse(&mut digest, builder().with_tool(bent));
    refuse(&mut digest, builder().with_tool(lost));
    refuse(&mut digest, builder().with_joint_weights(&[1.0; 6]));
    refuse(&mut digest, builder().with_max_move(&[1.0; 8]));
    refuse(&mut digest, builder().with_locked("joint0", 0.0));
    refuse(
        &mut digest,
        builder()
            .with_locked("joint1", 0.1)
            .with_locked("joint1", 0.2),
    );
    refuse(&mut digest, builder().with_only(["joint9"], &[0.0; 9]));
    refuse(&mut digest, builder().with_only(["joint1"], &[0.0; 3]));
    for (base, tip) in [
        ("bas", "tool"),
        ("base", "tol"),
        ("base", "base"),
        ("flange", "tool"),
    ] {
        refused(&mut digest, Arm::new(&panda, base, tip));
    }
    let arm = builder().with_attempts(3).build().unwrap();
    let q = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
    let there = arm.base_from_tool(&q).unwrap();
    let mut odd = q;
    odd[2] = f64::INFINITY;
    let mut solution = Solution::default();
    for (target, start) in [
        (there, &q[..6]),
        (there, &odd[..]),
        (bent, &q[..]),
        (lost, &q[..]),
    ] {
        refused(&mut digest, arm.solve(target, start));
        refused(&mut digest, arm.solve_all(target, start));
        refused(&mut digest, arm.solve_into(target, start, &mut solution));
        refused(
            &mut digest,
            arm.solve_batch(&[there, target], &[&q[..], start].concat()),
        );
        refused(&mut digest, arm.track(&[there, target], start));
        refused(&mut digest, arm.derivative(target, start));
        refused(
            &mut digest,
            arm.follower(start)
                .and_then(|mut f| f.advance(target, &mut solution).map(drop)),
        );
        refused(
            &mut digest,
            arm.servo(start, 0.01)
                .and_then(|mut s| s.step(target).map(drop)),
        );
        refused(&mut digest, arm.base_from_tool(start));
        refused(&mut digest, arm.with_tool(target));
    }
    for time in [0.0, f64::NAN, -0.1] {
        refused(&mut digest, arm.servo(&q, time));
        refused(&mut digest, arm.servo(&q, 0.1).unwrap().with_damping(time));
        refused(
            &mut digest,
            arm.servo(&q, 0.1).unwrap().with_velocity_limits(&[time; 7]),
        );
    }
    refused(
        &mut digest,
        arm.servo(&q, 0.1).unwrap().with_velocity_limits(&[1.0; 3]),
    );
    for (numbers, told) in [(14, 1), (13, 2), (14, 3)] {
        let (mut q, mut outcomes) = (vec![0.0; numbers], vec![PoseOutcome::default(); told]);
        let found = arm.solve_batch_into(&[there; 2], &[0.0; 14], &mut q[..], &mut outcomes[..]);
        refused(&mut digest, found);
    }
    refused(&mut digest, arm.configuration(&q, &mut [0.0; 3]));
    refused(&mut digest, arm.configuration(&q[..3], &mut [0.0; 9]));
    refused(&mut digest, arm.joint_values(&[0.0; 3], &mut [0.0; 7][..]));
    refused(&mut digest, arm.collisions(&q));
    refused(
        &mut digest,
        Arm::builder(&mixed, "base", "tip")
            .with_locked("j5", 0.2)
            .build(),
    );
    digest.value()
}

#[test]
fn of_what_arms_tell_of_themselves() {
    check(&[("what arms tell of themselves", of_themselves())]);
}

#[test]
fn of_arms_given_other_tools_and_goals() {
    check(&[("arms given other tools, goals and searches", given_others())]);
}

#[test]
fn of_what_arms_refuse() {
    check(&[("what arms refuse", refusals_of_arms())]);
}
