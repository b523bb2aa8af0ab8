//! Arms for tests, and forward kinematics by nalgebra, joint by joint from the model's numbers.

use kinopt::arm::Arm;
use kinopt::model::{JointKind, Limits, Model};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::spatial::Placement;
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

use crate::random::Random;

impl Random {
    /// Random configuration within the limits; joints without limits are within half a turn of zero.
    pub fn configuration(&mut self, arm: &Arm) -> Vec<f64> {
        let pi = std::f64::consts::PI;
        let ends: Vec<_> = arm
            .limits()
            .map(|l| {
                let end = |v: f64, other: f64| if v.is_finite() { v } else { other };
                (end(l.lower, -pi), end(l.upper, pi))
            })
            .collect();
        ends.iter()
            .map(|(l, u)| l + self.unit() * (u - l))
            .collect()
    }
}

fn file_of(name: &str) -> String {
    let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models");
    format!("{models}/{name}.urdf")
}

pub fn robot(name: &str) -> Robot {
    Robot::read(file_of(name)).unwrap()
}

/// The shipped robot `name` with the limits of one revolute joint removed.
pub fn with_endless_joint(name: &str, joint: &str) -> Robot {
    let text = std::fs::read_to_string(file_of(name)).unwrap();
    let [limited, endless] =
        ["revolute", "continuous"].map(|kind| format!(r#"<joint name="{joint}" type="{kind}">"#));
    assert!(text.contains(&limited), "{joint}");
    Robot::parse(&text.replace(&limited, &endless), "endless.urdf").unwrap()
}

/// Placement world_from_frame at a configuration of the whole model.
pub fn frame(model: &Model, q: &[f64], name: &str) -> Isometry3<f64> {
    let mut world: Vec<Isometry3<f64>> = Vec::new();
    for id in model.joint_ids() {
        let joint = &model.joints()[id.index()];
        let value = model.coordinate(id).map_or(0.0, |c| q[c]);
        let axis = Vector3::from(joint.axis);
        let motion = match joint.kind {
            JointKind::Fixed => Isometry3::identity(),
            JointKind::Prismatic => {
                Isometry3::from_parts(Translation3::from(axis * value), UnitQuaternion::identity())
            }
            _ => Isometry3::from_parts(
                Translation3::identity(),
                UnitQuaternion::from_axis_angle(&Unit::new_normalize(axis), value),
            ),
        };
        let parent = joint
            .parent
            .map_or(Isometry3::identity(), |p| world[p.index()]);
        world.push(parent * Isometry3::from(&joint.parent_from_joint) * motion);
    }
    let frame = &model.frames()[model.frame(name).unwrap().index()];
    let joint = frame
        .joint
        .map_or(Isometry3::identity(), |j| world[j.index()]);
    joint * Isometry3::from(&frame.joint_from_frame)
}

/// Placement base_from_tip by forward kinematics of the whole model; joints outside the arm are at neutral.
pub fn base_from_tip(model: &Model, arm: &Arm, q: &[f64], base: &str, tip: &str) -> Isometry3<f64> {
    let mut all = model.neutral();
    arm.configuration(q, &mut all).unwrap();
    frame(model, &all, base).inverse() * frame(model, &all, tip)
}

/// Distance (m) and angle (rad) between two placements.
pub fn apart(a: &Isometry3<f64>, b: &Isometry3<f64>) -> (f64, f64) {
    let distance = (a.translation.vector - b.translation.vector).norm();
    (distance, a.rotation.angle_to(&b.rotation))
}

/// True if every value is exactly within its limits.
pub fn within_limits(arm: &Arm, q: &[f64]) -> bool {
    arm.limits()
        .zip(q)
        .all(|(l, v)| l.lower <= *v && *v <= l.upper)
}

pub fn placement(isometry: &Isometry3<f64>) -> Placement<f64> {
    Placement::from(isometry)
}

pub fn panda() -> (Robot, &'static str, &'static str) {
    (robot("franka_panda"), "base", "flange")
}

pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b) * (a - b))
        .sum::<f64>()
        .sqrt()
}

/// Planar arm of two links of 1 m with a rotating hand; the shoulder has the given limits.
pub fn planar_with_hand(shoulder: Limits) -> Arm {
    let mut builder = Model::builder("planar");
    let identity = Placement::identity();
    let [x, _, z] = kinopt::spatial::Vector3::UNITS;
    let link = Placement::translation(x);
    let limits = Limits::new(-3.0, 3.0);
    builder.frame("base", None, identity);
    let shoulder = builder.revolute("shoulder", None, identity, z, shoulder);
    let elbow = builder.revolute("elbow", Some(shoulder), link, z, limits);
    let hand = builder.revolute("hand", Some(elbow), link, z, limits);
    builder.frame("tool", Some(hand), identity);
    let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
    let arm = Arm::builder(&robot, "base", "tool").with_atlas(false);
    arm.build().unwrap()
}

/// The shipped NAO with a free base.
pub fn floating_nao() -> Robot {
    let nao = robot("aldebaran_nao");
    nao.with_base_joint(BaseJoint::FREE).unwrap()
}
