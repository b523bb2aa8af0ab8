//! The articulated model: joints, frames and limits, immutable once built.

mod ball;
mod ball_variables;
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
mod rotation_chart;
mod scaled;
mod segment;
#[cfg(feature = "serde")]
mod serialised;
mod unknown_name;

use std::collections::HashMap;

pub use ball::BallLimits;
pub(crate) use ball_variables::BallVariables;
pub use builder::ModelBuilder;
pub use closed_loop::{Loop, LoopKind};
pub use error::ModelError;
pub use id::{FrameId, JointId};
pub use joint::{Joint, JointKind};
pub use length_unit::LengthUnit;
pub use limits::Limits;
pub(crate) use masses::moving_joint;
pub use masses::{MassError, Masses, PointMass};
pub(crate) use parameter_map::check_configuration;
pub use parameter_map::{ParameterMap, Source};
pub use parameter_map_builder::ParameterMapBuilder;
pub use reference::{FrameRef, JointRef, Reference};
pub(crate) use rotation_chart::RotationChart;
pub(crate) use segment::{Segment, SegmentKind, quaternion_at};
pub use unknown_name::UnknownName;

use crate::spatial::{Placement, Vector3};

/// A named place on a joint: a link, a bone's tip, a tool point.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Frame {
    /// Unique within the model.
    pub name: String,
    /// The joint that carries it; `None` for a frame fixed in the world.
    pub joint: Option<JointId>,
    /// Where the frame stands in its joint's frame.
    pub joint_from_frame: Placement<f64>,
}

/// A tree of joints, parents before children, that no algorithm changes.
///
/// A configuration `q` has one number for each moving joint but balls, in the order of
/// [`moving_joints`](Self::moving_joints): radians for revolute and continuous joints, metres for
/// prismatic ones. A ball joint has four, its unit quaternion w, x, y, z. A
/// [free joint](ModelBuilder::free) is three slides and a ball, its q x, y, z, w, x, y, z.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "serialised::Parts", into = "serialised::Parts")
)]
pub struct Model {
    name: String,
    length_unit: LengthUnit,
    joints: Vec<Joint>,
    frames: Vec<Frame>,
    loops: Vec<Loop>,
    /// Coordinate k of a configuration is joint `moving[k]`'s.
    moving: Vec<JointId>,
    /// The first coordinate of each joint.
    coordinates: Vec<Option<usize>>,
    /// What moves as one, in the order of a configuration.
    segments: Vec<Segment>,
    /// The first slide of each free joint; its other slides and its ball follow.
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

    getters! {
        /// What its lengths are counted in.
        pub fn length_unit(&self) -> LengthUnit = self.length_unit;
        /// The model's name.
        pub fn name(&self) -> &str = &self.name;
        /// All joints, parents before children.
        pub fn joints(&self) -> &[Joint] = &self.joints;
        /// All frames.
        pub fn frames(&self) -> &[Frame] = &self.frames;
        /// The loops that every problem on the model closes; a configuration may leave them open.
        pub fn loops(&self) -> &[Loop] = &self.loops;
        /// How many numbers a configuration has: four for a ball joint, one for any other that moves.
        pub fn configuration_len(&self) -> usize = self.moving.len();
        /// The joint that each coordinate of a configuration is of: four times the same for a ball.
        pub fn moving_joints(&self) -> &[JointId] = &self.moving;
        /// The first slide of each [free](ModelBuilder::free) joint; its other slides and its ball follow.
        pub fn free_joints(&self) -> &[JointId] = &self.free;
    }

    /// How many numbers a velocity has: three for a ball joint, one for any other that moves.
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

    /// Where a joint's value stands in a configuration, or the first of a ball's four numbers; `None` for a
    /// fixed joint or an id beyond this model's joints.
    #[must_use]
    pub fn coordinate(&self, joint: JointId) -> Option<usize> {
        self.coordinates.get(joint.index()).copied().flatten()
    }

