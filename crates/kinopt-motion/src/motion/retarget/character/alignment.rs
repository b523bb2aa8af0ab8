//! Alignment of a character's rest pose to the reference pose of a subject.
//!
//! Both are upright, for example in a T-pose and an A-pose. Each bone gets the rotation in the world that aligns it:
//!
//! - pelvis and head: about the vertical, to the subject's heading;
//! - spine, neck, arms, legs and fingers: the smallest rotation between the directions to the next joint, after that of
//!   the bone above;
//! - hands: by the knuckles, if both have them;
//! - feet: about the vertical, so that they stay on the ground.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};

use super::super::BodyPart;
use super::super::anatomy::{FingerName, JointTree, fingers};
use super::bones::CharacterBone;
use super::correspondence::{BoneMotion, Correspondence};
use super::rotation::{arc, axes, heading};

/// Length below which a bone has no direction, relative to the leg.
const MIN_LENGTH_RATIO: f64 = 0.02;

/// Joints of a body in one pose.
#[derive(Clone, Copy, Debug)]
struct PosedBody<'a> {
    positions: &'a [DVec3],
    parts: &'a BTreeMap<BodyPart, usize>,
    tree: Option<&'a JointTree>,
}

impl PosedBody<'_> {
    fn at(&self, part: BodyPart) -> Option<DVec3> {
        let joint = self.parts.get(&part)?;
        self.positions.get(*joint).copied()
    }

    fn between(&self, from: BodyPart, to: BodyPart) -> Option<DVec3> {
        Some(self.at(to)? - self.at(from)?)
    }

    /// Direction from the right to the left hip or shoulder.
    fn left(&self) -> Option<DVec3> {
        self.between(BodyPart::RightHip, BodyPart::LeftHip)
            .or_else(|| self.between(BodyPart::RightShoulder, BodyPart::LeftShoulder))
    }

    fn leg(&self) -> f64 {
        let length = |from, to| self.between(from, to).map_or(0.0, DVec3::length);
        length(BodyPart::LeftHip, BodyPart::LeftKnee)
            + length(BodyPart::LeftKnee, BodyPart::LeftAnkle)
    }

    /// Mean of the knuckles relative to the wrist, and the direction across them, from the little to the index finger.
    fn knuckles(&self, hand: BodyPart) -> Option<(DVec3, Option<DVec3>)> {
        let (tree, &wrist) = (self.tree?, self.parts.get(&hand)?);
        let mut bases: Vec<DVec3> = Vec::new();
        for (finger, chain) in fingers(tree, wrist) {
            if let Some(&base) = chain.first().filter(|_| finger != FingerName::Thumb) {
                bases.push(self.positions[base]);
            }
        }
        let (first, last) = (bases.first()?, bases.last()?);
        let mean = bases.iter().sum::<DVec3>() / bases.len() as f64;
        let across = (bases.len() > 1).then(|| *first - *last);
        Some((mean - self.positions[wrist], across))
    }
}

/// Returns the rotation of each bone that aligns it to the subject.
///
/// `positions` are those of the captured joints in the reference pose, with z up, and `source` is their tree.
pub(super) fn alignments(
    bones: &[CharacterBone],
    tree: &JointTree,
    source: Option<&JointTree>,
    positions: &[DVec3],
    relation: &Correspondence,
) -> Vec<DQuat> {
    let rest: Vec<DVec3> = bones.iter().map(|bone| bone.position).collect();
    let character = PosedBody {
        positions: &rest,
        parts: &relation.bones,
        tree: Some(tree),
    };
    let subject = PosedBody {
        positions,
        parts: &relation.joints,
        tree: source,
    };
    let facing = match (character.left(), subject.left()) {
        (Some(from), Some(to)) => heading(from, to),
        _ => DQuat::IDENTITY,
    };
    let part_of: BTreeMap<usize, BodyPart> = relation
        .bones
        .iter()
        .map(|(part, bone)| (*bone, *part))
        .collect();
    let mut chain_of = BTreeMap::new();
    for chain in &relation.axial_chains {
        for bone in &chain.bones {
            chain_of.insert(*bone, (chain.lower, chain.upper));
        }
    }
    let neck = neck_directions(&character, &subject, relation);
    let mut aligned: Vec<DQuat> = Vec::with_capacity(bones.len());
    for (index, bone) in bones.iter().enumerate() {
        let above = bone.parent.and_then(|parent| aligned.get(parent)).copied();
        let above = above.unwrap_or(facing);
        let towards = |directions: Option<(DVec3, DVec3)>| match directions {
            Some((from, to)) => (arc(above * from, to) * above).normalize(),
            None => above,
        };
        let limb = |to: BodyPart| {
            let from = part_of.get(&index).copied()?;
            Some((character.between(from, to)?, subject.between(from, to)?))
        };
        let rotation = match part_of.get(&index) {
            Some(BodyPart::Pelvis | BodyPart::Head) => facing,
            Some(BodyPart::Chest) => towards(neck.or_else(|| limb(BodyPart::Head))),
            Some(BodyPart::LeftHip) => towards(limb(BodyPart::LeftKnee)),
            Some(BodyPart::LeftKnee) => towards(limb(BodyPart::LeftAnkle)),
            Some(BodyPart::RightHip) => towards(limb(BodyPart::RightKnee)),
            Some(BodyPart::RightKnee) => towards(limb(BodyPart::RightAnkle)),
            Some(BodyPart::LeftShoulder) => towards(limb(BodyPart::LeftElbow)),
            Some(BodyPart::LeftElbow) => towards(limb(BodyPart::LeftHand)),
            Some(BodyPart::RightShoulder) => towards(limb(BodyPart::RightElbow)),
            Some(BodyPart::RightElbow) => towards(limb(BodyPart::RightHand)),
            Some(hand @ (BodyPart::LeftHand | BodyPart::RightHand)) => {
                hand_alignment(&character, &subject, *hand, above)
            }
            Some(BodyPart::LeftAnkle) => foot_alignment(limb(BodyPart::LeftToe), facing),
            Some(BodyPart::RightAnkle) => foot_alignment(limb(BodyPart::RightToe), facing),
            Some(BodyPart::LeftToe | BodyPart::RightToe) => above,
            None => match (chain_of.get(&index), relation.motions[index]) {
                (Some((BodyPart::Chest, BodyPart::Head)), _) => {
                    let from_neck = neck_to_head(&character, &subject, relation);
                    towards(from_neck)
                }
                (Some((lower, upper)), _) => {
                    let trunk = (
                        character.between(*lower, *upper),
                        subject.between(*lower, *upper),
                    );
                    towards(trunk.0.zip(trunk.1))
                }
                (None, BoneMotion::Joint(joint)) if !is_towards_limb(tree, &part_of, index) => {
                    towards(child_directions(
                        tree,
                        source,
                        &rest,
                        positions,
                        relation,
                        (index, joint),
                    ))
                }
                _ => above,
            },
        };
        aligned.push(rotation);
    }
    aligned
}

