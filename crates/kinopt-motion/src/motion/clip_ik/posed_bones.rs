//! Model of the bones between a root and the end effectors, with its joints at the placements of a pose.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::ClipIkError;
use kinopt_animation::animation::{Armature, Mirror, Pose, Stretch, bone_angles, bone_rotation};
use kinopt_kinematics::model::{FrameId, JointId, Limits, Model};
use kinopt_kinematics::skeleton::{ANGLES_PER_BONE, BoneId};
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3};

/// Joints of a skeleton's bone: rest rotation, limits of the three angles, and length.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct BoneHinges {
    pub(super) rest: DQuat,
    pub(super) limits: [Limits; ANGLES_PER_BONE],
    pub(super) length: f64,
}

/// Bone that rotates.
#[derive(Clone, Debug)]
struct RotatingBone {
    bone: BoneId,
    /// Index of the parent among the rotating bones.
    parent: Option<usize>,
    /// First joint of the bone, a child of the parent's last joint.
    joint: JointId,
    frame: FrameId,
    /// Index of its first value in a configuration.
    coordinate: usize,
    /// `None` for a ball joint without limits. Its rotation is relative to the pose last taken.
    hinges: Option<BoneHinges>,
}

/// Bones between a root and end effectors. The root and the bones above it do not rotate.
#[derive(Clone, Debug)]
pub(super) struct PosedBones {
    /// `None` if all bones rotate.
    root: Option<BoneId>,
    bones: Vec<RotatingBone>,
    model: Model,
    /// All bones up to each effector with their parents, parents first.
    placed: Vec<(BoneId, Option<BoneId>)>,
    transforms: Vec<DAffine3>,
    /// Rotations in the model without scales. Below mirrored bones the axes are reflected.
    rotations: Vec<DQuat>,
    /// Mirror of the children of each bone.
    mirrors: Vec<Mirror>,
    stretches: Vec<Stretch>,
    /// Rotations of the pose of the clip, in the model and in the bone's parent.
    clip_rotations: Vec<DQuat>,
    clip_locals: Vec<DQuat>,
    /// Position of the root in that pose, in the model.
    clip_root: DVec3,
}

impl PosedBones {
    /// Builds the model of the bones from below `root` to `effectors`. All effectors must be below `root`.
    pub(super) fn new(
        armature: &Armature,
        root: Option<BoneId>,
        effectors: &[BoneId],
        hinges: impl Fn(BoneId) -> Option<BoneHinges>,
    ) -> Result<Self, ClipIkError> {
        let count = armature.bones();
        let (mut is_placed, mut rotates) = (vec![false; count], vec![false; count]);
        for &effector in effectors {
            let mut below_root = true;
            let parent = |bone: &BoneId| armature.parent(*bone);
            for bone in std::iter::successors(Some(effector), parent) {
                below_root &= Some(bone) != root;
                is_placed[bone.index()] = true;
                rotates[bone.index()] |= below_root;
            }
        }
        let mut builder = Model::builder("posed bones");
        let mut bones: Vec<RotatingBone> = Vec::new();
        let (mut coordinate, mut joints) = (0, 0);
        for bone in armature.bone_ids().filter(|bone| rotates[bone.index()]) {
            let parent_bone = armature.parent(bone);
            let parent = bones
                .iter()
                .position(|candidate| Some(candidate.bone) == parent_bone);
            let parent_joint = parent.and_then(|parent| last_joint(&bones[parent]));
            let name = format!("{}", bone.index());
            let [x, _, z] = Vector3::UNITS;
            let placement = Placement::identity();
            let hinges = hinges(bone);
            let last = match &hinges {
                None => builder.ball(&name, parent_joint, placement, x, None),
                Some(bone_hinges) => {
                    let axes = bone_hinges.limits.iter().rev().zip([x, z, x]).enumerate();
                    let chain = axes.fold(parent_joint, |below, (part, (limits, axis))| {
                        let name = format!("{name}/{part}");
                        Some(builder.revolute(name, below, placement, axis, *limits))
                    });
                    chain.unwrap_or(JointId::new(joints))
                }
            };
            bones.push(RotatingBone {
                bone,
                parent,
                joint: JointId::new(joints),
                frame: builder.frame(&name, Some(last), Placement::translation(tip_of(&hinges))),
                coordinate,
                hinges,
            });
            let added = &bones[bones.len() - 1];
            joints += added.joints();
            coordinate += added.numbers();
        }
        let placed = armature.bone_ids().filter(|bone| is_placed[bone.index()]);
        Ok(Self {
            root,
            bones,
            model: builder.build()?,
            placed: placed.map(|bone| (bone, armature.parent(bone))).collect(),
            transforms: vec![DAffine3::IDENTITY; count],
            rotations: vec![DQuat::IDENTITY; count],
            mirrors: vec![Mirror::NONE; count],
            stretches: vec![Stretch::NONE; count],
            clip_rotations: vec![DQuat::IDENTITY; count],
            clip_locals: vec![DQuat::IDENTITY; count],
            clip_root: DVec3::ZERO,
        })
    }