    /// The limits of every coordinate, in configuration order: from -1 to 1 for those of a ball, whose cone is
    /// in its [`Joint::ball`].
    pub fn limits(&self) -> impl Iterator<Item = Limits> + '_ {
        self.moving.iter().map(|id| {
            let joint = &self.joints[id.index()];
            match joint.kind {
                JointKind::Ball => Limits::new(-1.0, 1.0),
                _ => joint.limits,
            }
        })
    }

    /// Looks a joint up.
    ///
    /// # Errors
    /// An unknown name; the error tells the valid ones.
    pub fn joint(&self, name: &str) -> Result<JointId, UnknownName> {
        self.joint_by_name.get(name).copied().ok_or_else(|| {
            UnknownName::new("joint", name, self.joints.iter().map(|j| j.name.as_str()))
        })
    }

    /// Looks a frame up.
    ///
    /// # Errors
    /// An unknown name; the error tells the valid ones.
    pub fn frame(&self, name: &str) -> Result<FrameId, UnknownName> {
        self.frame_by_name.get(name).copied().ok_or_else(|| {
            UnknownName::new("frame", name, self.frames.iter().map(|f| f.name.as_str()))
        })
    }

    /// The joint whose coordinate it is.
    pub(crate) fn joint_of(&self, coordinate: usize) -> &Joint {
        &self.joints[self.moving[coordinate].index()]
    }

    /// The same model with the origins of some joints elsewhere on their parents (in the parent's axes, metres): links of
    /// other lengths.
    ///
    /// # Errors
    /// A joint beyond this model's, and a place that is not finite.
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

    /// Puts a joint elsewhere on its parent, turned as it was; for layers that own the model.
    pub(crate) fn move_joint(&mut self, joint: JointId, translation: Vector3<f64>) {
        if let Some(own) = self.joints.get_mut(joint.index()) {
            own.parent_from_joint.translation = translation;
        }
    }

    /// Puts a joint elsewhere on its parent and turns it; for layers that own the model.
    pub(crate) fn place_joint(&mut self, joint: JointId, parent_from_joint: Placement<f64>) {
        if let Some(own) = self.joints.get_mut(joint.index()) {
            own.parent_from_joint = parent_from_joint;
        }
    }

    /// Puts a frame elsewhere on its joint, turned as it was.
    pub(crate) fn move_frame(&mut self, frame: FrameId, translation: Vector3<f64>) {
        if let Some(own) = self.frames.get_mut(frame.index()) {
            own.joint_from_frame.translation = translation;
        }
    }

    /// How far what turns reaches, in metres: the longest way from the first moving joint above a
    /// frame to that frame, adding up offsets and the travel of slides that a joint above them turns,
    /// each slide by no more than the offsets' longest way. What does not move says nothing about the
    /// size of the model (frames in the world, fixed and locked joints next to the root), nor does
    /// how far a base may slide: it lengthens no lever. Where nothing turns, all slides count. It is
    /// the length by which tolerances and weights scale; 0 where nothing moves.
    #[must_use]
    pub fn reach(&self) -> f64 {
        let rigid = self.longest_way(|_, _| 0.0);
        let anything_turns = self.joints.iter().any(Joint::turns);
        self.longest_way(|joint, turned| match turned || !anything_turns {
            true if rigid > 0.0 => travel(joint).min(rigid),
            true => travel(joint),
            false => 0.0,
        })
    }

    /// The longest way from the first moving joint above a frame to it, by offsets and what `travel`
    /// adds for a moving joint, which hears whether one above it turns.
    fn longest_way(&self, travel: impl Fn(&Joint, bool) -> f64) -> f64 {
        // By joint: the length up to it, once something above or at it moves, and whether that turns.
        let mut length: Vec<(Option<f64>, bool)> = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            let above = joint.parent.map(|p| length[p.index()]);
            let (before, turned) = above.unwrap_or((None, false));
            let before = before.map(|b| b + joint.parent_from_joint.translation.norm());
            let here = match joint.moves() {
                true => Some(before.unwrap_or(0.0) + travel(joint, turned)),
                false => before,
            };
            length.push((here, turned || joint.turns()));
        }
        let tips = self.frames.iter().filter_map(|frame| {
            let before = length[frame.joint?.index()].0?;
            Some(before + frame.joint_from_frame.translation.norm())
        });
        tips.chain(length.iter().filter_map(|(length, _)| *length))
            .fold(0.0, f64::max)
    }

    /// How far from where it stands a joint is drawn at random where its limits mean none: half a
    /// turn; for slides the reach, or their travel where that is of the reach's order.
    pub(crate) fn sampling_spread(&self, joint: &Joint, reach: f64) -> f64 {
        const SAME_ORDER: f64 = 100.0;
        // Files may say lengths whose sum is no number any more; what is drawn must be one.
        let reach = reach.min(f64::MAX / 100.0);
        match travel(joint) {
            _ if !joint.kind.slides() => std::f64::consts::PI,
            // Where what turns has no lever, travel is all the size that there is.
            travel if reach == 0.0 || travel <= SAME_ORDER * reach => travel.max(reach),
            _ => reach,
        }
    }
}

/// How far a sliding joint goes from its zero. Files write numbers like 1e16 for "no limit".
fn travel(joint: &Joint) -> f64 {
    const PLACEHOLDER: f64 = 1e9;
    let farthest = joint.limits.lower.abs().max(joint.limits.upper.abs());
    match joint.kind.slides() && farthest < PLACEHOLDER {
        true => farthest,
        false => 0.0,
    }
}
