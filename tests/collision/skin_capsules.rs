//! Promise: the capsules of a character are where its skin is, so that a hand in the belly is detected.

use kinopt::collision::{Checker, CollisionModel};
use kinopt::io::rig::Rig;
use kinopt::skeleton::{BallSkeleton, Cones, SkeletonRoot};
use kinopt::spatial::Vector3;
use kinopt::task::Point;
use kinopt::{Problem, Solver};

fn humanoid() -> (Rig, CollisionModel) {
    let rig = Rig::read("../models/humanoid/humanoid.json").unwrap();
    let (mesh, weights) = (rig.mesh.as_ref().unwrap(), rig.weights.as_ref().unwrap());
    let model = kinopt::motion::skin_capsules(&rig.skeleton, mesh, weights).unwrap();
    (rig, model)
}

#[test]
fn capsules_approximate_the_skin() {
    let (rig, model) = humanoid();
    let mut outside = 0;
    let positions = rig.mesh.as_ref().unwrap().positions();
    // The character is 1.75 m tall.
    for position in positions {
        let at = Vector3::new(position.x.into(), position.y.into(), position.z.into());
        let distance = model.objects().iter().map(|object| {
            let (bone, _) = rig.skeleton.bone_of_frame(object.link).unwrap();
            let rest = rig.skeleton.bones()[bone.index()].model_from_rest * object.link_from_shape;
            object.shape.signed_distance(rest.inverse().apply(at))
        });
        let distance = distance.fold(f64::INFINITY, f64::min);
        assert!(distance.abs() < 0.12, "{at:?}: {distance}");
        outside += usize::from(distance > 0.02);
    }
    assert!(
        10 * outside < positions.len(),
        "{outside} of {}",
        positions.len()
    );
}

/// Vertices with equal weights belong to the first bone.
#[test]
fn equally_weighted_skin_belongs_to_first_bone() {
    let (rig, _) = humanoid();
    let (mesh, bones) = (rig.mesh.as_ref().unwrap(), rig.skeleton.bones().len());
    let vertices = mesh.positions().len();
    let [first, second] = ["spine", "left_forearm"].map(|bone| rig.skeleton.bone(bone).unwrap());
    assert!(first.index() < second.index());
    let mut weights = kinopt::skinning::SkinWeights::builder(vertices, bones);
    for vertex in 0..vertices {
        weights.add(vertex, second.index(), 0.5).unwrap();
        weights.add(vertex, first.index(), 0.5).unwrap();
    }
    let weights = weights.build().unwrap();
    let model = kinopt::motion::skin_capsules(&rig.skeleton, mesh, &weights).unwrap();
    assert!(!model.objects().is_empty());
    for object in model.objects() {
        let (bone, _) = rig.skeleton.bone_of_frame(object.link).unwrap();
        assert_eq!(bone, first);
    }
}

#[test]
fn hand_in_the_belly_is_detected() {
    let (rig, model) = humanoid();
    let skeleton = &rig.skeleton;
    assert!(!model.is_checked("left_hand", "left_forearm").unwrap());
    let checker = Checker::new(model);
    let rest = skeleton.model().neutral();
    assert_eq!(checker.collisions(&rest).unwrap(), []);

    let spine = &skeleton.bones()[skeleton.bone("spine").unwrap().index()];
    let belly = (spine.rest_tail() + spine.rest_tip()) * 0.5;
    let tip = skeleton.tip(skeleton.bone("left_hand").unwrap());
    let reach = |target: Vector3<f64>| {
        let mut tasks = Problem::builder(skeleton.model());
        tasks.add(Point::new(tip, target.to_array()));
        // Only the arm moves.
        let arm = ["left_upper_arm", "left_forearm", "left_hand"];
        let joints = arm
            .map(|bone| skeleton.joints(skeleton.bone(bone).unwrap()))
            .concat();
        let map = kinopt::model::ParameterMap::builder(skeleton.model()).with_only(&joints, &rest);
        tasks.parameters(map.build().unwrap());
        let problem = tasks.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &rest).unwrap();
        assert!(solution.reached, "{solution:?}");
        checker.collisions(&solution.q).unwrap()
    };
    let reported = reach(belly);
    let trunk = ["spine", "pelvis", "chest", "upper_chest"];
    let through = |pairs: &[kinopt::collision::Collision]| {
        let pair = |pair: &&kinopt::collision::Collision| {
            let both = [pair.first.as_str(), pair.second.as_str()];
            both.contains(&"left_hand") && both.iter().any(|name| trunk.contains(name))
        };
        pairs.iter().find(pair).map(|pair| pair.depth())
    };
    assert!(through(&reported).unwrap() > 0.02, "{reported:?}");
    // 35 cm from the belly, on one side at least, the hand does not touch the trunk.
    let free = [-1.0, 1.0].map(|side| {
        let across = [Vector3::UNITS[1], Vector3::UNITS[2]];
        across.map(|axis| through(&reach(belly + axis * (0.35 * side))).is_none())
    });
    assert!(free.iter().flatten().any(|free| *free));
}

#[test]
fn ball_skeleton_has_equal_capsules() {
    let (rig, model) = humanoid();
    let balls = BallSkeleton::new(rig.skeleton.clone(), &Cones::new(), SkeletonRoot::FREE).unwrap();
    let (mesh, weights) = (rig.mesh.as_ref().unwrap(), rig.weights.as_ref().unwrap());
    let on_balls = kinopt::motion::ball_skin_capsules(&balls, mesh, weights).unwrap();
    assert_eq!(on_balls.objects().len(), model.objects().len());
    assert_eq!(on_balls.pairs(), model.pairs());
}
