//! Promise: a bone that is placed, rotated or moved in model coordinates is there afterwards. The bones above it do not
//! move, and those below it move along.

use glam::{Affine3A, Mat3A, Quat, Vec3A};
use kinopt::animation::{Armature, ArmatureBone, ClipError, LocalTransform, Pose};
use kinopt::skeleton::BoneId;
use support::armatures::{apart, armature, pose, rotation, vector};
use support::random::Random;

/// Every bone's placement in the model.
fn placed(armature: &Armature, pose: &Pose) -> Vec<Affine3A> {
    let mut model_from_bone = Vec::new();
    armature.local_to_model(pose, &mut model_from_bone).unwrap();
    model_from_bone
}

fn near(a: &Affine3A, b: &Affine3A, within: f32) -> bool {
    a.abs_diff_eq(*b, within)
}

/// Bones that rotate and move, but do not scale.
fn unscaled(armature: &Armature, random: &mut Random) -> Pose {
    let mut pose = pose(armature, random);
    for index in 0..armature.bones() {
        let bone = armature.bone_at(index).unwrap();
        pose.set_scale(bone, Vec3A::ONE).unwrap();
    }
    pose
}

/// Asserts that bones outside a subtree are unchanged, and bones below its root keep their local transforms.
fn only_below(armature: &Armature, before: &Pose, after: &Pose, bone: BoneId) {
    for index in 0..armature.bones() {
        let other = armature.bone_at(index).unwrap();
        if other != bone {
            assert_eq!(before.local(other).unwrap(), after.local(other).unwrap());
        }
    }
    assert_eq!(before.morph_weights(), after.morph_weights());
}

#[test]
fn placed_bone_has_the_given_placement() {
    let mut random = Random::new(1);
    for _ in 0..200 {
        let armature = armature(12, &mut random);
        let before = unscaled(&armature, &mut random);
        let bone = armature.bone_at(random.below(12)).unwrap();
        let target = Affine3A::from_scale_rotation_translation(
            (Vec3A::ONE * random.within(0.5, 2.0) as f32).into(),
            rotation(&mut random, 3.0),
            vector(&mut random, 4.0).into(),
        );
        let mut after = before.clone();
        armature
            .set_model_from_bone(&mut after, bone, target)
            .unwrap();
        let all = placed(&armature, &after);
        assert!(near(&all[bone.index()], &target, 2e-5));
        assert!(near(
            &armature.model_from_bone(&after, bone).unwrap(),
            &target,
            2e-5
        ));
        only_below(&armature, &before, &after, bone);

        // A bone placed at its current placement is unchanged.
        let mut again = before.clone();
        let placement = armature.model_from_bone(&before, bone).unwrap();
        assert!(near(
            &placement,
            &placed(&armature, &before)[bone.index()],
            2e-5
        ));
        armature
            .set_model_from_bone(&mut again, bone, placement)
            .unwrap();
        let same = again.local(bone).unwrap().to_affine();
        assert!(near(&same, &before.local(bone).unwrap().to_affine(), 2e-5));
    }
}

#[test]
fn bone_rotates_in_model_space() {
    let mut random = Random::new(2);
    for case in 0..200 {
        let armature = armature(12, &mut random);
        let scaled = case % 2 == 1;
        let before = match scaled {
            true => pose(&armature, &mut random),
            false => unscaled(&armature, &mut random),
        };
        let bone = armature.bone_at(random.below(12)).unwrap();
        let target = rotation(&mut random, 3.0);
        let mut after = before.clone();
        // A direction of any length is valid.
        armature
            .set_model_rotation(&mut after, bone, target * 3.0)
            .unwrap();
        assert!(apart(armature.model_rotation(&after, bone).unwrap(), target) < 1e-5);
        let (old, new) = (before.local(bone).unwrap(), after.local(bone).unwrap());
        assert_eq!((old.translation, old.scale), (new.translation, new.scale));
        only_below(&armature, &before, &after, bone);
        if !scaled {
            let matrix = placed(&armature, &after)[bone.index()].matrix3;
            assert!(matrix.abs_diff_eq(Mat3A::from_quat(target), 2e-5));
        }
    }
}

#[test]
fn bone_moves_in_model_space() {
    let mut random = Random::new(3);
    for _ in 0..200 {
        let armature = armature(12, &mut random);
        let before = pose(&armature, &mut random);
        let bone = armature.bone_at(random.below(12)).unwrap();
        let target = vector(&mut random, 4.0);
        let mut after = before.clone();
        armature
            .set_model_translation(&mut after, bone, target)
            .unwrap();
        let origin = placed(&armature, &after)[bone.index()].translation;
        assert!(origin.abs_diff_eq(target, 1e-4), "{origin} {target}");
        let (old, new) = (before.local(bone).unwrap(), after.local(bone).unwrap());
        assert_eq!((old.rotation, old.scale), (new.rotation, new.scale));
        only_below(&armature, &before, &after, bone);
    }
}

