//! A person of seventeen places who steps, and a small robot for whom that is.
#![allow(clippy::unwrap_used)]

use kinopt::Scalar;
use kinopt::motion::retarget::{BodyPart, Capture};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::spatial::Vector3;

/// Where each part is when the person stands, z upward, in tenths of a metre.
const STANDS: [[f64; 3]; 17] = [
    [0.0, 0.0, 10.0],
    [0.0, 0.0, 14.5],
    [0.0, 0.0, 16.5],
    [0.0, 1.0, 9.2],
    [0.2, 1.1, 5.2],
    [0.0, 1.1, 1.0],
    [1.5, 1.2, 0.3],
    [0.0, 2.0, 14.0],
    [0.0, 2.4, 11.2],
    [0.3, 2.5, 8.9],
    [0.0, -1.0, 9.2],
    [0.2, -1.1, 5.2],
    [0.0, -1.1, 1.0],
    [1.5, -1.2, 0.3],
    [0.0, -2.0, 14.0],
    [0.0, -2.4, 11.2],
    [0.3, -2.5, 8.9],
];

fn smooth(share: f64) -> f64 {
    let share = share.clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// The left foot steps ahead, then the right one, higher than the ground; hands wave.
pub(crate) fn places(frame: usize) -> [Vector3<f64>; 17] {
    let time = frame as f64 / 10.0;
    let steps = [smooth((time - 0.4) / 0.7), smooth((time - 1.4) / 0.7)];
    let (wave, other) = Scalar::sin_cos(4.0 * time);
    let mut all = STANDS.map(Vector3::from);
    for (place, (part, _)) in all.iter_mut().zip(BodyPart::ALL) {
        let ahead = 1.5 * (steps[0] + steps[1]);
        let body = Vector3::new(ahead, 0.6 * wave, 0.15 * other - 0.2);
        let foot = |step: f64, rise: f64| {
            Vector3::new(3.0 * step, 0.0, 5.0 * step * (1.0 - step) + rise * step)
        };
        *place += match part {
            BodyPart::LeftAnkle | BodyPart::LeftToe => foot(steps[0], 0.0),
            BodyPart::RightAnkle | BodyPart::RightToe => foot(steps[1], 0.5),
            BodyPart::LeftKnee => foot(steps[0], 0.0) * 0.5 + body * 0.5,
            BodyPart::RightKnee => foot(steps[1], 0.5) * 0.5 + body * 0.5,
            BodyPart::LeftHand => body + Vector3::new(2.0 * wave, other, 1.5),
            BodyPart::RightHand => body + Vector3::new(other, 2.5 + wave, -wave),
            _ => body,
        };
    }
    all
}

/// So many frames of it, ten a second, as joints of these names; y upward where that is said.
pub(crate) fn capture(frames: usize, y_up: bool) -> Capture {
    let names = BodyPart::ALL.map(|(_, name)| name.to_owned()).to_vec();
    let numbers = (0..frames).flat_map(|frame| {
        let own = places(frame).map(|at| match y_up {
            true => [at.y, at.z, at.x],
            false => at.to_array(),
        });
        own.into_iter().flatten().collect::<Vec<_>>()
    });
    Capture::new(names, &numbers.collect::<Vec<_>>(), 10.0).unwrap()
}

/// Legs of six hinges and toes, arms of three, feet of a shape.
pub(crate) fn biped(foot: &str, toe: &str) -> Robot {
    let side = |name: &str, sign: f64| {
        format!(
            r#"<body name="{name}_hip" pos="0 {hip} -0.04">
              <joint name="{name}_yaw" axis="0 0 1" range="-60 60"/><joint name="{name}_roll" axis="1 0 0" range="-40 40"/><joint name="{name}_pitch" axis="0 1 0" range="-100 60"/>
              <geom type="capsule" fromto="0 0 -0.05 0 0 -0.16" size="0.025"/>
              <body name="{name}_knee" pos="0 0 -0.2"><joint name="{name}_knee" axis="0 1 0" range="0 140"/><geom type="capsule" fromto="0 0 -0.03 0 0 -0.15" size="0.02"/>
              <body name="{name}_ankle" pos="0 0 -0.2"><joint name="{name}_ankle_pitch" axis="0 1 0" range="-50 50"/><joint name="{name}_ankle_roll" axis="1 0 0" range="-30 30"/>
              {foot}<body name="{name}_toe" pos="0.07 0 -0.03"><joint name="{name}_toe" axis="0 1 0" range="-40 20"/>{toe}</body></body></body></body>
            <body name="{name}_shoulder" pos="0 {shoulder} 0.2"><joint name="{name}_lift" axis="0 1 0" range="-170 60"/><joint name="{name}_spread" axis="1 0 0" range="-90 90"/>
              <body name="{name}_elbow" pos="0 0 -0.14"><joint name="{name}_elbow" axis="0 1 0" range="-130 0"/>
              <body name="{name}_hand" pos="0 0 -0.12"><geom type="sphere" size="0.03"/></body></body></body>"#,
            hip = 0.05 * sign,
            shoulder = 0.1 * sign,
        )
    };
    let text = format!(
        r#"<mujoco model="biped"><worldbody><body name="pelvis" pos="0 0 0.5"><freejoint name="root"/><geom type="box" size="0.05 0.06 0.05"/>
        <body name="chest" pos="0 0 0.22"><geom type="sphere" size="0.06" pos="0 0 -0.05"/><body name="head" pos="0 0 0.1"><joint name="nod" axis="0 1 0" range="-40 40"/></body></body>
        {}{}</body></worldbody></mujoco>"#,
        side("left", 1.0),
        side("right", -1.0)
    );
    let robot = Robot::parse_mjcf(&text, "biped.xml").unwrap();
    let robot = robot.with_base_joint(BaseJoint::FREE).unwrap();
    let limits = "joint_limits:\n  left_knee: {max_velocity: 1.5}\n  right_knee: {max_velocity: 4}\n  left_lift: {max_velocity: 2}\n  right_spread: {max_velocity: 0.5}\n";
    robot
        .with_joint_limits_of(limits.as_bytes(), "limits.yaml")
        .unwrap()
}

/// Boxes under ankle and toe.
pub(crate) const BOXES: [&str; 2] = [
    r#"<geom type="box" size="0.05 0.03 0.01" pos="0.02 0 -0.04"/>"#,
    r#"<geom type="box" size="0.02 0.03 0.01" pos="0.02 0 -0.01"/>"#,
];
