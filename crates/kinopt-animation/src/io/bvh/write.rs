//! Writer of BVH files.

use std::fmt::Write;
use std::path::Path;

use glam::Vec3A;

use super::joint::{self, WrittenJoint};
use super::{BvhFormat, MotionCapture};
use crate::animation::{Armature, Clip, Cursor, Playback, Pose};
use crate::io::{FormatError, write_file};

/// Largest number of frames; above it, key times in single precision may coincide.
const MAX_FRAMES: f64 = 16_777_216.0;
/// Fraction of a frame by which a clip may end before its last frame; the span is in single precision.
const LAST_FRAME_TOLERANCE: f64 = 1e-3;

/// A clip as BVH text, from its start to its last whole frame. `format` is a number of frames per second or a
/// [`BvhFormat`].
///
/// [`poses_to_text`] describes the text.
///
/// # Errors
/// As [`poses_to_text`], or the clip is of another armature's size or has too many frames.
pub fn to_text<'a>(
    armature: &Armature,
    clip: &Clip,
    format: impl Into<BvhFormat<'a>>,
) -> Result<String, FormatError> {
    let format = format.into();
    poses_to_text(armature, &sample(armature, clip, &format)?, format)
}

/// Poses as BVH text, such as results of blending, layers or inverse kinematics. `format` is a number of frames per
/// second or a [`BvhFormat`].
///
/// - Each bone becomes a `JOINT`, or a `ROOT` without a parent, at the bone's origin. The format has no rest rotations:
///   angles are relative to the rest pose about the axes of the model. Bones with a rest rotation therefore have other
///   axes when read, but equal positions.
/// - Rotations are `Zrotation Xrotation Yrotation` to a millionth of a degree, without jumps of full turns between
///   frames. Roots have positions, and so has any bone that deviates from its offset by more than a millionth of the
///   offset's length.
/// - A format with [channels](BvhFormat::with_channels) keeps their order. A bone that its channels cannot pose gets
///   missing positions before them and missing rotations after them. No End Site is added.
/// - A tip bone, as named by [`from_bytes`](super::from_bytes), becomes an `End Site` unless it moves. Any other leaf
///   bone gets an End Site of zero length, which programs expect on each branch. It is read as an additional bone.
/// - Lengths are in the armature's unit, exact in single precision unless the parent has a rest rotation. Morph targets
///   are omitted.
///
/// # Errors
/// A [`FormatError`]:
/// - no bones;
/// - a name that the format cannot represent;
/// - a scaled bone;
/// - poses of another armature's size;
/// - a rate that is not positive.
pub fn poses_to_text<'a>(
    armature: &Armature,
    poses: &[Pose],
    format: impl Into<BvhFormat<'a>>,
) -> Result<String, FormatError> {
    let format = format.into();
    format.check()?;
    let frame_time = format.frame_time();
    if !((frame_time * poses.len() as f64) as f32).is_finite() {
        return Err(format.rate_error());
    }
    let joints = joint::joints(armature, poses, &format)?;
    let mut text = String::from("HIERARCHY\n");
    let adds_end_sites = format.channels().is_none();
    let order = hierarchy(armature, &joints, adds_end_sites, &mut text);
    // Writing to a `String` cannot fail; the results here and below are ignored.
    let _ = writeln!(text, "MOTION\nFrames: {}", poses.len());
    let _ = writeln!(text, "Frame Time: {frame_time}");
    let mut previous_angles = vec![[0.0; 3]; joints.len()];
    for pose in poses {
        for &index in &order {
            let (joint, Some(bone)) = (&joints[index], armature.bone_at(index)) else {
                continue;
            };
            let local = pose.local_of(bone);
            let position = joint.position(&local);
            let angles = joint
                .axes
                .nearest(joint.rotation(&local), previous_angles[index]);
            previous_angles[index] = angles;
            let mut angles = angles.into_iter();
            for channel in &joint.channels {
                let _ = if channel.is_rotation() {
                    let degrees = angles.next().unwrap_or_default().to_degrees();
                    write!(text, "{degrees:.6} ")
                } else {
                    write!(text, "{} ", number(position[channel.axis()]))
                };
            }
        }
        text.pop();
        text.push('\n');
    }
    Ok(text)
}

/// Writes [`to_text`] to a file.
///
/// # Errors
/// As [`to_text`], or the file cannot be written.
pub fn write<'a>(
    armature: &Armature,
    clip: &Clip,
    format: impl Into<BvhFormat<'a>>,
    path: impl AsRef<Path>,
) -> Result<(), FormatError> {
    let text = to_text(armature, clip, format)?;
    Ok(write_file(path.as_ref(), text.as_bytes())?)
}

