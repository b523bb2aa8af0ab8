//! Kinematic models: joints, frames and limits, immutable once built.

mod ball_joint;
mod builder;
mod closed_loop;
mod configuration;
mod error;
mod id;
mod joint;
mod joint_chains;
mod length_unit;
mod limits;
mod masses;
mod parameter_map;
mod parameter_map_builder;
mod path;
mod reference;
mod scaled;
mod segment;
#[cfg(feature = "serde")]
mod serialised;
mod unknown_name;

use std::collections::HashMap;

pub use ball_joint::{BallLimits, BallVariables, RotationChart};
#[doc(hidden)]
pub use builder::ModelBuilder;
pub use closed_loop::{Loop, LoopKind};
pub use error::ModelError;
pub use id::{FrameId, JointId};
pub use joint::{Joint, JointKind};
pub use length_unit::LengthUnit;
pub use limits::Limits;
#[doc(hidden)]
pub use masses::moving_joint;
pub use masses::{Masses, PointMass};
#[doc(hidden)]
pub use parameter_map::check_configuration;
pub use parameter_map::{ParameterMap, Source};
pub use parameter_map_builder::ParameterMapBuilder;
pub use reference::{FrameRef, JointRef, Reference};
#[doc(hidden)]
#[doc(hidden)]
pub use segment::{Segment, SegmentKind, quaternion_at};
pub use unknown_name::UnknownName;

use crate::spatial::{Placement, Vector3};

/// A named frame on a joint: a link, a bone's tip, a tool centre point.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Frame {
    /// Name, unique within the model.
    pub name: String,
    /// The joint that carries it; `None` for a frame fixed in the world.
    pub joint: Option<JointId>,
    /// Placement of the frame in its joint's frame.
    pub joint_from_frame: Placement<f64>,
}

/// A tree of joints, parents before children, immutable once built.
///
/// A configuration `q` has one number for each moving joint except ball joints, in the order of
/// [`moving_joints`](Self::moving_joints): radians for revolute and continuous joints, metres for prismatic joints. A
/// ball joint has four: its unit quaternion w, x, y, z. A [free joint](ModelBuilder::free) is three prismatic joints
/// and a ball joint; its coordinates are x, y, z, w, x, y, z.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        try_from = "serialised::ModelDocument",
        into = "serialised::ModelDocument"
    )
)]
pub struct Model {
    name: String,
    length_unit: LengthUnit,
    joints: Vec<Joint>,
    frames: Vec<Frame>,
    loops: Vec<Loop>,
    /// The joint of each coordinate of a configuration.
    moving: Vec<JointId>,
    /// The first coordinate of each joint; `None` for a fixed joint.
    coordinates: Vec<Option<usize>>,
    /// Parts of a configuration that are integrated together, in its order.
    segments: Vec<Segment>,
    /// The first prismatic joint of each free joint; its other joints follow.
    free: Vec<JointId>,
    joint_by_name: HashMap<String, JointId>,
    frame_by_name: HashMap<String, FrameId>,
}

impl Model {
    /// Starts an empty model.
    #[must_use]
    pub fn builder(name: impl Into<String>) -> ModelBuilder {
        ModelBuilder::new(name)
    }

    /// The unit of lengths.
    #[must_use]
    pub fn length_unit(&self) -> LengthUnit {
        self.length_unit
    }

    /// The model's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// All joints, parents before children.
    #[must_use]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// All frames.
    #[must_use]
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// The loop closures, which are constraints of every problem on the model; a configuration may leave them open.
    #[must_use]
    pub fn loops(&self) -> &[Loop] {
        &self.loops
    }

    /// Number of coordinates of a configuration: four for a ball joint, one for every other moving joint.
    #[must_use]
    pub fn configuration_len(&self) -> usize {
        self.moving.len()
    }

    /// The joint of each coordinate of a configuration; a ball joint occurs four times.
    #[must_use]
    pub fn moving_joints(&self) -> &[JointId] {
        &self.moving
    }