    #[must_use]
    pub(super) fn model(&self) -> &Model {
        &self.model
    }

    /// Returns the effector frame of a rotating bone, with the bone's axes.
    pub(super) fn frame(&self, bone: BoneId) -> Option<FrameId> {
        let rotating_bone = self
            .bones
            .iter()
            .find(|rotating_bone| rotating_bone.bone == bone)?;
        Some(rotating_bone.frame)
    }

    /// Returns the bones that rotate.
    pub(super) fn rotating_bones(&self) -> impl Iterator<Item = BoneId> + '_ {
        self.bones.iter().map(|rotating_bone| rotating_bone.bone)
    }

    /// Stores the pose of the clip that a frame should stay close to.
    pub(super) fn store_clip_pose(&mut self, pose: &Pose) {
        self.place_bones(pose);
        self.clip_rotations.clone_from(&self.rotations);
        for &(bone, _) in &self.placed {
            self.clip_locals[bone.index()] = pose.local_of(bone).rotation.as_dquat();
        }
        self.clip_root = self.root.map_or(DVec3::ZERO, |root| self.origin(root));
    }

    /// Places the bones as in a pose.
    pub(super) fn place_bones(&mut self, pose: &Pose) {
        for &(bone, parent) in &self.placed {
            let local = pose.local_of(bone);
            let rotation = local.rotation.as_dquat().normalize();
            let (scale, translation) = (local.scale.as_dvec3(), local.translation.as_dvec3());
            let local_transform =
                DAffine3::from_scale_rotation_translation(scale, rotation, translation);
            let index = bone.index();
            let parent_index = parent.map(BoneId::index);
            let mirror = self.mirror_above(parent);
            let stretch =
                parent_index.map_or(Stretch::NONE, |parent_index| self.stretches[parent_index]);
            self.mirrors[index] = mirror.below(local.scale);
            self.stretches[index] = stretch.below(mirror, rotation, local.scale);
            (self.transforms[index], self.rotations[index]) = match parent_index {
                None => (local_transform, rotation),
                Some(parent_index) => (
                    self.transforms[parent_index] * local_transform,
                    (self.rotations[parent_index] * mirror.rotation(rotation)).normalize(),
                ),
            };
        }
    }

    /// Returns whether a bone of the pose shears its children as they rotate.
    pub(super) fn is_sheared(&self) -> bool {
        let mut carriers = self
            .bones
            .iter()
            .filter_map(|rotating_bone| rotating_bone.parent);
        let sheared = |bone: BoneId| !self.stretches[bone.index()].is_even();
        carriers.any(|parent| sheared(self.bones[parent].bone)) || self.root.is_some_and(sheared)
    }

    fn mirror_above(&self, parent: Option<BoneId>) -> Mirror {
        parent.map_or(Mirror::NONE, |parent| self.mirrors[parent.index()])
    }

    /// Returns the end-effector position of a bone in the model, in the pose last placed: the tip of a skeleton's bone,
    /// else its origin.
    pub(super) fn effector_position(&self, bone: BoneId) -> DVec3 {
        let hinges = self
            .bones
            .iter()
            .find(|rotating_bone| rotating_bone.bone == bone);
        let tip = hinges.map_or(Vector3::zero(), |rotating_bone| {
            tip_of(&rotating_bone.hinges)
        });
        self.transforms[bone.index()].transform_point3(DVec3::from(tip.to_array()))
    }

    fn origin(&self, bone: BoneId) -> DVec3 {
        self.transforms[bone.index()].translation
    }

    /// Returns the orientation of a bone in the model, in the pose last placed.
    pub(super) fn orientation(&self, bone: BoneId) -> Matrix3<f64> {
        matrix(self.rotations[bone.index()])
    }

    /// Returns the position of the first bone of an effector's limb, below the root, and the length of the limb from
    /// there.
    pub(super) fn limb(&self, armature: &Armature, effector: BoneId) -> (DVec3, f64) {
        let mut first = effector;
        let mut length = self
            .effector_position(effector)
            .distance(self.origin(effector));
        while let Some(parent) = armature
            .parent(first)
            .filter(|&candidate| Some(candidate) != self.root)
        {
            length += self.origin(first).distance(self.origin(parent));
            first = parent;
        }
        (self.origin(first), length)
    }

    /// Moves the joints to the placements of the pose last placed, with the root displaced by `moved`. Writes the
    /// configuration of that pose to `q`.
    pub(super) fn place_joints(&mut self, armature: &Armature, moved: DVec3, q: &mut [f64]) {
        for rotating_bone in &self.bones {
            let index = rotating_bone.bone.index();
            let parent_index = rotating_bone
                .parent
                .map(|parent| self.bones[parent].bone.index());
            let relative_to_parent = |rotations: &[DQuat]| match parent_index {
                Some(parent_index) => rotations[parent_index].conjugate() * rotations[index],
                None => rotations[index],
            };
            let local_rotation = relative_to_parent(&self.clip_rotations);
            let offset = match parent_index {
                Some(parent_index) => {
                    let displacement = self.transforms[index].translation
                        - self.transforms[parent_index].translation;
                    self.rotations[parent_index].conjugate() * displacement
                }
                None => self.transforms[index].translation + moved,
            };
            let mirror = self.mirror_above(armature.parent(rotating_bone.bone));
            let on_parent = match (rotating_bone.parent, &rotating_bone.hinges) {
                (_, None) => local_rotation,
                (Some(_), Some(hinges)) => mirror.rotation(hinges.rest),
                (None, Some(hinges)) => {
                    let root = self.root.map(|root| self.rotations[root.index()]);
                    root.unwrap_or(DQuat::IDENTITY) * mirror.rotation(hinges.rest)
                }
            };
            let placement = Placement::new(matrix(on_parent), offset.to_array().into());
            self.model.place_joint(rotating_bone.joint, placement);
            let tip =
                self.stretches[index].apply(DVec3::from(tip_of(&rotating_bone.hinges).to_array()));
            self.model
                .move_frame(rotating_bone.frame, tip.to_array().into());
            let current = relative_to_parent(&self.rotations);
            let numbers = &mut q
                [rotating_bone.coordinate..rotating_bone.coordinate + rotating_bone.numbers()];
            match &rotating_bone.hinges {
                None if self.rotations == self.clip_rotations => {
                    numbers.copy_from_slice(&[1.0, 0.0, 0.0, 0.0]);
                }
                None => {
                    let [x, y, z, w] = (local_rotation.conjugate() * current)
                        .normalize()
                        .to_array();
                    numbers.copy_from_slice(&[w, x, y, z]);
                }
                Some(hinges) => {
                    let local_rotation = on_parent.conjugate() * current;
                    let [first, bend, second] = bone_angles(local_rotation, &hinges.limits);
                    numbers.copy_from_slice(&[second, bend, first]);
                }
            }
        }
    }

    /// Writes a configuration and the displacement of the root to a pose.
    pub(super) fn pose(&self, q: &[f64], moved: DVec3, armature: &Armature, pose: &mut Pose) {
        for rotating_bone in &self.bones {
            let numbers =
                &q[rotating_bone.coordinate..rotating_bone.coordinate + rotating_bone.numbers()];
            let mirror = self.mirror_above(armature.parent(rotating_bone.bone));
            let local_rotation = match (&rotating_bone.hinges, numbers) {
                (None, &[w, x, y, z]) => {
                    let clip = self.clip_locals[rotating_bone.bone.index()];
                    clip * mirror.rotation(DQuat::from_xyzw(x, y, z, w))
                }
                (Some(hinges), &[second, bend, first]) => {
                    hinges.rest * mirror.rotation(bone_rotation([first, bend, second]))
                }
                _ => continue,
            };
            // Cannot fail: the bone is in the pose, and the rotation has unit length.
            let _ = pose.set_rotation(
                rotating_bone.bone,
                local_rotation.normalize().as_quat().normalize(),
            );
        }
        if let Some(root) = self.root.filter(|_| moved != DVec3::ZERO) {
            let parent = armature.parent(root);
            let parent =
                parent.map_or(DAffine3::IDENTITY, |parent| self.transforms[parent.index()]);
            let root_position = self.clip_root + moved;
            let local = parent.inverse().transform_point3(root_position);
            // Below a singular scale the root keeps its translation.
            let _ = pose.set_translation(root, local.as_vec3a());
        }
    }
}

impl RotatingBone {
    fn joints(&self) -> usize {
        if self.hinges.is_some() {
            ANGLES_PER_BONE
        } else {
            1
        }
    }

    fn numbers(&self) -> usize {
        if self.hinges.is_some() {
            ANGLES_PER_BONE
        } else {
            4
        }
    }
}

/// Returns the tip of a bone on its own x axis. Without a skeleton, the origin.
fn tip_of(hinges: &Option<BoneHinges>) -> Vector3<f64> {
    let length = hinges.as_ref().map_or(0.0, |hinges| hinges.length);
    Vector3::new(length, 0.0, 0.0)
}

fn last_joint(rotating_bone: &RotatingBone) -> Option<JointId> {
    Some(JointId::new(
        rotating_bone.joint.index() + rotating_bone.joints() - 1,
    ))
}

fn matrix(rotation: DQuat) -> Matrix3<f64> {
    let [x, y, z] = DMat3::from_quat(rotation)
        .to_cols_array_2d()
        .map(Vector3::from);
    Matrix3::from_columns(x, y, z)
}
