//! Promise: a chain with base and tip exchanged is the same chain. A start outside the limits counts from its
//! projection.

use kinopt::arm::Arm;
use support::arms::{panda, robot};
use support::random::Random;

#[test]
fn reversed_chain_has_the_inverse_pose() {
    for (name, base, tip) in [
        ("adept_cobra_s600", "base", "flange"),
        ("aldebaran_nao", "left_sole", "right_sole"),
        ("rethink_baxter", "left_tool", "right_tool"),
    ] {
        let robot = robot(name);
        let build = |base, tip| {
            let builder = Arm::builder(&robot, base, tip);
            builder.with_atlas(false).build().unwrap()
        };
        let [forward_arm, backward_arm] = [build(base, tip), build(tip, base)];
        let mut random = Random::split_mix(51);
        for _ in 0..5 {
            let q = random.configuration(&forward_arm);
            let named = |joint: &str| forward_arm.joints().position(|name| name == joint).unwrap();
            let same: Vec<f64> = backward_arm.joints().map(|joint| q[named(joint)]).collect();
            let forth = forward_arm.base_from_tool(&q).unwrap();
            let around = forth * backward_arm.base_from_tool(&same).unwrap();
            assert!(around.translation.norm() < 1e-12, "{name}");
            assert!(
                (around.rotation.x.x + around.rotation.y.y - 2.0).abs() < 1e-12,
                "{name}"
            );
        }
    }
}

#[test]
fn move_limits_apply_from_the_projected_start() {
    let (robot, base, tip) = panda();
    let builder = Arm::builder(&robot, base, tip).with_atlas(false);
    let arm = builder.with_max_move(&[0.3; 7]).build().unwrap();
    let limits: Vec<_> = arm.limits().collect();
    let start: Vec<f64> = limits.iter().map(|l| l.upper + 0.2).collect();
    let goal: Vec<f64> = limits.iter().map(|l| l.upper - 0.25).collect();
    let target = arm.base_from_tool(&goal).unwrap();
    let solution = arm.solve(target, &start).unwrap();
    assert!(solution.reached, "{}", solution.explain());
    let moved = solution.q.iter().zip(&limits).map(|(q, l)| l.upper - q);
    assert!(moved.into_iter().all(|moved| (0.0..=0.3).contains(&moved)));
}

/// Joints outside the arm keep their values, locked or not.
#[test]
fn configuration_writes_only_the_arms_joints() {
    let nao = robot("aldebaran_nao");
    let model = nao.model();
    let nao_arm = Arm::new(&nao, "torso", "left_hand").unwrap();
    let mut other_joints = model
        .moving_joints()
        .iter()
        .filter(|id| !nao_arm.joint_ids().contains(id));
    let other = *other_joints.next().unwrap();
    let held = nao_arm.joint_ids()[1];
    let name = |id: kinopt::model::JointId| model.joints()[id.index()].name.as_str();
    let value = |id: kinopt::model::JointId| {
        let coordinate = model.coordinate(id).unwrap();
        let limits = model.limits().nth(coordinate).unwrap();
        (coordinate, 0.5 * (limits.lower + limits.upper))
    };
    let builder = Arm::builder(&nao, "torso", "left_hand");
    let builder = builder.with_locked(name(other), value(other).1);
    let builder = builder.with_locked(name(held), value(held).1);
    let arm = builder.with_atlas(false).build().unwrap();
    let mut q = vec![77.0; model.degrees_of_freedom()];
    arm.configuration(&vec![0.01; arm.joint_count()], &mut q)
        .unwrap();
    assert_eq!(q[value(other).0], 77.0);
    assert_eq!(q[value(held).0], value(held).1);
    let written = q.iter().filter(|value| **value != 77.0).count();
    assert!(written > arm.joint_count() && written < q.len());
}
