//! Skeletons of twist-bend-twist bones, compiled to a [`Model`].
//!
//! A canonical bone lies along x from its tail at 0 to its tip at (ℓ, 0, 0). The rest placement T̂ maps it to the
//! model. A pose rotates it by R_x(θ₃) R_z(θ₂) R_x(θ₁) in its canonical frame, after the pose of its parent.
//!
//! In the model a bone is three revolute joints at one point. A configuration is the stacked vector (θ₁₁, θ₁₂, θ₁₃,
//! θ₂₁, …) in radians, bone by bone. Bones come after their parents. Tips of leaf bones are the usual end effectors.
//!
//! A bone with a [`Hinge`] rotates about one axis: its bend is the angle about it, and its twists are locked.
//!
//! A [`BallSkeleton`] has the same bones on ball joints within cones, and the same hinges.

mod ball_skeleton;
mod bone;
mod builder;
mod cone;
mod hinge;
mod holds;
mod pose;
#[cfg(feature = "serde")]
mod serialised;

use std::collections::{BTreeMap, HashMap, HashSet};

pub use ball_skeleton::{BallSkeleton, SkeletonRoot};
pub use bone::{Bone, BoneId};
pub use builder::SkeletonBuilder;
pub use cone::{BoneCone, Cones};
pub use hinge::{Hinge, Hinges};
pub use holds::Holds;
pub use pose::{BonePlacements, Posing};

use self::hinge::HingedBone;
use crate::model::{FrameId, JointId, LengthUnit, Limits, Model, ModelError, UnknownName};
use crate::spatial::{Placement, Vector3};

/// Number of angles per bone in the stacked vector.
pub const ANGLES_PER_BONE: usize = 3;

/// A checked tree of bones, parents before children, with its compiled model.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        try_from = "serialised::SkeletonParts",
        into = "serialised::SkeletonParts"
    )
)]
pub struct Skeleton {
    bones: Vec<Bone>,
    hinges: BTreeMap<BoneId, HingedBone>,
    model: Model,
    by_name: HashMap<String, BoneId>,
}

impl Skeleton {
    /// Starts an empty skeleton.
    #[must_use]
    pub fn builder(name: impl Into<String>) -> SkeletonBuilder {
        SkeletonBuilder::new(name.into())
    }

    /// Checks the bones and compiles them to a model.
    ///
    /// The frames of the model are `NAME` (the bone's frame at its tail) and `NAME/tip`. If a bone has the name
    /// `NAME/tip`, as End Sites of motion capture have, the frame is the first unused of `NAME/tip/2`, `NAME/tip/3`, …
    ///
    /// The joints are `NAME/twist2`, `NAME/bend` and `NAME/twist1`, from the parent outwards. A child is attached to
    /// its parent's canonical frame, also if its tail is not at the parent's tip.
    ///
    /// # Errors
    /// The first faulty bone, by name: a parent that does not come before it, a negative or non-finite length, invalid
    /// limits, or a repeated name. Also a rest placement that is not rigid within 1e-6; within that tolerance the
    /// nearest rigid one is used.
    pub fn new(name: impl Into<String>, bones: Vec<Bone>) -> Result<Self, ModelError> {
        Self::assemble(name.into(), bones, BTreeMap::new())
    }

    /// As [`new`](Self::new), with hinges whose limits are those of their bones.
    fn assemble(
        name: String,
        mut bones: Vec<Bone>,
        hinges: BTreeMap<BoneId, HingedBone>,
    ) -> Result<Self, ModelError> {
        let mut by_name = HashMap::with_capacity(bones.len());
        for (index, bone) in bones.iter_mut().enumerate() {
            bone.check(index)?;
            bone.model_from_rest = bone.model_from_rest.made_rigid();
            if by_name
                .insert(bone.name.clone(), BoneId::new(index))
                .is_some()
            {
                return Err(ModelError::DuplicateName {
                    kind: "bone",
                    name: bone.name.clone(),
                });
            }
        }
        let model = compile(name, &bones, &hinges)?;
        Ok(Self {
            bones,
            hinges,
            model,
            by_name,
        })
    }

    /// The skeleton moved as a whole into a scene: every rest placement T̂ becomes P T̂. Targets of problems on its
    /// model are then positions in the scene. Angles and limits keep their meaning.
    ///
    /// An unmoved mesh is skinned by the [`skinning_transforms`](BonePlacements::skinning_transforms) of the placed
    /// skeleton's poses with the original skeleton. [`BonePlacements::placed`] moves a single pose at lower cost.
    ///
    /// # Errors
    /// [`ModelError::BadRest`] for the first bone if P is not a rigid motion.
    pub fn placed(&self, scene_from_model: impl Into<Placement<f64>>) -> Result<Self, ModelError> {
        let scene_from_model = scene_from_model.into();
        let mut bones = self.bones.clone();
        for bone in &mut bones {
            bone.model_from_rest = scene_from_model * bone.model_from_rest;
        }
        Self::assemble(self.model.name().to_owned(), bones, self.hinges.clone())
    }

    /// Moves the joint of a bone on its parent and the tip on the bone, in the model only: for layers that own the
    /// skeleton and solve on that model.
    #[doc(hidden)]
    pub fn move_bone(&mut self, bone: BoneId, position: Vector3<f64>, tip: Vector3<f64>) {
        let first = JointId::new(ANGLES_PER_BONE * bone.index());
        let frame = self.tip(bone);
        self.model.move_joint(first, position);
        self.model.move_frame(frame, tip);
    }

