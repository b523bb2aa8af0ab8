//! Parts of a skeleton that stay fixed while other parts are dragged.

use super::{BoneId, Skeleton};
use crate::model::{JointId, Limits, ModelError, ParameterMap, ParameterMapBuilder};

/// Smallest number of movable bones of a limb.
const MIN_LIMB_BONES: usize = 2;
/// Smallest length of a limb whose end is fixed, relative to the size of the skeleton. Arms, legs and tails exceed it;
/// fingers and heads do not.
const MIN_RELATIVE_LIMB_LENGTH: f64 = 0.2;
/// Largest difference of the lengths of two limbs of a pair, relative to the longer one, on one parent and on different
/// ones.
const MAX_SIBLING_DIFFERENCE: f64 = 0.05;
const MAX_PAIR_DIFFERENCE: f64 = 0.01;
/// Largest bend of the spine, summed over its bones, and largest twist, radians.
const MAX_SPINE_BEND: f64 = 0.7;

/// Fixed parts during a drag: see [`Skeleton::holds`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Holds {
    /// The bones from the root to the branching of the first limbs (of a character: to the hips). They are locked.
    pub trunk: Vec<BoneId>,
    /// The bones between the root chain and the branching of a dragged limb from another one (of a character: the
    /// spine). Together they bend and twist by at most 0.7 rad.
    pub back: Vec<BoneId>,
    /// One bone at the end of each fixed long limb; its tip stays in place.
    pub ends: Vec<BoneId>,
}

impl Skeleton {
    /// The parts to fix while the tips of the `dragged` bones move, so that a character stays on its feet.
    ///
    /// These are the root chain up to the hips and the end of every long limb that carries no dragged bone. The spine
    /// bends only slightly. A limb is long from a fifth of the skeleton's size: heads and fingers move along. If any limbs
    /// are pairs of equal length, limbs without a partner move along too, such as a tail.
    ///
    /// A dragged root chain is free. A skeleton without branching limbs has no fixed parts. Locked bones do not count.
    #[must_use]
    pub fn holds(&self, dragged: &[BoneId]) -> Holds {
        let bones = self.bones.len();
        let parent = |bone: usize| self.bones[bone].parent.map(BoneId::index);
        let is_movable = |bone: usize| !self.bones[bone].limits.iter().all(Limits::is_locked);
        let dragged: Vec<usize> = dragged.iter().map(|bone| bone.index()).collect();

        // Largest number of movable bones in a chain from each bone.
        let mut depth = vec![0; bones];
        for bone in (0..bones).rev() {
            depth[bone] += usize::from(is_movable(bone));
            if let Some(parent) = parent(bone) {
                depth[parent] = depth[parent].max(depth[bone]);
            }
        }
        let mut limbs = vec![0; bones];
        for bone in (0..bones).filter(|&bone| depth[bone] >= MIN_LIMB_BONES) {
            if let Some(parent) = parent(bone) {
                limbs[parent] += 1;
            }
        }

        let mut branched = vec![false; bones];
        for bone in 0..bones {
            if let Some(parent) = parent(bone) {
                branched[bone] = branched[parent] || limbs[parent] > 1;
            }
        }
        let leads_to_limbs = |bone: usize| !branched[bone] && limbs[bone] > 0;

        // By bone: it or a descendant is dragged; it or an ancestor is dragged. A dragged root chain does not carry its
        // limbs.
        let mut dragged_below: Vec<bool> = (0..bones).map(|bone| dragged.contains(&bone)).collect();
        let mut dragged_above: Vec<bool> = dragged_below.clone();
        for bone in 0..bones {
            if let Some(parent) = parent(bone) {
                dragged_above[bone] |= dragged_above[parent] && !leads_to_limbs(parent);
            }
        }
        for bone in (0..bones).rev() {
            if let Some(parent) = parent(bone) {
                dragged_below[parent] |= dragged_below[bone];
            }
        }
        // By bone: the movable child with the longest chain.
        let mut longest_child: Vec<Option<usize>> = vec![None; bones];
        let lengths = self.lengths_of_chains(|_| true);
        for bone in (0..bones).filter(|&bone| depth[bone] > 0) {
            if let Some(parent) = parent(bone) {
                let best = &mut longest_child[parent];
                if best.is_none_or(|best| {
                    self.chain_length(&lengths, bone) > self.chain_length(&lengths, best)
                }) {
                    *best = Some(bone);
                }
            }
        }
        // By bone: a dragged limb branches off another one here or at a descendant.
        let min_limb_length = MIN_RELATIVE_LIMB_LENGTH * self.size();
        let (mut long_limbs, mut has_dragged_branch) = (vec![0; bones], vec![false; bones]);
        for bone in (0..bones).rev() {
            has_dragged_branch[bone] |= long_limbs[bone] > 1;
            has_dragged_branch[bone] &= dragged_below[bone] && !dragged.contains(&bone);
            if let Some(parent) = parent(bone) {
                long_limbs[parent] += usize::from(lengths[bone] >= min_limb_length);
                has_dragged_branch[parent] |= has_dragged_branch[bone];
            }
        }
        // By bone: it belongs to a long limb to fix; it is the end of that limb, apart from short limbs.
        let is_long_limb = |bone: usize| lengths[bone] >= min_limb_length && depth[bone] > 0;
        // By bone: the first bone of a limb with a partner. Tails and heads have none, and move along.
        let movable_lengths = self.lengths_of_chains(|bone| depth[bone] > 0);
        let length_of = |bone: usize| self.chain_length(&movable_lengths, bone);
        let starts: Vec<usize> = (0..bones)
            .filter(|&bone| is_long_limb(bone) && parent(bone).is_some_and(|p| long_limbs[p] > 1))
            .collect();
        let is_pair = |a: usize, b: usize| {
            let difference = (length_of(a) - length_of(b)).abs();
            let tolerance = match parent(a) == parent(b) {
                true => MAX_SIBLING_DIFFERENCE,
                false => MAX_PAIR_DIFFERENCE,
            };
            a != b && difference <= tolerance * length_of(a).max(length_of(b))
        };
        let has_partner = |bone: usize| starts.iter().any(|&other| is_pair(bone, other));
        let has_pairs = starts.iter().any(|&bone| has_partner(bone));
        let mut on_fixed_limb = vec![false; bones];
        let mut is_end = vec![false; bones];
        for bone in 0..bones {
            let parent_index = parent(bone);
            let branches =
                parent_index.is_none_or(|parent| dragged_below[parent] || long_limbs[parent] > 1);
            on_fixed_limb[bone] = !dragged_below[bone]
                && !dragged_above[bone]
                && match parent_index {
                    _ if branches => is_long_limb(bone) && (has_partner(bone) || !has_pairs),
                    Some(parent) => on_fixed_limb[parent] && longest_child[parent] == Some(bone),
                    None => false,
                };
            is_end[bone] =
                on_fixed_limb[bone] && longest_child[bone].is_none() && long_limbs[bone] < 2;
        }
        let has_limbs = limbs.iter().any(|&limbs| limbs > 1);
        let ids = |is_selected: &dyn Fn(usize) -> bool| {
            let selected = (0..bones).filter(|&bone| has_limbs && is_selected(bone));
            selected.map(BoneId::new).collect()
        };
        Holds {
            trunk: ids(&|bone| leads_to_limbs(bone) && dragged_below[bone] && !dragged_above[bone]),
            back: ids(&|bone| {
                is_movable(bone)
                    && branched[bone]
                    && has_dragged_branch[bone]
                    && !dragged_above[bone]
            }),
            ends: ids(&|bone| is_end[bone]),
        }
    }
}

