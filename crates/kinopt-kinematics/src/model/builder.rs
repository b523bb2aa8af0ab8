//! Model builder, which checks the whole model once.

use std::collections::{HashMap, HashSet};

use super::segment::segments;
use super::{
    Frame, FrameId, Joint, JointId, JointKind, LengthUnit, Limits, Loop, Model, ModelError,
};
use crate::spatial::{Placement, Vector3};

/// Largest deviation of RᵀR of a placement from the identity, per entry.
const ORTHONORMALITY_TOLERANCE: f64 = 1e-6;

const MAX_COUNT: usize = u32::MAX as usize;

/// Collects joints and frames; [`build`](Self::build) checks them all.
///
/// Add the parent of a joint before the joint.
///
/// ```
/// use kinopt::model::{Limits, Model};
/// use kinopt::spatial::{Placement, Vector3};
///
/// let mut builder = Model::builder("pendulum");
/// let down = Vector3::new(0.0, 0.0, -1.0);
/// let pivot = builder.revolute(
///     "pivot", None, Placement::identity(), Vector3::new(1.0, 0.0, 0.0), Limits::new(-1.0, 1.0));
/// builder.frame("bob", Some(pivot), Placement::translation(down));
/// let model = builder.build()?;
/// assert_eq!(model.degrees_of_freedom(), 1);
/// # Ok::<(), kinopt::model::ModelError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ModelBuilder {
    name: String,
    length_unit: LengthUnit,
    joints: Vec<Joint>,
    frames: Vec<Frame>,
    loops: Vec<Loop>,
    configuration_order: Option<Vec<JointId>>,
    /// The first prismatic joint of each free joint.
    pub(super) free: Vec<JointId>,
}

