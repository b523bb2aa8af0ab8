//! Promise: BVH files with the joint names of SOMA and of CMU are retargeted, in any unit of length, and with y or z up.

use std::fmt::Write;

use kinopt::motion::retarget::{BodyMap, Capture, RetargetOptions, Retargeting, UpAxis};
use support::arms::floating_nao;

/// Joint, its parent, and its offset in metres with y up, arms along x.
type Joint = (&'static str, &'static str, [f64; 3]);

/// Joints of NVIDIA's SOMA, whose `LeftLeg` is the thigh. Hands without fingers.
const SOMA: [Joint; 21] = [
    ("Root", "", [0.0, 0.0, 0.0]),
    ("Hips", "Root", [0.0, 1.0, 0.0]),
    ("Spine1", "Hips", [0.0, 0.1, 0.0]),
    ("Spine2", "Spine1", [0.0, 0.12, 0.0]),
    ("Chest", "Spine2", [0.0, 0.13, 0.0]),
    ("Neck1", "Chest", [0.0, 0.2, 0.0]),
    ("Head", "Neck1", [0.0, 0.1, 0.02]),
    ("LeftShoulder", "Chest", [0.05, 0.15, 0.0]),
    ("LeftArm", "LeftShoulder", [0.13, 0.0, 0.0]),
    ("LeftForeArm", "LeftArm", [0.28, 0.0, 0.0]),
    ("LeftHand", "LeftForeArm", [0.25, 0.0, 0.0]),
    ("RightShoulder", "Chest", [-0.05, 0.15, 0.0]),
    ("RightArm", "RightShoulder", [-0.13, 0.0, 0.0]),
    ("RightForeArm", "RightArm", [-0.28, 0.0, 0.0]),
    ("RightHand", "RightForeArm", [-0.25, 0.0, 0.0]),
    ("LeftLeg", "Hips", [0.1, -0.05, 0.0]),
    ("LeftShin", "LeftLeg", [0.0, -0.43, 0.0]),
    ("LeftFoot", "LeftShin", [0.0, -0.42, 0.0]),
    ("RightLeg", "Hips", [-0.1, -0.05, 0.0]),
    ("RightShin", "RightLeg", [0.0, -0.43, 0.0]),
    ("RightFoot", "RightShin", [0.0, -0.42, 0.0]),
];

/// Joints of the CMU data base, as its BVH conversions name them. Hands without fingers.
const CMU: [Joint; 25] = [
    ("Hips", "", [0.0, 1.0, 0.0]),
    ("LHipJoint", "Hips", [0.0, 0.0, 0.0]),
    ("LeftUpLeg", "LHipJoint", [0.1, -0.05, 0.0]),
    ("LeftLeg", "LeftUpLeg", [0.0, -0.43, 0.0]),
    ("LeftFoot", "LeftLeg", [0.0, -0.42, 0.0]),
    ("LeftToeBase", "LeftFoot", [0.0, -0.07, 0.14]),
    ("RHipJoint", "Hips", [0.0, 0.0, 0.0]),
    ("RightUpLeg", "RHipJoint", [-0.1, -0.05, 0.0]),
    ("RightLeg", "RightUpLeg", [0.0, -0.43, 0.0]),
    ("RightFoot", "RightLeg", [0.0, -0.42, 0.0]),
    ("RightToeBase", "RightFoot", [0.0, -0.07, 0.14]),
    ("LowerBack", "Hips", [0.0, 0.0, 0.0]),
    ("Spine", "LowerBack", [0.0, 0.12, 0.0]),
    ("Spine1", "Spine", [0.0, 0.13, 0.0]),
    ("Neck", "Spine1", [0.0, 0.2, 0.0]),
    ("Neck1", "Neck", [0.0, 0.05, 0.0]),
    ("Head", "Neck1", [0.0, 0.05, 0.0]),
    ("LeftShoulder", "Spine1", [0.0, 0.15, 0.0]),
    ("LeftArm", "LeftShoulder", [0.18, 0.0, 0.0]),
    ("LeftForeArm", "LeftArm", [0.28, 0.0, 0.0]),
    ("LeftHand", "LeftForeArm", [0.25, 0.0, 0.0]),
    ("RightShoulder", "Spine1", [0.0, 0.15, 0.0]),
    ("RightArm", "RightShoulder", [-0.18, 0.0, 0.0]),
    ("RightForeArm", "RightArm", [-0.28, 0.0, 0.0]),
    ("RightHand", "RightForeArm", [-0.25, 0.0, 0.0]),
];

/// Axes and unit of a file.
#[derive(Clone, Copy)]
struct Convention {
    up: UpAxis,
    units_per_metre: f64,
}

impl Convention {
    fn vector(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let axes = match self.up {
            UpAxis::Y => [x, y, z],
            UpAxis::Z => [x, -z, y],
        };
        axes.map(|length| length * self.units_per_metre)
    }

    /// Rotation by an angle about x, in degrees, or by an angle about the axis that points forward.
    fn channels(self) -> &'static str {
        match self.up {
            UpAxis::Y => "Xrotation Zrotation Yrotation",
            UpAxis::Z => "Xrotation Yrotation Zrotation",
        }
    }
}

