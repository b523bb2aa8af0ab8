//! Motion capture: joint positions of each capture frame.

use glam::DQuat;

use super::joint_rotations::PosedTree;
use super::{JointRotations, RetargetError};
use kinopt_animation::animation::{Armature, Clip, Cursor, Mirror, Playback, Pose};
use kinopt_kinematics::bad_option::{BadOption, POSITIVE};
use kinopt_kinematics::model::UnknownName;
use kinopt_kinematics::spatial::Vector3;

/// Maximum number of capture frames of a clip: a day at 100 frames per second, over 10 GB for 53 joints.
pub(super) const MAX_FRAMES: usize = 10_000_000;

/// Largest coordinate, in the capture's unit; the resolution of doubles there is about 1e-4.
pub(super) const MAX_COORDINATE: f64 = 1e12;

/// Positions of named joints in capture frames at a constant rate, in any unit of length.
#[derive(Clone, Debug, PartialEq)]
pub struct Capture {
    names: Vec<String>,
    /// Positions, frame by frame, joint by joint.
    places: Vec<Vector3<f64>>,
    /// Joint after joint, if the capture is of a clip.
    rest: Option<Vec<Vector3<f64>>>,
    /// Rotations of the joints, if the source has them.
    posed: Option<PosedTree>,
    frame_rate: f64,
}

