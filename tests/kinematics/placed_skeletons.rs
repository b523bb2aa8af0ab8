//! Promise: a skeleton's root may have any placement in a scene. Relative rotations, skinning and inverse kinematics
//! are unchanged, also below any joint.

use kinopt::ik::Restarts;
use kinopt::model::ModelError;
use kinopt::problem::Problem;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::Point;
use kinopt::{Skeleton, Solver};
use nalgebra as na;
use support::bones::RandomRig;
use support::random::Random;
use support::trees::configuration_of;
use support::{Rigid, apart, placement, rigid};

fn random_rigid(random: &mut Random) -> Rigid {
    rigid(random.rotation(), random.vector(3.0))
}

#[test]
fn skinning_transforms_include_the_root() {
    for seed in 0..10 {
        let rig = RandomRig::new(seed);
        let mut random = Random::new(seed);
        let root = random_rigid(&mut random);
        let q = configuration_of(rig.skeleton.model(), &mut random);
        // The recursion with T_root = P in place of the identity.
        let expected: Vec<Rigid> = rig.transforms(&q).iter().map(|t| root * t).collect();
        let in_scene = placement(&root);
        let placed = rig.skeleton.placed(in_scene).unwrap();
        // By placing the pose, and by placing the skeleton with an unchanged mesh.
        let poses = [
            rig.skeleton.pose(&q).unwrap().placed(in_scene),
            placed.pose(&q).unwrap(),
        ];
        for pose in &poses {
            let ours: Vec<_> = pose.skinning_transforms(&rig.skeleton).collect();
            assert_eq!(ours.len(), expected.len());
            for (ours, theirs) in ours.iter().zip(&expected) {
                assert!(apart(ours, theirs) < 1e-12);
            }
        }
        for bone in rig.skeleton.bone_ids() {
            let tips = [
                poses[0].tip(&rig.skeleton, bone).unwrap(),
                poses[1].tip(&placed, bone).unwrap(),
            ];
            let carried = root * na::Point3::from(rig.tip(&rig.transforms(&q), bone));
            for tip in tips {
                assert!((na::Vector3::from(tip) - carried.coords).amax() < 1e-12);
            }
        }
    }
}

#[test]
fn joint_motion_is_relative_to_its_parent() {
    // T_parent⁻¹ T_i of the knee does not change when the hip moves.
    let rig = RandomRig::new(4);
    let mut random = Random::new(4);
    let q = configuration_of(rig.skeleton.model(), &mut random);
    let relative = |q: &[f64], bone: usize, parent: usize| {
        let pose = rig.skeleton.pose(q).unwrap();
        let all: Vec<Placement<f64>> = pose.skinning_transforms(&rig.skeleton).collect();
        all[parent].inverse() * all[bone]
    };
    for (bone, parent) in rig.parents.iter().enumerate() {
        let Some(parent) = *parent else { continue };
        let mut moved = q.clone();
        for angle in &mut moved[3 * parent..3 * parent + 3] {
            *angle += random.within(-1.0, 1.0);
        }
        let (before, after) = (relative(&q, bone, parent), relative(&moved, bone, parent));
        let offset = before.inverse() * after;
        assert!(apart(&offset, &Rigid::identity()) < 1e-13);
    }
}

#[test]
fn placed_skeleton_solves_equally() {
    for seed in 0..6 {
        let rig = RandomRig::new(seed);
        let mut random = Random::new(seed);
        let root = random_rigid(&mut random);
        let placed = rig.skeleton.placed(placement(&root)).unwrap();
        let start = configuration_of(rig.skeleton.model(), &mut random);
        let goal = configuration_of(rig.skeleton.model(), &mut random);
        let transforms = rig.transforms(&goal);
        let solve = |skeleton: &Skeleton, from_model: &Rigid| {
            let mut builder = Problem::builder(skeleton.model());
            for &tip in &rig.tips {
                let target = from_model * na::Point3::from(rig.tip(&transforms, tip));
                builder.add(Point::new(skeleton.tip(tip), target.coords));
            }
            let solver = Solver::default().with_restarts(Restarts::none());
            solver
                .solve_once(&builder.build().unwrap(), &start)
                .unwrap()
        };
        let placed_solution = solve(&placed, &root);
        let original_solution = solve(&rig.skeleton, &Rigid::identity());
        assert_eq!(
            original_solution.reached, placed_solution.reached,
            "rig {seed}"
        );
        assert!(
            (original_solution.cost - placed_solution.cost).abs()
                <= 1e-9 * (1.0 + original_solution.cost),
            "rig {seed}"
        );
        // Checked by the recursion: positions of the tips relative to the root.
        let posed = rig.transforms(&placed_solution.q);
        if placed_solution.reached {
            for &tip in &rig.tips {
                let missed = rig.tip(&posed, tip) - rig.tip(&transforms, tip);
                assert!(missed.norm() < 1e-5, "rig {seed}: {}", missed.norm());
            }
        }
    }
}

#[test]
fn non_rigid_root_is_rejected() {
    let rig = RandomRig::new(5);
    let mut stretched = Placement::translation(Vector3::new(1.0, 0.0, 0.0));
    stretched.rotation = Matrix3::from_columns(
        Vector3::new(2.0, 0.0, 0.0),
        Vector3::new(0.0, 1.0, 0.0),
        Vector3::new(0.0, 0.0, 1.0),
    );
    let error = rig.skeleton.placed(stretched).unwrap_err();
    assert!(matches!(error, ModelError::BadRest { bone, .. } if bone == "bone/0"));
}

/// A bone's parent precedes it: no later bone, and not itself.
#[test]
fn parent_precedes_its_bones() {
    let rig = RandomRig::new(3);
    let bones = rig.skeleton.bones().to_vec();
    for (bone, parent) in [(0, 0), (1, 1), (1, 2), (2, 2)] {
        let mut cyclic = bones.clone();
        cyclic[bone].parent = rig.skeleton.bone_at(parent);
        let error = Skeleton::new("loop", cyclic).unwrap_err();
        let bone = bones[bone].name.clone();
        assert_eq!(error, ModelError::ParentNotBefore { bone });
    }
}
