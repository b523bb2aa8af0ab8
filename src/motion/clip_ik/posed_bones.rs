//! The bones between a root and what is led, as a model whose joints stand where a pose has them.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::ClipIkError;
use crate::animation::{Armature, Mirror, Pose, Stretch, bone_angles, bone_rotation};
use crate::model::{FrameId, JointId, Limits, Model};
use crate::skeleton::{ANGLES_PER_BONE, BoneId};
use crate::spatial::{Matrix3, Placement, Vector3};

/// A rig's bone: how it is turned at rest, the ranges of its three angles, and how long it is.
#[derive(Clone, Debug)]
pub(super) struct Hinges {
    pub(super) rest: DQuat,
    pub(super) limits: [Limits; ANGLES_PER_BONE],
    pub(super) length: f64,
}

/// A bone that turns.
#[derive(Clone, Debug)]
struct TurningBone {
    bone: BoneId,
    /// The one before it that turns.
    parent: Option<usize>,
    /// Its first joint, which stands on the parent's last.
    joint: JointId,
    frame: FrameId,
    /// Where its numbers are in a configuration.
    coordinate: usize,
    /// `None` for one that turns any way, told by the turn from where the pose has it.
    hinges: Option<Hinges>,
}

/// What hangs between a root and effectors; the root itself and what it hangs on do not turn.
#[derive(Clone, Debug)]
pub(super) struct PosedBones {
    /// `None` where the whole chain turns, from the top.
    root: Option<BoneId>,
    bones: Vec<TurningBone>,
    model: Model,
    /// Bones that are placed: all above an effector, parents first.
    placed: Vec<(BoneId, Option<BoneId>)>,
    places: Vec<DAffine3>,
    /// Rotations in the model without scales, in reflected axes below mirrored bones.
    turns: Vec<DQuat>,
    /// Of each bone's children.
    mirrors: Vec<Mirror>,
    stretches: Vec<Stretch>,
    /// The rotations of the pose that frames keep near to: in the model, and in the bone's parent as the pose has them.
    clip_turns: Vec<DQuat>,
    clip_locals: Vec<DQuat>,
    /// Where that pose has the root.
    clip_root: DVec3,
}

impl PosedBones {
    /// The bones from below `root` to `effectors`, all of which hang on it.
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

    /// The frame of a bone that turns, with its axes, at what is led of it.
    pub(super) fn frame(&self, bone: BoneId) -> Option<FrameId> {
        let own = self.bones.iter().find(|own| own.bone == bone)?;
        Some(own.frame)
    }

    /// The bones that turn.
    pub(super) fn turning(&self) -> impl Iterator<Item = BoneId> + '_ {
        self.bones.iter().map(|own| own.bone)
    }

    /// Takes up a pose that a frame keeps near to.
    pub(super) fn take(&mut self, pose: &Pose) {
        self.place_bones(pose);
        self.clip_turns.clone_from(&self.turns);
        for &(bone, _) in &self.placed {
            self.clip_locals[bone.index()] = pose.local_of(bone).rotation.as_dquat();
        }
        self.clip_root = self.root.map_or(DVec3::ZERO, |root| self.origin(root));
    }

    /// Places the bones as a pose has them.
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

    /// Whether a bone of the pose shears others as they turn.
    pub(super) fn shear(&self) -> bool {
        let mut carriers = self.bones.iter().filter_map(|own| own.parent);
        let sheared = |bone: BoneId| !self.stretches[bone.index()].is_even();
        carriers.any(|parent| sheared(self.bones[parent].bone)) || self.root.is_some_and(sheared)
    }

    fn mirror_above(&self, parent: Option<BoneId>) -> Mirror {
        parent.map_or(Mirror::NONE, |parent| self.mirrors[parent.index()])
    }

    /// Where what is led of a bone is in the model in the pose last taken: a rig's tip, another bone's origin.
    pub(super) fn place(&self, bone: BoneId) -> DVec3 {
        let hinges = self.bones.iter().find(|own| own.bone == bone);
        let tip = hinges.map_or(Vector3::zero(), |own| tip_of(&own.hinges));
        self.places[bone.index()].transform_point3(DVec3::from(tip.to_array()))
    }

    fn origin(&self, bone: BoneId) -> DVec3 {
        self.places[bone.index()].translation
    }

    /// How it is turned there.
    pub(super) fn turn(&self, bone: BoneId) -> Matrix3<f64> {
        matrix(self.turns[bone.index()])
    }

    /// Where the limb of an effector hangs on the root, and how long it is from there.
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

    /// Puts the joints where the bones were last placed, with the root moved by `moved`, and writes the configuration of
    /// that pose.
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

    /// Turns the bones of the pose that was taken as a configuration has them, and moves the root.
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
            // A bone of this pose, a rotation of unit length.
            let _ = pose.set_rotation(own.bone, turned.normalize().as_quat().normalize());
        }
        if let Some(root) = self.root.filter(|_| moved != DVec3::ZERO) {
            let above = armature.parent(root);
            let above = above.map_or(DAffine3::IDENTITY, |above| self.places[above.index()]);
            let there = self.clip_root + moved;
            let local = above.inverse().transform_point3(there);
            // Below a bone that flattens space the root stays.
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

/// The tip of a rig's bone, along its own x.
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
