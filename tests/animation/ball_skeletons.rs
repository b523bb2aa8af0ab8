//! Promise: the bones of an armature on ball joints have the placements of the armature's own matrices. They rest in
//! its rest pose, reproduce its poses, and stay within their cones.

use std::collections::BTreeSet;

use glam::{DAffine3, DQuat, DVec3, EulerRot, Quat, Vec3A};
use kinopt::animation::{Armature, ArmatureBone, BallPoseMap, LocalTransform, Pose};
use kinopt::model::ModelError;
use kinopt::model::{BallLimits, Limits};
use kinopt::skeleton::{BallSkeleton, BoneCone, Cones, SkeletonRoot};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::Point;
use kinopt::{Problem, Solver, Workspace};
use support::fault_tables::ExpectedError;
use support::random::Random;

/// Number of bones. The first one is motionless, like a scene's node above the hips, and so are some further ones.
const BONES: usize = 14;
const MOTIONLESS_BONES: [usize; 3] = [0, 6, 13];

fn turn(random: &mut Random, max_angle: f64) -> Quat {
    let [x, y, z] = [max_angle, 0.5 * max_angle, max_angle]
        .map(|half_range| random.within(-half_range, half_range) as f32);
    Quat::from_euler(EulerRot::ZYX, x, y, z)
}

/// Tree with bones of many sizes; some are scaled uniformly.
fn armature(random: &mut Random) -> Armature {
    let bones = (0..BONES).map(|index| ArmatureBone {
        name: format!("bone {index}"),
        parent: index.checked_sub(1 + index % 3 / 2),
        rest: LocalTransform {
            translation: Vec3A::from_array([0; 3].map(|_| random.within(-1.0, 1.0) as f32)),
            rotation: turn(random, 3.0),
            scale: Vec3A::splat(random.within(0.7, 1.4) as f32),
        },
    });
    Armature::new(bones.collect(), Vec::new()).unwrap()
}

fn figure(armature: &Armature, cones: &Cones, root: SkeletonRoot) -> BallSkeleton {
    let limits = |still| match still {
        true => [Limits::new(0.0, 0.0); 3],
        false => [Limits::UNBOUNDED; 3],
    };
    let skeleton = armature.skeleton("one", |bone| {
        limits(MOTIONLESS_BONES.contains(&bone.index()))
    });
    BallSkeleton::new(skeleton.unwrap(), cones, root).unwrap()
}

/// Placements of a pose's bones, as products of matrices in double precision.
fn placed(armature: &Armature, pose: &Pose) -> Vec<(DAffine3, DQuat)> {
    let mut placed: Vec<(DAffine3, DQuat)> = Vec::new();
    for bone in armature.bone_ids() {
        let local = pose.local(bone).unwrap();
        let rotation = local.rotation.as_dquat().normalize();
        let (scale, at) = (local.scale.as_dvec3(), local.translation.as_dvec3());
        let local = DAffine3::from_scale_rotation_translation(scale, rotation, at);
        let above = armature.parent(bone).map(|parent| placed[parent.index()]);
        let (above, turned) = above.unwrap_or((DAffine3::IDENTITY, DQuat::IDENTITY));
        placed.push((above * local, turned * rotation));
    }
    placed
}

/// Axes of a frame.
fn axes(placed: &Placement<f64>) -> [DVec3; 3] {
    let Matrix3 { x, y, z } = placed.rotation;
    [x, y, z].map(|axis| DVec3::from(axis.to_array()))
}

/// Random rotations of the rotating bones, and a displacement of the root if `moved`.
fn any_pose(armature: &Armature, moved: bool, random: &mut Random) -> Pose {
    let mut pose = armature.rest().clone();
    for bone in armature
        .bone_ids()
        .filter(|bone| !MOTIONLESS_BONES.contains(&bone.index()))
    {
        pose.set_rotation(bone, turn(random, 3.0)).unwrap();
        let is_root = armature
            .parent(bone)
            .is_some_and(|parent| parent.index() == 0);
        if moved && is_root {
            let mut local = pose.local(bone).unwrap();
            local.translation += Vec3A::from_array([0; 3].map(|_| random.within(-2.0, 2.0) as f32));
            pose.set_local(bone, local).unwrap();
        }
    }
    pose
}

