//! Motion as BVH text.

use std::fmt::Write;
use std::path::Path;

use glam::Vec3A;

use super::angles::{self, ORDER};
use super::joint::{self, Joint, Kind};
use super::{BvhChannel, BvhError};
use crate::animation::{Armature, Clip, Cursor, Playback, Pose};
use crate::io::write_file;

/// The most frames: beyond as many, key times in single precision may meet.
const MOST_FRAMES: f64 = 16_777_216.0;
/// A clip whose end is so much of a frame before one still has that frame: its span is in single
/// precision.
const ROUNDING: f64 = 1e-3;

/// A clip as BVH text, `rate` frames a second from its start to its end; what is left after the last
/// whole frame is not written.
///
/// See [`poses_to_text`] for how.
///
/// # Errors
/// As [`poses_to_text`], and when the clip is of another armature's size or has too many frames.
pub fn to_text(armature: &Armature, clip: &Clip, rate: f64) -> Result<String, BvhError> {
    poses_to_text(armature, &sample(armature, clip, rate)?, rate)
}

/// Poses as BVH text, `rate` of them a second: what became of a clip by blending, layers or inverse
/// kinematics.
///
/// - A bone becomes a `JOINT` (without a parent, a `ROOT`) where the bone's tail is. Angles are
///   counted from the rest pose along the model's own axes, as the format has no other, so bones that
///   are turned at rest come back along other axes; where they are stays the same.
/// - Rotations are `Zrotation Xrotation Yrotation` to a millionth of a degree, and run on from frame
///   to frame without leaps of whole turns. Roots have positions, and so has any bone that leaves its
///   place in its parent by more than a millionth of its offset.
/// - A bone at a tip, as [`from_bytes`](super::from_bytes) names them, becomes an `End Site` unless
///   something moves it. Any other bone on which nothing hangs gets one of no length, as programs
///   look for one on each branch; read back, it is a bone more.
/// - Lengths are in the armature's unit, exact to the last bit of single precision unless the parent
///   is turned at rest. Morph targets are left out.
///
/// # Errors
/// A [`BvhError`]: no bones, a name the format cannot say, a scaled bone, poses of another armature's
/// size, a rate that is not positive.
pub fn poses_to_text(armature: &Armature, poses: &[Pose], rate: f64) -> Result<String, BvhError> {
    let frame_time = frame_time(rate)?;
    if !((frame_time * poses.len() as f64) as f32).is_finite() {
        return Err(BvhError::Rate { rate });
    }
    let joints = joint::joints(armature, poses)?;
    let mut text = String::from("HIERARCHY\n");
    let order = hierarchy(armature, &joints, &mut text);
    // Writing to a String cannot fail, so here and below the results carry nothing.
    let _ = writeln!(text, "MOTION\nFrames: {}", poses.len());
    let _ = writeln!(text, "Frame Time: {frame_time}");
    let mut before = vec![[0.0; 3]; joints.len()];
    for pose in poses {
        for &index in &order {
            let (joint, Some(bone)) = (&joints[index], armature.bone_at(index)) else {
                continue;
            };
            let local = pose.local_of(bone);
            if joint.kind == Kind::TurnsAndMoves {
                let _ = write!(text, "{} ", numbers(joint.position(&local)));
            }
            let angles = angles::nearest(joint.rotation(&local), before[index]);
            before[index] = angles;
            let [z, x, y] = angles.map(f64::to_degrees);
            let _ = write!(text, "{z:.6} {x:.6} {y:.6} ");
        }
        text.pop();
        text.push('\n');
    }
    Ok(text)
}

/// Writes [`to_text`] to a file.
///
/// # Errors
/// As [`to_text`], and when the file cannot be written.
pub fn write(
    armature: &Armature,
    clip: &Clip,
    rate: f64,
    path: impl AsRef<Path>,
) -> Result<(), BvhError> {
    let text = to_text(armature, clip, rate)?;
    Ok(write_file(path.as_ref(), text.as_bytes())?)
}

/// Writes [`poses_to_text`] to a file.
///
/// # Errors
/// As [`poses_to_text`], and when the file cannot be written.
pub fn write_poses(
    armature: &Armature,
    poses: &[Pose],
    rate: f64,
    path: impl AsRef<Path>,
) -> Result<(), BvhError> {
    let text = poses_to_text(armature, poses, rate)?;
    Ok(write_file(path.as_ref(), text.as_bytes())?)
}

fn frame_time(rate: f64) -> Result<f64, BvhError> {
    let frame_time = 1.0 / rate;
    if frame_time as f32 > 0.0 && (frame_time as f32).is_finite() {
        Ok(frame_time)
    } else {
        Err(BvhError::Rate { rate })
    }
}

fn sample(armature: &Armature, clip: &Clip, rate: f64) -> Result<Vec<Pose>, BvhError> {
    let frame_time = frame_time(rate)?;
    let duration = clip.duration();
    let last = (duration * rate + ROUNDING).floor();
    if last >= MOST_FRAMES {
        let most = MOST_FRAMES as usize;
        return Err(BvhError::TooManyFrames {
            duration,
            rate,
            most,
        });
    }
    let mut cursor = Cursor::new();
    let frames = (0..=last as usize).map(|frame| {
        let mut pose = armature.rest().clone();
        let time = clip.start() + frame as f64 * frame_time;
        clip.sample(time, Playback::Hold, &mut cursor, &mut pose)?;
        Ok(pose)
    });
    frames.collect()
}

/// Writes the joints, children inside their parents. The order in which those with channels come.
fn hierarchy(armature: &Armature, joints: &[Joint], text: &mut String) -> Vec<usize> {
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
        let Joint {
            children,
            kind,
            offset,
            ..
        } = &joints[index];
        let name = &armature.names()[index];
        let _ = match (kind, depth) {
            (Kind::EndSite, _) => writeln!(text, "{indent}End Site"),
            (_, 0) => writeln!(text, "{indent}ROOT {name}"),
            _ => writeln!(text, "{indent}JOINT {name}"),
        };
        let _ = writeln!(text, "{indent}{{\n{indent}\tOFFSET {}", numbers(*offset));
        depth += 1;
        steps.push(Step::Close);
        steps.extend(children.iter().rev().map(|&child| Step::Open(child)));
        if *kind == Kind::EndSite {
            continue;
        }
        order.push(index);
        let channels = channels(*kind);
        let _ = write!(text, "{indent}\tCHANNELS {}", channels.len());
        for channel in channels {
            let _ = write!(text, " {}", channel.name());
        }
        text.push('\n');
        if children.is_empty() {
            let zero = numbers(Vec3A::ZERO);
            let _ = writeln!(
                text,
                "{indent}\tEnd Site\n{indent}\t{{\n{indent}\t\tOFFSET {zero}\n{indent}\t}}"
            );
        }
    }
    order
}

fn channels(kind: Kind) -> Vec<BvhChannel> {
    let [x, y, z, rotations @ ..] = BvhChannel::ALL;
    let mut channels = match kind {
        Kind::TurnsAndMoves => vec![x, y, z],
        Kind::Turns | Kind::EndSite => Vec::new(),
    };
    channels.extend(ORDER.axes().map(|axis| rotations[axis]));
    channels
}

/// With as many digits as it takes to read the same numbers back.
fn numbers(vector: Vec3A) -> String {
    // Adding zero turns −0 into 0.
    let [x, y, z] = (vector + Vec3A::ZERO).to_array();
    format!("{x} {y} {z}")
}
