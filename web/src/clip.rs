//! Clips and poses of the bones of a file of animation.

use std::rc::Rc;

use kinopt::animation::{Armature as Bones, Cursor, Playback};
use kinopt::glam::{Affine3A, Mat4};
use kinopt::model::UnknownName;
use wasm_bindgen::prelude::*;

use crate::raise;

/// How a clip goes on beyond its ends.
pub(crate) fn playback(name: Option<&str>) -> Result<Playback, JsError> {
    match name {
        None | Some("hold") => Ok(Playback::Hold),
        Some("loop") => Ok(Playback::Loop),
        Some("ping-pong") => Ok(Playback::PingPong),
        Some(other) => {
            let names = ["hold", "loop", "ping-pong"];
            Err(raise(UnknownName::new("playback", other, names)))
        }
    }
}

/// The bones of a file of animation, at rest as the file has them.
#[wasm_bindgen]
#[derive(Clone)]
pub struct Armature {
    pub(crate) inner: Rc<Bones>,
}

#[wasm_bindgen]
impl Armature {
    /// The bones, parents before children.
    #[wasm_bindgen(getter)]
    pub fn names(&self) -> Vec<String> {
        self.inner.names().to_vec()
    }

    /// The number of each bone's parent; -1 for roots.
    #[wasm_bindgen(getter)]
    pub fn parents(&self) -> Vec<i32> {
        let bones = self.inner.bone_ids();
        bones
            .map(|bone| (self.inner.parent(bone)).map_or(-1, |parent| parent.index() as i32))
            .collect()
    }

    /// The pose at rest.
    #[wasm_bindgen(getter)]
    pub fn rest(&self) -> Pose {
        let inner = self.inner.rest().clone();
        Pose { inner }
    }

    /// Where the bones of a pose stand: sixteen numbers a bone, a matrix by columns.
    #[wasm_bindgen(js_name = localToModel)]
    pub fn local_to_model(&self, pose: &Pose) -> Result<Vec<f32>, JsError> {
        let mut placed = vec![Affine3A::IDENTITY; self.inner.bones()];
        self.inner
            .local_to_model(&pose.inner, &mut placed)
            .map_err(raise)?;
        let columns = placed.iter().map(|bone| Mat4::from(*bone).to_cols_array());
        Ok(columns.flatten().collect())
    }
}

/// Where each bone stands in its parent, and how strong each morph target is.
#[wasm_bindgen]
pub struct Pose {
    pub(crate) inner: kinopt::animation::Pose,
}

/// A motion of an armature's bones.
#[wasm_bindgen]
pub struct Clip {
    inner: kinopt::animation::Clip,
    armature: Rc<Bones>,
    cursor: Cursor,
}

impl Clip {
    pub(crate) fn new(inner: kinopt::animation::Clip, armature: &Rc<Bones>) -> Self {
        Self {
            inner,
            armature: Rc::clone(armature),
            cursor: Cursor::new(),
        }
    }

    #[cfg(feature = "retargeting")]
    pub(crate) fn inner(&self) -> &kinopt::animation::Clip {
        &self.inner
    }

    #[cfg(feature = "retargeting")]
    pub(crate) fn armature(&self) -> &Bones {
        &self.armature
    }
}

#[wasm_bindgen]
impl Clip {
    /// Its name.
    #[wasm_bindgen(getter)]
    pub fn name(&self) -> String {
        self.inner.name().to_owned()
    }

    /// How long it is, seconds.
    #[wasm_bindgen(getter)]
    pub fn duration(&self) -> f64 {
        self.inner.duration()
    }

    /// The pose so many seconds after its start; `playback` is "hold", "loop" or "ping-pong".
    pub fn sample(&mut self, seconds: f64, playback: Option<String>) -> Result<Pose, JsError> {
        let mut inner = self.armature.rest().clone();
        let playback = self::playback(playback.as_deref())?;
        let sampled = self
            .inner
            .sample(seconds, playback, &mut self.cursor, &mut inner);
        sampled.map_err(raise)?;
        Ok(Pose { inner })
    }
}
