//! Recognition of body parts in a joint tree.
//!
//! Limbs are pairs of three joints. Symmetry, lengths and names select them. The chest and the pelvis follow from the
//! tree: the joints that arms and legs hang on.

use std::collections::BTreeMap;

use glam::DVec3;

use super::super::BodyPart;
use super::joint_tree::JointTree;
use super::limb_pairs::{LimbKind, LimbPair, limb_pairs};
use super::name_words::{BoneName, BoneRole, bone_names, is_chain_end};

/// Score of the names of a pair of limbs below which its kind follows from the tree.
const MIN_NAME_SCORE: f64 = 2.0;
/// Largest distance of the pelvis from the middle of the hips, relative to the leg.
const MAX_PELVIS_DISTANCE: f64 = 0.45;

/// Body parts of a joint tree.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct Anatomy {
    pub(in super::super) parts: BTreeMap<BodyPart, usize>,
    /// Disagreements of names and tree.
    pub(in super::super) notes: Vec<String>,
}

/// Recognises the body parts of a tree. `posed` are positions in an upright pose, in which left and right are
/// determined if no name does.
pub(in super::super) fn recognise(tree: &JointTree, posed: &[DVec3]) -> Anatomy {
    let names = bone_names(&tree.names);
    let size = size_of(tree);
    if size == 0.0 {
        return Anatomy::default();
    }
    let mut anatomy = Anatomy::default();
    let leg_pairs = limb_pairs(tree, &names, LimbKind::Leg, size);
    let arm_pairs = limb_pairs(tree, &names, LimbKind::Arm, size);
    let (legs, arms) = legs_and_arms(tree, &leg_pairs, &arm_pairs, &mut anatomy.notes);
    let by_parts = [
        (
            legs,
            [
                [BodyPart::LeftHip, BodyPart::LeftKnee, BodyPart::LeftAnkle],
                [
                    BodyPart::RightHip,
                    BodyPart::RightKnee,
                    BodyPart::RightAnkle,
                ],
            ],
        ),
        (
            arms,
            [
                [
                    BodyPart::LeftShoulder,
                    BodyPart::LeftElbow,
                    BodyPart::LeftHand,
                ],
                [
                    BodyPart::RightShoulder,
                    BodyPart::RightElbow,
                    BodyPart::RightHand,
                ],
            ],
        ),
    ];
    for (pair, parts) in by_parts {
        let Some(pair) = pair else { continue };
        for (limb, parts) in pair.sides.iter().zip(parts) {
            anatomy.parts.extend(parts.into_iter().zip(limb.joints));
        }
    }
    add_trunk(tree, &names, (legs, arms), &mut anatomy);
    add_toes(tree, &names, &mut anatomy);
    let sides_named = [legs, arms]
        .into_iter()
        .flatten()
        .any(|pair| pair.sides_named);
    if !sides_named && is_mirrored(&anatomy.parts, posed) {
        swap_sides(&mut anatomy.parts);
    }
    anatomy
}

/// Largest distance of two joints.
fn size_of(tree: &JointTree) -> f64 {
    // Twice the farthest from one joint is at least the largest distance of two: rotations of a pose do not matter.
    let first = tree.positions.first().copied().unwrap_or(DVec3::ZERO);
    let farthest = |from: DVec3| {
        let distances = tree.positions.iter().map(|at| (at.distance(from), *at));
        distances.fold((0.0, from), |a, b| if b.0 > a.0 { b } else { a })
    };
    farthest(farthest(first).1).0
}

