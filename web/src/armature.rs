//! Armatures of animation files, and their poses.

use std::rc::Rc;

use kinopt::animation::Armature as Bones;
use kinopt::glam::{Affine3A, Mat4};
use wasm_bindgen::prelude::*;

use crate::error::{Exception, raise};

/// Bones of an animation file, with their rest pose.
#[wasm_bindgen]
#[derive(Clone)]
pub struct Armature {
    pub(crate) inner: Rc<Bones>,
}

#[wasm_bindgen]
impl Armature {
    /// Names of the bones, parents before children.
    #[wasm_bindgen(getter)]
    pub fn names(&self) -> Vec<String> {
        self.inner.names().to_vec()
    }

    /// Index of each bone's parent; -1 for roots.
    #[wasm_bindgen(getter)]
    pub fn parents(&self) -> Vec<i32> {
        let bones = self.inner.bone_ids();
        bones
            .map(|bone| (self.inner.parent(bone)).map_or(-1, |parent| parent.index() as i32))
            .collect()
    }

    /// Rest pose.
    #[wasm_bindgen(getter)]
    pub fn rest(&self) -> Pose {
        let inner = self.inner.rest().clone();
        Pose { inner }
    }

    /// A line for each bone with children whose rest scale a skeleton cannot have. An uneven scale shears the bones
    /// that rotate below it, a negative one mirrors them.
    #[wasm_bindgen(getter, js_name = scaleNotes)]
    pub fn scale_notes(&self) -> Vec<String> {
        let notes = self.inner.scale_notes();
        notes.iter().map(ToString::to_string).collect()
    }

    /// The same bones with scales of 1 at rest. Translations and rotations in the parents stay, so joints below a
    /// scaled bone move in the model.
    #[wasm_bindgen(js_name = withoutScale)]
    pub fn without_scale(&self) -> Self {
        let inner = Rc::new(Bones::clone(&self.inner).without_scale());
        Self { inner }
    }

    /// Bone transforms of a pose in the model: sixteen numbers for each bone, a matrix by columns.
    #[wasm_bindgen(js_name = localToModel)]
    pub fn local_to_model(&self, pose: &Pose) -> Result<Vec<f32>, Exception> {
        let placed = self.placed(pose)?;
        let columns = placed.iter().map(|bone| Mat4::from(*bone).to_cols_array());
        Ok(columns.flatten().collect())
    }
}

#[cfg(feature = "retargeting")]
#[wasm_bindgen]
impl Armature {
    /// Origins of the bones of a pose, three numbers each, as input of a `RetargetFollower`.
    pub fn places(&self, pose: &Pose) -> Result<Vec<f64>, Exception> {
        let placed = self.placed(pose)?;
        let places = placed.iter().map(|bone| bone.translation.as_dvec3());
        Ok(places.flat_map(|at| at.to_array()).collect())
    }
}

impl Armature {
    fn placed(&self, pose: &Pose) -> Result<Vec<Affine3A>, Exception> {
        let mut placed = vec![Affine3A::IDENTITY; self.inner.bones()];
        let located = self.inner.local_to_model(&pose.inner, &mut placed);
        located.map_err(raise)?;
        Ok(placed)
    }
}

/// Local transform of each bone, and weight of each morph target.
#[wasm_bindgen]
pub struct Pose {
    pub(crate) inner: kinopt::animation::Pose,
}
