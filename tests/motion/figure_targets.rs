//! Promise: a figure is upright for retargeting, for either up axis of its file. Its clip has every bone at the
//! placement of the configurations, in the file's axes.

use kinopt::animation::{Armature, Cursor, Playback};
use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::retarget::{
    BodyMap, Capture, FigureTarget, RetargetError, RetargetOptions, Retargeting, UpAxis,
};
use support::bones::humanoid;

/// Largest distance of the clip's bones from forward kinematics, except for the bones in `still`, and the height of the
/// figure.
fn largest_distance(figure: &FigureTarget, armature: &Armature, still: &[&str]) -> (f64, f64) {
    let model = figure.robot().model();
    let q: Vec<f64> = (0..12)
        .flat_map(|seed| model.random_configuration(seed))
        .collect();
    let clip = figure.clip("moved", armature, &q, 10.0).unwrap();
    assert_eq!(clip.span(), [0.0, 1.1]);
    let mut kinematics = ForwardKinematics::new(model);
    let mut pose = armature.rest().clone();
    let (mut largest, mut tall) = (0.0_f64, 0.0_f64);
    for (frame, q) in q.chunks_exact(model.configuration_len()).enumerate() {
        clip.sample(
            frame as f64 / 10.0,
            Playback::Hold,
            &mut Cursor::new(),
            &mut pose,
        )
        .unwrap();
        let placed = kinematics.place(q).unwrap();
        let bones = armature.bone_ids().zip(armature.names());
        for (bone, name) in bones.filter(|(_, name)| !still.contains(&name.as_str())) {
            let at = armature.model_from_bone(&pose, bone).unwrap().translation;
            let [x, y, z] = placed[model.frame(name).unwrap().index()]
                .translation
                .to_array();
            let expected = match figure.up() {
                UpAxis::Y => [x, z, -y],
                UpAxis::Z => [x, y, z],
            };
            for (actual, expected) in at.to_array().into_iter().zip(expected) {
                largest = largest.max((f64::from(actual) - expected).abs());
                tall = tall.max(expected.abs());
            }
        }
    }
    (largest, tall)
}

#[test]
fn figure_of_a_capture_with_y_up_is_upright() {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let turning = read.turning_bones();
    let figure = FigureTarget::of_armature(&read.armature, &turning, UpAxis::Y).unwrap();
    // In the rest pose its head is above its feet.
    let model = figure.robot().model();
    let mut kinematics = ForwardKinematics::new(model);
    let placed = kinematics.place(&model.neutral()).unwrap();
    let height = |name: &str| placed[model.frame(name).unwrap().index()].translation.z;
    assert!(height("Head") > height("LeftFoot") + 100.0);
    let (largest, tall) = largest_distance(&figure, &read.armature, &[]);
    assert!(largest < 2e-6 * tall, "{largest} of {tall}");
}

/// If the root does not rotate, each of its children moves with the figure's base.
#[test]
fn figure_with_several_root_bones_is_placed() {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let mut turning = read.turning_bones();
    assert!(turning.remove(&read.armature.bone("Hips").unwrap()));
    let figure = FigureTarget::of_armature(&read.armature, &turning, UpAxis::Y).unwrap();
    let (largest, tall) = largest_distance(&figure, &read.armature, &["Hips"]);
    assert!(largest < 2e-6 * tall, "{largest} of {tall}");
}

#[test]
fn figure_of_a_rig_with_z_up_is_upright() {
    let rig = humanoid();
    let figure = FigureTarget::new(&rig.skeleton, UpAxis::Z).unwrap();
    let (largest, tall) = largest_distance(&figure, &Armature::of_skeleton(&rig.skeleton), &[]);
    assert!(largest < 2e-6 * tall, "{largest} of {tall}");
}

/// The command warns by this: a figure lies down if the wrong up axis is given for its file.
#[test]
fn up_axis_of_a_figure_is_found_from_its_feet() {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let capture = Capture::of_clip(&read.armature, &read.clip, 30.0).unwrap();
    for (stated_axis, upright_axis) in [(UpAxis::Y, UpAxis::Z), (UpAxis::Z, UpAxis::Y)] {
        let turning = read.turning_bones();
        let figure = FigureTarget::of_armature(&read.armature, &turning, stated_axis).unwrap();
        let mut map = BodyMap::guess(&capture, figure.robot().model())
            .unwrap()
            .map;
        let options = RetargetOptions::default().with_up(UpAxis::Y);
        let along = |map: &BodyMap| {
            let fitted = Retargeting::new(figure.robot(), map, &capture, options.clone());
            fitted.unwrap().model_stands_along()
        };
        assert_eq!(along(&map), Some(upright_axis));
        // Without contacts there is nothing to decide by.
        map.contacts = Some(Vec::new());
        assert_eq!(along(&map), None);
    }
}

/// The joints have no limits, so limb lengths of the figure are those at rest.
#[test]
fn figure_on_its_own_motion_has_the_subject_lengths() {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let capture = Capture::of_clip(&read.armature, &read.clip, 30.0).unwrap();
    let turning = read.turning_bones();
    let figure = FigureTarget::of_armature(&read.armature, &turning, UpAxis::Y).unwrap();
    let map = BodyMap::guess(&capture, figure.robot().model())
        .unwrap()
        .map;
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    let fitted = Retargeting::new(figure.robot(), &map, &capture, options).unwrap();
    let driving = fitted.driving();
    let index = |name: &str| capture.names().iter().position(|other| other == name);
    for limb in [
        ["Hips", "Spine1"],
        ["Spine1", "LeftArm"],
        ["LeftUpLeg", "LeftLeg"],
    ] {
        let joints = limb.map(|name| index(name).unwrap());
        let [from, to] = joints.map(|joint| driving.iter().position(|other| *other == joint));
        let (mut target, mut subject) = (0.0, 0.0);
        for frame in 0..capture.frames() {
            let (targets, captured) = (fitted.targets(frame), capture.frame(frame));
            let (targets, captured) = (targets.unwrap(), captured.unwrap());
            target += (targets[from.unwrap()] - targets[to.unwrap()]).norm();
            subject += (captured[joints[0]] - captured[joints[1]]).norm();
        }
        let ratio: f64 = target / subject;
        assert!((ratio - 1.0).abs() < 1e-3, "{limb:?}: {ratio}");
    }
}

#[test]
fn clip_of_another_armature_is_rejected() {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let rig = humanoid();
    let figure = FigureTarget::new(&rig.skeleton, UpAxis::Z).unwrap();
    let q = figure.robot().model().neutral();
    let refused = figure.clip("moved", &read.armature, &q, 10.0).unwrap_err();
    assert!(
        matches!(refused, RetargetError::OtherBone { .. }),
        "{refused}"
    );
    let rig_armature = Armature::of_skeleton(&rig.skeleton);
    assert!(figure.clip("moved", &rig_armature, &[], 10.0).is_err());
    assert!(
        figure
            .clip("moved", &rig_armature, &q.repeat(2), f64::NAN)
            .is_err()
    );
}
