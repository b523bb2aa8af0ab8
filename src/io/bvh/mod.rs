//! Motion capture: Biovision Hierarchy (BVH) files, a skeleton and what it does frame by frame.
//!
//! There is no standard; the description that is handed on is the University of Wisconsin's
//! ("Biovision BVH", CS 838, 1999). Where it is silent, or programs differ, files are read so:
//!
//! - **Joints** become bones of the same name, turned like their parents at rest, `OFFSET` away from
//!   them. Offsets may be zero. There may be several `ROOT`s. A name may have spaces. A name that is
//!   taken gets a suffix, `_2` or the next free number, with a [note](BvhNote).
//! - **End Sites** become bones as well, called `JOINT/tip` (more of one joint: `JOINT/tip/2`, …),
//!   because the tips of fingers, toes and the head are what poses are judged and goals set by. They
//!   never move in their joints.
//! - **`CHANNELS`**: none to six, in any order. Rotations are in degrees and apply as they stand in
//!   the file: `Zrotation Xrotation Yrotation` is R = R_z R_x R_y, each about axes that those before
//!   have turned. One or two are enough, and an axis may come twice unless it follows itself.
//! - **Positions** are where the joint is in its parent, *instead of* its `OFFSET`, for roots and for
//!   joints; a coordinate without a channel keeps the offset's. Programs differ here: Blender reads
//!   and writes files so. The Wisconsin description adds a root's offset, three.js any joint's, which
//!   puts a root that Blender wrote twice as far off. With a root's offset of zero, as most files
//!   have it, there is no difference.
//! - **Between frames** bones turn at constant speed along the shorter arc (slerp) and move straight.
//!   At the frames they are exact. Angles between frames would follow the file's whole turns, but
//!   they also jump from 180° to −180° wherever the file wraps them; no capture turns a joint half
//!   round from one frame to the next.
//! - **Frame k** is at k times the `Frame Time`, so a clip of n frames lasts n − 1 of them. One frame
//!   is a pose that stays; without any frames all is at rest. Whole frames beyond those that `Frames:`
//!   announces are left out, with a [note](BvhNote), as three.js and Assimp do.
//! - **Truncated files** keep their whole frames, those with all their numbers, with a note. The last digits of the last number may
//!   be missing. A file that announces frames and has no whole one is an error.
//! - **Names** are UTF-8. Other bytes are characters of Latin-1, with a note.
//! - The **unit of length** is the file's own: centimetres, inches and others occur, and no file says
//!   which.
//! - Keywords may be in capitals or not, numbers and braces on any lines.

mod angles;
mod capture;
mod channel;
mod error;
mod format;
mod hierarchy;
mod joint;
mod lexer;
mod motion;
mod note;
mod write;

pub use channel::BvhChannel;
pub use error::BvhError;
pub use format::BvhFormat;
pub use note::BvhNote;
pub use write::{poses_to_text, to_text, write, write_poses};

use std::collections::BTreeSet;
use std::path::Path;

use self::lexer::Lexer;
use super::{MAX_FILE_BYTES, ReadError, read_with};
use crate::animation::{Armature, Clip};
use crate::skeleton::BoneId;

/// The longest offset and position that is read and written: sums of as many as a file holds, and
/// their squares in double precision, stay finite.
const LONGEST: f64 = 1e30;

/// What a BVH file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionCapture {
    /// A bone for each joint and End Site, in the order of the file and in its unit of length.
    pub armature: Armature,
    /// The motion, in seconds from the first frame; named as the file is, without its extension.
    pub clip: Clip,
    /// How many frames there are.
    pub frames: usize,
    /// From one frame to the next, in seconds.
    pub frame_time: f64,
    /// The channels of each bone in the order of the file; none for End Sites.
    pub channels: Vec<Vec<BvhChannel>>,
    /// Repairs made by the reader.
    pub notes: Vec<BvhNote>,
}

impl MotionCapture {
    /// The bones that a figure of this capture turns, in their order: those with channels of rotation, or all where
    /// there is none.
    #[must_use]
    pub fn turning_bones(&self) -> BTreeSet<BoneId> {
        let bones = self.armature.bone_ids().zip(&self.channels);
        let turns = |own: &Vec<BvhChannel>| own.iter().any(|channel| channel.is_rotation());
        let turning: BTreeSet<BoneId> = bones
            .filter_map(|(bone, own)| turns(own).then_some(bone))
            .collect();
        match turning.is_empty() {
            true => self.armature.bone_ids().collect(),
            false => turning,
        }
    }
}

/// Reads motion capture from the bytes of a BVH file; `name` is for messages and the clip.
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
/// Repairs are [notes](BvhNote): whole frames of a truncated file are read, joints whose name is taken are renamed, and bytes that
/// are not UTF-8 are read as Latin-1.
///
/// # Errors
/// A [`ReadError`] with the line: an unexpected word, a number that is missing or not finite, no whole frame although frames
/// are announced, a frame time that is not positive, frames whose times are equal in single precision.
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
/// As [`from_bytes`], and when the file cannot be opened.
pub fn read(path: impl AsRef<Path>) -> Result<MotionCapture, ReadError> {
    read_with(path.as_ref(), MAX_FILE_BYTES, from_bytes)
}