#[test]
fn kinematics_equal_the_armatures_matrices() {
    let random = &mut Random::new(31);
    for round in 0..20 {
        let armature = armature(random);
        for root in [SkeletonRoot::Fixed, SkeletonRoot::FREE] {
            let figure = figure(&armature, &Cones::new(), root);
            let bridge = BallPoseMap::new(&armature, &figure);
            let mut pose = any_pose(&armature, root != SkeletonRoot::Fixed, random);
            if round == 0 {
                pose = armature.rest().clone();
            }
            let mut q = Vec::new();
            bridge.configuration_of(&pose, &mut q).unwrap();
            assert_eq!(q.len(), figure.model().configuration_len());
            let ours = figure.pose(&q).unwrap();
            for (bone, (affine, rotation)) in armature.bone_ids().zip(placed(&armature, &pose)) {
                let placement = ours.model_from_bone[bone.index()];
                let at = DVec3::from(placement.translation.to_array());
                assert!(
                    (affine.translation - at).length() < 1e-12 * 20.0,
                    "{bone:?}"
                );
                for (axis, ours) in DVec3::AXES.into_iter().zip(axes(&placement)) {
                    assert!((rotation * axis - ours).length() < 1e-12, "{bone:?}");
                }
            }
            // The inverse, to the rounding of single precision.
            let mut back = armature.rest().clone();
            bridge.pose_of(&q, &mut back).unwrap();
            for bone in armature.bone_ids() {
                let (a, b) = (pose.local(bone).unwrap(), back.local(bone).unwrap());
                assert!(a.translation.abs_diff_eq(b.translation, 1e-5));
                assert!(a.rotation.dot(b.rotation).abs() > 1.0 - 1e-6);
            }
        }
    }
}

#[test]
fn neutral_configuration_is_the_rest_pose() {
    let random = &mut Random::new(32);
    let armature = armature(random);
    for root in [SkeletonRoot::Fixed, SkeletonRoot::FREE] {
        let figure = figure(&armature, &Cones::new(), root);
        let mut q = Vec::new();
        BallPoseMap::new(&armature, &figure)
            .configuration_of(armature.rest(), &mut q)
            .unwrap();
        for (ours, neutral) in q.iter().zip(figure.model().neutral()) {
            assert!((ours - neutral).abs() < 1e-12);
        }
        let model = figure.model();
        let turning = armature
            .bone_ids()
            .filter(|bone| !MOTIONLESS_BONES.contains(&bone.index()));
        let joints: BTreeSet<_> = turning.flat_map(|bone| figure.joints(bone)).collect();
        let moving: BTreeSet<_> = model.moving_joints().iter().copied().collect();
        assert_eq!(joints, moving);
        // Frames are those of the skeleton on revolute joints, with equal ids.
        let names = |frames: &[kinopt::model::Frame]| -> Vec<String> {
            frames.iter().map(|frame| frame.name.clone()).collect()
        };
        let hinged = figure.skeleton().model().frames();
        assert_eq!(names(model.frames()), names(hinged));
    }
}

/// Straight arm of three bones along x, given by the origins of its bones.
fn arm() -> Armature {
    let bone = |name: &str, parent, x: f32| ArmatureBone {
        name: name.into(),
        parent,
        rest: LocalTransform {
            translation: Vec3A::new(x, 0.0, 0.0),
            ..LocalTransform::IDENTITY
        },
    };
    let bones = vec![
        bone("upper", None, 0.0),
        bone("fore", Some(0), 1.0),
        bone("hand", Some(1), 1.0),
    ];
    Armature::new(bones, Vec::new()).unwrap()
}

#[test]
fn solutions_stay_within_cones() {
    let armature = arm();
    let skeleton = armature
        .skeleton("arm", |_| [Limits::UNBOUNDED; 3])
        .unwrap();
    // The upper arm swings by 40 degrees and twists by 20. The elbow is a hinge about z that bends in one direction.
    let (swing, twist) = (40f64.to_radians(), 20f64.to_radians());
    let upper = BoneCone::new(BallLimits::cone(swing, Limits::new(-twist, twist)));
    let hinge = BallLimits::cone(1e-3, Limits::new(0.0, 2.0));
    let elbow = BoneCone::about([0.0, 0.0, 1.0], hinge);
    let cones = Cones::from([("upper".to_owned(), upper), ("fore".to_owned(), elbow)]);
    let figure = BallSkeleton::new(skeleton, &cones, SkeletonRoot::Fixed).unwrap();
    let hand = figure.tail(figure.bone("hand").unwrap());
    let mut problem = Problem::builder(figure.model());
    let task = problem.add(Point::new(hand, [0.0; 3]));
    let problem = problem.build().unwrap();
    let mut targets = problem.targets();
    let (solver, mut workspace) = (Solver::default(), Workspace::default());
    let random = &mut Random::new(33);
    let (mut reached, mut on_the_edge) = (0, 0);
    for _ in 0..200 {
        let target = [0; 3].map(|_| random.within(-1.8, 1.8));
        targets.get_mut(task).unwrap().set_target(target);
        let rest = figure.model().neutral();
        let solution = solver
            .solve(
                problem.with_targets(&targets).unwrap(),
                &rest,
                &mut workspace,
            )
            .unwrap();
        reached += usize::from(solution.reached);
        let pose = figure.pose(&solution.q).unwrap();
        let columns = |bone: usize| axes(&pose.model_from_bone[bone]);
        let ([along, across, _], fore) = (columns(0), columns(1));
        // Swing of x, and the twist about it beyond the shortest arc.
        let tipped = along.dot(DVec3::X).clamp(-1.0, 1.0).acos();
        assert!(tipped <= swing + 1e-9, "{tipped}");
        on_the_edge += usize::from(tipped > swing - 1e-9);
        let carried = DQuat::from_rotation_arc(DVec3::X, along) * DVec3::Y;
        assert!(carried.angle_between(across) <= twist + 1e-7);
        // The elbow keeps x on one side in the plane of rotation about the upper arm's z.
        let bent = along.cross(fore[0]).dot(columns(0)[2]);
        assert!(bent > -2e-3 && fore[0].dot(columns(0)[2]).abs() < 2e-3);
        let length: f64 = solution.q[..4].iter().map(|part| part * part).sum();
        assert!((length - 1.0).abs() < 1e-12);
    }
    assert!(reached > 5 && on_the_edge > 50, "{reached} {on_the_edge}");
}

