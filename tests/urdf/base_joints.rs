//! Promise: a robot moves on the base that it is given, and on the floating, planar and spherical joints of its file;
//! everything else stays as it was.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{JointKind, Limits, ModelError};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::spatial::Vector3;
use nalgebra as na;

const TWO: &str = r#"<robot name="two">
  <link name="base"/><link name="arm"/><link name="finger"/><link name="other finger"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/><parent link="base"/><child link="arm"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="2" velocity="3" effort="4"/>
  </joint>
  <joint name="grip" type="prismatic">
    <origin xyz="0.5 0 0"/><parent link="arm"/><child link="finger"/><limit lower="0" upper="0.1"/>
  </joint>
  <joint name="other grip" type="prismatic">
    <origin xyz="0.5 0.1 0"/><parent link="arm"/><child link="other finger"/><limit lower="0" upper="0.3"/>
    <mimic joint="grip" multiplier="2"/>
  </joint>
</robot>"#;

fn frames(robot: &Robot, q: &[f64]) -> Vec<na::Isometry3<f64>> {
    let mut kinematics = ForwardKinematics::new(robot.model());
    let placed = kinematics.place(q).unwrap();
    placed.iter().map(|placement| (*placement).into()).collect()
}

#[test]
fn everything_stands_on_the_base() {
    let own = [0.7, 0.05, 0.1];
    let fixed = Robot::parse(TWO, "two.urdf").unwrap();
    let in_base = frames(&fixed, &own);
    let rotation = na::UnitQuaternion::from_euler_angles(0.3, -0.8, 1.9);
    let any = na::Isometry3::from_parts(na::Translation3::new(1.0, -2.0, 3.0), rotation);
    let turned = na::UnitQuaternion::from_euler_angles(0.0, 0.0, 0.6);
    let on_ground = na::Isometry3::from_parts(na::Translation3::new(4.0, 5.0, 0.0), turned);
    let along = na::Isometry3::translation(0.0, 0.0, -0.5);
    let [x, y, z, w] = rotation.coords.into();
    let axis = Vector3::new(0.0, 0.0, -2.0);
    let rail = BaseJoint::Sliding {
        axis,
        limits: Limits::new(-1.0, 1.0),
    };
    for (base, q, dof, world_from_base) in [
        (BaseJoint::Fixed, vec![], 0, na::Isometry3::identity()),
        (BaseJoint::FREE, vec![1.0, -2.0, 3.0, w, x, y, z], 6, any),
        (BaseJoint::PLANAR, vec![4.0, 5.0, 0.6], 3, on_ground),
        (rail, vec![0.5], 1, along),
    ] {
        let robot = fixed.clone().with_base_joint(base).unwrap();
        assert_eq!(robot.model().degrees_of_freedom(), dof + 3);
        let q = [&q[..], &own].concat();
        for (ours, theirs) in frames(&robot, &q).iter().zip(&in_base) {
            let theirs = world_from_base * theirs;
            assert!((ours.to_homogeneous() - theirs.to_homogeneous()).amax() < 1e-14);
        }
        // Mimics, speeds and links are still those of the same joints and frames.
        let mimic = robot.mimics()[0];
        let name =
            |joint: kinopt::model::JointId| robot.model().joints()[joint.index()].name.as_str();
        assert_eq!(
            (name(mimic.joint), name(mimic.master)),
            ("other grip", "grip")
        );
        let shoulder = robot.model().joint("shoulder").unwrap();
        assert_eq!(robot.velocity_limit(shoulder), Some(3.0));
        assert_eq!(robot.map().variables(), dof + 2);
        assert!(robot.link(robot.model().frame("arm").unwrap()).is_some());
    }
}

#[test]
fn a_base_that_leaves_nothing_is_refused() {
    let robot = Robot::parse(TWO, "two.urdf").unwrap();
    let room = [Limits::UNBOUNDED, Limits::new(1.0, -1.0), Limits::UNBOUNDED];
    let empty = robot.clone().with_base_joint(BaseJoint::Free { room });
    assert!(matches!(empty, Err(ModelError::BadLimits { joint, .. }) if joint == "root_joint/y"));
    let axis = Vector3::new(0.0, 0.0, 0.0);
    let limits = Limits::UNBOUNDED;
    assert!(
        robot
            .clone()
            .with_base_joint(BaseJoint::Sliding { axis, limits })
            .is_err()
    );
    let twice = robot
        .with_base_joint(BaseJoint::FREE)
        .unwrap()
        .with_base_joint(BaseJoint::FREE);
    assert!(matches!(twice, Err(ModelError::DuplicateName { .. })));
}

fn with_type(kind: &str) -> Robot {
    let text = TWO.replace("type=\"revolute\"", &format!("type=\"{kind}\""));
    Robot::parse(&text, "two.urdf").unwrap()
}

#[test]
fn floating_planar_and_spherical_joints_are_read_as_such() {
    let at = na::Isometry3::from_parts(
        na::Translation3::new(0.1, 0.2, 0.3),
        na::UnitQuaternion::from_euler_angles(0.4, 0.5, 0.6),
    );
    let turned = na::UnitQuaternion::from_euler_angles(0.7, -0.2, 0.1);
    let [x, y, z, w] = turned.coords.into();
    let about_y = na::UnitQuaternion::from_euler_angles(0.0, 0.9, 0.0);
    let moved = |x, y, z| na::Translation3::new(x, y, z);
    for (kind, q, joint_from_arm) in [
        (
            "floating",
            vec![1.0, 2.0, 3.0, w, x, y, z],
            moved(1.0, 2.0, 3.0) * turned,
        ),
        (
            "spherical",
            vec![w, x, y, z],
            na::Translation3::identity() * turned,
        ),
        // In the plane across its axis, y: along z and along x, then about y.
        (
            "planar",
            vec![0.3, 0.2, 0.9],
            moved(0.2, 0.0, 0.3) * about_y,
        ),
    ] {
        let robot = with_type(kind);
        let arm = robot.model().frame("arm").unwrap();
        let q = [&q[..], &[0.0, 0.0]].concat();
        let placed = frames(&robot, &q)[arm.index()].to_homogeneous();
        let off = (placed - (at * joint_from_arm).to_homogeneous()).amax();
        assert!(off < 1e-14, "{kind}: {off:e}");
    }
    let last = with_type("floating").model().joints()[3].clone();
    assert_eq!(
        (last.name.as_str(), last.kind),
        ("shoulder/rotation", JointKind::Ball)
    );
}
