//! Promise: a robot moves with a given base joint, and with floating, planar and spherical joints of its file.
//! Everything else is unchanged.

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{JointKind, Limits, ModelError};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::spatial::Vector3;
use nalgebra as na;
use support::fault_tables::ExpectedError;

const TWO_JOINT_ROBOT: &str = r#"<robot name="two">
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
fn base_joint_moves_everything() {
    let arm_q = [0.7, 0.05, 0.1];
    let fixed = Robot::parse(TWO_JOINT_ROBOT, "two.urdf").unwrap();
    let in_base = frames(&fixed, &arm_q);
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
        let q = [&q[..], &arm_q].concat();
        for (ours, theirs) in frames(&robot, &q).iter().zip(&in_base) {
            let theirs = world_from_base * theirs;
            assert!((ours.to_homogeneous() - theirs.to_homogeneous()).amax() < 1e-14);
        }
        // Mimic joints, velocity limits and links still refer to the same joints and frames.
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
fn invalid_base_joints_are_rejected() {
    let robot = Robot::parse(TWO_JOINT_ROBOT, "two.urdf").unwrap();
    let bounds = [Limits::UNBOUNDED, Limits::new(1.0, -1.0), Limits::UNBOUNDED];
    let empty = robot
        .clone()
        .with_base_joint(BaseJoint::Free { room: bounds });
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
        .with_base_joint(BaseJoint::PLANAR)
        .unwrap()
        .with_base_joint(BaseJoint::FREE);
    assert!(matches!(twice, Err(ModelError::DuplicateName { .. })));
}

#[test]
fn moves_as_a_whole_is_reported_for_every_base() {
    let robot = Robot::parse(TWO_JOINT_ROBOT, "two.urdf").unwrap();
    assert!(!robot.moves_as_a_whole());
    let range = Limits::new(-1.0, 1.0);
    for base in [
        BaseJoint::FREE,
        BaseJoint::PLANAR,
        BaseJoint::named("slide-x", [("x", range)]).unwrap(),
    ] {
        let based = robot.clone().with_base_joint(base).unwrap();
        assert!(based.moves_as_a_whole());
        assert_eq!(based.free_root().is_some(), base == BaseJoint::FREE);
    }
}

#[test]
fn free_base_may_be_bounded_but_not_repeated() {
    let range = Limits::new(-2.0, 2.0);
    let robot = Robot::parse(TWO_JOINT_ROBOT, "two.urdf").unwrap();
    let robot = robot
        .with_base_joint(BaseJoint::Free { room: [range; 3] })
        .unwrap();
    let bounds = [Limits::UNBOUNDED, Limits::new(0.5, 9.0), range];
    let again = robot
        .clone()
        .with_base_joint(BaseJoint::Free { room: bounds })
        .unwrap();
    let (before, after) = (robot.model(), again.model());
    assert_eq!(after.joints().len(), before.joints().len());
    let ranges: Vec<Limits> = after.limits().take(3).collect();
    assert_eq!(ranges, [range, Limits::new(0.5, 2.0), range]);
    assert_eq!(again.map().variables(), robot.map().variables());
    let fixed = robot.clone().with_base_joint(BaseJoint::Fixed).unwrap();
    assert_eq!(
        fixed.model().configuration_len(),
        before.configuration_len()
    );

    let none = BaseJoint::Free {
        room: [Limits::new(3.0, 4.0); 3],
    };
    let empty = robot.clone().with_base_joint(none);
    assert!(matches!(empty, Err(ModelError::BadLimits { joint, .. }) if joint == "root_joint/x"));
    for other in [
        BaseJoint::PLANAR,
        BaseJoint::named("slide-x", [("x", range)]).unwrap(),
    ] {
        robot
            .clone()
            .with_base_joint(other)
            .says("`root_joint/x` already moves all of `two` freely");
    }
}

#[test]
fn free_base_is_the_only_child_of_the_root() {
    // The floating joint is listed last; a revolute joint below it comes first.
    let text = |other: &str| {
        format!(
            r#"<robot name="late"><link name="world"/><link name="body"/><link name="arm"/>{other}
            <joint name="hinge" type="continuous"><parent link="body"/><child link="arm"/></joint>
            <joint name="float" type="floating"><parent link="world"/><child link="body"/></joint></robot>"#
        )
    };
    let robot = Robot::parse(&text(""), "late.urdf").unwrap();
    let based = robot.clone().with_base_joint(BaseJoint::FREE).unwrap();
    let q = [1.0, 2.0, 3.0, 0.6, 0.0, 0.0, 0.8, 0.25];
    let file_order = [&q[7..], &q[..7]].concat();
    for (ours, theirs) in frames(&based, &q).iter().zip(frames(&robot, &file_order)) {
        assert!((ours.to_homogeneous() - theirs.to_homogeneous()).amax() < 1e-15);
    }
    let other = r#"<link name="door"/><joint name="door" type="continuous"><parent link="world"/><child link="door"/></joint>"#;
    let robot = Robot::parse(&text(other), "late.urdf").unwrap();
    let based = robot.clone().with_base_joint(BaseJoint::FREE).unwrap();
    assert_eq!(
        based.model().configuration_len(),
        robot.model().configuration_len() + 7
    );
}

fn with_type(kind: &str) -> Robot {
    let text = TWO_JOINT_ROBOT.replace("type=\"revolute\"", &format!("type=\"{kind}\""));
    Robot::parse(&text, "two.urdf").unwrap()
}

#[test]
fn floating_planar_and_spherical_joints_are_read() {
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
        // In the plane normal to its axis y: along z and along x, then about y.
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
        let deviation = (placed - (at * joint_from_arm).to_homogeneous()).amax();
        assert!(deviation < 1e-14, "{kind}: {deviation:e}");
    }
    let last = with_type("floating").model().joints()[3].clone();
    assert_eq!(
        (last.name.as_str(), last.kind),
        ("shoulder/rotation", JointKind::Ball)
    );
}