fn write_joint(joints: &[Joint], joint: &Joint, convention: Convention, text: &mut String) {
    let (name, parent, offset) = *joint;
    let kind = if parent.is_empty() { "ROOT" } else { "JOINT" };
    let [x, y, z] = convention.vector(offset);
    let positions = if parent.is_empty() {
        "6 Xposition Yposition Zposition"
    } else {
        "3"
    };
    let channels = convention.channels();
    write!(
        text,
        "{kind} {name} {{\nOFFSET {x} {y} {z}\nCHANNELS {positions} {channels}\n"
    )
    .unwrap();
    let children: Vec<&Joint> = joints
        .iter()
        .filter(|(_, parent, _)| *parent == name)
        .collect();
    for child in &children {
        write_joint(joints, child, convention, text);
    }
    if children.is_empty() {
        let [x, y, z] = convention.vector([0.0, 0.0, 0.1]);
        write!(text, "End Site {{\nOFFSET {x} {y} {z}\n}}\n").unwrap();
    }
    text.push_str("}\n");
}

/// Joints in the order of a file.
fn file_order(joints: &[Joint], name: &str, order: &mut Vec<String>) {
    order.push(name.to_owned());
    for (child, ..) in joints.iter().filter(|(_, parent, _)| *parent == name) {
        file_order(joints, child, order);
    }
}

/// A person that lowers the arms and bends the knees a little.
fn bvh(joints: &[Joint], convention: Convention) -> String {
    let mut text = "HIERARCHY\n".to_owned();
    write_joint(joints, &joints[0], convention, &mut text);
    let mut order = Vec::new();
    file_order(joints, joints[0].0, &mut order);
    let frames = 31;
    write!(text, "MOTION\nFrames: {frames}\nFrame Time: 0.0333333\n").unwrap();
    let knees = ["LeftShin", "RightShin"];
    let has_shins = order.iter().any(|name| name == "LeftShin");
    for frame in 0..frames {
        let bend = 20.0 * f64::from(frame) / 30.0;
        let root = convention.vector(joints[0].2);
        write!(text, "{} {} {}", root[0], root[1], root[2]).unwrap();
        for name in &order {
            let is_knee = match has_shins {
                true => knees.contains(&name.as_str()),
                false => ["LeftLeg", "RightLeg"].contains(&name.as_str()),
            };
            // About the axis that points forward, arms hang at 75°.
            let side = match (name.as_str(), convention.up) {
                ("LeftArm", UpAxis::Y) | ("RightArm", UpAxis::Z) => -75.0,
                ("RightArm", UpAxis::Y) | ("LeftArm", UpAxis::Z) => 75.0,
                _ => 0.0,
            };
            let knee = if is_knee { bend } else { 0.0 };
            write!(text, " {knee} {side} 0").unwrap();
        }
        text.push('\n');
    }
    text
}

#[test]
fn soma_and_cmu_files_are_retargeted_alike() {
    let robot = floating_nao();
    for (joints, thigh, skeleton) in [
        (&SOMA[..], "LeftLeg", None),
        (&CMU[..], "LeftUpLeg", Some("cmu")),
    ] {
        let mut expected: Option<Vec<f64>> = None;
        for (up, units_per_metre) in [(UpAxis::Y, 1.0), (UpAxis::Y, 100.0), (UpAxis::Z, 39.37)] {
            let text = bvh(
                joints,
                Convention {
                    up,
                    units_per_metre,
                },
            );
            let read = kinopt::io::bvh::from_bytes(text.as_bytes(), "person.bvh").unwrap();
            let capture = Capture::of_clip(&read.armature, &read.clip, 30.0).unwrap();
            assert_eq!(capture.up_axis(), Some(up), "{thigh}");
            let guess = BodyMap::guess(&capture, robot.model()).unwrap();
            assert_eq!(guess.skeleton, skeleton);
            let drive = |joint: &str| {
                let drives = guess.map.drives.iter();
                drives
                    .filter(|drive| drive.joint == joint)
                    .map(|drive| drive.frame.clone())
                    .next()
            };
            assert_eq!(drive("Hips").as_deref(), Some("torso"));
            assert!(
                drive(thigh).is_some_and(|frame| frame.contains("thigh") || frame.contains("hip")),
                "{thigh}"
            );
            assert!(drive("LeftHand").is_some() && drive("RightFoot").is_some());
            let options = RetargetOptions::default().with_up(up);
            let retargeting = Retargeting::new(&robot, &guess.map, &capture, options).unwrap();
            let found = retargeting.per_frame().unwrap();
            let hanging = found
                .report
                .score
                .limbs
                .iter()
                .find(|limb| limb.limb == "left_upper_arm");
            assert!(hanging.unwrap().angle.mean < 25.0, "{hanging:?}");
            let expected = expected.get_or_insert_with(|| found.q.clone());
            for (a, b) in expected.iter().zip(&found.q) {
                assert!((a - b).abs() < 1e-2, "{up:?} {units_per_metre}: {a} {b}");
            }
        }
    }
}