impl ModelBuilder {
    /// An empty model.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            length_unit: LengthUnit::default(),
            joints: Vec::new(),
            frames: Vec::new(),
            loops: Vec::new(),
            configuration_order: None,
            free: Vec::new(),
        }
    }

    /// A builder that starts from a built model, to add joints or frames.
    ///
    /// The ids of existing joints and frames stay valid.
    #[must_use]
    pub fn from_model(model: &Model) -> Self {
        Self {
            name: model.name.clone(),
            length_unit: model.length_unit,
            joints: model.joints.clone(),
            frames: model.frames.clone(),
            loops: model.loops.clone(),
            configuration_order: Some(model.configuration_order()),
            free: model.free.clone(),
        }
    }

    /// A builder for `model` on a base: `add` may add joints first and return the one that carries the model.
    ///
    /// Joints and frames of the world are attached to that joint. Frames keep their ids; joints come after the added
    /// ones.
    #[doc(hidden)]
    pub fn on_base(model: &Model, add: impl FnOnce(&mut Self) -> Option<JointId>) -> Self {
        let mut builder = Self::new(model.name.clone());
        builder.length_unit = model.length_unit;
        let base = add(&mut builder);
        let added = builder.joints.len();
        let shifted_id = |id: JointId| JointId::new(id.index() + added);
        let added_ids = (0..added).map(JointId::new);
        let order = model.configuration_order().into_iter().map(shifted_id);
        builder.configuration_order = Some(added_ids.chain(order).collect());
        builder
            .free
            .extend(model.free.iter().copied().map(shifted_id));
        builder
            .joints
            .extend(model.joints.iter().map(|joint| Joint {
                parent: joint.parent.map(shifted_id).or(base),
                ..joint.clone()
            }));
        builder
            .frames
            .extend(model.frames.iter().map(|frame| Frame {
                joint: frame.joint.map(shifted_id).or(base),
                ..frame.clone()
            }));
        builder.loops.clone_from(&model.loops);
        builder
    }

    /// Sets the unit of lengths in texts for people; metres by default.
    pub fn length_unit(&mut self, unit: LengthUnit) {
        self.length_unit = unit;
    }

    /// Sets the order of the moving joints in a configuration, if it differs from the order of the joints.
    ///
    /// `joints` must contain every moving joint once.
    pub fn configuration_order(&mut self, joints: Vec<JointId>) {
        self.configuration_order = Some(joints);
    }

    /// Sets the free joints, by their first prismatic joints.
    #[cfg(feature = "serde")]
    pub(super) fn free_joints(&mut self, first: Vec<JointId>) {
        self.free = first;
    }

    /// Adds a joint of any kind. Its axis need not be of unit length.
    pub fn joint(&mut self, joint: Joint) -> JointId {
        self.joints.push(joint);
        JointId::new(self.joints.len() - 1)
    }

    /// The present limits of a joint.
    #[doc(hidden)]
    pub fn limits(&self, joint: JointId) -> Option<Limits> {
        self.joints.get(joint.index()).map(|joint| joint.limits)
    }

    /// Intersects the limits of a joint with `limits`.
    ///
    /// A continuous joint becomes a revolute joint; a fixed joint does not change.
    #[doc(hidden)]
    pub fn narrow(&mut self, joint: JointId, limits: Limits) {
        if let Some(joint) = self.joints.get_mut(joint.index()) {
            joint.limits = joint.limits.intersection(&limits);
            joint.kind = joint.kind.within(&joint.limits);
        }
    }

    /// Replaces the limits of a joint. A continuous joint becomes a revolute joint; a fixed joint does not change.
    #[doc(hidden)]
    pub fn replace_limits(&mut self, joint: JointId, limits: Limits) {
        let joint = self.joints.get_mut(joint.index());
        if let Some(joint) = joint.filter(|joint| joint.kind != JointKind::Fixed) {
            joint.limits = limits;
            joint.kind = joint.kind.within(&limits);
        }
    }

    /// Adds a joint that rotates about `axis` (joint frame), with limits in radians.
    pub fn revolute(
        &mut self,
        name: impl Into<String>,
        parent: Option<JointId>,
        parent_from_joint: impl Into<Placement<f64>>,
        axis: impl Into<Vector3<f64>>,
        limits: Limits,
    ) -> JointId {
        let (placement, kind) = (parent_from_joint, JointKind::Revolute);
        self.joint(Joint::new(name, parent, placement, kind, axis, limits))
    }

    /// Adds a joint that rotates about `axis` (joint frame) without limits.
    pub fn continuous(
        &mut self,
        name: impl Into<String>,
        parent: Option<JointId>,
        parent_from_joint: impl Into<Placement<f64>>,
        axis: impl Into<Vector3<f64>>,
    ) -> JointId {
        let (placement, kind, limits) =
            (parent_from_joint, JointKind::Continuous, Limits::UNBOUNDED);
        self.joint(Joint::new(name, parent, placement, kind, axis, limits))
    }

    /// Adds a joint that translates along `axis` (joint frame), with limits in metres.
    pub fn prismatic(
        &mut self,
        name: impl Into<String>,
        parent: Option<JointId>,
        parent_from_joint: impl Into<Placement<f64>>,
        axis: impl Into<Vector3<f64>>,
        limits: Limits,
    ) -> JointId {
        let (placement, kind) = (parent_from_joint, JointKind::Prismatic);
        self.joint(Joint::new(name, parent, placement, kind, axis, limits))
    }

    /// Adds a joint that does not move.
    pub fn fixed(
        &mut self,
        name: impl Into<String>,
        parent: Option<JointId>,
        parent_from_joint: impl Into<Placement<f64>>,
    ) -> JointId {
        let (placement, kind, locked) =
            (parent_from_joint, JointKind::Fixed, Limits::new(0.0, 0.0));
        self.joint(Joint::new(
            name,
            parent,
            placement,
            kind,
            Vector3::UNITS[0],
            locked,
        ))
    }

    /// Adds a frame on a joint, or in the world.
    pub fn frame(
        &mut self,
        name: impl Into<String>,
        joint: Option<JointId>,
        joint_from_frame: impl Into<Placement<f64>>,
    ) -> FrameId {
        self.frames.push(Frame {
            name: name.into(),
            joint,
            joint_from_frame: joint_from_frame.into(),
        });
        FrameId::new(self.frames.len() - 1)
    }

    /// Adds a loop closure. Every problem on the model has it as a constraint.
    pub fn close(&mut self, closed: Loop) {
        self.loops.push(closed);
    }

    /// Checks all parts and builds the model.
    ///
    /// # Errors
    /// Returns the first invalid joint, frame or loop by name:
    /// - duplicate names;
    /// - parents that are not in the model or come later;
    /// - limits that are not an interval, axes without direction;
    /// - placements that are not rigid: RᵀR must be the identity within 1e-6 per entry;
    /// - loops of frames that are not in the model, or of one frame with itself;
    /// - loops that no configuration closes, detected if one link is longer than all other links of the loop together.
    ///
    /// A rotation that is off by more than rounding is replaced by the nearest exact one. Ids are indices: an id of
    /// another model is an error only if it is out of range.
    pub fn build(mut self) -> Result<Model, ModelError> {
        check_count("joint", self.joints.len())?;
        check_count("frame", self.frames.len())?;

        let mut joint_by_name = HashMap::with_capacity(self.joints.len());
        let mut moving = Vec::new();
        for (index, joint) in self.joints.iter_mut().enumerate() {
            check_joint(index, joint)?;
            let id = JointId::new(index);
            if joint_by_name.insert(joint.name.clone(), id).is_some() {
                return Err(duplicate("joint", &joint.name));
            }
            if joint.kind.moves() {
                moving.push(id);
            }
        }
        if let Some(order) = self.configuration_order {
            let mut sorted = order.clone();
            sorted.sort_unstable();
            if sorted != moving {
                return Err(ModelError::BadConfigurationOrder {
                    given: order.len(),
                    moving: moving.len(),
                });
            }
            moving = order;
        }
        let segments = segments(&self.joints, &moving, &self.free)?;
        let mut coordinates = vec![None; self.joints.len()];
        let mut joint_of = Vec::with_capacity(moving.len());
        for id in moving {
            coordinates[id.index()] = Some(joint_of.len());
            let count = self.joints[id.index()].kind.coordinates();
            joint_of.extend(std::iter::repeat_n(id, count));
        }

        let mut frame_by_name = HashMap::with_capacity(self.frames.len());
        for (index, frame) in self.frames.iter_mut().enumerate() {
            if frame.joint.is_some_and(|j| j.index() >= self.joints.len()) {
                return Err(ModelError::ForeignId {
                    kind: "frame",
                    name: frame.name.clone(),
                });
            }
            check_placement("frame", &frame.name, &mut frame.joint_from_frame)?;
            let id = FrameId::new(index);
            if frame_by_name.insert(frame.name.clone(), id).is_some() {
                return Err(duplicate("frame", &frame.name));
            }
        }

        let mut loop_names = HashSet::with_capacity(self.loops.len());
        for closed in &mut self.loops {
            let name = closed.name.as_str();
            if !loop_names.insert(name.to_owned()) {
                return Err(duplicate("loop", name));
            }
            if closed.frames.iter().any(|f| f.index() >= self.frames.len()) {
                let name = name.to_owned();
                return Err(ModelError::ForeignLoop { name });
            }
            if closed.frames[0] == closed.frames[1] {
                return Err(ModelError::LoopOfOneFrame {
                    name: name.to_owned(),
                    frame: self.frames[closed.frames[0].index()].name.clone(),
                });
            }
            for anchor in &mut closed.frame_from_place {
                check_placement("loop", &closed.name, anchor)?;
            }
        }

        let model = Model {
            name: self.name,
            length_unit: self.length_unit,
            joints: self.joints,
            frames: self.frames,
            loops: self.loops,
            moving: joint_of,
            coordinates,
            segments,
            free: self.free,
            joint_by_name,
            frame_by_name,
        };
        let mut loops = model.loops.iter();
        loops.try_for_each(|closed| model.check_closes(closed))?;
        Ok(model)
    }
}