#[test]
fn cone_axis_is_the_bone_by_default() {
    let axis_of = |armature: &Armature, name: &str| {
        let skeleton = armature
            .skeleton("one", |_| [Limits::UNBOUNDED; 3])
            .unwrap();
        let figure = BallSkeleton::new(skeleton, &Cones::new(), SkeletonRoot::Fixed).unwrap();
        let joint = figure.joint(figure.bone(name).unwrap()).unwrap();
        figure.model().joints()[joint.index()].axis
    };
    // Towards the child; without a child, in the direction from the parent.
    for bone in ["upper", "fore", "hand"] {
        assert!((axis_of(&arm(), bone) - Vector3::UNITS[0]).norm() < 1e-12);
    }
    // Between two children, in its own axes.
    let bone = |name: &str, parent, at: [f32; 3]| ArmatureBone {
        name: name.into(),
        parent,
        rest: LocalTransform {
            translation: Vec3A::from_array(at),
            rotation: match parent {
                None => Quat::from_rotation_z(std::f32::consts::FRAC_PI_2),
                Some(_) => Quat::IDENTITY,
            },
            scale: Vec3A::ONE,
        },
    };
    let bones = vec![
        bone("chest", None, [0.0; 3]),
        bone("left", Some(0), [0.0, 1.0, 1.0]),
        bone("right", Some(0), [0.0, 1.0, -1.0]),
    ];
    let chest = Armature::new(bones, Vec::new()).unwrap();
    assert!((axis_of(&chest, "chest") - Vector3::UNITS[1]).norm() < 1e-7);
}

#[test]
fn cones_of_other_bones_are_rejected() {
    let random = &mut Random::new(34);
    let armature = armature(random);
    let limits = |bone: kinopt::skeleton::BoneId| match MOTIONLESS_BONES.contains(&bone.index()) {
        true => [Limits::new(0.0, 0.0); 3],
        false => [Limits::UNBOUNDED; 3],
    };
    let with = |name: &str, cone, root| {
        let skeleton = armature.skeleton("one", limits).unwrap();
        let cones = Cones::from([(name.to_owned(), cone)]);
        BallSkeleton::new(skeleton, &cones, root).map(|_| ())
    };
    let fine = BoneCone::new(BallLimits::cone(1.0, Limits::UNBOUNDED));
    assert!(with("bone 1", fine, SkeletonRoot::Fixed).is_ok());
    let error = with("bone 1", fine, SkeletonRoot::FREE).unwrap_err();
    assert!(matches!(error, ModelError::ConeOfFreeBone { bone } if bone == "bone 1"));
    let error = with("bone 6", fine, SkeletonRoot::Fixed).unwrap_err();
    assert!(matches!(error, ModelError::ConeOfStillBone { bone } if bone == "bone 6"));
    with("bone 99", fine, SkeletonRoot::Fixed).says("`bone 99` | bone 9");
    let wide = BoneCone::new(BallLimits::cone(4.0, Limits::UNBOUNDED));
    with("bone 2", wide, SkeletonRoot::Fixed).says("`bone 2` | swing");
    let nowhere = BoneCone {
        axis: Some(Vector3::zero()),
        ..fine
    };
    with("bone 2", nowhere, SkeletonRoot::Fixed).says("`bone 2` | axis");
    let root = SkeletonRoot::Free {
        bounds: [Limits::new(1.0, -1.0); 3],
    };
    assert!(with("bone 2", fine, root).is_err());
}
