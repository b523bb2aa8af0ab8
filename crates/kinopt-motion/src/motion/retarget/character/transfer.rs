//! Transfer of a subject's rotations to a character, frame by frame.
//!
//! Each bone keeps the world rotation of its joint relative to the aligned rest pose. The hips then move to the scaled
//! place of the subject's hips, and two-bone IK brings the feet to theirs.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};

use super::super::anatomy::JointTree;
use super::super::{BodyPart, Capture, FigureTarget, UpAxis};
use super::alignment::alignments;
use super::bones::{CharacterBone, bones_of};
use super::correspondence::{BoneMotion, Correspondence};
use super::leg::leg_rotation;
use super::pose::BonePose;
use super::position_frames::part_rotations;
use super::proportions::{LEGS, Sizes};
use super::rotation::{arc, between, from_rotation_vector, twist_angle};
use super::source::{ReferencePose, upright, upright_rotation};
use kinopt_kinematics::spatial::Vector3;

/// Length of a leg, relative to its full length, up to which it extends for a foot's target. A subject's straight leg
/// stays straight.
const MAX_EXTENSION: f64 = 0.985;
/// Level of contact that keeps the ankle of a free foot at its place.
const MIN_CONTACT_LEVEL: f64 = 1e-4;
/// Largest distance by which the hips are lowered for the feet, relative to the leg.
const MAX_DROP: f64 = 0.25;
/// Quantile of the heights of the lowest foot that counts as the ground.
const GROUND_QUANTILE: f64 = 0.05;

/// Rotations of a subject in one capture frame.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct SubjectFrame<'a> {
    /// Positions of the captured joints.
    pub(in super::super) positions: &'a [Vector3<f64>],
    /// Rotations of the captured joints, if known.
    pub(in super::super) rotations: Option<&'a [DQuat]>,
}

/// Targets of the feet in one frame, with z up, in the character's unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FootTarget {
    pub(super) ankle: DVec3,
    pub(super) toe: Option<DVec3>,
    /// Level of contact of the foot, from 0 (free) to 1.
    pub(super) contact_level: f64,
}

/// Targets of both feet in each frame.
pub(super) type FootTargets = Vec<[Option<FootTarget>; 2]>;

impl FootTarget {
    /// Returns the target at the foot's length from the ankle to the toe. Of a contact and a free point the free one
    /// moves. The levels of contact are from 0 (free) to 1.
    pub(super) fn with_length(
        ankle: DVec3,
        toe: Option<DVec3>,
        length: f64,
        [ankle_level, toe_level]: [f64; 2],
    ) -> Self {
        let contact_level = ankle_level.max(toe_level);
        let Some(place) = toe else {
            return Self {
                ankle,
                toe,
                contact_level,
            };
        };
        let hold = |level: f64| level / (1.0 + MIN_CONTACT_LEVEL - level);
        let (at_ankle, at_toe) = (hold(ankle_level) + MIN_CONTACT_LEVEL, hold(toe_level));
        let along = place - ankle;
        let excess = along - along.normalize_or(DVec3::Y) * length;
        let toe_share = at_ankle / (at_ankle + at_toe);
        Self {
            ankle: ankle + excess * (1.0 - toe_share),
            toe: Some(place - excess * toe_share),
            contact_level,
        }
    }
}

/// Source of a bone's rotation, with its aligned rest rotation.
#[derive(Clone, Debug)]
pub(super) struct BoneRig {
    pub(super) relation: Correspondence,
    /// Rotation of each bone in the aligned rest pose.
    rest: Vec<DQuat>,
    base: BaseMotion,
}

/// Bone that carries the base of the character.
#[derive(Clone, Copy, Debug, PartialEq)]
enum BaseMotion {
    /// The base rotates with a bone, whose own angles stay at rest.
    Bone(usize),
    /// The base keeps a rotation.
    Fixed(DQuat),
}

/// Transfer of a subject's motion to a character.
#[derive(Clone, Debug)]
pub(super) struct CharacterTransfer {
    pub(super) bones: Vec<CharacterBone>,
    reference: ReferencePose,
    /// Relation of captures with rotations.
    posed: Option<BoneRig>,
    /// Relation of captures with positions only.
    positioned: BoneRig,
    /// Rotations of the character's parts at rest, by their positions.
    part_rest: BTreeMap<BodyPart, DQuat>,
    pub(super) sizes: Sizes,
    /// Height of the subject's ground, in the capture's unit.
    ground: f64,
}