/// Returns whether a bone carries a mapped part, as a clavicle. Such bones keep their angle to the trunk at rest.
fn is_towards_limb(tree: &JointTree, part_of: &BTreeMap<usize, BodyPart>, bone: usize) -> bool {
    tree.subtree(bone)
        .iter()
        .any(|below| part_of.contains_key(below))
}

/// Directions from the chest to the neck, if both bodies have one.
fn neck_directions(
    character: &PosedBody<'_>,
    subject: &PosedBody<'_>,
    relation: &Correspondence,
) -> Option<(DVec3, DVec3)> {
    let (bone, joint) = neck(relation)?;
    let from = character.positions[bone] - character.at(BodyPart::Chest)?;
    let to = subject.positions[joint] - subject.at(BodyPart::Chest)?;
    let is_long = |v: DVec3, body: &PosedBody<'_>| v.length() > MIN_LENGTH_RATIO * body.leg();
    (is_long(from, character) && is_long(to, subject)).then_some((from, to))
}

/// Directions from the neck to the head, if both bodies have a neck; else from the chest to the head.
fn neck_to_head(
    character: &PosedBody<'_>,
    subject: &PosedBody<'_>,
    relation: &Correspondence,
) -> Option<(DVec3, DVec3)> {
    let directions = neck(relation).and_then(|(bone, joint)| {
        let from = character.at(BodyPart::Head)? - character.positions[bone];
        let to = subject.at(BodyPart::Head)? - subject.positions[joint];
        Some((from, to))
    });
    directions.or_else(|| {
        let between = |body: &PosedBody<'_>| body.between(BodyPart::Chest, BodyPart::Head);
        between(character).zip(between(subject))
    })
}

/// First bone and joint of the neck.
fn neck(relation: &Correspondence) -> Option<(usize, usize)> {
    let mut chains = relation.axial_chains.iter();
    let chain =
        chains.find(|chain| chain.upper == BodyPart::Head && chain.lower == BodyPart::Chest)?;
    Some((*chain.bones.first()?, *chain.joints.first()?))
}

fn hand_alignment(
    character: &PosedBody<'_>,
    subject: &PosedBody<'_>,
    hand: BodyPart,
    above: DQuat,
) -> DQuat {
    let (Some((from, from_across)), Some((to, to_across))) =
        (character.knuckles(hand), subject.knuckles(hand))
    else {
        return above;
    };
    let by_plane = from_across
        .zip(to_across)
        .and_then(|(from_across, to_across)| {
            Some((axes(to, to_across)? * axes(from, from_across)?.conjugate()).normalize())
        });
    by_plane.unwrap_or_else(|| (arc(above * from, to) * above).normalize())
}

/// Rotation about the vertical to the heading of the subject's foot, or of the body without toes.
fn foot_alignment(directions: Option<(DVec3, DVec3)>, facing: DQuat) -> DQuat {
    match directions {
        Some((from, to)) => heading(from, to),
        None => facing,
    }
}

/// Directions from a bone and its joint to their first corresponding children.
fn child_directions(
    tree: &JointTree,
    source: Option<&JointTree>,
    rest: &[DVec3],
    positions: &[DVec3],
    relation: &Correspondence,
    (bone, joint): (usize, usize),
) -> Option<(DVec3, DVec3)> {
    let source = source?;
    let mut children = tree.children(bone).iter();
    children.find_map(|child| {
        let BoneMotion::Joint(below) = relation.motions[*child] else {
            return None;
        };
        if !source.is_below(below, joint) {
            return None;
        }
        Some((
            rest[*child] - rest[bone],
            positions[below] - positions[joint],
        ))
    })
}
