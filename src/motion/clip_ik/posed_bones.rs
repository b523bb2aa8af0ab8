//! The bones between a root and what is led, as a model whose joints stand where a pose has them.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::ClipIkError;
use crate::animation::{Armature, Pose, bone_angles, bone_rotation, scales_evenly};
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
    turns: Vec<DQuat>,
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

    /// Takes up a pose.
    ///
    /// # Errors
    /// A bone whose scale would shear what hangs on it.
    pub(super) fn take(&mut self, armature: &Armature, pose: &Pose) -> Result<(), ClipIkError> {
        for &(bone, parent) in &self.placed {
            let local = pose.local_of(bone);
            let turn = local.rotation.as_dquat().normalize();
            let (scale, at) = (local.scale.as_dvec3(), local.translation.as_dvec3());
            let own = DAffine3::from_scale_rotation_translation(scale, turn, at);
            let index = bone.index();
            (self.places[index], self.turns[index]) = match parent.map(BoneId::index) {
                None => (own, turn),
                Some(above) => (
                    self.places[above] * own,
                    (self.turns[above] * turn).normalize(),
                ),
            };
            let carries = self.placed.iter().any(|(_, above)| *above == Some(bone));
            if carries && !scales_evenly(local.scale) {
                return Err(ClipIkError::Sheared {
                    bone: armature.names()[index].clone(),
                });
            }
        }
        Ok(())
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

    /// Stands the joints where the pose last taken has them, with the root moved by `moved`, and writes the
    /// configuration of that pose.
    pub(super) fn stand(&mut self, moved: DVec3, q: &mut [f64]) {
        for own in &self.bones {
            let at = own.bone.index();
            let (turned, offset) = match own.parent.map(|parent| self.bones[parent].bone.index()) {
                Some(above) => {
                    let back = self.turns[above].conjugate();
                    let apart = self.places[at].translation - self.places[above].translation;
                    (back * self.turns[at], back * apart)
                }
                None => (self.turns[at], self.places[at].translation + moved),
            };
            let on_carrier = match (own.parent, &own.hinges) {
                (_, None) => turned,
                (Some(_), Some(hinges)) => hinges.rest,
                (None, Some(hinges)) => {
                    let root = self.root.map(|root| self.turns[root.index()]);
                    root.unwrap_or(DQuat::IDENTITY) * hinges.rest
                }
            };
            let placement = Placement::new(matrix(on_carrier), offset.to_array().into());
            self.model.place_joint(own.joint, placement);
            let numbers = &mut q[own.coordinate..own.coordinate + own.numbers()];
            match &own.hinges {
                None => numbers.copy_from_slice(&[1.0, 0.0, 0.0, 0.0]),
                Some(hinges) => {
                    let turned = on_carrier.conjugate() * turned;
                    let [first, bend, second] = bone_angles(turned, &hinges.limits);
                    numbers.copy_from_slice(&[second, bend, first]);
                }
            }
        }
    }

    /// Turns the bones of the pose last taken as a configuration has them, and moves the root.
    pub(super) fn pose(&self, q: &[f64], moved: DVec3, armature: &Armature, pose: &mut Pose) {
        for own in &self.bones {
            let numbers = &q[own.coordinate..own.coordinate + own.numbers()];
            let turned = match (&own.hinges, numbers) {
                (None, &[w, x, y, z]) => {
                    let clip = pose.local_of(own.bone).rotation.as_dquat();
                    clip * DQuat::from_xyzw(x, y, z, w)
                }
                (Some(hinges), &[second, bend, first]) => {
                    hinges.rest * bone_rotation([first, bend, second])
                }
                _ => continue,
            };
            // A bone of this pose, a rotation of unit length.
            let _ = pose.set_rotation(own.bone, turned.normalize().as_quat().normalize());
        }
        if let Some(root) = self.root.filter(|_| moved != DVec3::ZERO) {
            let above = armature.parent(root);
            let above = above.map_or(DAffine3::IDENTITY, |above| self.places[above.index()]);
            let there = self.origin(root) + moved;
            let local = above.inverse().transform_point3(there);
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
