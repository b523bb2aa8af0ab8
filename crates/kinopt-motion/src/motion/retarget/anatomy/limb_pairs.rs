//! Pairs of limbs of a joint tree: three joints each, found by symmetry, lengths and names.

use super::joint_tree::JointTree;
use super::name_words::{BoneName, BoneRole, BoneSide};

/// Number of the best limbs of a kind that are paired.
const MAX_CANDIDATES: usize = 60;
/// Largest number of joints between the ends of a limb and its middle joint.
const MAX_STEPS: usize = 8;
/// Largest ratio of the lengths of both sides.
const MAX_SIDE_RATIO: f64 = 1.3;
/// Largest ratio of the two segments of a limb.
const MAX_SEGMENT_RATIO: f64 = 2.2;
/// Smallest length of a segment, relative to the size of the tree.
const MIN_SEGMENT: f64 = 0.03;

/// Distance of both limbs, relative to their length, below which their first joints are joints of the trunk.
const MIN_SPREAD: f64 = 0.01;

/// Kind of a limb.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LimbKind {
    Leg,
    Arm,
}

impl LimbKind {
    fn roles(self) -> [BoneRole; 3] {
        match self {
            Self::Leg => [BoneRole::Hip, BoneRole::Knee, BoneRole::Ankle],
            Self::Arm => [BoneRole::Shoulder, BoneRole::Elbow, BoneRole::Wrist],
        }
    }
}

/// Joints of a limb from the trunk outwards: hip, knee, ankle or shoulder, elbow, wrist.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LimbJoints {
    pub(super) joints: [usize; 3],
    side: Option<BoneSide>,
    /// Score of the names, from 0 to 3.3.
    names: f64,
    score: f64,
    lengths: [f64; 2],
}

/// Limbs of both sides, left first if the names say so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LimbPair {
    pub(super) sides: [LimbJoints; 2],
    /// True if the names determine left and right.
    pub(super) sides_named: bool,
    /// Score of the names of both limbs, from 0 to 6.6.
    pub(super) names: f64,
    pub(super) score: f64,
}

/// Returns the pairs of limbs of a kind, the best first.
pub(super) fn limb_pairs(
    tree: &JointTree,
    names: &[BoneName],
    kind: LimbKind,
    size: f64,
) -> Vec<LimbPair> {
    let mut limbs = Vec::new();
    for end in 0..tree.len() {
        let above: Vec<usize> = tree.up_from(end).skip(1).take(2 * MAX_STEPS).collect();
        for (k, &middle) in above.iter().take(MAX_STEPS).enumerate() {
            for &start in above.iter().skip(k + 1).take(MAX_STEPS) {
                limbs.extend(limb(tree, names, kind, [start, middle, end], size));
            }
        }
    }
    limbs.sort_by(|a, b| b.score.total_cmp(&a.score));
    // The best of each side, so that one side with many bones does not displace the other.
    let mut kept: Vec<LimbJoints> = Vec::new();
    for side in [None, Some(BoneSide::Left), Some(BoneSide::Right)] {
        let of_side = limbs.iter().filter(|limb| limb.side == side);
        kept.extend(of_side.take(MAX_CANDIDATES));
    }
    let mut pairs = Vec::new();
    for (k, a) in kept.iter().enumerate() {
        for b in &kept[k + 1..] {
            pairs.extend(pair(tree, a, b));
        }
    }
    pairs.sort_by(|a, b| b.score.total_cmp(&a.score));
    pairs
}

fn limb(
    tree: &JointTree,
    names: &[BoneName],
    kind: LimbKind,
    joints: [usize; 3],
    size: f64,
) -> Option<LimbJoints> {
    let [start, middle, end] = joints;
    let lengths = [tree.distance(start, middle), tree.distance(middle, end)];
    let ratio = lengths[0].max(lengths[1]) / lengths[0].min(lengths[1]).max(1e-9 * size);
    if lengths[0].min(lengths[1]) < MIN_SEGMENT * size || ratio > MAX_SEGMENT_RATIO {
        return None;
    }
    let sides = joints.map(|joint| names[joint].side);
    let side = sides[2];
    // Joints of one limb are on one side.
    if sides
        .iter()
        .flatten()
        .any(|other| Some(*other) != side.or(Some(*other)))
    {
        return None;
    }
    let by_name = joints
        .iter()
        .zip(kind.roles())
        .map(|(joint, role)| names[*joint].score(role))
        .sum::<f64>();
    // Bones between the joints are twist bones, so there are few.
    let steps = tree.joints_between(start, end)?.len().saturating_sub(1) as f64;
    // Beyond the wrist are fingers, beyond the ankle is the foot.
    let beyond = tree.subtree(end).into_iter();
    let reach = beyond
        .map(|joint| tree.distance(end, joint))
        .fold(0.0, f64::max);
    let reach_ratio = reach / lengths[1];
    let by_shape = 2.0 * (lengths[0] + lengths[1]) / size
        - (ratio - 1.0)
        - 0.1 * steps
        - if reach_ratio > 1.0 { 1.0 } else { 0.0 }
        + if reach_ratio > 0.05 { 0.2 } else { 0.0 };
    Some(LimbJoints {
        joints,
        side,
        names: by_name,
        score: by_shape + 1.5 * by_name,
        lengths,
    })
}

fn pair(tree: &JointTree, a: &LimbJoints, b: &LimbJoints) -> Option<LimbPair> {
    if (a.side.is_some() || b.side.is_some()) && a.side == b.side {
        return None;
    }
    let ratio = |k: usize| {
        let [shorter, longer] = [
            a.lengths[k].min(b.lengths[k]),
            a.lengths[k].max(b.lengths[k]),
        ];
        longer / shorter
    };
    let asymmetry = ratio(0).max(ratio(1));
    let [a_start, b_start] = [a.joints[0], b.joints[0]];
    let ancestor = tree.common_ancestor(a_start, b_start);
    if asymmetry > MAX_SIDE_RATIO || ancestor == Some(a_start) || ancestor == Some(b_start) {
        return None;
    }
    let depth = |joint: usize| tree.up_from(joint).count();
    let depths = a
        .joints
        .iter()
        .zip(b.joints)
        .map(|(a, b)| depth(*a).abs_diff(depth(b)))
        .sum::<usize>() as f64;
    // Both limbs begin near each other.
    let spread = tree.distance(a_start, b_start) / (a.lengths[0] + a.lengths[1]);
    let coincidence = if spread < MIN_SPREAD { 1.0 } else { 0.0 };
    let sides = match a.side == Some(BoneSide::Right) || b.side == Some(BoneSide::Left) {
        true => [*b, *a],
        false => [*a, *b],
    };
    Some(LimbPair {
        sides,
        sides_named: a.side.is_some() && b.side.is_some(),
        names: a.names + b.names,
        score: a.score + b.score
            - 3.0 * (asymmetry - 1.0)
            - 0.3 * depths
            - 0.3 * spread
            - coincidence,
    })
}
