//! Promise: a symmetric skeleton with symmetric targets settles symmetrically, within and beyond reach, unless
//! asymmetry brings it closer.

use kinopt::ik::Drag;
use kinopt::io::rig::Rig;
use kinopt::problem::{Problem, TaskId};
use kinopt::skeleton::Skeleton;
use kinopt::spatial::Vector3;
use kinopt::task::{Point, Quantity};
use support::bones::humanoid;

/// Largest allowed difference of the two sides, metres, from the tolerance and flat directions.
const SYMMETRY_TOLERANCE: f64 = 1e-3;

/// All tips pinned, and the tasks of the two hands.
fn problem(rig: &Rig, start: &[f64]) -> (Problem, [TaskId<Point>; 2]) {
    let skeleton = &rig.skeleton;
    let pose = skeleton.pose(start).unwrap();
    let mut builder = Problem::builder(skeleton.model());
    builder.tolerance(Quantity::Metres, 1e-8);
    let hands = ["left_hand", "right_hand"].map(|name| skeleton.bone(name).unwrap());
    let tasks = hands.map(|hand| builder.add(Point::new(skeleton.tip(hand), [0.0; 3])));
    for &held in rig.constrained.iter().filter(|held| !hands.contains(held)) {
        builder.add(Point::new(
            skeleton.tip(held),
            pose.tip(skeleton, held).unwrap(),
        ));
    }
    (builder.build().unwrap(), tasks)
}

fn mirrored(p: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(p.x, -p.y, p.z)
}

/// Largest distance of the left side from the mirrored right side.
fn lopsided(skeleton: &Skeleton, q: &[f64]) -> f64 {
    let pose = skeleton.pose(q).unwrap();
    let bones = skeleton.bones().iter().map(|bone| {
        let other = match bone.name.strip_prefix("left_") {
            Some(rest) => format!("right_{rest}"),
            None => bone.name.clone(),
        };
        if bone.name.starts_with("right_") {
            return 0.0;
        }
        let [bone_id, mirror_bone] =
            [bone.name.as_str(), &other].map(|name| skeleton.bone(name).unwrap());
        let ends = [
            pose.tail(bone_id).unwrap(),
            pose.tip(skeleton, bone_id).unwrap(),
        ];
        let others = [
            pose.tail(mirror_bone).unwrap(),
            pose.tip(skeleton, mirror_bone).unwrap(),
        ];
        let apart = ends
            .into_iter()
            .zip(others)
            .map(|(a, b)| (a - mirrored(b)).norm());
        apart.fold(0.0, f64::max)
    });
    bones.fold(0.0, f64::max)
}

#[test]
fn symmetric_hand_targets_settle_symmetrically() {
    let rig = humanoid();
    let skeleton = &rig.skeleton;
    let rest = skeleton.model().neutral();
    assert!(lopsided(skeleton, &rest) < 1e-6);
    let (problem, hands) = problem(&rig, &rest);
    let mut body = Drag::new(problem, &rest).unwrap();
    for (target, within) in [
        ([0.3, 0.4, 1.3], true),
        // A case in which a search from another start gives 12 cm of asymmetry.
        ([0.35, 0.45, 1.5], true),
        ([0.1, 0.6, 1.2], true),
        // Above and sideways, farther than the arms reach.
        ([0.3, 0.5, 3.0], false),
        ([0.2, 3.0, 1.4], false),
    ] {
        let target = Vector3::from(target);
        for (hand, target) in hands.into_iter().zip([target, mirrored(target)]) {
            body.target_mut(hand).unwrap().set_target(target);
        }
        body.set_configuration(&rest).unwrap();
        let settled = body.settle(200);
        assert_eq!(settled.reached, within, "{target:?}: {}", settled.explain());
        let off = lopsided(skeleton, &settled.q);
        assert!(off < SYMMETRY_TOLERANCE, "{target:?}: {off}");
    }
}
