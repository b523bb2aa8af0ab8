//! What of a body stays where it is while something else is dragged.

use super::{BoneId, Skeleton};
use crate::model::{Limits, ModelError, ParameterMap};

/// A limb has at least so many bones that move.
const BONES_OF_A_LIMB: usize = 2;

/// What stays while bones are dragged: see [`Skeleton::holds`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Holds {
    /// The bones from the root to where the first limbs branch off (of a character: to the hips). They
    /// do not turn.
    pub trunk: Vec<BoneId>,
    /// The ends of limbs, whose tips stay where they are.
    pub ends: Vec<BoneId>,
}

impl Skeleton {
    /// What should stay where it is while the tips of `dragged` bones are, so that a character stays on
    /// its feet: the trunk up to the hips, and the end of every limb but those that a dragged bone
    /// carries. Where the trunk itself is dragged it is free, and where no limbs branch off there
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
        let has_limbs = (0..bones).any(|bone| !branched[bone] && limbs[bone] > 1);
        let ids = |wanted: &dyn Fn(usize) -> bool| {
            let wanted = (0..bones).filter(|&bone| has_limbs && wanted(bone));
            wanted.map(BoneId::new).collect()
        };
        Holds {
            trunk: ids(&|bone| leads_to_limbs(bone) && carries[bone] && !carried[bone]),
            ends: ids(&|bone| moves(bone) && depth[bone] == 1 && !carried[bone] && !carries[bone]),
        }
    }
}

impl Holds {
    /// The angles that are free: those of the skeleton but the trunk's, which stay as in `q` (stacked
    /// angles, radians; missing ones count as 0).
    ///
    /// # Errors
    /// Angles of the trunk beyond its limits.
    pub fn parameters(&self, skeleton: &Skeleton, q: &[f64]) -> Result<ParameterMap, ModelError> {
        let model = skeleton.model();
        let mut map = ParameterMap::builder(model);
        for joint in self.trunk.iter().flat_map(|&bone| skeleton.joints(bone)) {
            let at = model.coordinate(joint).and_then(|at| q.get(at));
            map = map.lock(joint, at.copied().unwrap_or(0.0));
        }
        map.build()
    }
}