fn legs_and_arms(
    tree: &JointTree,
    leg_pairs: &[LimbPair],
    arm_pairs: &[LimbPair],
    notes: &mut Vec<String>,
) -> (Option<LimbPair>, Option<LimbPair>) {
    let overlap = |a: &LimbPair, b: &LimbPair| {
        let joints = |pair: &LimbPair| pair.sides.map(|limb| limb.joints).concat();
        let [first, second] = [joints(a), joints(b)];
        first.iter().any(|a| {
            second
                .iter()
                .any(|b| a == b || tree.is_below(*a, *b) || tree.is_below(*b, *a))
        })
    };
    let best_beside = |pairs: &[LimbPair], other: &LimbPair| {
        pairs.iter().find(|pair| !overlap(pair, other)).copied()
    };
    let candidates = [
        leg_pairs
            .first()
            .map(|legs| (Some(*legs), best_beside(arm_pairs, legs))),
        arm_pairs
            .first()
            .map(|arms| (best_beside(leg_pairs, arms), Some(*arms))),
    ];
    let score = |(legs, arms): &(Option<LimbPair>, Option<LimbPair>)| {
        [legs, arms]
            .into_iter()
            .flatten()
            .map(|pair| pair.score)
            .sum::<f64>()
    };
    let best = candidates.into_iter().flatten();
    let best = best.max_by(|a, b| score(a).total_cmp(&score(b)));
    let Some((legs, arms)) = best else {
        return (None, None);
    };
    let (Some(first), Some(second)) = (legs, arms) else {
        return (legs, arms);
    };
    // Legs hang on the pelvis, and arms on a joint above it that also carries the head.
    let joint =
        |pair: &LimbPair| tree.common_ancestor(pair.sides[0].joints[0], pair.sides[1].joints[0]);
    let are_exchanged = match (joint(&first), joint(&second)) {
        (Some(legs), Some(arms)) => tree.is_below(legs, arms),
        _ => false,
    };
    if !are_exchanged {
        return (legs, arms);
    }
    if first.names + second.names > MIN_NAME_SCORE {
        notes.push(
            "the names of arms and legs do not agree with the tree, in which legs are nearer to the root: names are used"
                .to_owned(),
        );
        return (legs, arms);
    }
    (arms, legs)
}

/// Adds pelvis, chest and head.
fn add_trunk(
    tree: &JointTree,
    names: &[BoneName],
    (legs, arms): (Option<LimbPair>, Option<LimbPair>),
    anatomy: &mut Anatomy,
) {
    let joint =
        |pair: LimbPair| tree.common_ancestor(pair.sides[0].joints[0], pair.sides[1].joints[0]);
    let (hips, shoulders) = (legs.and_then(joint), arms.and_then(joint));
    let limbs: Vec<usize> = [legs, arms]
        .into_iter()
        .flatten()
        .flat_map(|pair| pair.sides.map(|limb| limb.joints[0]))
        .collect();
    let in_limb = |joint: usize| {
        limbs
            .iter()
            .any(|limb| joint == *limb || tree.is_below(joint, *limb))
    };
    let head = head(tree, names, shoulders, &in_limb);
    if let Some(head) = head {
        anatomy.parts.insert(BodyPart::Head, head);
    }
    let chest = match (shoulders, head) {
        (Some(shoulders), Some(head)) => tree.common_ancestor(shoulders, head),
        (shoulders, _) => shoulders,
    };
    let chest = chest.filter(|chest| Some(*chest) != hips);
    if let Some(chest) = chest {
        anatomy.parts.insert(BodyPart::Chest, chest);
    }
    let Some((hips, legs)) = hips.zip(legs) else {
        return;
    };
    let middle =
        0.5 * (tree.positions[legs.sides[0].joints[0]] + tree.positions[legs.sides[1].joints[0]]);
    let leg = tree.distance(legs.sides[0].joints[0], legs.sides[0].joints[1]);
    let is_near = |joint: &usize| {
        tree.positions[*joint].distance(middle) < MAX_PELVIS_DISTANCE * leg && Some(*joint) != chest
    };
    let root = chest.and_then(|chest| tree.common_ancestor(hips, chest));
    let name_score = |joint: &usize| names[*joint].score(BoneRole::Pelvis);
    let named = |joint: &usize| name_score(joint) >= 0.85 && is_near(joint);
    // The joint that carries legs and spine, or one above it with the name of a pelvis.
    let root = root
        .filter(|root| *root == hips || is_near(root))
        .unwrap_or(hips);
    let mut above = tree.up_from(root);
    let pelvis = match name_score(&root) >= 0.85 {
        true => root,
        false => above.find(named).unwrap_or(root),
    };
    anatomy.parts.insert(BodyPart::Pelvis, pelvis);
}