    /// The first prismatic joint of each [free](ModelBuilder::free) joint; its other joints follow.
    #[must_use]
    pub fn free_joints(&self) -> &[JointId] {
        &self.free
    }

    /// Number of components of a velocity: three for a ball joint, one for every other moving joint.
    #[must_use]
    pub fn degrees_of_freedom(&self) -> usize {
        let last = self.segments.last();
        last.map_or(0, |last| last.velocity + last.kind.degrees_of_freedom())
    }

    /// All joint ids, parents before children.
    pub fn joint_ids(&self) -> impl Iterator<Item = JointId> + use<> {
        (0..self.joints.len()).map(JointId::new)
    }

    /// All frame ids.
    pub fn frame_ids(&self) -> impl Iterator<Item = FrameId> + use<> {
        (0..self.frames.len()).map(FrameId::new)
    }

    /// Index of a joint's first coordinate in a configuration.
    ///
    /// Returns `None` for a fixed joint or an id that is not in the model.
    #[must_use]
    pub fn coordinate(&self, joint: JointId) -> Option<usize> {
        self.coordinates.get(joint.index()).copied().flatten()
    }

    /// Limits of every coordinate, in configuration order.
    ///
    /// A ball joint's four are [-1, 1]; its cone is in [`Joint::ball`].
    pub fn limits(&self) -> impl Iterator<Item = Limits> + '_ {
        self.moving.iter().map(|id| {
            let joint = &self.joints[id.index()];
            match joint.kind {
                JointKind::Ball => Limits::new(-1.0, 1.0),
                _ => joint.limits,
            }
        })
    }

    /// The joint of this name.
    ///
    /// # Errors
    /// Returns an error with the valid names for an unknown name.
    pub fn joint(&self, name: &str) -> Result<JointId, UnknownName> {
        self.joint_by_name.get(name).copied().ok_or_else(|| {
            UnknownName::new("joint", name, self.joints.iter().map(|j| j.name.as_str()))
        })
    }

    /// The frame of this name.
    ///
    /// # Errors
    /// Returns an error with the valid names for an unknown name.
    pub fn frame(&self, name: &str) -> Result<FrameId, UnknownName> {
        self.frame_by_name.get(name).copied().ok_or_else(|| {
            UnknownName::new("frame", name, self.frames.iter().map(|f| f.name.as_str()))
        })
    }

    /// The joint of a coordinate.
    #[doc(hidden)]
    pub fn joint_of(&self, coordinate: usize) -> &Joint {
        &self.joints[self.moving[coordinate].index()]
    }

    /// The model with new joint origins, in the parent joint's axes, metres: links of other lengths.
    ///
    /// # Errors
    /// Returns an error for a joint id that is not in the model or an origin that is not finite.
    pub fn with_joint_origins(
        mut self,
        origins: impl IntoIterator<Item = (JointId, [f64; 3])>,
    ) -> Result<Self, ModelError> {
        for (id, origin) in origins {
            let Some(joint) = self.joints.get_mut(id.index()) else {
                return Err(ModelError::ForeignId {
                    kind: "joint number",
                    name: id.index().to_string(),
                });
            };
            joint.parent_from_joint.translation = origin.into();
            builder::check_placement("joint", &joint.name, &mut joint.parent_from_joint)?;
        }
        Ok(self)
    }

    /// Moves a joint's origin on its parent and keeps its rotation; for modules that own the model.
    #[doc(hidden)]
    pub fn move_joint(&mut self, joint: JointId, translation: Vector3<f64>) {
        if let Some(joint) = self.joints.get_mut(joint.index()) {
            joint.parent_from_joint.translation = translation;
        }
    }

    /// Sets a joint's placement on its parent; for modules that own the model.
    #[doc(hidden)]
    pub fn place_joint(&mut self, joint: JointId, parent_from_joint: Placement<f64>) {
        if let Some(joint) = self.joints.get_mut(joint.index()) {
            joint.parent_from_joint = parent_from_joint;
        }
    }

    /// Moves a frame's origin on its joint and keeps its rotation.
    #[doc(hidden)]
    pub fn move_frame(&mut self, frame: FrameId, translation: Vector3<f64>) {
        if let Some(frame) = self.frames.get_mut(frame.index()) {
            frame.joint_from_frame.translation = translation;
        }
    }

    /// Length of the longest lever of the model, in metres; 0 if no joint moves. Tolerances and weights scale with it.
    ///
    /// It is the longest chain from the first moving joint above a frame to that frame. Offsets between joints count
    /// fully. The travel of a prismatic joint below a rotating joint counts up to the longest sum of offsets. Prismatic
    /// joints above all rotating joints lengthen no lever and do not count, unless no joint rotates. Frames in the
    /// world do not count, nor do fixed and locked joints next to the root.
    #[must_use]
    pub fn reach(&self) -> f64 {
        let rigid = self.longest_chain(|_, _| 0.0);
        let any_rotates = self.joints.iter().any(Joint::turns);
        self.longest_chain(|joint, rotates| match rotates || !any_rotates {
            true if rigid > 0.0 => travel(joint).min(rigid),
            true => travel(joint),
            false => 0.0,
        })
    }

    /// The longest chain from the first moving joint above a frame to that frame, metres.
    ///
    /// Sums offsets and `travel(joint, rotates)` of each moving joint; `rotates` is true if a joint above it rotates.
    fn longest_chain(&self, travel: impl Fn(&Joint, bool) -> f64) -> f64 {
        // By joint: the length up to it (`None` if no joint up to it moves), and whether a joint up to it rotates.
        let mut lengths: Vec<(Option<f64>, bool)> = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            let above = joint.parent.map(|p| lengths[p.index()]);
            let (length_before, rotates) = above.unwrap_or((None, false));
            let length_before =
                length_before.map(|b| b + joint.parent_from_joint.translation.norm());
            let chain_length = match joint.moves() {
                true => Some(length_before.unwrap_or(0.0) + travel(joint, rotates)),
                false => length_before,
            };
            lengths.push((chain_length, rotates || joint.turns()));
        }
        let tips = self.frames.iter().filter_map(|frame| {
            let length_before = lengths[frame.joint?.index()].0?;
            Some(length_before + frame.joint_from_frame.translation.norm())
        });
        tips.chain(lengths.iter().filter_map(|(length, _)| *length))
            .fold(0.0, f64::max)
    }

    /// Half width of the sampling range of a joint without limits.
    ///
    /// π for rotations. For prismatic joints, their travel if it is of the order of the reach or less, otherwise the
    /// reach; never below the reach.
    #[doc(hidden)]
    pub fn sampling_spread(&self, joint: &Joint, reach: f64) -> f64 {
        const MAX_TRAVEL_RATIO: f64 = 100.0;
        // Lengths in files may have an infinite sum; samples must be finite.
        let reach = reach.min(f64::MAX / 100.0);
        match travel(joint) {
            _ if !joint.kind.slides() => std::f64::consts::PI,
            // Without a lever, the travel is the only length of the model.
            travel if reach == 0.0 || travel <= MAX_TRAVEL_RATIO * reach => travel.max(reach),
            _ => reach,
        }
    }
}

/// Largest distance of a prismatic joint from zero, metres.
///
/// 0 for other joints and beyond 1e9: files write numbers like 1e16 for "no limit".
fn travel(joint: &Joint) -> f64 {
    const MIN_PLACEHOLDER: f64 = 1e9;
    let farthest = joint.limits.lower.abs().max(joint.limits.upper.abs());
    match joint.kind.slides() && farthest < MIN_PLACEHOLDER {
        true => farthest,
        false => 0.0,
    }
}
