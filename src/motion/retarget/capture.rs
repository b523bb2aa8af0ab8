//! Captured movements: where joints are, frame by frame.

use super::RetargetError;
use crate::animation::{Armature, Clip, Cursor, Playback};
use crate::bad_option::{BadOption, POSITIVE};
use crate::model::UnknownName;
use crate::spatial::Vector3;

/// Frames of a clip that are sampled at most: a day at 100 a second, over 10 GB of 53 joints.
pub(super) const MOST_FRAMES: usize = 10_000_000;

/// Places farther than this from the origin, in the capture's unit, are refused: doubles tell no more than a tenth of a thousandth there.
pub(super) const FARTHEST: f64 = 1e12;

/// Places of named joints in frames a fixed time apart, in any unit of length.
#[derive(Clone, Debug, PartialEq)]
pub struct Capture {
    names: Vec<String>,
    /// Frame after frame, joint after joint.
    places: Vec<Vector3<f64>>,
    /// Joint after joint, if the capture is of a clip.
    rest: Option<Vec<Vector3<f64>>>,
    frame_rate: f64,
}

impl Capture {
    /// Of places as they stand in an array of (frames, joints, 3), at so many frames a second.
    ///
    /// # Errors
    /// No frame, numbers that are no whole frames, a name twice, a number that is not finite or beyond ±1e12, a rate that is not
    /// positive.
    pub fn new(
        names: Vec<String>,
        numbers: &[f64],
        frame_rate: f64,
    ) -> Result<Self, RetargetError> {
        BadOption::check("frames a second", frame_rate, POSITIVE)?;
        check_named_once(&names)?;
        let width = 3 * names.len();
        if width == 0 || !numbers.len().is_multiple_of(width) {
            return Err(RetargetError::NotFrames {
                numbers: numbers.len(),
                joints: names.len(),
            });
        }
        if numbers.is_empty() {
            return Err(RetargetError::NoFrames);
        }
        if let Some(at) = numbers.iter().position(|number| !number.is_finite()) {
            return Err(RetargetError::NotFinite {
                frame: at / width,
                joint: names[at % width / 3].clone(),
            });
        }
        if let Some(at) = numbers.iter().position(|number| number.abs() > FARTHEST) {
            return Err(RetargetError::TooFar {
                frame: at / width,
                joint: names[at % width / 3].clone(),
            });
        }
        let places = numbers.chunks_exact(3);
        Ok(Self {
            places: places.map(|at| Vector3::new(at[0], at[1], at[2])).collect(),
            names,
            rest: None,
            frame_rate,
        })
    }

    /// Of a clip's bones, at so many frames a second from its beginning to its end.
    ///
    /// # Errors
    /// As [`new`](Self::new), no frame where the clip [is empty](Clip::is_empty); more than 10 million frames; a clip of another
    /// armature counts as one without frames.
    pub fn of_clip(
        armature: &Armature,
        clip: &Clip,
        frame_rate: f64,
    ) -> Result<Self, RetargetError> {
        BadOption::check("frames a second", frame_rate, POSITIVE)?;
        if clip.is_empty() {
            return Err(RetargetError::NoFrames);
        }
        let steps = (clip.duration() * frame_rate + 0.5).floor();
        if steps >= MOST_FRAMES as f64 {
            return Err(RetargetError::TooManyFrames {
                duration: clip.duration(),
                frame_rate,
            });
        }
        let frames = steps as usize + 1;
        let mut pose = armature.rest().clone();
        let mut placed = vec![glam::Affine3A::IDENTITY; armature.bones()];
        let origin = |placed: &glam::Affine3A| placed.translation.to_array().map(f64::from);
        let is_placed = armature.local_to_model(&pose, &mut placed).is_ok();
        let rest = is_placed.then(|| placed.iter().map(|at| origin(at).into()).collect());
        let mut cursor = Cursor::new();
        let mut numbers = Vec::with_capacity(3 * frames * armature.bones());
        for frame in 0..frames {
            let time = clip.start() + frame as f64 / frame_rate;
            let sampled = clip.sample(time, Playback::Hold, &mut cursor, &mut pose);
            let located = armature.local_to_model(&pose, &mut placed);
            if sampled.is_err() || located.is_err() {
                return Err(RetargetError::NoFrames);
            }
            numbers.extend(placed.iter().flat_map(origin));
        }
        let capture = Self::new(armature.names().to_vec(), &numbers, frame_rate)?;
        Ok(Self { rest, ..capture })
    }

    getters! {
        /// The joints' names.
        pub fn names(&self) -> &[String] = &self.names;
        /// How many frames there are.
        pub fn frames(&self) -> usize = self.places.len() / self.names.len();
        /// Frames a second.
        pub fn frame_rate(&self) -> f64 = self.frame_rate;
    }

    /// A joint's number.
    ///
    /// # Errors
    /// A name that there is not; the error lists the valid ones.
    pub fn joint(&self, name: &str) -> Result<usize, UnknownName> {
        let found = self.names.iter().position(|own| own == name);
        found.ok_or_else(|| {
            UnknownName::new(
                "captured joint",
                name,
                self.names.iter().map(String::as_str),
            )
        })
    }

    /// Positions of all joints in the rest pose of the clip that was captured.
    pub(super) fn rest(&self) -> Option<&[Vector3<f64>]> {
        self.rest.as_deref()
    }

    /// Where all joints are in a frame.
    #[must_use]
    pub fn frame(&self, frame: usize) -> Option<&[Vector3<f64>]> {
        let n = self.names.len();
        self.places.get(frame * n..(frame + 1) * n)
    }
}

/// Refuses a joint that is named twice.
pub(super) fn check_named_once(names: &[String]) -> Result<(), RetargetError> {
    let mut seen = std::collections::BTreeSet::new();
    match names.iter().find(|name| !seen.insert(name.as_str())) {
        Some(joint) => Err(RetargetError::NamedTwice {
            joint: joint.clone(),
        }),
        None => Ok(()),
    }
}
