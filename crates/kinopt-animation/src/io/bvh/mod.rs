//! Motion capture in Biovision Hierarchy (BVH) files: a skeleton and its motion by frames.
//!
//! BVH has no standard. The common reference is the description by the University of Wisconsin ("Biovision BVH", CS
//! 838, 1999). This reader resolves ambiguities and differences between programs as follows:
//!
//! - **Joints** become bones with the names of the file, at `OFFSET` from their parents and without rotation at rest.
//!   Offsets may be zero. Several `ROOT`s are allowed. A name may contain spaces. A repeated name gets a suffix, `_2`
//!   or the next free number, with a [note](BvhNote).
//! - **End Sites** become bones named `JOINT/tip` (further ones of a joint: `JOINT/tip/2`, …). They are useful as end
//!   effectors at fingers, toes and the head. They never move relative to their joints.
//! - **`CHANNELS`**: none to six, in any order. Rotations are in degrees, intrinsic, in file order: `Zrotation
//!   Xrotation Yrotation` is R = R_z R_x R_y. One or two are enough, and an axis may be repeated unless it follows
//!   itself.
//! - **Positions** replace the `OFFSET`, for roots and for joints; a coordinate without a channel keeps the offset's
//!   value. Blender reads and writes files this way. The Wisconsin description adds a root's offset, three.js that of
//!   any joint, which doubles the position of a root written by Blender. Most files have a zero root offset, so there
//!   is no difference.
//! - **Between frames** rotations use slerp and positions are linear; at frames they are exact. Interpolated angles
//!   would follow full turns of the file, but also jump where the file wraps from 180° to −180°. Captured joints do not
//!   rotate by half a turn in one frame.
//! - **Frame k** is at k times the `Frame Time`, so a clip of n frames lasts n − 1 frame times. A single frame is a
//!   constant pose; without frames the clip is at rest. Whole frames beyond the number in `Frames:` are ignored, with a
//!   [note](BvhNote), as in three.js and Assimp.
//! - **Truncated files** keep their whole frames, those with all their numbers, with a note. The last digits of the
//!   last number may be missing. A file that announces frames but contains no whole frame is an error.
//! - **Names** are UTF-8. Other bytes are characters of Latin-1, with a note.
//! - The **unit of length** is that of the file: centimetres or inches, for example. The format does not state it.
//! - Keywords are case-insensitive; numbers and braces may be on any lines.

mod angles;
mod capture;
mod channel;
mod format;
mod hierarchy;
mod joint;
mod lexer;
mod motion;
mod note;
mod write;

pub use channel::BvhChannel;
pub use format::BvhFormat;
pub use note::BvhNote;
pub use write::{poses_to_text, to_text, write, write_poses};

use std::collections::BTreeSet;
use std::path::Path;

use self::lexer::Lexer;
use super::{MAX_FILE_BYTES, ReadError, read_with};
use crate::animation::{Armature, Clip};
use kinopt_kinematics::skeleton::BoneId;

/// Largest offset and position that is read and written, in the file's unit. Sums over all joints of a file, and their
/// squares, remain finite in double precision.
const MAX_COORDINATE: f64 = 1e30;

/// Contents of a BVH file.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionCapture {
    /// Bone for each joint and End Site, in file order and in the file's unit of length.
    pub armature: Armature,
    /// Motion with times in seconds from the first frame; named after the file, without extension.
    pub clip: Clip,
    /// Number of frames.
    pub frames: usize,
    /// Time between frames, seconds.
    pub frame_time: f64,
    /// Channels of each bone, in file order; none for End Sites.
    pub channels: Vec<Vec<BvhChannel>>,
    /// Repairs made by the reader.
    pub notes: Vec<BvhNote>,
}

impl MotionCapture {
    /// Bones with rotation channels, or all bones if there are none.
    #[must_use]
    pub fn turning_bones(&self) -> BTreeSet<BoneId> {
        let bones = self.armature.bone_ids().zip(&self.channels);
        let has_rotation =
            |channels: &Vec<BvhChannel>| channels.iter().any(|channel| channel.is_rotation());
        let turning: BTreeSet<BoneId> = bones
            .filter_map(|(bone, channels)| has_rotation(channels).then_some(bone))
            .collect();
        match turning.is_empty() {
            true => self.armature.bone_ids().collect(),
            false => turning,
        }
    }
}

/// Reads motion capture from the bytes of a BVH file; `name` is used for messages and the clip.
///
/// ```
/// use kinopt::animation::{Cursor, Playback};
/// use kinopt::io::bvh;
///
/// let nod = "HIERARCHY
/// ROOT Neck {
///     OFFSET 0 150 0
///     CHANNELS 1 Xrotation
///     End Site { OFFSET 0 20 0 }
/// }
/// MOTION
/// Frames: 2
/// Frame Time: 0.5
/// 0
/// 90";
/// let capture = bvh::from_bytes(nod.as_bytes(), "nod.bvh")?;
/// assert_eq!(capture.armature.names(), ["Neck", "Neck/tip"]);
///
/// let mut pose = capture.armature.rest().clone();
/// capture.clip.sample(0.5, Playback::Hold, &mut Cursor::new(), &mut pose)?;
/// let mut model_from_bone = vec![glam::Affine3A::IDENTITY; 2];
/// capture.armature.local_to_model(&pose, &mut model_from_bone)?;
/// let tip = model_from_bone[1].translation;
/// assert!(tip.abs_diff_eq(glam::Vec3A::new(0.0, 150.0, 20.0), 1e-4));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Repairs are reported as [notes](BvhNote): a truncated file gives its whole frames, joints with a repeated name are
/// renamed, and invalid UTF-8 is read as Latin-1.
///
/// # Errors
/// A [`ReadError`] with the line:
/// - an unexpected word;
/// - a number that is missing or not finite;
/// - no whole frame although frames are announced;
/// - a frame time that is not positive;
/// - frame times that are equal in single precision.
pub fn from_bytes(bytes: &[u8], name: &str) -> Result<MotionCapture, ReadError> {
    let (text, latin1) = lexer::decode(bytes);
    let mut lexer = Lexer::new(&text, name);
    let (joints, renamed) = hierarchy::read(&mut lexer)?;
    let mut motion = motion::read(&mut lexer, &joints)?;
    let notes = latin1.into_iter().chain(renamed);
    let notes = notes.chain(motion.note.take()).collect();
    capture::capture(&lexer, joints, motion, notes)
}

/// Reads a BVH file of at most 1 GiB.
///
/// # Errors
/// As [`from_bytes`], or the file cannot be opened.
pub fn read(path: impl AsRef<Path>) -> Result<MotionCapture, ReadError> {
    read_with(path.as_ref(), MAX_FILE_BYTES, from_bytes)
}