impl CharacterTransfer {
    /// Relates a capture to a character. `drives` are pairs of captured joint and bone with the part that both are.
    pub(super) fn new(
        figure: &FigureTarget,
        scale: f64,
        capture: &Capture,
        up: UpAxis,
        drives: &[(usize, usize, Option<BodyPart>)],
    ) -> Self {
        let bones = bones_of(figure.upright(), scale);
        let tree = JointTree::new(
            bones.iter().map(|bone| bone.name.clone()).collect(),
            bones.iter().map(|bone| bone.parent).collect(),
            bones.iter().map(|bone| bone.position).collect(),
        );
        let pairs: Vec<(usize, usize)> = drives
            .iter()
            .map(|(joint, bone, _)| (*joint, *bone))
            .collect();
        let parts: Vec<Option<BodyPart>> = drives.iter().map(|(.., part)| *part).collect();
        let positioned = Correspondence::new(&tree, None, &pairs, &parts);
        let at_rest = |part: BodyPart| {
            positioned
                .bones
                .get(&part)
                .map(|bone| bones[*bone].position)
        };
        let reference = ReferencePose::new(capture, up, &positioned.joints, &at_rest);
        let source = capture.posed().map(|posed| {
            JointTree::new(
                capture.names().to_vec(),
                posed.parents.clone(),
                reference.positions.clone(),
            )
        });
        let posed = source.as_ref().map(|source| {
            let relation = Correspondence::new(&tree, Some(source), &pairs, &parts);
            let aligned = alignments(&bones, &tree, Some(source), &reference.positions, &relation);
            let rest = bones.iter().zip(aligned);
            let rest = rest.map(|(bone, aligned)| (aligned * bone.rest).normalize());
            BoneRig::new(&bones, relation, rest.collect())
        });
        let part_rest = part_rotations(&at_rest);
        let below = |tree: &JointTree, parts: &BTreeMap<BodyPart, usize>| -> Vec<usize> {
            let ankles = LEGS.iter().filter_map(|[.., ankle, _]| parts.get(ankle));
            ankles.flat_map(|ankle| tree.subtree(*ankle)).collect()
        };
        let rest_positions: Vec<DVec3> = tree.positions.clone();
        let sizes = Sizes::new(
            &positioned,
            &reference.positions,
            &rest_positions,
            [
                &source
                    .as_ref()
                    .map(|source| below(source, &positioned.joints))
                    .unwrap_or_default(),
                &below(&tree, &positioned.bones),
            ],
        );
        let at_rest = bones.iter().map(|bone| bone.rest).collect();
        let positioned = BoneRig::new(&bones, positioned, at_rest);
        let mut transfer = Self {
            bones,
            reference,
            posed,
            positioned,
            part_rest,
            sizes,
            ground: 0.0,
        };
        transfer.ground = transfer.ground_of(capture);
        transfer
    }

    /// Height of the subject's ground: that of the lowest foot, less its height over the ground in the reference pose.
    fn ground_of(&self, capture: &Capture) -> f64 {
        let joints = &self.positioned.relation.joints;
        let clearances = &self.sizes.subject_clearance;
        let heights = (0..capture.frames()).filter_map(|frame| {
            let positions = capture.frame(frame)?;
            let feet = clearances.iter().filter_map(|(part, clearance)| {
                Some(upright(self.reference.up, positions[*joints.get(part)?]).z - clearance)
            });
            let lowest = feet.fold(f64::INFINITY, f64::min);
            lowest.is_finite().then_some(lowest)
        });
        let mut heights: Vec<f64> = heights.collect();
        heights.sort_by(f64::total_cmp);
        let index = (GROUND_QUANTILE * heights.len() as f64) as usize;
        heights.get(index).copied().unwrap_or(0.0)
    }

    /// Bone of a part.
    pub(super) fn bone(&self, part: BodyPart) -> Option<usize> {
        self.positioned.relation.bones.get(&part).copied()
    }

