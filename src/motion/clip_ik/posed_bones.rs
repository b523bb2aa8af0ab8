//! Model of the bones between a root and the end effectors, with its joints at the placements of a pose.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::ClipIkError;
use crate::animation::{Armature, Mirror, Pose, Stretch, bone_angles, bone_rotation};
use crate::model::{FrameId, JointId, Limits, Model};
use crate::skeleton::{ANGLES_PER_BONE, BoneId};
use crate::spatial::{Matrix3, Placement, Vector3};

/// Joints of a skeleton's bone: rest rotation, limits of the three angles, and length.
#[derive(Clone, Debug)]
pub(super) struct Hinges {
    pub(super) rest: DQuat,
    pub(super) limits: [Limits; ANGLES_PER_BONE],
    pub(super) length: f64,
}

/// Bone that rotates.
#[derive(Clone, Debug)]
struct TurningBone {
    bone: BoneId,
    /// Index of the parent among the rotating bones.
    parent: Option<usize>,
    /// First joint of the bone, a child of the parent's last joint.
    joint: JointId,
    frame: FrameId,
    /// Index of its first value in a configuration.
    coordinate: usize,
    /// `None` for a ball joint without limits. Its rotation is relative to the pose last taken.
    hinges: Option<Hinges>,
}

/// Bones between a root and end effectors. The root and the bones above it do not rotate.
#[derive(Clone, Debug)]
pub(super) struct PosedBones {
    /// `None` if all bones rotate.
    root: Option<BoneId>,
    bones: Vec<TurningBone>,
    model: Model,
    /// All bones up to each effector with their parents, parents first.
    placed: Vec<(BoneId, Option<BoneId>)>,
    places: Vec<DAffine3>,
    /// Rotations in the model without scales. Below mirrored bones the axes are reflected.
    turns: Vec<DQuat>,
    /// Mirror of the children of each bone.
    mirrors: Vec<Mirror>,
    stretches: Vec<Stretch>,
    /// Rotations of the pose of the clip, in the model and in the bone's parent.
    clip_turns: Vec<DQuat>,
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
        hinges: impl Fn(BoneId) -> Option<Hinges>,
    ) -> Result<Self, ClipIkError> {
        let count = armature.bones();
        let (mut is_placed, mut turns) = (vec![false; count], vec![false; count]);
        for &effector in effectors {
            let mut below_root = true;
            let parent = |bone: &BoneId| armature.parent(*bone);
            for bone in std::iter::successors(Some(effector), parent) {
                below_root &= Some(bone) != root;
                is_placed[bone.index()] = true;
                turns[bone.index()] |= below_root;
            }
        }
        let mut builder = Model::builder("posed bones");
        let mut bones: Vec<TurningBone> = Vec::new();
        let (mut coordinate, mut joints) = (0, 0);
        for bone in armature.bone_ids().filter(|bone| turns[bone.index()]) {
            let above = armature.parent(bone);
            let parent = bones.iter().position(|own| Some(own.bone) == above);
            let carrier = parent.and_then(|parent| last_joint(&bones[parent]));
            let name = format!("{}", bone.index());
            let [x, _, z] = Vector3::UNITS;
            let at = Placement::identity();
            let hinges = hinges(bone);
            let last = match &hinges {
                None => builder.ball(&name, carrier, at, x, None),
                Some(own) => {
                    let axes = own.limits.iter().rev().zip([x, z, x]).enumerate();
                    let chain = axes.fold(carrier, |below, (part, (limits, axis))| {
                        let name = format!("{name}/{part}");
                        Some(builder.revolute(name, below, at, axis, *limits))
                    });
                    chain.unwrap_or(JointId::new(joints))
                }
            };
            bones.push(TurningBone {
                bone,
                parent,
                joint: JointId::new(joints),
                frame: builder.frame(&name, Some(last), Placement::translation(tip_of(&hinges))),
                coordinate,
                hinges,
            });
            let own = &bones[bones.len() - 1];
            joints += own.joints();
            coordinate += own.numbers();
        }
        let placed = armature.bone_ids().filter(|bone| is_placed[bone.index()]);
        Ok(Self {
            root,
            bones,
            model: builder.build()?,
            placed: placed.map(|bone| (bone, armature.parent(bone))).collect(),
            places: vec![DAffine3::IDENTITY; count],
            turns: vec![DQuat::IDENTITY; count],
            mirrors: vec![Mirror::NONE; count],
            stretches: vec![Stretch::NONE; count],
            clip_turns: vec![DQuat::IDENTITY; count],
            clip_locals: vec![DQuat::IDENTITY; count],
            clip_root: DVec3::ZERO,
        })
    }

    getters! {
        pub(super) fn model(&self) -> &Model = &self.model;
    }

    /// Returns the effector frame of a rotating bone, with the bone's axes.
    pub(super) fn frame(&self, bone: BoneId) -> Option<FrameId> {
        let own = self.bones.iter().find(|own| own.bone == bone)?;
        Some(own.frame)
    }

    /// Returns the bones that rotate.
    pub(super) fn turning(&self) -> impl Iterator<Item = BoneId> + '_ {
        self.bones.iter().map(|own| own.bone)
    }

    /// Stores the pose of the clip that a frame should stay close to.
    pub(super) fn take(&mut self, pose: &Pose) {
        self.place_bones(pose);
        self.clip_turns.clone_from(&self.turns);
        for &(bone, _) in &self.placed {
            self.clip_locals[bone.index()] = pose.local_of(bone).rotation.as_dquat();
        }
        self.clip_root = self.root.map_or(DVec3::ZERO, |root| self.origin(root));
    }

    /// Places the bones as in a pose.
    pub(super) fn place_bones(&mut self, pose: &Pose) {
        for &(bone, parent) in &self.placed {
            let local = pose.local_of(bone);
            let turn = local.rotation.as_dquat().normalize();
            let (scale, at) = (local.scale.as_dvec3(), local.translation.as_dvec3());
            let own = DAffine3::from_scale_rotation_translation(scale, turn, at);
            let index = bone.index();
            let above = parent.map(BoneId::index);
            let mirror = self.mirror_above(parent);
            let stretch = above.map_or(Stretch::NONE, |above| self.stretches[above]);
            self.mirrors[index] = mirror.below(local.scale);
            self.stretches[index] = stretch.below(mirror, turn, local.scale);
            (self.places[index], self.turns[index]) = match above {
                None => (own, turn),
                Some(above) => (
                    self.places[above] * own,
                    (self.turns[above] * mirror.rotation(turn)).normalize(),
                ),
            };
        }
    }

    /// Returns whether a bone of the pose shears its children as they rotate.
    pub(super) fn shear(&self) -> bool {
        let mut carriers = self.bones.iter().filter_map(|own| own.parent);
        let sheared = |bone: BoneId| !self.stretches[bone.index()].is_even();
        carriers.any(|parent| sheared(self.bones[parent].bone)) || self.root.is_some_and(sheared)
    }

    fn mirror_above(&self, parent: Option<BoneId>) -> Mirror {
        parent.map_or(Mirror::NONE, |parent| self.mirrors[parent.index()])
    }

    /// Returns the end-effector position of a bone in the model, in the pose last placed: the tip of a skeleton's bone,
    /// else its origin.
    pub(super) fn place(&self, bone: BoneId) -> DVec3 {
        let hinges = self.bones.iter().find(|own| own.bone == bone);
        let tip = hinges.map_or(Vector3::zero(), |own| tip_of(&own.hinges));
        self.places[bone.index()].transform_point3(DVec3::from(tip.to_array()))
    }

    fn origin(&self, bone: BoneId) -> DVec3 {
        self.places[bone.index()].translation
    }

    /// Returns the orientation of a bone in the model, in the pose last placed.
    pub(super) fn turn(&self, bone: BoneId) -> Matrix3<f64> {
        matrix(self.turns[bone.index()])
    }

    /// Returns the position of the first bone of an effector's limb, below the root, and the length of the limb from
    /// there.
    pub(super) fn limb(&self, armature: &Armature, effector: BoneId) -> (DVec3, f64) {
        let mut first = effector;
        let mut length = self.place(effector).distance(self.origin(effector));
        while let Some(parent) = armature
            .parent(first)
            .filter(|&above| Some(above) != self.root)
        {
            length += self.origin(first).distance(self.origin(parent));
            first = parent;
        }
        (self.origin(first), length)
    }

    /// Moves the joints to the placements of the pose last placed, with the root displaced by `moved`. Writes the
    /// configuration of that pose to `q`.
    pub(super) fn stand(&mut self, armature: &Armature, moved: DVec3, q: &mut [f64]) {
        for own in &self.bones {
            let at = own.bone.index();
            let above = own.parent.map(|parent| self.bones[parent].bone.index());
            let turned_in = |turns: &[DQuat]| match above {
                Some(above) => turns[above].conjugate() * turns[at],
                None => turns[at],
            };
            let turned = turned_in(&self.clip_turns);
            let offset = match above {
                Some(above) => {
                    let apart = self.places[at].translation - self.places[above].translation;
                    self.turns[above].conjugate() * apart
                }
                None => self.places[at].translation + moved,
            };
            let mirror = self.mirror_above(armature.parent(own.bone));
            let on_carrier = match (own.parent, &own.hinges) {
                (_, None) => turned,
                (Some(_), Some(hinges)) => mirror.rotation(hinges.rest),
                (None, Some(hinges)) => {
                    let root = self.root.map(|root| self.turns[root.index()]);
                    root.unwrap_or(DQuat::IDENTITY) * mirror.rotation(hinges.rest)
                }
            };
            let placement = Placement::new(matrix(on_carrier), offset.to_array().into());
            self.model.place_joint(own.joint, placement);
            let tip = self.stretches[at].apply(DVec3::from(tip_of(&own.hinges).to_array()));
            self.model.move_frame(own.frame, tip.to_array().into());
            let now = turned_in(&self.turns);
            let numbers = &mut q[own.coordinate..own.coordinate + own.numbers()];
            match &own.hinges {
                None if self.turns == self.clip_turns => {
                    numbers.copy_from_slice(&[1.0, 0.0, 0.0, 0.0]);
                }
                None => {
                    let [x, y, z, w] = (turned.conjugate() * now).normalize().to_array();
                    numbers.copy_from_slice(&[w, x, y, z]);
                }
                Some(hinges) => {
                    let turned = on_carrier.conjugate() * now;
                    let [first, bend, second] = bone_angles(turned, &hinges.limits);
                    numbers.copy_from_slice(&[second, bend, first]);
                }
            }
        }
    }

    /// Writes a configuration and the displacement of the root to a pose.
    pub(super) fn pose(&self, q: &[f64], moved: DVec3, armature: &Armature, pose: &mut Pose) {
        for own in &self.bones {
            let numbers = &q[own.coordinate..own.coordinate + own.numbers()];
            let mirror = self.mirror_above(armature.parent(own.bone));
            let turned = match (&own.hinges, numbers) {
                (None, &[w, x, y, z]) => {
                    let clip = self.clip_locals[own.bone.index()];
                    clip * mirror.rotation(DQuat::from_xyzw(x, y, z, w))
                }
                (Some(hinges), &[second, bend, first]) => {
                    hinges.rest * mirror.rotation(bone_rotation([first, bend, second]))
                }
                _ => continue,
            };
            // Cannot fail: the bone is in the pose, and the rotation has unit length.
            let _ = pose.set_rotation(own.bone, turned.normalize().as_quat().normalize());
        }
        if let Some(root) = self.root.filter(|_| moved != DVec3::ZERO) {
            let above = armature.parent(root);
            let above = above.map_or(DAffine3::IDENTITY, |above| self.places[above.index()]);
            let there = self.clip_root + moved;
            let local = above.inverse().transform_point3(there);
            // Below a singular scale the root keeps its translation.
            let _ = pose.set_translation(root, local.as_vec3a());
        }
    }
}

impl TurningBone {
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
fn tip_of(hinges: &Option<Hinges>) -> Vector3<f64> {
    let length = hinges.as_ref().map_or(0.0, |hinges| hinges.length);
    Vector3::new(length, 0.0, 0.0)
}

fn last_joint(own: &TurningBone) -> Option<JointId> {
    Some(JointId::new(own.joint.index() + own.joints() - 1))
}

fn matrix(turn: DQuat) -> Matrix3<f64> {
    let [x, y, z] = DMat3::from_quat(turn).to_cols_array_2d().map(Vector3::from);
    Matrix3::from_columns(x, y, z)
}