/// Writes [`poses_to_text`] to a file.
///
/// # Errors
/// As [`poses_to_text`], or the file cannot be written.
pub fn write_poses<'a>(
    armature: &Armature,
    poses: &[Pose],
    format: impl Into<BvhFormat<'a>>,
    path: impl AsRef<Path>,
) -> Result<(), FormatError> {
    let text = poses_to_text(armature, poses, format)?;
    Ok(write_file(path.as_ref(), text.as_bytes())?)
}

impl MotionCapture {
    /// Frame time and channels of the capture, for [`poses_to_text`] and the other functions that write.
    #[must_use]
    pub fn format(&self) -> BvhFormat<'_> {
        BvhFormat::of_frame_time(self.frame_time).with_channels(&self.channels)
    }

    /// The capture as BVH text, with its own channels, frames and frame time.
    ///
    /// # Errors
    /// As [`poses_to_text`].
    pub fn to_text(&self) -> Result<String, FormatError> {
        to_text(&self.armature, &self.clip, self.format())
    }

    /// Writes [`to_text`](Self::to_text) to a file.
    ///
    /// # Errors
    /// As [`to_text`](Self::to_text), or the file cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), FormatError> {
        Ok(write_file(path.as_ref(), self.to_text()?.as_bytes())?)
    }
}

fn sample(armature: &Armature, clip: &Clip, format: &BvhFormat) -> Result<Vec<Pose>, FormatError> {
    format.check()?;
    if clip.is_empty() {
        return Ok(Vec::new());
    }
    let duration = clip.duration();
    let (rate, frame_time) = (format.rate(), format.frame_time());
    let last = (duration * rate + LAST_FRAME_TOLERANCE).floor();
    if last >= MAX_FRAMES {
        let most = MAX_FRAMES as usize;
        return Err(FormatError::TooManyFrames {
            duration,
            rate,
            most,
        });
    }
    let mut cursor = Cursor::new();
    let frames = (0..=last as usize).map(|frame| {
        let mut pose = armature.rest().clone();
        // Key times are in single precision.
        let time = f64::from((clip.start() + frame as f64 * frame_time) as f32);
        clip.sample(time, Playback::Hold, &mut cursor, &mut pose)?;
        Ok(pose)
    });
    frames.collect()
}

/// Writes the joints, children inside their parents. Returns the joints with channels, in the order written.
fn hierarchy(
    armature: &Armature,
    joints: &[WrittenJoint],
    adds_end_sites: bool,
    text: &mut String,
) -> Vec<usize> {
    enum Step {
        Open(usize),
        Close,
    }
    let mut order = Vec::new();
    let mut depth = 0;
    let bones = (0..joints.len()).filter_map(|index| armature.bone_at(index));
    let roots = bones.filter(|&bone| armature.parent(bone).is_none());
    let mut steps: Vec<Step> = roots.map(|bone| Step::Open(bone.index())).collect();
    steps.reverse();
    while let Some(step) = steps.pop() {
        let Step::Open(index) = step else {
            depth -= 1;
            let _ = writeln!(text, "{}}}", "\t".repeat(depth));
            continue;
        };
        let indent = "\t".repeat(depth);
        let WrittenJoint {
            children,
            is_end_site,
            offset,
            channels,
            ..
        } = &joints[index];
        let name = &armature.names()[index];
        let _ = match (is_end_site, depth) {
            (true, _) => writeln!(text, "{indent}End Site"),
            (_, 0) => writeln!(text, "{indent}ROOT {name}"),
            _ => writeln!(text, "{indent}JOINT {name}"),
        };
        let _ = writeln!(text, "{indent}{{\n{indent}\tOFFSET {}", numbers(*offset));
        depth += 1;
        steps.push(Step::Close);
        steps.extend(children.iter().rev().map(|&child| Step::Open(child)));
        if *is_end_site {
            continue;
        }
        order.push(index);
        let _ = write!(text, "{indent}\tCHANNELS {}", channels.len());
        for channel in channels {
            let _ = write!(text, " {}", channel.name());
        }
        text.push('\n');
        if children.is_empty() && adds_end_sites {
            let zero = numbers(Vec3A::ZERO);
            let _ = writeln!(
                text,
                "{indent}\tEnd Site\n{indent}\t{{\n{indent}\t\tOFFSET {zero}\n{indent}\t}}"
            );
        }
    }
    order
}

/// Three numbers that a reader restores exactly.
fn numbers(vector: Vec3A) -> String {
    let [x, y, z] = vector.to_array().map(number);
    format!("{x} {y} {z}")
}

/// The number, with a negative zero made positive.
fn number(number: f32) -> f32 {
    number + 0.0
}