/// Finds the head by its name, or else at the end of the chain between the shoulders.
fn head(
    tree: &JointTree,
    names: &[BoneName],
    shoulders: Option<usize>,
    in_limb: &dyn Fn(usize) -> bool,
) -> Option<usize> {
    let is_above_chest = |joint: &usize| {
        let Some(shoulders) = shoulders else {
            return true;
        };
        // Below the shoulders' joint, or on a chain next to it.
        *joint != shoulders && !tree.is_below(shoulders, *joint)
    };
    let depth = |joint: usize| tree.up_from(joint).count();
    let mut named: Vec<usize> = (0..tree.len())
        .filter(|joint| !in_limb(*joint) && names[*joint].score(BoneRole::Head) > 0.5)
        .filter(is_above_chest)
        .collect();
    named.sort_by(|a, b| {
        let scores = [a, b].map(|joint| names[*joint].score(BoneRole::Head));
        scores[1]
            .total_cmp(&scores[0])
            .then(depth(*a).cmp(&depth(*b)))
    });
    if let Some(head) = named.first() {
        return Some(*head);
    }
    let shoulders = shoulders?;
    let reach = |joint: usize| {
        let below = tree.subtree(joint).into_iter();
        below
            .map(|end| tree.distance(joint, end))
            .fold(0.0, f64::max)
    };
    let continues = |joint: &usize| !in_limb(*joint) && !is_chain_end(&tree.names[*joint]);
    // Clavicles carry an arm; the neck does not.
    let carries_limb = |joint: usize| tree.subtree(joint).into_iter().any(in_limb);
    let central = |joint: usize| {
        let children = tree.children(joint).iter().copied().filter(continues);
        let children = children.filter(|child| !carries_limb(*child));
        children.max_by(|a, b| {
            let size = |joint: usize| {
                reach(joint) + tree.distance(joint, tree.parents[joint].unwrap_or(joint))
            };
            size(*a).total_cmp(&size(*b))
        })
    };
    let mut head = central(shoulders)?;
    // Up to the joint where the chain branches into the face, or ends.
    while let [child] = tree.children(head) {
        if !continues(child) || tree.children(head).len() > 1 {
            break;
        }
        head = *child;
    }
    Some(head)
}

/// Adds the toes: by name, or else the child of an ankle that is farthest from it.
fn add_toes(tree: &JointTree, names: &[BoneName], anatomy: &mut Anatomy) {
    for [ankle, knee, toe] in [
        [BodyPart::LeftAnkle, BodyPart::LeftKnee, BodyPart::LeftToe],
        [
            BodyPart::RightAnkle,
            BodyPart::RightKnee,
            BodyPart::RightToe,
        ],
    ] {
        let (Some(&ankle), Some(&knee)) = (anatomy.parts.get(&ankle), anatomy.parts.get(&knee))
        else {
            continue;
        };
        let min_length = 0.05 * tree.distance(knee, ankle);
        let below: Vec<usize> = tree.subtree(ankle).into_iter().skip(1).collect();
        let is_long = |joint: &usize| tree.distance(ankle, *joint) > min_length;
        let named = below.iter().copied().filter(is_long).filter(|joint| {
            names[*joint].score(BoneRole::Toe) > 0.5 && !is_chain_end(&tree.names[*joint])
        });
        let by_score = named.reduce(|a, b| {
            match names[b].score(BoneRole::Toe) > names[a].score(BoneRole::Toe) {
                true => b,
                false => a,
            }
        });
        let farthest = tree.children(ankle).iter().copied();
        let farthest = farthest.filter(|joint| is_long(joint) && !names[*joint].is_helper);
        let farthest = farthest.max_by(|a, b| {
            tree.distance(ankle, *a)
                .total_cmp(&tree.distance(ankle, *b))
        });
        if let Some(found) = by_score.or(farthest) {
            anatomy.parts.insert(toe, found);
        }
    }
}

/// Returns whether left parts are on the right: by the directions from the pelvis to the head and along the feet.
fn is_mirrored(parts: &BTreeMap<BodyPart, usize>, posed: &[DVec3]) -> bool {
    let at = |part: BodyPart| {
        parts
            .get(&part)
            .and_then(|joint| posed.get(*joint))
            .copied()
    };
    let upright = || {
        let up = at(BodyPart::Head)? - at(BodyPart::Pelvis)?;
        let foot = |ankle, toe| Some(at(toe)? - at(ankle)?);
        let forward = foot(BodyPart::LeftAnkle, BodyPart::LeftToe)?
            + foot(BodyPart::RightAnkle, BodyPart::RightToe)?;
        let left = at(BodyPart::LeftHip)? - at(BodyPart::RightHip)?;
        Some(up.cross(forward).dot(left) < 0.0)
    };
    upright().unwrap_or(false)
}

fn swap_sides(parts: &mut BTreeMap<BodyPart, usize>) {
    let mirrored = |part: BodyPart| {
        let name = part.name();
        let other = match name.split_once('_') {
            Some(("left", rest)) => format!("right_{rest}"),
            Some(("right", rest)) => format!("left_{rest}"),
            _ => return part,
        };
        let found = BodyPart::ALL.iter().find(|(_, name)| *name == other);
        found.map_or(part, |(part, _)| *part)
    };
    *parts = parts
        .iter()
        .map(|(part, joint)| (mirrored(*part), *joint))
        .collect();
}
