//! Skeletons of characters.

use std::rc::Rc;

use kinopt::skeleton::BoneId;
use wasm_bindgen::prelude::*;

use crate::armature::Pose;
use crate::error::{Exception, raise};
use crate::model::Model;

/// Bones of a character, with three angles each.
#[wasm_bindgen]
#[derive(Clone)]
pub struct Skeleton {
    pub(crate) inner: Rc<kinopt::Skeleton>,
}

impl From<kinopt::Skeleton> for Skeleton {
    fn from(inner: kinopt::Skeleton) -> Self {
        let inner = Rc::new(inner);
        Self { inner }
    }
}

#[wasm_bindgen]
impl Skeleton {
    /// Model of the skeleton; problems use it.
    #[wasm_bindgen(getter)]
    pub fn model(&self) -> Model {
        self.inner.model().clone().into()
    }

    /// Names of the bones, parents before children.
    #[wasm_bindgen(getter, js_name = boneNames)]
    pub fn bone_names(&self) -> Vec<String> {
        let bones = self.inner.bones().iter();
        bones.map(|bone| bone.name.clone()).collect()
    }

    /// Index of each bone's parent; -1 for roots.
    #[wasm_bindgen(getter)]
    pub fn parents(&self) -> Vec<i32> {
        let bones = self.inner.bones().iter();
        bones
            .map(|bone| bone.parent.map_or(-1, |parent| parent.index() as i32))
            .collect()
    }

    /// The same skeleton with its joints and tips at their positions in a pose of its armature, by the pose's own
    /// translations and scales. The meaning of the angles is unchanged.
    #[wasm_bindgen(js_name = standingIn)]
    pub fn standing_in(&self, pose: &Pose) -> Result<Self, Exception> {
        let standing = pose.inner.posed_skeleton(&self.inner).map_err(raise)?;
        Ok(standing.into())
    }

    /// The frame at the start of a bone.
    pub fn tail(&self, bone: &str) -> Result<String, Exception> {
        self.frame(|bone| self.inner.tail(bone), bone)
    }

    /// Frame at the tip of a bone.
    pub fn tip(&self, bone: &str) -> Result<String, Exception> {
        self.frame(|bone| self.inner.tip(bone), bone)
    }

    /// Names of the bones whose tips should stay in place during a drag of the tips of `dragged`.
    pub fn holds(&self, dragged: Vec<String>) -> Result<Vec<String>, Exception> {
        let holds = self.inner.holds(&self.bones_named(&dragged)?);
        let ends = holds.ends.iter().map(|end| self.name(*end));
        Ok(ends.collect())
    }
}

impl Skeleton {
    pub(crate) fn bones_named(&self, names: &[String]) -> Result<Vec<BoneId>, Exception> {
        let bones = names.iter().map(|name| self.inner.bone(name));
        bones.collect::<Result<_, _>>().map_err(raise)
    }

    pub(crate) fn name(&self, bone: BoneId) -> String {
        self.inner.bones()[bone.index()].name.clone()
    }

    fn frame(
        &self,
        frame_of: impl Fn(BoneId) -> kinopt::model::FrameId,
        bone: &str,
    ) -> Result<String, Exception> {
        let frame = frame_of(self.inner.bone(bone).map_err(raise)?);
        Ok(self.inner.model().frames()[frame.index()].name.clone())
    }
}