    /// Position of a part of the subject, with z up, in the capture's unit.
    pub(super) fn captured(&self, part: BodyPart, frame: SubjectFrame<'_>) -> Option<DVec3> {
        let joint = *self.positioned.relation.joints.get(&part)?;
        let position = frame.positions.get(joint)?;
        Some(upright(self.reference.up, *position))
    }

    /// Returns whether the feet need no IK: equal rotations give them their places.
    pub(super) fn keeps_places(&self) -> bool {
        self.sizes.are_same && self.posed.is_some()
    }

    /// Position of a captured joint, with z up, in the capture's unit.
    pub(super) fn upright_joint(&self, joint: usize, frame: SubjectFrame<'_>) -> DVec3 {
        let position = frame.positions.get(joint);
        position.map_or(DVec3::ZERO, |position| {
            upright(self.reference.up, *position)
        })
    }

    /// Scaled place of a part of a foot over the character's ground.
    pub(super) fn foot_place(&self, part: BodyPart, frame: SubjectFrame<'_>) -> Option<DVec3> {
        let position = self.captured(part, frame)? - DVec3::Z * self.ground;
        let place = position * self.sizes.stride + DVec3::Z * self.sizes.rise(part);
        Some(place + self.stance_shift(part, frame).unwrap_or(DVec3::ZERO))
    }

    /// Sideways shift of a foot for a character whose hips are wider or narrower than the scaled subject's, so that its
    /// legs keep their directions.
    fn stance_shift(&self, part: BodyPart, frame: SubjectFrame<'_>) -> Option<DVec3> {
        let [[left, ..], [right, ..]] = LEGS;
        let across = self.captured(left, frame)? - self.captured(right, frame)?;
        let level = DVec3::new(across.x, across.y, 0.0);
        let side = if LEGS[0].contains(&part) { 0.5 } else { -0.5 };
        let direction = level.normalize_or_zero() * side;
        Some(direction * self.sizes.wider_hips)
    }

    /// Height of a part of a foot over the ground at rest.
    pub(super) fn clearance(&self, part: BodyPart) -> f64 {
        let found = self
            .sizes
            .clearance
            .iter()
            .find(|(known, _)| *known == part);
        found.map_or(0.0, |(_, height)| *height)
    }

    /// Distance from the ankle to the toe of a leg; 0 without a toe.
    pub(super) fn foot_length(&self, leg: &[BodyPart; 4]) -> f64 {
        let at = |part: BodyPart| self.bone(part).map(|bone| self.bones[bone].position);
        let [ankle, toe] = [at(leg[2]), at(leg[3])];
        ankle
            .zip(toe)
            .map_or(0.0, |(ankle, toe)| ankle.distance(toe))
    }

    /// Scaled place of the middle of the hips; of the pelvis without legs.
    fn hip_place(&self, frame: SubjectFrame<'_>) -> Option<DVec3> {
        let hips = LEGS
            .iter()
            .filter_map(|[hip, ..]| self.captured(*hip, frame));
        let hips: Vec<DVec3> = hips.collect();
        let middle = match hips.len() {
            0 => self.captured(BodyPart::Pelvis, frame)?,
            count => hips.iter().sum::<DVec3>() / count as f64,
        };
        let rises = LEGS.iter().map(|[.., ankle, _]| self.sizes.rise(*ankle));
        let rise = rises.sum::<f64>() / LEGS.len() as f64;
        Some((middle - DVec3::Z * self.ground) * self.sizes.stride + DVec3::Z * rise)
    }

    /// Scaled place of the pelvis.
    pub(super) fn pelvis_place(&self, frame: SubjectFrame<'_>) -> Option<DVec3> {
        let hips = LEGS
            .iter()
            .filter_map(|[hip, ..]| self.captured(*hip, frame));
        let hips: Vec<DVec3> = hips.collect();
        let place = self.hip_place(frame)?;
        let pelvis = self.captured(BodyPart::Pelvis, frame)?;
        let middle = match hips.len() {
            0 => pelvis,
            count => hips.iter().sum::<DVec3>() / count as f64,
        };
        Some(place + (pelvis - middle) * self.sizes.stride)
    }

