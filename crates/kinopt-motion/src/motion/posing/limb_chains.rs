//! Limbs of a skeleton without known names, by lengths and branches.

use kinopt_kinematics::skeleton::{BoneId, Skeleton};
use kinopt_kinematics::spatial::Vector3;

use super::body_limb::{BodyLimb, BodyLimbKind};

/// Smallest length of a limb, relative to the size of the skeleton.
const MIN_RELATIVE_LENGTH: f64 = 0.2;
/// Smallest length of a segment, relative to its limb. Shorter segments are feet, hands and twist bones.
const MIN_RELATIVE_SEGMENT: f64 = 0.2;
/// Largest difference of the lengths of two limbs of a pair, relative to the longer one.
const MAX_PAIR_DIFFERENCE: f64 = 0.05;

/// Limbs that end without further branches into limbs, and that have a partner of equal length. Tails and necks have
/// none.
pub(super) fn chains(skeleton: &Skeleton) -> Vec<BodyLimb> {
    let bones = skeleton.bones();
    let lengths = lengths_below(skeleton);
    let min_length = MIN_RELATIVE_LENGTH * skeleton.size();
    let is_long = |bone: usize| lengths[bone] >= min_length;
    let long_children = |bone: usize| -> Vec<usize> {
        let children =
            (0..bones.len()).filter(|&child| bones[child].parent.map(BoneId::index) == Some(bone));
        children.filter(|&child| is_long(child)).collect()
    };
    let mut found = Vec::new();
    for base in 0..bones.len() {
        let children = long_children(base);
        for &child in children.iter().filter(|_| children.len() > 1) {
            found.extend(limb_from(skeleton, &lengths, child));
        }
    }
    let has_partner = |limb: &BodyLimb| {
        found.iter().any(|other: &BodyLimb| {
            let (a, b) = (limb.length(), other.length());
            other.upper != limb.upper && (a - b).abs() <= MAX_PAIR_DIFFERENCE * a.max(b)
        })
    };
    found
        .iter()
        .filter(|limb| has_partner(limb))
        .cloned()
        .collect()
}

/// Longest distance along the bones from each bone's tail to an end below it.
fn lengths_below(skeleton: &Skeleton) -> Vec<f64> {
    let bones = skeleton.bones();
    let mut lengths: Vec<f64> = bones.iter().map(|bone| bone.length).collect();
    for index in (0..bones.len()).rev() {
        if let Some(parent) = bones[index].parent.map(BoneId::index) {
            let step = (bones[index].rest_tail() - bones[parent].rest_tail()).norm();
            lengths[parent] = lengths[parent].max(step + lengths[index]);
        }
    }
    lengths
}

/// The limb along the longest chain from a bone: its longest segment begins at the hip or shoulder, or ends at the
/// ankle or wrist.
fn limb_from(skeleton: &Skeleton, lengths: &[f64], first: usize) -> Option<BodyLimb> {
    let bones = skeleton.bones();
    let next = |bone: &usize| {
        let children =
            (0..bones.len()).filter(|&child| bones[child].parent.map(BoneId::index) == Some(*bone));
        children.max_by(|&a, &b| {
            let reach = |child: usize| {
                lengths[child] + (bones[child].rest_tail() - bones[*bone].rest_tail()).norm()
            };
            reach(a).total_cmp(&reach(b))
        })
    };
    let chain: Vec<usize> = std::iter::successors(Some(first), next).collect();
    let mut points: Vec<(usize, Vector3<f64>)> = chain
        .iter()
        .map(|&bone| (bone, bones[bone].rest_tail()))
        .collect();
    let last = *chain.last()?;
    if bones[last].length > 0.0 {
        points.push((last, bones[last].rest_tip()));
    }
    let total: f64 = points
        .windows(2)
        .map(|pair| (pair[1].1 - pair[0].1).norm())
        .sum();
    // Segments of the limb itself: the first bone may be a clavicle, the last ones a foot or fingers.
    let is_long = |pair: &[(usize, Vector3<f64>)]| {
        (pair[1].1 - pair[0].1).norm() >= MIN_RELATIVE_SEGMENT * total
    };
    let start = (0..points.len().saturating_sub(2))
        .find(|&k| is_long(&points[k..k + 2]) && is_long(&points[k + 1..k + 3]))?;
    let [(upper, a), (lower, b), (end, c)] = [points[start], points[start + 1], points[start + 2]];
    let end = (end != lower).then_some(end);
    Some(BodyLimb {
        kind: BodyLimbKind::Other,
        side: None,
        upper: skeleton.bone_at(upper)?,
        lower: skeleton.bone_at(lower)?,
        end: end.and_then(|end| skeleton.bone_at(end)),
        toe: None,
        joints: [a, b, c],
        toe_position: points.get(start + 3).map(|(_, position)| *position),
    })
}
