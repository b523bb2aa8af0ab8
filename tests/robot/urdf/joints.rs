//! Promise: joints are read as specified where other readers differ. Fixed joints combine in order, axes of any length
//! move by the joint value, and limits and kinds are those of the file.

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{JointKind, Limits};
use kinopt::robot::Robot;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

type Pose = Isometry3<f64>;

/// Robot of consecutive links, from the joints' bodies.
fn chain(joints: &[(&str, &str)]) -> Robot {
    let mut text = String::from("<robot name='chain' version='1.1'><link name='l0'/>");
    for (i, (kind, body)) in joints.iter().enumerate() {
        let next = i + 1;
        text += &format!(
            "<link name='l{next}'/><joint name='j{next}' type='{kind}'><parent link='l{i}'/>\
             <child link='l{next}'/>{body}</joint>"
        );
    }
    Robot::parse(&(text + "</robot>"), "chain.urdf").unwrap()
}

/// Pose of the last link.
fn tip(robot: &Robot, q: &[f64]) -> Pose {
    let last = robot.model().frame_ids().last().unwrap();
    let mut kinematics = ForwardKinematics::under(robot.model(), robot.map(), &[last]).unwrap();
    (&kinematics.place(q).unwrap()[0]).into()
}

/// Fixed-axis roll, pitch and yaw, by three rotations about fixed axes.
fn origin(xyz: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Pose {
    let about = |axis: Vector3<f64>, angle: f64| UnitQuaternion::from_scaled_axis(axis * angle);
    let turned = about(Vector3::z(), yaw) * about(Vector3::y(), pitch) * about(Vector3::x(), roll);
    Pose::from_parts(Translation3::from(Vector3::from(xyz)), turned)
}

fn assert_same(actual: &Pose, expected: &Pose) {
    let deviation = (actual.to_homogeneous() - expected.to_homogeneous()).amax();
    assert!(
        deviation < 1e-14,
        "off by {deviation:e}\n{actual}\n{expected}"
    );
}

const LIMIT: &str = "<limit lower='-2' upper='2' velocity='1'/>";

#[test]
fn rotated_fixed_joints_combine_in_order() {
    let turn = format!("<origin xyz='0.1 0 0.2' rpy='0 0 0.3'/><axis xyz='0 0 1'/>{LIMIT}");
    let slide = format!("<origin xyz='0 0.3 0'/><axis xyz='0 1 0'/>{LIMIT}");
    let robot = chain(&[
        ("revolute", &turn),
        ("fixed", "<origin xyz='0.2 -0.1 0.4' rpy='0.4 -1.3 2.2'/>"),
        ("fixed", "<origin xyz='-0.3 0.5 0.1' rpy='-2 0.7 0.1'/>"),
        ("prismatic", &slide),
        ("fixed", "<origin xyz='0.6 0.1 0' rpy='1 1 1'/>"),
    ]);
    let q = [0.8, -0.35];
    let expected = origin([0.1, 0.0, 0.2], [0.0, 0.0, 0.3])
        * origin([0.0; 3], [0.0, 0.0, q[0]])
        * origin([0.2, -0.1, 0.4], [0.4, -1.3, 2.2])
        * origin([-0.3, 0.5, 0.1], [-2.0, 0.7, 0.1])
        * origin([0.0, 0.3 + q[1], 0.0], [0.0; 3])
        * origin([0.6, 0.1, 0.0], [1.0, 1.0, 1.0]);
    assert_same(&tip(&robot, &q), &expected);
}

#[test]
fn axis_of_any_length_moves_by_the_value() {
    for kind in ["revolute", "prismatic", "continuous"] {
        let unit = chain(&[(kind, &format!("<axis xyz='0.6 0 -0.8'/>{LIMIT}"))]);
        for axis in [
            "3 0 -4",
            "0.003 0 -0.004",
            "3e-200 0 -4e-200",
            "3e200 0 -4e200",
        ] {
            let long = chain(&[(kind, &format!("<axis xyz='{axis}'/>{LIMIT}"))]);
            assert_same(&tip(&long, &[1.25]), &tip(&unit, &[1.25]));
        }
    }
}

#[test]
fn missing_axis_is_x() {
    let slide = chain(&[("prismatic", LIMIT)]);
    assert_same(&tip(&slide, &[0.7]), &origin([0.7, 0.0, 0.0], [0.0; 3]));
    let turn = chain(&[("revolute", LIMIT)]);
    assert_same(&tip(&turn, &[0.7]), &origin([0.0; 3], [0.7, 0.0, 0.0]));
}

#[test]
fn kinds_and_limits_are_those_of_the_file() {
    let robot = chain(&[
        ("revolute", "<limit lower='-0.25' upper='7' velocity='1'/>"),
        ("continuous", "<limit velocity='1' effort='2'/>"),
        ("prismatic", "<limit lower='-5' upper='-4' velocity='1'/>"),
        ("continuous", ""),
        ("revolute", "<limit lower='0' upper='0.5' velocity='1'/>"),
        ("fixed", "<axis xyz='0 0 0'/>"),
    ]);
    let model = robot.model();
    let kinds: Vec<JointKind> = model.joints().iter().map(|joint| joint.kind).collect();
    let (turn, free, slide) = (
        JointKind::Revolute,
        JointKind::Continuous,
        JointKind::Prismatic,
    );
    assert_eq!(kinds, [turn, free, slide, free, turn, JointKind::Fixed]);
    let limits: Vec<Limits> = model.limits().collect();
    assert_eq!(
        limits,
        [
            Limits::new(-0.25, 7.0),
            Limits::UNBOUNDED,
            Limits::new(-5.0, -4.0),
            Limits::UNBOUNDED,
            Limits::new(0.0, 0.5),
        ]
    );
}

#[test]
fn prismatic_values_are_metres_and_never_wrapped() {
    let robot = chain(&[("prismatic", "<limit lower='-50' upper='50' velocity='1'/>")]);
    assert_same(&tip(&robot, &[31.4]), &origin([31.4, 0.0, 0.0], [0.0; 3]));
}

#[test]
fn quaternion_origin_is_exact_at_90_degrees_pitch() {
    // urdf-rs rounds every pitch within 4.5 mrad of 90° to 90°.
    for pitch in [std::f64::consts::FRAC_PI_2, 1.569, -1.5700, 0.3] {
        let expected = origin([0.0; 3], [0.2, pitch, -0.9]);
        let c = expected.rotation.coords * 3.0;
        let robot = chain(&[(
            "fixed",
            &format!("<origin quat_xyzw='{} {} {} {}'/>", c.x, c.y, c.z, c.w),
        )]);
        assert_same(&tip(&robot, &[]), &expected);
    }
}

#[test]
fn quarter_turns_have_exact_zeros() {
    let robot = Robot::read("../models/universal_ur5e.urdf").unwrap();
    for joint in robot.model().joints() {
        let rotation = joint.parent_from_joint.rotation;
        for entry in [rotation.x, rotation.y, rotation.z].map(|column| column.to_array()) {
            assert!(
                entry.iter().all(|e| [-1.0, 0.0, 1.0].contains(e)),
                "{entry:?}"
            );
        }
    }
}

#[test]
fn fixed_joint_with_mimic_is_fixed() {
    let mimic = "<mimic joint='j1' multiplier='2'/>";
    let robot = chain(&[("revolute", LIMIT), ("fixed", mimic)]);
    assert!(robot.mimics().is_empty());
    assert_eq!(robot.model().degrees_of_freedom(), 1);
    assert_same(&tip(&robot, &[0.7]), &origin([0.0; 3], [0.7, 0.0, 0.0]));
}

#[test]
fn byte_order_mark_is_accepted() {
    let text = std::fs::read_to_string("../models/kuka_iiwa14.urdf").unwrap();
    let robot = Robot::parse(&format!("\u{feff}{text}"), "iiwa").unwrap();
    assert_eq!(robot.model().degrees_of_freedom(), 7);
}