    /// Rotation of each captured joint from the reference pose, with z up.
    fn deltas(&self, frame: SubjectFrame<'_>) -> (Vec<DQuat>, &BoneRig) {
        let joints = frame.positions.len();
        if let (Some(rig), Some(rotations), Some(reference)) =
            (&self.posed, frame.rotations, &self.reference.rotations)
        {
            let pairs = rotations.iter().zip(reference);
            let deltas = pairs.map(|(rotation, rest)| {
                upright_rotation(
                    self.reference.up,
                    (*rotation * rest.conjugate()).normalize(),
                )
            });
            return (deltas.collect(), rig);
        }
        let rotations = part_rotations(&|part| self.captured(part, frame));
        let mut deltas = vec![DQuat::IDENTITY; joints];
        for (part, joint) in &self.positioned.relation.joints {
            if let (Some(rotation), Some(rest)) = (rotations.get(part), self.part_rest.get(part)) {
                deltas[*joint] = (*rotation * rest.conjugate()).normalize();
            }
        }
        (deltas, &self.positioned)
    }

    /// Computes the pose of the bones. `drop` lowers the hips; `feet` are targets of both feet, or `None` to keep the
    /// subject's rotations. `previous` are the angles before.
    pub(super) fn pose(
        &self,
        frame: SubjectFrame<'_>,
        feet: Option<&[Option<FootTarget>; 2]>,
        drop: impl FnOnce(f64) -> f64,
        previous: Option<&[[f64; 3]]>,
    ) -> (BonePose, (DQuat, DVec3)) {
        let (deltas, rig) = self.deltas(frame);
        let mut corrections = vec![DQuat::IDENTITY; self.bones.len()];
        let mut pose = BonePose::new(self.bones.len());
        let hips = self.hip_place(frame);
        let mut base = self.solve(rig, &deltas, &corrections, previous, hips, &mut pose);
        if self.keeps_places() {
            return (pose, base);
        }
        if self.correct_trunk(rig, frame, &pose, &mut corrections) {
            base = self.solve(rig, &deltas, &corrections, previous, hips, &mut pose);
        }
        let Some(feet) = feet else {
            return (pose, base);
        };
        let shift = self.hip_shift(frame, feet, &pose);
        pose.translate(shift);
        let feet = &self.with_free_feet(feet, &pose);
        let lowered = DVec3::NEG_Z * drop(self.missing_reach(&pose, feet));
        pose.translate(lowered);
        let hips = hips.map(|hips| hips + shift + lowered);
        for (leg, target) in LEGS.iter().zip(feet) {
            if let Some(target) = target {
                self.bend_leg(leg, target, &pose, &mut corrections);
            }
        }
        base = self.solve(rig, &deltas, &corrections, previous, hips, &mut pose);
        let mut turned = false;
        for (leg, target) in LEGS.iter().zip(feet) {
            turned |=
                target.is_some_and(|target| self.turn_foot(leg, &target, &pose, &mut corrections));
        }
        if turned {
            base = self.solve(rig, &deltas, &corrections, previous, hips, &mut pose);
        }
        (pose, base)
    }

    /// Rotates and places all bones, with corrections in the world after their transferred rotations.
    fn solve(
        &self,
        rig: &BoneRig,
        deltas: &[DQuat],
        corrections: &[DQuat],
        previous: Option<&[[f64; 3]]>,
        hips: Option<DVec3>,
        pose: &mut BonePose,
    ) -> (DQuat, DVec3) {
        let world = |bone: usize| -> Option<DQuat> {
            let delta = match rig.relation.motions[bone] {
                BoneMotion::Joint(joint) => deltas[joint],
                BoneMotion::Between {
                    lower,
                    upper,
                    fraction,
                } => between(deltas[lower], deltas[upper], fraction),
                _ => return None,
            };
            Some((corrections[bone] * delta * rig.rest[bone]).normalize())
        };
        let rotation = match rig.base {
            BaseMotion::Bone(bone) => match world(bone) {
                Some(rotation) => (rotation * self.bones[bone].rest.conjugate()).normalize(),
                None => DQuat::IDENTITY,
            },
            BaseMotion::Fixed(rotation) => rotation,
        };
        for bone in 0..self.bones.len() {
            let wanted = match rig.relation.motions[bone] {
                BoneMotion::Joint(_) | BoneMotion::Between { .. } => world(bone),
                _ => None,
            };
            let wanted = wanted.unwrap_or_else(|| pose.rest_on_parent(&self.bones, bone, rotation));
            let before = previous.and_then(|angles| angles.get(bone)).copied();
            pose.rotate(&self.bones, bone, rotation, wanted, before);
        }
        self.twist(rig, rotation, previous, pose);
        pose.place(&self.bones, (rotation, DVec3::ZERO));
        let middle = self.hip_middle(pose);
        let translation = match (hips, middle) {
            (Some(place), Some(middle)) => place - middle,
            _ => DVec3::ZERO,
        };
        pose.translate(translation);
        (rotation, translation)
    }