impl Capture {
    /// Creates a capture from an array of shape (frames, joints, 3) and a rate in capture frames per second.
    ///
    /// # Errors
    /// Returns an error if:
    ///
    /// - there is no frame, or the array has incomplete frames;
    /// - a name appears twice;
    /// - a number is not finite or beyond ±1e12;
    /// - the rate is not positive.
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
        if let Some(index) = numbers.iter().position(|number| !number.is_finite()) {
            return Err(RetargetError::NotFinite {
                frame: index / width,
                joint: names[index % width / 3].clone(),
            });
        }
        if let Some(index) = numbers
            .iter()
            .position(|number| number.abs() > MAX_COORDINATE)
        {
            return Err(RetargetError::TooFar {
                frame: index / width,
                joint: names[index % width / 3].clone(),
            });
        }
        let places = numbers.chunks_exact(3);
        Ok(Self {
            places: places
                .map(|position| Vector3::new(position[0], position[1], position[2]))
                .collect(),
            names,
            rest: None,
            posed: None,
            frame_rate,
        })
    }

    /// Creates a capture from the bone positions and rotations of a clip, sampled from its start to its end.
    ///
    /// # Errors
    /// Returns the errors of [`new`](Self::new). Returns an error if the clip [is empty](Clip::is_empty), belongs to
    /// another armature, or has more than 10 million samples.
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
        if steps >= MAX_FRAMES as f64 {
            return Err(RetargetError::TooManyFrames {
                duration: clip.duration(),
                frame_rate,
            });
        }
        let frames = steps as usize + 1;
        let mut pose = armature.rest().clone();
        let mut transforms = vec![glam::Affine3A::IDENTITY; armature.bones()];
        let origin = |transforms: &glam::Affine3A| transforms.translation.to_array().map(f64::from);
        let is_placed = armature.local_to_model(&pose, &mut transforms).is_ok();
        let rest = is_placed.then(|| {
            transforms
                .iter()
                .map(|transform| origin(transform).into())
                .collect()
        });
        let parents = armature.bone_ids().map(|bone| armature.parent(bone));
        let parents: Vec<Option<usize>> = parents
            .map(|parent| parent.map(|bone| bone.index()))
            .collect();
        let mut rest_rotations = Vec::with_capacity(parents.len());
        extend_with_rotations(&pose, &parents, &mut rest_rotations);
        let mut cursor = Cursor::new();
        let mut numbers = Vec::with_capacity(3 * frames * armature.bones());
        let mut rotations = Vec::with_capacity(frames * armature.bones());
        for frame in 0..frames {
            let time = clip.start() + frame as f64 / frame_rate;
            let sampled = clip.sample(time, Playback::Hold, &mut cursor, &mut pose);
            let located = armature.local_to_model(&pose, &mut transforms);
            if sampled.is_err() || located.is_err() {
                return Err(RetargetError::NoFrames);
            }
            numbers.extend(transforms.iter().flat_map(origin));
            extend_with_rotations(&pose, &parents, &mut rotations);
        }
        let capture = Self::new(armature.names().to_vec(), &numbers, frame_rate)?;
        let posed = PosedTree {
            parents,
            rest: rest_rotations,
            rotations,
        };
        Ok(Self {
            posed: rest.is_some().then_some(posed),
            rest,
            ..capture
        })
    }

    /// Adds the rotations of the joints, with their bone tree and rest pose. Retargeting to characters uses them.
    ///
    /// # Errors
    /// Returns an error if a count differs from the joints or frames, if parents form a cycle, or if a quaternion's
    /// length differs from 1 by more than 1e-3.
    pub fn with_rotations(self, rotations: JointRotations) -> Result<Self, RetargetError> {
        let (rest, posed) = rotations.checked(&self.names, self.frames())?;
        Ok(Self {
            rest: Some(rest),
            posed: Some(posed),
            ..self
        })
    }

    /// Returns whether the capture has rotations of its joints.
    #[must_use]
    pub fn has_rotations(&self) -> bool {
        self.posed.is_some()
    }

    /// Returns the rotations of the joints, if the source has them.
    #[must_use]
    pub fn rotations(&self) -> Option<JointRotations> {
        let (posed, rest) = (self.posed.as_ref()?, self.rest.as_ref()?);
        let numbers = |q: &DQuat| [q.w, q.x, q.y, q.z];
        Some(JointRotations {
            parents: posed.parents.clone(),
            rest_positions: rest.clone(),
            rest_rotations: posed.rest.iter().map(numbers).collect(),
            rotations: posed.rotations.iter().map(numbers).collect(),
        })
    }

    /// Names of the joints.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Number of capture frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.places.len() / self.names.len()
    }

    /// Capture frames per second.
    #[must_use]
    pub fn frame_rate(&self) -> f64 {
        self.frame_rate
    }

    /// Returns the index of a joint.
    ///
    /// # Errors
    /// Returns an error that lists the valid names if the joint does not exist.
    pub fn joint(&self, name: &str) -> Result<usize, UnknownName> {
        let index = self.names.iter().position(|known| known == name);
        index.ok_or_else(|| {
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

    /// Tree, rest rotations and rotations of the joints, if the source has them.
    pub(super) fn posed(&self) -> Option<&PosedTree> {
        self.posed.as_ref()
    }

    /// Returns the positions of all joints in a capture frame, or `None` beyond the last one.
    #[must_use]
    pub fn frame(&self, frame: usize) -> Option<&[Vector3<f64>]> {
        let n = self.names.len();
        self.places.get(frame * n..(frame + 1) * n)
    }
}

/// Appends the rotation of each bone from the model, parents before children. Below mirrored bones it is that of the
/// rigid bone, as in [`Armature::skeleton`].
fn extend_with_rotations(pose: &Pose, parents: &[Option<usize>], to: &mut Vec<DQuat>) {
    let first = to.len();
    let mut mirrors: Vec<Mirror> = Vec::with_capacity(parents.len());
    for ((parent, local), scale) in parents.iter().zip(pose.rotations()).zip(pose.scales()) {
        let (above, mirror) = match parent {
            Some(parent) => (
                to.get(first + parent).copied().unwrap_or_default(),
                mirrors.get(*parent).copied().unwrap_or(Mirror::NONE),
            ),
            None => (DQuat::IDENTITY, Mirror::NONE),
        };
        let local = local.as_dquat().normalize();
        to.push((above * mirror.rotation(local)).normalize());
        mirrors.push(mirror.below(*scale));
    }
}

/// Returns an error if a joint appears twice.
pub(super) fn check_named_once(names: &[String]) -> Result<(), RetargetError> {
    let mut seen = std::collections::BTreeSet::new();
    match names.iter().find(|name| !seen.insert(name.as_str())) {
        Some(joint) => Err(RetargetError::NamedTwice {
            joint: joint.clone(),
        }),
        None => Ok(()),
    }
}