impl Model {
    /// The moving joints in the order of a configuration, each once.
    pub(super) fn configuration_order(&self) -> Vec<JointId> {
        let mut order = self.moving.clone();
        order.dedup();
        order
    }

    /// The model without limits on any joint, locked joints included.
    #[doc(hidden)]
    pub fn without_limits(&self) -> Self {
        let mut model = self.clone();
        for joint in model.joints.iter_mut().filter(|joint| joint.kind.moves()) {
            joint.limits = Limits::UNBOUNDED;
        }
        model
    }

    /// The model with a new placement of one frame on its joint.
    ///
    /// # Errors
    /// Returns an error for a placement that is not rigid, as [`ModelBuilder::build`] does.
    #[doc(hidden)]
    pub fn with_frame_at(
        &self,
        frame: FrameId,
        mut joint_from_frame: Placement<f64>,
    ) -> Result<Self, ModelError> {
        let mut model = self.clone();
        if let Some(frame) = model.frames.get_mut(frame.index()) {
            check_placement("frame", &frame.name, &mut joint_from_frame)?;
            frame.joint_from_frame = joint_from_frame;
        }
        Ok(model)
    }
}

fn check_count(kind: &'static str, count: usize) -> Result<(), ModelError> {
    if count > MAX_COUNT {
        return Err(ModelError::TooMany {
            kind,
            limit: MAX_COUNT,
        });
    }
    Ok(())
}

