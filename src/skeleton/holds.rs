//! Parts of a skeleton that stay fixed while other parts are dragged.

use super::{BoneId, Skeleton};
use crate::model::{Limits, ModelError, ParameterMap, ParameterMapBuilder};

/// Smallest number of movable bones of a limb.
const BONES_OF_A_LIMB: usize = 2;
/// Smallest length of a limb whose end is fixed, relative to the size of the skeleton. Arms, legs and tails exceed it;
/// fingers and heads do not.
const LENGTH_OF_A_LIMB: f64 = 0.2;
/// Largest bend of the spine, summed over its bones, and largest twist, radians.
const BENDS_OF_A_BACK: f64 = 0.7;

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
    /// bends only slightly. A limb is long from a fifth of the skeleton's size: heads and fingers move along.
    ///
    /// A dragged root chain is free. A skeleton without branching limbs has no fixed parts. Locked bones do not count.
    #[must_use]
    pub fn holds(&self, dragged: &[BoneId]) -> Holds {
        let bones = self.bones.len();
        let parent = |bone: usize| self.bones[bone].parent.map(BoneId::index);
        let moves = |bone: usize| !self.bones[bone].limits.iter().all(Limits::is_locked);
        let dragged: Vec<usize> = dragged.iter().map(|bone| bone.index()).collect();

        // Largest number of movable bones in a chain from each bone.
        let mut depth = vec![0; bones];
        for bone in (0..bones).rev() {
            depth[bone] += usize::from(moves(bone));
            if let Some(parent) = parent(bone) {
                depth[parent] = depth[parent].max(depth[bone]);
            }
        }
        let mut limbs = vec![0; bones];
        for bone in (0..bones).filter(|&bone| depth[bone] >= BONES_OF_A_LIMB) {
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
        let mut carries: Vec<bool> = (0..bones).map(|bone| dragged.contains(&bone)).collect();
        let mut carried: Vec<bool> = carries.clone();
        for bone in 0..bones {
            if let Some(parent) = parent(bone) {
                carried[bone] |= carried[parent] && !leads_to_limbs(parent);
            }
        }
        for bone in (0..bones).rev() {
            if let Some(parent) = parent(bone) {
                carries[parent] |= carries[bone];
            }
        }
        // By bone: the movable child with the longest chain.
        let mut furthest: Vec<Option<usize>> = vec![None; bones];
        let long = self.limb_lengths();
        for bone in (0..bones).filter(|&bone| depth[bone] > 0) {
            if let Some(parent) = parent(bone) {
                let best = &mut furthest[parent];
                if best.is_none_or(|best| self.goes(&long, bone) > self.goes(&long, best)) {
                    *best = Some(bone);
                }
            }
        }
        // By bone: a dragged limb branches off another one here or at a descendant.
        let least = LENGTH_OF_A_LIMB * self.size();
        let (mut limbs_here, mut splits) = (vec![0; bones], vec![false; bones]);
        for bone in (0..bones).rev() {
            splits[bone] |= limbs_here[bone] > 1;
            splits[bone] &= carries[bone] && !dragged.contains(&bone);
            if let Some(parent) = parent(bone) {
                limbs_here[parent] += usize::from(long[bone] >= least);
                splits[parent] |= splits[bone];
            }
        }
        // By bone: it belongs to a long limb to fix; it is the end of that limb, apart from short limbs.
        let long_limb = |bone: usize| long[bone] >= least && depth[bone] > 0;
        let mut goes_on = vec![false; bones];
        let mut is_end = vec![false; bones];
        for bone in 0..bones {
            let above = parent(bone);
            let branches = above.is_none_or(|parent| carries[parent] || limbs_here[parent] > 1);
            goes_on[bone] = !carries[bone]
                && !carried[bone]
                && match above {
                    _ if branches => long_limb(bone),
                    Some(parent) => goes_on[parent] && furthest[parent] == Some(bone),
                    None => false,
                };
            is_end[bone] = goes_on[bone] && furthest[bone].is_none() && limbs_here[bone] < 2;
        }
        let has_limbs = limbs.iter().any(|&limbs| limbs > 1);
        let ids = |wanted: &dyn Fn(usize) -> bool| {
            let wanted = (0..bones).filter(|&bone| has_limbs && wanted(bone));
            wanted.map(BoneId::new).collect()
        };
        Holds {
            trunk: ids(&|bone| leads_to_limbs(bone) && carries[bone] && !carried[bone]),
            back: ids(&|bone| moves(bone) && branched[bone] && splits[bone] && !carried[bone]),
            ends: ids(&|bone| is_end[bone]),
        }
    }
}

impl Skeleton {
    /// Length of the longest chain from the tail of each bone, at rest.
    fn limb_lengths(&self) -> Vec<f64> {
        let mut lengths: Vec<f64> = self.bones.iter().map(|bone| bone.length).collect();
        for index in (0..lengths.len()).rev() {
            if let Some(parent) = self.bones[index].parent.map(BoneId::index) {
                lengths[parent] = lengths[parent].max(self.goes(&lengths, index));
            }
        }
        lengths
    }

    /// Length of the longest chain through a bone, from its parent's tail.
    fn goes(&self, lengths: &[f64], bone: usize) -> f64 {
        let here = &self.bones[bone];
        let parent = here.parent.map(|parent| &self.bones[parent.index()]);
        let from = parent.unwrap_or(here).rest_tail();
        (here.rest_tail() - from).norm() + lengths[bone]
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
        let model = skeleton.model();
        let at = |joint| {
            let at = model.coordinate(joint).and_then(|at| q.get(at));
            at.copied().unwrap_or(0.0)
        };
        for joint in self.trunk.iter().flat_map(|&bone| skeleton.joints(bone)) {
            map = map.with_locked(joint, at(joint));
        }
        let bend = BENDS_OF_A_BACK / self.back.len().max(1) as f64;
        for joints in self.back.iter().map(|&bone| skeleton.joints(bone)) {
            // In a straight bone both twists have one axis, so each gets half.
            for (joint, far) in joints.into_iter().zip([0.5 * bend, bend, 0.5 * bend]) {
                let at = at(joint);
                map = map.with_narrowed(joint, Limits::new(at - far, at + far));
            }
        }
        map
    }
}