    /// The bones, parents before children.
    #[must_use]
    pub fn bones(&self) -> &[Bone] {
        &self.bones
    }

    /// The compiled model, for problems.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Number of angles of a configuration: three per bone.
    #[must_use]
    pub fn angles(&self) -> usize {
        ANGLES_PER_BONE * self.bones.len()
    }

    /// The model frame at a bone's tail, with the bone's canonical axes.
    #[must_use]
    pub fn tail(&self, bone: BoneId) -> FrameId {
        FrameId::new(2 * bone.index())
    }

    /// The model frame at a bone's tip, with the bone's canonical axes.
    #[must_use]
    pub fn tip(&self, bone: BoneId) -> FrameId {
        FrameId::new(2 * bone.index() + 1)
    }

    /// All bone ids in order.
    pub fn bone_ids(&self) -> impl Iterator<Item = BoneId> + use<> {
        (0..self.bones.len()).map(BoneId::new)
    }

    /// The id of the bone at an index of [`bones`](Self::bones).
    #[must_use]
    pub fn bone_at(&self, index: usize) -> Option<BoneId> {
        (index < self.bones.len()).then(|| BoneId::new(index))
    }

    /// Looks up a bone by name.
    ///
    /// # Errors
    /// An unknown name. The error lists the valid ones.
    pub fn bone(&self, name: &str) -> Result<BoneId, UnknownName> {
        self.by_name.get(name).copied().ok_or_else(|| {
            UnknownName::new("bone", name, self.bones.iter().map(|b| b.name.as_str()))
        })
    }

    /// The joints of a bone in the order of its angles: first twist, bend, second twist.
    #[must_use]
    pub fn joints(&self, bone: BoneId) -> [JointId; ANGLES_PER_BONE] {
        let first = ANGLES_PER_BONE * bone.index();
        [first + 2, first + 1, first].map(JointId::new)
    }

    /// The bone of a model frame, and true if the frame is at its tip.
    #[must_use]
    pub fn bone_of_frame(&self, frame: FrameId) -> Option<(BoneId, bool)> {
        let bone = self.bone_at(frame.index() / 2)?;
        Some((bone, frame.index() % 2 == 1))
    }

    /// Diagonal of the bounding box of all tails and tips at rest, in the rig's unit. Tolerances scale with it.
    #[must_use]
    pub fn size(&self) -> f64 {
        let ends = self
            .bones
            .iter()
            .flat_map(|bone| [bone.rest_tail(), bone.rest_tip()]);
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for point in ends {
            for (axis, value) in point.to_array().into_iter().enumerate() {
                low[axis] = low[axis].min(value);
                high[axis] = high[axis].max(value);
            }
        }
        let sides = [0, 1, 2].map(|axis| (high[axis] - low[axis]).max(0.0));
        let squared: f64 = sides.iter().map(|side| side * side).sum();
        squared.sqrt()
    }
}

/// Compiles each bone to three revolute joints: x by θ₃ on the parent, then z (or the axis of a hinge) by θ₂, then x by
/// θ₁.
fn compile(
    name: String,
    bones: &[Bone],
    hinges: &BTreeMap<BoneId, HingedBone>,
) -> Result<Model, ModelError> {
    let about_x = Vector3::new(1.0, 0.0, 0.0);
    let about_z = Vector3::new(0.0, 0.0, 1.0);
    let mut builder = Model::builder(name);
    builder.length_unit(LengthUnit::Own);
    let mut order = Vec::with_capacity(ANGLES_PER_BONE * bones.len());
    let mut last_joint: Vec<JointId> = Vec::with_capacity(bones.len());
    let used_names: HashSet<&str> = bones.iter().map(|bone| bone.name.as_str()).collect();
    for (index, bone) in bones.iter().enumerate() {
        let (parent, parent_from_bone) = match bone.parent {
            Some(parent) => {
                let parent_from_model = bones[parent.index()].model_from_rest.inverse();
                let placed = parent_from_model * bone.model_from_rest;
                (Some(last_joint[parent.index()]), placed)
            }
            None => (None, bone.model_from_rest),
        };
        let mut add_revolute = |part: &str, parent, placement, axis, limits: Limits| {
            builder.revolute(
                format!("{}/{part}", bone.name),
                parent,
                placement,
                axis,
                limits,
            )
        };
        let [first, bend, second] = bone.limits;
        let identity = Placement::identity();
        let twist2 = add_revolute("twist2", parent, parent_from_bone, about_x, second);
        let hinge = hinges.get(&BoneId::new(index));
        let axis = hinge.map_or(about_z, |hinged| hinged.hinge.axis);
        let bend = add_revolute("bend", Some(twist2), identity, axis, bend);
        let twist1 = add_revolute("twist1", Some(bend), identity, about_x, first);
        order.extend([twist1, bend, twist2]);
        last_joint.push(twist1);

        builder.frame(bone.name.clone(), Some(twist1), identity);
        let tip = Vector3::new(bone.length, 0.0, 0.0);
        let tip_name = free_name(format!("{}/tip", bone.name), &used_names);
        builder.frame(tip_name, Some(twist1), Placement::translation(tip));
    }
    builder.configuration_order(order);
    builder.build()
}

/// The name, or the first numbered one that no bone has. Results are unique, as names of bones are.
fn free_name(name: String, used_names: &HashSet<&str>) -> String {
    let numbered = (2..).map(|number| format!("{name}/{number}"));
    let free = std::iter::once(name.clone())
        .chain(numbered)
        .find(|name| !used_names.contains(name.as_str()));
    free.unwrap_or(name)
}
