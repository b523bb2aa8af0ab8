//! Fingers of a hand, by name and tree.

use std::collections::BTreeMap;

use super::joint_tree::JointTree;
use super::name_words::{FingerName, bone_names, is_chain_end, is_twist};

/// Largest number of rotating bones of a finger.
const PHALANGES: usize = 3;

/// Returns the bones of each finger below a wrist, from the palm outwards, without metacarpals and ends.
pub(in super::super) fn fingers(
    tree: &JointTree,
    wrist: usize,
) -> BTreeMap<FingerName, Vec<usize>> {
    let names = bone_names(&tree.names);
    let mut fingers: BTreeMap<FingerName, Vec<usize>> = BTreeMap::new();
    for joint in tree.subtree(wrist).into_iter().skip(1) {
        let name = &tree.names[joint];
        let Some(finger) = names[joint].finger() else {
            continue;
        };
        let lower = name.to_lowercase();
        let is_in_palm = ["metacarpal", "inhand", "carpal"]
            .iter()
            .any(|word| lower.contains(word));
        if is_in_palm || is_twist(name) || is_chain_end(name) {
            continue;
        }
        let chain = fingers.entry(finger).or_default();
        // A chain: each bone is below the one before.
        if chain.last().is_none_or(|last| tree.is_below(joint, *last)) {
            chain.push(joint);
        }
    }
    for chain in fingers.values_mut() {
        // A fourth bone without children is the tip of the finger.
        if chain.len() > PHALANGES {
            let is_leaf = chain
                .last()
                .is_some_and(|last| tree.children(*last).is_empty());
            match is_leaf {
                true => chain.truncate(PHALANGES),
                false => {
                    chain.remove(0);
                    chain.truncate(PHALANGES);
                }
            }
        }
    }
    fingers
}