/// Passive joints keep their names under any base.
#[test]
fn passive_joints_are_kept_under_any_base() {
    let rail = BaseJoint::Sliding {
        axis: Vector3::new(0.0, 1.0, 0.0),
        limits: Limits::new(-1.0, 1.0),
    };
    for base in [BaseJoint::Fixed, BaseJoint::FREE, BaseJoint::PLANAR, rail] {
        let robot = Robot::parse(TWO_JOINT_ROBOT, "two.urdf").unwrap();
        let robot = robot.with_passive_joints(["grip"]).unwrap();
        let robot = robot.with_base_joint(base).unwrap();
        let name = |id: &kinopt::model::JointId| robot.model().joints()[id.index()].name.as_str();
        let passive: Vec<&str> = robot.passive_joints().iter().map(name).collect();
        assert_eq!(passive, ["grip"], "{base:?}");
    }
}

/// Whatever other bounds the same axis has.
#[test]
fn nan_base_bounds_are_named() {
    let good = Limits::new(-1.0, 1.0);
    for invalid in [Limits::new(f64::NAN, 1.0), Limits::new(0.0, f64::NAN)] {
        for rooms in [
            vec![("z", invalid)],
            vec![("z", invalid), ("z", good)],
            vec![("z", good), ("z", invalid)],
        ] {
            let base = BaseJoint::named("free", rooms).unwrap();
            let robot = Robot::parse(TWO_JOINT_ROBOT, "two.urdf").unwrap();
            robot.with_base_joint(base).says("root_joint/z | NaN");
        }
    }
}

#[test]
fn repeated_base_bounds_intersect() {
    let rooms = [
        ("z", Limits::new(-1.0, 0.5)),
        ("z", Limits::new(-0.2, 2.0)),
        ("x", Limits::new(0.0, f64::INFINITY)),
    ];
    for order in [[0, 1, 2], [2, 1, 0]] {
        let base = BaseJoint::named("free", order.map(|k| rooms[k])).unwrap();
        let bounds = [
            Limits::new(0.0, f64::INFINITY),
            Limits::UNBOUNDED,
            Limits::new(-0.2, 0.5),
        ];
        assert_eq!(base, BaseJoint::Free { room: bounds });
    }
}