    /// Middle of the character's hips; its pelvis without legs.
    fn hip_middle(&self, pose: &BonePose) -> Option<DVec3> {
        let hips = LEGS.iter().filter_map(|[hip, ..]| self.bone(*hip));
        let hips: Vec<DVec3> = hips.map(|bone| pose.positions[bone]).collect();
        match hips.len() {
            0 => Some(pose.positions[self.bone(BodyPart::Pelvis)?]),
            count => Some(hips.iter().sum::<DVec3>() / count as f64),
        }
    }

    /// Rotates twist bones, which depend on the ends of their limbs.
    fn twist(
        &self,
        rig: &BoneRig,
        base: DQuat,
        previous: Option<&[[f64; 3]]>,
        pose: &mut BonePose,
    ) {
        for bone in 0..self.bones.len() {
            let turn = match rig.relation.motions[bone] {
                BoneMotion::TwistToEnd {
                    limb,
                    end,
                    fraction,
                } => {
                    let local = self.bones[limb].rest.conjugate() * self.bones[end].rest;
                    let relative = pose.rotations[limb].conjugate() * pose.rotations[end];
                    let turned = (relative * local.conjugate()).normalize();
                    let along = self.bones[end].position - self.bones[limb].position;
                    let axis = self.bones[limb].rest.conjugate() * along.normalize_or_zero();
                    let angle = fraction * twist_angle(turned, axis);
                    Some((limb, from_rotation_vector(axis * angle)))
                }
                BoneMotion::TwistFromRoot { limb, fraction } => {
                    let at_rest = pose.rest_on_parent(&self.bones, limb, base);
                    let turned = (at_rest.conjugate() * pose.rotations[limb]).normalize();
                    let end = self.bones.iter().enumerate();
                    let end = end.filter(|(_, other)| other.parent == Some(limb));
                    let offset = end.map(|(_, child)| child.offset);
                    let axis = offset.reduce(|a, b| if b.length() > a.length() { b } else { a });
                    let axis = axis.unwrap_or(DVec3::X).normalize_or_zero();
                    let angle = (fraction - 1.0) * twist_angle(turned, axis);
                    Some((limb, from_rotation_vector(axis * angle)))
                }
                BoneMotion::Rigid => {
                    // Below a twist bone.
                    let wanted = pose.rest_on_parent(&self.bones, bone, base);
                    pose.rotate(&self.bones, bone, base, wanted, None);
                    None
                }
                _ => None,
            };
            let Some((limb, turn)) = turn else { continue };
            let local = self.bones[limb].rest.conjugate() * self.bones[bone].rest;
            let wanted = (pose.rotations[limb] * turn * local).normalize();
            let before = previous.and_then(|angles| angles.get(bone)).copied();
            pose.rotate(&self.bones, bone, base, wanted, before);
        }
    }

    /// Distance by which the hips must be lowered for both feet to reach their targets.
    fn missing_reach(&self, pose: &BonePose, feet: &[Option<FootTarget>; 2]) -> f64 {
        let mut lowered = 0.0_f64;
        for (leg, target) in LEGS.iter().zip(feet) {
            let (Some(target), Some([hip, knee, ankle])) = (target, self.leg_positions(leg, pose))
            else {
                continue;
            };
            let full = hip.distance(knee) + knee.distance(ankle);
            let reach = (MAX_EXTENSION * full).max(hip.distance(ankle));
            let place = target.ankle;
            let level = DVec3::new(place.x - hip.x, place.y - hip.y, 0.0).length();
            let height = (reach * reach - level * level).max(0.0).sqrt();
            lowered = lowered.max(hip.z - place.z - height);
        }
        lowered.min(MAX_DROP * self.sizes.leg)
    }