#[test]
fn local_transform_is_read_from_a_matrix() {
    let mut random = Random::new(4);
    let armature = armature(3, &mut random);
    let (mut pose, bone) = (armature.rest().clone(), armature.bone_at(1).unwrap());
    let local = LocalTransform {
        translation: vector(&mut random, 1.0),
        rotation: rotation(&mut random, 2.0),
        scale: Vec3A::new(2.0, 0.5, 1.0),
    };
    pose.set_translation(bone, local.translation).unwrap();
    pose.set_rotation(bone, local.rotation).unwrap();
    pose.set_scale(bone, local.scale).unwrap();
    assert_eq!(pose.local(bone).unwrap(), local);
    let read = LocalTransform::of_affine(&local.to_affine()).unwrap();
    assert!(near(&read.to_affine(), &local.to_affine(), 1e-5));
    let mirror = Affine3A::from_scale(glam::Vec3::new(2.0, 3.0, -4.0));
    let read = LocalTransform::of_affine(&mirror).unwrap();
    assert!(near(&read.to_affine(), &mirror, 1e-5));
}

/// Sheared axes, for any two axes and either sign: no translation, rotation and scale give such a matrix.
#[test]
fn sheared_matrix_is_no_local_transform() {
    let turned = glam::Mat3A::from_quat(Quat::from_rotation_y(0.4));
    for (leaning, towards) in [(0, 1), (1, 2), (2, 0)] {
        for by in [-0.1, 0.1] {
            let mut columns = [Vec3A::X, Vec3A::Y, Vec3A::Z];
            columns[leaning] += columns[towards] * by;
            let [x, y, z] = columns.map(|column| turned * column);
            let leans = Affine3A::from_mat3(glam::Mat3A::from_cols(x, y, z).into());
            assert_eq!(LocalTransform::of_affine(&leans), None, "{leans}");
        }
    }
}

#[test]
fn invalid_edits_change_nothing() {
    let bone = |name: &str, parent, scale| ArmatureBone {
        name: name.to_owned(),
        parent,
        rest: LocalTransform {
            scale,
            ..LocalTransform::IDENTITY
        },
    };
    let flat = Vec3A::new(1.0, 0.0, 1.0);
    let long = Vec3A::new(3.0, 1.0, 1.0);
    let bones = vec![
        bone("flat", None, flat),
        bone("on it", Some(0), Vec3A::ONE),
        bone("long", None, long),
        bone("in it", Some(2), Vec3A::ONE),
    ];
    let armature = Armature::new(bones, Vec::new()).unwrap();
    let at = |index| armature.bone_at(index).unwrap();
    let mut pose = armature.rest().clone();
    let turn = Affine3A::from_rotation_z(0.5);
    let result = armature.set_model_from_bone(&mut pose, at(1), turn);
    assert_eq!(result, Err(ClipError::Flattened { bone: 1 }));
    let result = armature.set_model_translation(&mut pose, at(1), Vec3A::Y);
    assert_eq!(result, Err(ClipError::Flattened { bone: 1 }));
    let result = armature.set_model_from_bone(&mut pose, at(3), turn);
    assert_eq!(result, Err(ClipError::Sheared { bone: 3 }));
    let nowhere = Affine3A::from_translation(glam::Vec3::NAN);
    let result = armature.set_model_from_bone(&mut pose, at(3), nowhere);
    assert_eq!(result, Err(ClipError::NonFiniteTransform { bone: 3 }));
    let point = Affine3A::from_scale(glam::Vec3::ZERO);
    let result = armature.set_model_from_bone(&mut pose, at(2), point);
    assert_eq!(result, Err(ClipError::Sheared { bone: 2 }));
    let zero = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    let result = armature.set_model_rotation(&mut pose, at(3), zero);
    assert_eq!(result, Err(ClipError::ZeroRotation { bone: 3 }));
    assert_eq!(&pose, armature.rest());

    let few = Armature::new(vec![bone("one", None, Vec3A::ONE)], Vec::new()).unwrap();
    let mut other = few.rest().clone();
    let result = armature.set_model_rotation(&mut other, at(0), Quat::IDENTITY);
    assert!(matches!(result, Err(ClipError::Size(_))));
    let result = few.model_from_bone(few.rest(), at(3));
    assert_eq!(
        result,
        Err(ClipError::UnknownPoseBone { bone: 3, bones: 1 })
    );
}

/// Flattening is judged by proportions: tiny bones place their children as large ones do.
#[test]
fn flattening_is_judged_by_proportions() {
    for size in [1e-4, 1.0, 1e4] {
        for (thin, flattened) in [(1.0, false), (1e-3, false), (1e-8, true)] {
            let bone = |name: &str, parent, scale| ArmatureBone {
                name: name.to_owned(),
                parent,
                rest: LocalTransform {
                    scale,
                    ..LocalTransform::IDENTITY
                },
            };
            let scale = Vec3A::new(size, thin * size, size);
            let bones = vec![
                bone("above", None, scale),
                bone("below", Some(0), Vec3A::ONE),
            ];
            let armature = Armature::new(bones, Vec::new()).unwrap();
            let below = armature.bone_at(1).unwrap();
            let mut pose = armature.rest().clone();
            let moved = armature.set_model_translation(&mut pose, below, Vec3A::X);
            assert_eq!(moved.is_err(), flattened, "{size} {thin}");
        }
    }
}