impl Skeleton {
    /// Length of the longest chain of selected bones from the tail of each bone, at rest.
    fn lengths_of_chains(&self, is_selected: impl Fn(usize) -> bool) -> Vec<f64> {
        let mut lengths: Vec<f64> = self.bones.iter().map(|bone| bone.length).collect();
        for index in (0..lengths.len()).rev().filter(|&index| is_selected(index)) {
            if let Some(parent) = self.bones[index].parent.map(BoneId::index) {
                lengths[parent] = lengths[parent].max(self.chain_length(&lengths, index));
            }
        }
        lengths
    }

    /// Length of the longest chain through a bone, from its parent's tail.
    fn chain_length(&self, lengths: &[f64], bone: usize) -> f64 {
        let entry = &self.bones[bone];
        let parent = entry.parent.map(|parent| &self.bones[parent.index()]);
        let from = parent.unwrap_or(entry).rest_tail();
        (entry.rest_tail() - from).norm() + lengths[bone]
    }
}

impl Holds {
    /// A parameter map with the root chain locked at `q` (joint angles, radians) and the spine limited around `q`.
    ///
    /// # Errors
    /// A wrong number of angles, an angle that is not finite, or angles of the root chain or the spine outside their
    /// limits.
    pub fn parameters(&self, skeleton: &Skeleton, q: &[f64]) -> Result<ParameterMap, ModelError> {
        let map = ParameterMap::builder(skeleton.model());
        self.narrow(map, skeleton, q).build()
    }

    /// As [`parameters`](Self::parameters), in addition to the settings of a map.
    #[must_use]
    pub fn narrow<'m>(
        &self,
        mut map: ParameterMapBuilder<'m>,
        skeleton: &Skeleton,
        q: &[f64],
    ) -> ParameterMapBuilder<'m> {
        map = map.checked(q);
        for (joint, limits) in self.ranges(skeleton, q) {
            map = match limits.is_locked() {
                true => map.with_locked(joint, limits.lower),
                false => map.with_narrowed(joint, limits),
            };
        }
        map
    }

    /// The value of each joint of the root chain, and the range of each joint of the spine around `q`, radians.
    #[doc(hidden)]
    pub fn ranges<'a>(
        &'a self,
        skeleton: &'a Skeleton,
        q: &'a [f64],
    ) -> impl Iterator<Item = (JointId, Limits)> + 'a {
        let model = skeleton.model();
        let value_at = move |joint| {
            let value = model.coordinate(joint).and_then(|value| q.get(value));
            value.copied().unwrap_or(0.0)
        };
        let trunk = self.trunk.iter().flat_map(|&bone| skeleton.joints(bone));
        let locked = trunk.map(move |joint| (joint, Limits::new(value_at(joint), value_at(joint))));
        let bend = MAX_SPINE_BEND / self.back.len().max(1) as f64;
        // In a straight bone both twists have one axis, so each gets half.
        let ranges = [0.5 * bend, bend, 0.5 * bend];
        let back = self
            .back
            .iter()
            .flat_map(move |&bone| skeleton.joints(bone).into_iter().zip(ranges));
        locked.chain(back.map(move |(joint, range)| {
            let centre = value_at(joint);
            (joint, Limits::new(centre - range, centre + range))
        }))
    }
}