    /// Positions of hip, knee and ankle.
    fn leg_positions(&self, leg: &[BodyPart; 4], pose: &BonePose) -> Option<[DVec3; 3]> {
        let at = |part: BodyPart| self.bone(part).map(|bone| pose.positions[bone]);
        Some([at(leg[0])?, at(leg[1])?, at(leg[2])?])
    }

    /// Bends a leg so that its ankle reaches the target.
    fn bend_leg(
        &self,
        leg: &[BodyPart; 4],
        target: &FootTarget,
        pose: &BonePose,
        corrections: &mut [DQuat],
    ) {
        let (Some(joints), [Some(hip), Some(knee), Some(ankle)]) = (
            self.leg_positions(leg, pose),
            [leg[0], leg[1], leg[2]].map(|part| self.bone(part)),
        ) else {
            return;
        };
        let forward = self.forward(hip, pose);
        let rotation = leg_rotation(joints, target.ankle, forward);
        for (bone, correction) in corrections.iter_mut().enumerate() {
            let is_on = |below: usize| bone == below || self.is_below(bone, below);
            if is_on(ankle) || !is_on(hip) {
                continue;
            }
            *correction = match is_on(knee) {
                true => rotation.shin,
                false => rotation.thigh,
            };
        }
    }

    /// Direction in which a knee bends: forward of the thigh at rest.
    fn forward(&self, hip: usize, pose: &BonePose) -> DVec3 {
        let hips = LEGS.map(|[hip, ..]| self.bone(hip).map(|bone| self.bones[bone].position));
        let left = match hips {
            [Some(left), Some(right)] => left - right,
            _ => DVec3::NEG_X,
        };
        let from_rest = pose.rotations[hip] * self.bones[hip].rest.conjugate();
        from_rest * left.cross(DVec3::Z)
    }

    fn is_below(&self, bone: usize, ancestor: usize) -> bool {
        let parent = |bone: &usize| self.bones[*bone].parent;
        std::iter::successors(parent(&bone), parent).any(|above| above == ancestor)
    }

    /// Turns a foot so that its toe is in the direction of its target. Returns whether there is one.
    fn turn_foot(
        &self,
        leg: &[BodyPart; 4],
        target: &FootTarget,
        pose: &BonePose,
        corrections: &mut [DQuat],
    ) -> bool {
        let [ankle, toe] = [leg[2], leg[3]].map(|part| self.bone(part));
        let (Some(ankle), Some(toe), Some(place)) = (ankle, toe, target.toe) else {
            return false;
        };
        let present = pose.positions[toe] - pose.positions[ankle];
        let correction = arc(present, place - pose.positions[ankle]);
        corrections[ankle] = correction;
        true
    }
}

impl BoneRig {
    fn new(bones: &[CharacterBone], relation: Correspondence, rest: Vec<DQuat>) -> Self {
        let base = base_motion(bones, &relation, &rest);
        Self {
            relation,
            rest,
            base,
        }
    }
}

/// Selects the bone whose rotation the base has.
///
/// The base moves all bones. If a bone above the pelvis corresponds to no joint, it stays upright, unless the pelvis has
/// limits: then the base rotates with the pelvis.
fn base_motion(bones: &[CharacterBone], relation: &Correspondence, rest: &[DQuat]) -> BaseMotion {
    let is_joint = |bone: &usize| matches!(relation.motions[*bone], BoneMotion::Joint(_));
    let Some(&pelvis) = relation.bones.get(&BodyPart::Pelvis) else {
        let first = (0..bones.len()).find(is_joint);
        return first.map_or(BaseMotion::Fixed(DQuat::IDENTITY), BaseMotion::Bone);
    };
    let parent = |bone: &usize| bones[*bone].parent;
    let above = std::iter::successors(Some(pelvis), parent);
    let top = above
        .filter(|bone| bones[*bone].moves())
        .last()
        .unwrap_or(pelvis);
    if is_joint(&top) {
        return BaseMotion::Bone(top);
    }
    match bones[pelvis].is_unlimited() {
        true => BaseMotion::Fixed((rest[top] * bones[top].rest.conjugate()).normalize()),
        false => BaseMotion::Bone(pelvis),
    }
}
