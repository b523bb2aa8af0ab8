//! What of a body stays where it is while something else is dragged.

use super::{BoneId, Skeleton};
use crate::model::{Limits, ModelError, ParameterMap, ParameterMapBuilder};

/// A limb has at least so many bones that move.
const BONES_OF_A_LIMB: usize = 2;
/// A limb that is held is at least so long, as a share of the figure's size: an arm, a leg or a tail, not a
/// finger, and no head, which goes with its body.
const LENGTH_OF_A_LIMB: f64 = 0.2;
/// How far a back may bend, all its bones together, and as much it may twist, in radians.
const BENDS_OF_A_BACK: f64 = 0.7;

/// What stays while bones are dragged: see [`Skeleton::holds`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Holds {
    /// The bones from the root to where the first limbs branch off (of a character: to the hips). They
    /// do not turn.
    pub trunk: Vec<BoneId>,
    /// The bones between the trunk and where a dragged limb branches off another one (of a character: the
    /// back). Together they bend and twist by 0.7 rad at most.
    pub back: Vec<BoneId>,
    /// The ends of long limbs, one each, whose tips stay where they are.
    pub ends: Vec<BoneId>,
}

impl Skeleton {
    /// What should stay where it is while the tips of `dragged` bones are, so that a character stays on
    /// its feet: the trunk up to the hips, and the end of every long limb but those that a dragged bone
    /// carries; and the back hardly bends. A limb is long from a fifth of the figure's size on: heads and
    /// fingers go along. Where the trunk itself is dragged it is free, and where no limbs branch off there
    /// is nothing to hold. Bones that cannot move do not count.
    #[must_use]
    pub fn holds(&self, dragged: &[BoneId]) -> Holds {
        let bones = self.bones.len();
        let parent = |bone: usize| self.bones[bone].parent.map(BoneId::index);
        let moves = |bone: usize| !self.bones[bone].limits.iter().all(Limits::is_locked);
        let dragged: Vec<usize> = dragged.iter().map(|bone| bone.index()).collect();

        // The most bones that move one after the other, from each bone on.
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

        // By bone: whether it or one below it is dragged, and whether it or one above it is. A dragged
        // trunk leaves its limbs behind.
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
        // By bone: the child that moves and goes furthest.
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
        // By bone: whether a dragged limb branches off another one there or further out.
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
        // By bone: whether it goes on in a long limb to hold, and whether that ends there, beyond the short ones.
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
    /// How far the bones from each bone on go on from its tail, at rest.
    fn limb_lengths(&self) -> Vec<f64> {
        let mut lengths: Vec<f64> = self.bones.iter().map(|bone| bone.length).collect();
        for index in (0..lengths.len()).rev() {
            if let Some(parent) = self.bones[index].parent.map(BoneId::index) {
                lengths[parent] = lengths[parent].max(self.goes(&lengths, index));
            }
        }
        lengths
    }

    /// The same from its parent's tail on.
    fn goes(&self, lengths: &[f64], bone: usize) -> f64 {
        let here = &self.bones[bone];
        let parent = here.parent.map(|parent| &self.bones[parent.index()]);
        let from = parent.unwrap_or(here).rest_tail();
        (here.rest_tail() - from).norm() + lengths[bone]
    }
}

impl Holds {
    /// The angles that are free: those of the skeleton but the trunk's, which stay as in `q` (stacked
    /// angles, radians), and the back's little.
    ///
    /// # Errors
    /// Another number of angles, one that is not finite, or those of the trunk or the back beyond their
    /// limits.
    pub fn parameters(&self, skeleton: &Skeleton, q: &[f64]) -> Result<ParameterMap, ModelError> {
        let map = ParameterMap::builder(skeleton.model());
        self.narrow(map, skeleton, q).build()
    }

    /// As [`parameters`](Self::parameters), on top of what a map says already.
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
            // Both twists turn the same way where a bone is straight.
            for (joint, far) in joints.into_iter().zip([0.5 * bend, bend, 0.5 * bend]) {
                let at = at(joint);
                map = map.with_narrowed(joint, Limits::new(at - far, at + far));
            }
        }
        map
    }
}
