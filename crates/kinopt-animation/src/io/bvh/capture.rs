//! Conversion of a BVH file's joints and frames to an armature and a clip.

use std::path::Path;

use glam::{DQuat, DVec3, Quat, Vec3, Vec3A};

use super::MotionCapture;
use super::hierarchy::HierarchyJoint;
use super::lexer::Lexer;
use super::motion::MotionSection;
use super::note::BvhNote;
use crate::animation::rotation::RotationCurve;
use crate::animation::rotation::exponential::rotation_about_f64;
use crate::animation::{Armature, ArmatureBone, Channel, Clip, ClipError, LocalTransform};
use crate::io::ReadError;
use kinopt_kinematics::curve::KeyedCurve;

/// Builds the armature and the clip from the two parts of a file.
pub(super) fn capture(
    lexer: &Lexer,
    joints: Vec<HierarchyJoint>,
    motion: MotionSection,
    notes: Vec<BvhNote>,
) -> Result<MotionCapture, ReadError> {
    let bones = joints.iter().map(|joint| ArmatureBone {
        name: joint.name.clone(),
        parent: joint.parent,
        rest: LocalTransform {
            translation: Vec3A::from(vector(joint.offset)),
            ..LocalTransform::IDENTITY
        },
    });
    let armature = Armature::new(bones.collect(), Vec::new());
    let armature = armature.map_err(|error| ReadError::of_file(lexer.file(), error.to_string()))?;
    let clip = clip(lexer.file(), &armature, &joints, &motion);
    let clip = clip.map_err(|error| lexer.error(motion.frame_time_line, error.to_string()))?;
    Ok(MotionCapture {
        armature,
        clip,
        frames: motion.frames,
        frame_time: motion.frame_time,
        channels: joints.into_iter().map(|joint| joint.channels).collect(),
        notes,
    })
}

fn clip(
    file: &str,
    armature: &Armature,
    joints: &[HierarchyJoint],
    motion: &MotionSection,
) -> Result<Clip, ClipError> {
    let stem = Path::new(file)
        .file_stem()
        .map(|stem| stem.to_string_lossy());
    let mut builder = Clip::builder(stem.unwrap_or_default(), armature);
    // A product in double precision, so that the error does not grow with the frame number.
    let time = |frame: usize| (frame as f64 * motion.frame_time) as f32;
    let Some(last) = motion.frames.checked_sub(1) else {
        return Ok(builder.build().without_frames());
    };
    builder.span(0.0, time(last))?;
    let row = joints.iter().map(|joint| joint.channels.len()).sum();
    if row == 0 {
        return Ok(builder.build());
    }
    let times: Vec<f32> = (0..motion.frames).map(time).collect();
    let mut first = 0;
    for (index, joint) in joints.iter().enumerate() {
        let columns = first..first + joint.channels.len();
        first = columns.end;
        let frames = motion
            .values
            .chunks_exact(row)
            .map(|row| &row[columns.clone()]);
        let Some(bone) = armature.bone_at(index) else {
            continue;
        };
        let mut channels = joint.channels.iter();
        if channels.clone().any(|channel| !channel.is_rotation()) {
            let keys = frames.clone().map(|row| position(joint, row)).collect();
            let curve = KeyedCurve::linear(times.clone(), keys)?;
            builder.channel(bone, Channel::Translation(curve))?;
        }
        if channels.any(|channel| channel.is_rotation()) {
            let keys = frames.map(|row| rotation(joint, row)).collect();
            let curve = RotationCurve::slerp(times.clone(), keys)?;
            builder.channel(bone, Channel::Rotation(curve))?;
        }
    }
    Ok(builder.build())
}

/// Position of a joint in its parent in one frame.
fn position(joint: &HierarchyJoint, frame: &[f64]) -> Vec3A {
    let mut position = joint.offset;
    for (channel, &value) in joint.channels.iter().zip(frame) {
        if !channel.is_rotation() {
            position[channel.axis()] = value;
        }
    }
    Vec3A::from(vector(position))
}

/// Rotation of a joint in its parent in one frame.
fn rotation(joint: &HierarchyJoint, frame: &[f64]) -> Quat {
    let rotations = joint.channels.iter().zip(frame);
    let rotations = rotations.filter(|(channel, _)| channel.is_rotation());
    let product = rotations.fold(DQuat::IDENTITY, |product, (channel, degrees)| {
        let axis = DVec3::AXES[channel.axis()];
        product * rotation_about_f64(axis, degrees.to_radians())
    });
    product.as_quat()
}

fn vector(numbers: [f64; 3]) -> Vec3 {
    Vec3::from(numbers.map(|number| number as f32))
}