fn duplicate(kind: &'static str, name: &str) -> ModelError {
    ModelError::DuplicateName {
        kind,
        name: name.to_owned(),
    }
}

fn check_joint(index: usize, joint: &mut Joint) -> Result<(), ModelError> {
    if joint.parent.is_some_and(|p| p.index() >= index) {
        return Err(ModelError::ForeignId {
            kind: "joint",
            name: joint.name.clone(),
        });
    }
    check_placement("joint", &joint.name, &mut joint.parent_from_joint)?;
    if !joint.limits.is_valid() {
        return Err(ModelError::BadLimits {
            joint: joint.name.clone(),
            lower: joint.limits.lower,
            upper: joint.limits.upper,
        });
    }
    if matches!(joint.kind, JointKind::Continuous | JointKind::Ball) {
        joint.limits = Limits::UNBOUNDED;
    }
    if !joint.kind.moves() {
        // The axis of a fixed joint is unused; this one is at least a direction.
        joint.axis = Vector3::new(1.0, 0.0, 0.0);
        return Ok(());
    }
    let Vector3 { x, y, z } = joint.axis;
    // Scaled as in `hypot`: an axis of length 1e-200 still has a direction.
    let largest = x.abs().max(y.abs()).max(z.abs());
    if !(largest > 0.0 && largest.is_finite() && (x + y + z).is_finite()) {
        return Err(ModelError::BadAxis {
            joint: joint.name.clone(),
            x,
            y,
            z,
        });
    }
    let scaled = Vector3::new(x / largest, y / largest, z / largest);
    joint.axis = scaled * (1.0 / scaled.norm());
    let fault = match (joint.kind, &joint.ball) {
        (_, None) => None,
        (JointKind::Ball, Some(limits)) => limits.fault(joint.axis),
        (_, Some(_)) => Some("cone limits, but it is not a ball joint"),
    };
    match fault {
        None => Ok(()),
        Some(problem) => Err(ModelError::BadBallLimits {
            joint: joint.name.clone(),
            problem,
        }),
    }
}

/// Checks that a placement is a finite rigid motion and replaces its rotation by the nearest exact one.
pub(super) fn check_placement(
    kind: &'static str,
    name: &str,
    placement: &mut Placement<f64>,
) -> Result<(), ModelError> {
    placement
        .check_rigid(ORTHONORMALITY_TOLERANCE)
        .map(|()| *placement = placement.made_rigid())
        .map_err(|problem| ModelError::BadPlacement {
            kind,
            name: name.to_owned(),
            problem,
        })
}
