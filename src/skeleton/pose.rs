//! A skeleton in a pose: where each bone went, and the transforms that carry skin along.

use super::{BoneId, Skeleton};
use crate::kinematics::{Tree, TreeState};
use crate::model::{FrameId, ParameterMap};
use crate::spatial::{Placement, Vector3};

const NOWHERE: Vector3<f64> = Vector3 {
    x: f64::NAN,
    y: f64::NAN,
    z: f64::NAN,
};

/// Where every bone of a skeleton stands in one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct BonePlacements {
    /// W_i: canonical bone i → posed model, by bone index.
    pub model_from_bone: Vec<Placement<f64>>,
}

impl BonePlacements {
    /// A bone's tail in the pose; NaN for a bone that is not in it.
    #[must_use]
    pub fn tail(&self, bone: BoneId) -> Vector3<f64> {
        let posed = self.model_from_bone.get(bone.index());
        posed.map_or(NOWHERE, |posed| posed.translation)
    }

    /// A bone's tip in the pose of its skeleton; NaN for a bone that is not in both.
    #[must_use]
    pub fn tip(&self, skeleton: &Skeleton, bone: BoneId) -> Vector3<f64> {
        let posed = self.model_from_bone.get(bone.index());
        match (posed, skeleton.bones().get(bone.index())) {
            (Some(posed), Some(bone)) => posed.apply(Vector3::new(bone.length, 0.0, 0.0)),
            _ => NOWHERE,
        }
    }

    /// The same pose with the root placed generally in a larger scene: W_i → P W_i, and so T_i → P T_i
    /// for the skin.
    #[must_use]
    pub fn placed(mut self, scene_from_model: impl Into<Placement<f64>>) -> Self {
        let scene_from_model = scene_from_model.into();
        for posed in &mut self.model_from_bone {
            *posed = scene_from_model * *posed;
        }
        self
    }

    /// The skinning transforms T_i = W_i T̂_i⁻¹ by bone index: rest model → posed model.
    pub fn skinning_transforms<'a>(
        &'a self,
        skeleton: &'a Skeleton,
    ) -> impl Iterator<Item = Placement<f64>> + 'a {
        self.model_from_bone
            .iter()
            .zip(skeleton.bones())
            .map(|(posed, bone)| *posed * bone.model_from_rest.inverse())
    }
}

/// Poses one skeleton again and again: the compiled tree of all its bones and its memory.
#[derive(Clone, Debug)]
pub struct Posing {
    tree: Tree,
    state: TreeState<f64>,
    angles: usize,
    placements: BonePlacements,
}

impl Posing {
    /// Memory for posing `skeleton`. Every angle is read, also one whose limits lock it.
    #[must_use]
    pub fn new(skeleton: &Skeleton) -> Self {
        let map = ParameterMap::identity(skeleton.model());
        let frames: Vec<FrameId> = skeleton.bone_ids().map(|b| skeleton.tail(b)).collect();
        let tree = Tree::new(skeleton.model(), &map, &frames);
        let state = TreeState::new(&tree);
        let placements = BonePlacements {
            model_from_bone: state.frames().to_vec(),
        };
        Self {
            tree,
            state,
            angles: skeleton.angles(),
            placements,
        }
    }

    /// Where the bones stand for the stacked angles `q`, in radians. Missing angles count as 0.
    pub fn pose(&mut self, q: &[f64]) -> &BonePlacements {
        if q.len() >= self.angles {
            self.tree.forward(q, &mut self.state);
        } else {
            let mut padded = q.to_vec();
            padded.resize(self.angles, 0.0);
            self.tree.forward(&padded, &mut self.state);
        }
        self.placements
            .model_from_bone
            .copy_from_slice(self.state.frames());
        &self.placements
    }
}

impl Skeleton {
    /// Where the bones stand for the stacked angles `q`, in radians. [`Posing`] does the same
    /// without allocating each time.
    #[must_use]
    pub fn pose(&self, q: &[f64]) -> BonePlacements {
        let mut posing = Posing::new(self);
        posing.pose(q);
        posing.placements
    }
}
