//! Promise: a figure stands upright for what is brought onto it, whichever way up its file has it, and its clip has every bone where the
//! configurations put it, in the axes of the file.

use kinopt::animation::{Armature, Cursor, Playback};
use kinopt::io::rig::Rig;
use kinopt::kinematics::ForwardKinematics;
use kinopt::motion::retarget::{
    BodyMap, Capture, FigureTarget, RetargetError, RetargetOptions, Retargeting, UpAxis,
};

/// How far bones of the clip are at most from where forward kinematics has them, but for those that stand `still`, and the height of
/// the figure.
fn off(figure: &FigureTarget, armature: &Armature, still: &[&str]) -> (f64, f64) {
    let model = figure.robot().model();
    let q: Vec<f64> = (0..12)
        .flat_map(|seed| model.random_configuration(seed))
        .collect();
    let clip = figure.clip("moved", armature, &q, 10.0).unwrap();
    assert_eq!(clip.span(), [0.0, 1.1]);
    let mut kinematics = ForwardKinematics::new(model);
    let mut pose = armature.rest().clone();
    let (mut most, mut tall) = (0.0_f64, 0.0_f64);
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
            for (own, expected) in at.to_array().into_iter().zip(expected) {
                most = most.max((f64::from(own) - expected).abs());
                tall = tall.max(expected.abs());
            }
        }
    }
    (most, tall)
}

#[test]
fn a_capture_whose_y_points_upward() {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let turning = read.turning_bones();
    let figure = FigureTarget::of_armature(&read.armature, &turning, UpAxis::Y).unwrap();
    // At rest its head is above its feet.
    let model = figure.robot().model();
    let mut kinematics = ForwardKinematics::new(model);
    let placed = kinematics.place(&model.neutral()).unwrap();
    let height = |name: &str| placed[model.frame(name).unwrap().index()].translation.z;
    assert!(height("Head") > height("LeftFoot") + 100.0);
    let (most, tall) = off(&figure, &read.armature, &[]);
    assert!(most < 2e-6 * tall, "{most} of {tall}");
}

/// Where the root does not turn, its children each move with the figure's base.
#[test]
fn a_figure_of_several_topmost_bones() {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let mut turning = read.turning_bones();
    assert!(turning.remove(&read.armature.bone("Hips").unwrap()));
    let figure = FigureTarget::of_armature(&read.armature, &turning, UpAxis::Y).unwrap();
    let (most, tall) = off(&figure, &read.armature, &["Hips"]);
    assert!(most < 2e-6 * tall, "{most} of {tall}");
}

#[test]
fn a_rig_whose_z_points_upward() {
    let rig = Rig::read("../models/humanoid/humanoid.json").unwrap();
    let figure = FigureTarget::new(&rig.skeleton, UpAxis::Z).unwrap();
    let (most, tall) = off(&figure, &Armature::of_skeleton(&rig.skeleton), &[]);
    assert!(most < 2e-6 * tall, "{most} of {tall}");
}

/// What the command warns by: a figure whose file is said to have another axis upward lies down.
#[test]
fn the_way_that_a_figure_stands_is_told_from_its_feet() {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let capture = Capture::of_clip(&read.armature, &read.clip, 30.0).unwrap();
    for (said, stands) in [(UpAxis::Y, UpAxis::Z), (UpAxis::Z, UpAxis::Y)] {
        let turning = read.turning_bones();
        let figure = FigureTarget::of_armature(&read.armature, &turning, said).unwrap();
        let mut map = BodyMap::guess(&capture, figure.robot().model())
            .unwrap()
            .map;
        let options = RetargetOptions::default().with_up(UpAxis::Y);
        let along = |map: &BodyMap| {
            let fitted = Retargeting::new(figure.robot(), map, &capture, options.clone());
            fitted.unwrap().model_stands_along()
        };
        assert_eq!(along(&map), Some(stands));
        // On what would it stand?
        map.contacts = Some(Vec::new());
        assert_eq!(along(&map), None);
    }
}

#[test]
fn another_armature_is_refused() {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let rig = Rig::read("../models/humanoid/humanoid.json").unwrap();
    let figure = FigureTarget::new(&rig.skeleton, UpAxis::Z).unwrap();
    let q = figure.robot().model().neutral();
    let refused = figure.clip("moved", &read.armature, &q, 10.0).unwrap_err();
    assert!(
        matches!(refused, RetargetError::OtherBone { .. }),
        "{refused}"
    );
    let own = Armature::of_skeleton(&rig.skeleton);
    assert!(figure.clip("moved", &own, &[], 10.0).is_err());
    assert!(figure.clip("moved", &own, &q.repeat(2), f64::NAN).is_err());
}
