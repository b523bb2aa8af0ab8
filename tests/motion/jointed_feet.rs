//! Promise: the sole of a foot with a toe joint includes the heel. No part of the foot is in the ground, and the
//! reported depth is that of all parts.

use std::fmt::Write as _;

use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::Trajectory;
use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, RetargetReport, Retargeting};
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;

use crate::retargeted_feet::{RATE, person};

const MAP: &str = r#"{
    "joints": ["chest", "l_hip", "l_knee", "l_ankle", "l_toe", "r_hip", "r_knee", "r_ankle", "r_toe"],
    "drives": {
        "chest": "Pelvis",
        "l_hip": "L_Hip", "l_knee": "L_Knee", "l_ankle": "L_Ankle", "l_toe": "L_Toe",
        "r_hip": "R_Hip", "r_knee": "R_Knee", "r_ankle": "R_Ankle", "r_toe": "R_Toe"
    }
}"#;

/// Box of the ankle's link, with the heel, and of the toe's link: centre and half sizes, metres.
const BOXES: [([f64; 3], [f64; 3]); 2] = [
    ([0.02, 0.0, -0.024], [0.085, 0.048, 0.046]),
    ([0.035, 0.0, 0.0055], [0.05, 0.048, 0.02]),
];

/// Lower body of a humanoid as in SMPL models: three revolute joints per joint, a heel in the ankle's link and a toe
/// link.
fn humanoid() -> Robot {
    let mut text = String::from(
        r#"<mujoco model="smpl"><worldbody><body name="Pelvis" pos="0 0 0.9"><freejoint/><geom type="sphere" size="0.1"/>"#,
    );
    let joints = |name: &str, range: f64| {
        ["x", "y", "z"].map(|axis| {
            let axis_vector = ["1 0 0", "0 1 0", "0 0 1"][usize::from(axis.as_bytes()[0] - b'x')];
            format!(
                r#"<joint name="{name}_{axis}" axis="{axis_vector}" range="-{range} {range}"/>"#
            )
        })
    };
    for (side, y) in [("L", 0.07), ("R", -0.07)] {
        let bodies = [
            ("Hip", format!("0 {y} -0.08"), 150.0, String::new()),
            ("Knee", "0 0 -0.38".to_owned(), 150.0, String::new()),
            ("Ankle", "0 0 -0.4".to_owned(), 80.0, geom(0)),
            ("Toe", "0.12 0 -0.0556".to_owned(), 60.0, geom(1)),
        ];
        for (name, at, range, geom) in bodies {
            let joints = joints(&format!("{side}_{name}"), range).concat();
            write!(
                text,
                r#"<body name="{side}_{name}" pos="{at}">{joints}{geom}"#
            )
            .unwrap();
        }
        text.push_str(&"</body>".repeat(4));
    }
    text.push_str("</body></worldbody></mujoco>");
    Robot::parse_mjcf(&text, "smpl.xml").unwrap()
}

fn geom(index: usize) -> String {
    let [at, size] = [BOXES[index].0, BOXES[index].1].map(|[x, y, z]| format!("{x} {y} {z}"));
    format!(r#"<geom type="box" pos="{at}" size="{size}"/>"#)
}

/// Depth of the lowest corner of both feet in all frames, metres below the ground.
fn max_penetration(robot: &Robot, found: &Trajectory<RetargetReport>) -> f64 {
    let model = robot.model();
    let mut kinematics = ForwardKinematics::new(model);
    let mut lowest = f64::INFINITY;
    for q in found.rows() {
        let placed = kinematics.place(q).unwrap();
        for side in ["L", "R"] {
            for (name, (at, size)) in ["Ankle", "Toe"].iter().zip(BOXES) {
                let frame = model.frame(&format!("{side}_{name}")).unwrap();
                for corner in 0..8 {
                    let sign = |axis: usize| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
                    let corner: [f64; 3] = std::array::from_fn(|k| at[k] + sign(k) * size[k]);
                    lowest = placed[frame.index()]
                        .apply(Vector3::from(corner))
                        .z
                        .min(lowest);
                }
            }
        }
    }
    -lowest
}

/// Subject that rolls over the feet: toes down, then heels down, with the ankles lifted and lowered.
fn rolling() -> Vec<f64> {
    let mut numbers = person();
    for (k, frame) in numbers.chunks_mut(27).enumerate() {
        let lift = 0.1 * (0.08 * k as f64).sin();
        for ankle in [3, 7] {
            frame[3 * ankle + 2] += lift.max(0.0);
            // The toe is up if the heel is down.
            frame[3 * (ankle + 1) + 2] += (-lift).max(0.0);
        }
    }
    numbers
}

#[test]
fn heels_of_jointed_feet_stay_over_the_ground() {
    let robot = humanoid();
    let map = BodyMap::from_json(MAP, "smpl").unwrap();
    for numbers in [person(), rolling()] {
        let capture = Capture::new(map.joints.clone(), &numbers, RATE).unwrap();
        let options = RetargetOptions::default();
        let fitted = Retargeting::new(&robot, &map, &capture, options).unwrap();
        for found in [fitted.per_frame().unwrap(), fitted.whole().unwrap()] {
            let deepest = max_penetration(&robot, &found);
            assert!(
                deepest < 3e-3,
                "{deepest} m, reported {}",
                found.report.ground_penetration
            );
            assert!(
                (deepest.max(0.0) - found.report.ground_penetration).abs() < 1e-9,
                "{deepest} m, reported {}",
                found.report.ground_penetration
            );
        }
    }
}
