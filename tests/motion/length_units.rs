//! Promise: a character in centimetres or inches turns as it does in metres, whatever is solved.

use glam::{Quat, Vec3A};
use kinopt::Solver;
use kinopt::animation::{Armature, ArmatureBone, Clip, LocalTransform, Pose};
use kinopt::ik::Drag;
use kinopt::io::rig::Rig;
use kinopt::motion::clip_ik::{ClipIk, Reach};
use kinopt::motion::retarget::{
    BodyMap, Capture, FigureTarget, RetargetOptions, Retargeted, Retargeting, UpAxis,
};
use kinopt::problem::Problem;
use kinopt::skeleton::{BallSkeleton, Bone, BoneId, Cones, Skeleton, SkeletonRoot};
use kinopt::spatial::Vector3;
use kinopt::task::Point;

use crate::clip_ik::{at, figure, planted, walk};

/// Centimetres and inches to a metre.
const UNITS: [f64; 2] = [100.0, 39.37007874015748];
/// Largest difference of an angle, radians, or of a component of a unit quaternion.
const ALIKE: f64 = 1e-6;

fn scaled(skeleton: &Skeleton, unit: f64) -> Skeleton {
    let bones = skeleton.bones().iter().map(|bone| {
        let mut bone: Bone = bone.clone();
        bone.length *= unit;
        bone.model_from_rest.translation = bone.model_from_rest.translation * unit;
        bone
    });
    Skeleton::new("scaled", bones.collect()).unwrap()
}

/// The same numbers with the first `lengths` of each configuration in metres.
fn in_metres(q: &[f64], width: usize, lengths: usize, unit: f64) -> Vec<f64> {
    let numbers = q.iter().enumerate();
    let numbers = numbers.map(|(k, x)| if k % width < lengths { x / unit } else { *x });
    numbers.collect()
}

fn assert_alike(expected: &[f64], found: &[f64], what: &str) {
    assert_eq!(expected.len(), found.len(), "{what}");
    let pairs = expected.iter().zip(found);
    let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < ALIKE, "{what}: {off}");
}

/// Steps that people captured, on the humanoid in some unit.
fn retargeted(unit: f64, solve: impl Fn(&Retargeting<'_>) -> Retargeted) -> Vec<f64> {
    let read = kinopt::io::bvh::read("../models/captures/steps.bvh").unwrap();
    let capture = Capture::of_clip(&read.armature, &read.clip, 30.0).unwrap();
    let rig = Rig::read("../models/humanoid/humanoid.json").unwrap();
    let figure = FigureTarget::new(&scaled(&rig.skeleton, unit), UpAxis::Z).unwrap();
    let model = figure.robot().model();
    let map = BodyMap::guess(&capture, model).unwrap().map;
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    let fitted = Retargeting::new(figure.robot(), &map, &capture, options).unwrap();
    let found = solve(&fitted);
    // Errors are those of the places that the movement itself shows, in the figure's unit.
    let errors = fitted.errors(&found).unwrap();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!(
        (mean - found.mean_error).abs() < 1e-9 * unit,
        "{mean} {}",
        found.mean_error
    );
    in_metres(&found.q, model.configuration_len(), 3, unit)
}

#[test]
fn retargeted_frames_are_alike_in_all_units() {
    let per_frame = |fitted: &Retargeting<'_>| fitted.per_frame().unwrap();
    let metres = retargeted(1.0, per_frame);
    for unit in UNITS {
        assert_alike(&metres, &retargeted(unit, per_frame), &format!("{unit}"));
    }
}

#[test]
fn retargeted_movement_is_alike_in_all_units() {
    let whole = |fitted: &Retargeting<'_>| fitted.whole().unwrap();
    let metres = retargeted(1.0, whole);
    for unit in UNITS {
        assert_alike(&metres, &retargeted(unit, whole), &format!("{unit}"));
    }
}

/// Frames of a drag of a hand and a foot, one of them out of reach.
fn dragged(unit: f64) -> Vec<f64> {
    let rig = Rig::read("../models/humanoid/humanoid.json").unwrap();
    let skeleton = scaled(&rig.skeleton, unit);
    let figure = BallSkeleton::new(skeleton, &Cones::new(), SkeletonRoot::FREE).unwrap();
    let tips = figure.skeleton().bones();
    let leaf = |bone: &BoneId| tips.iter().all(|other| other.parent != Some(*bone));
    let leaves: Vec<BoneId> = figure.skeleton().bone_ids().filter(leaf).collect();
    let mut problem = Problem::builder(figure.model());
    let tasks: Vec<_> = leaves[..2]
        .iter()
        .map(|leaf| problem.add(Point::new(figure.tip(*leaf), [0.0; 3])))
        .collect();
    let start = figure.model().neutral();
    let mut drag = Drag::new(problem.build().unwrap(), &start).unwrap();
    let mut frames = Vec::new();
    for frame in 0..30 {
        for (k, (task, leaf)) in tasks.iter().zip(&leaves).enumerate() {
            let tip = tips[leaf.index()].rest_tip();
            let way = Vector3::new(0.3, -0.1, 0.2) * (unit * f64::from(frame) / 10.0);
            let far = if k == 0 { 1.0 } else { -1.0 };
            drag.target_mut(*task).unwrap().set_target(tip + way * far);
        }
        frames.extend_from_slice(&drag.advance().q);
    }
    in_metres(&frames, start.len(), 3, unit)
}

#[test]
fn dragged_figure_is_alike_in_all_units() {
    let metres = dragged(1.0);
    for unit in UNITS {
        assert_alike(&metres, &dragged(unit), &format!("{unit}"));
    }
}
