//! Animation clips of armatures.

use std::rc::Rc;

use kinopt::animation::{Armature as Bones, Cursor};
use wasm_bindgen::prelude::*;

use crate::armature::Pose;
use crate::error::{Exception, raise};

/// Animation clip of an armature.
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

    #[cfg(any(feature = "clip-ik", feature = "gltf", feature = "retargeting"))]
    pub(crate) fn inner(&self) -> &kinopt::animation::Clip {
        &self.inner
    }

    #[cfg(any(feature = "clip-ik", feature = "retargeting"))]
    pub(crate) fn armature(&self) -> &Rc<Bones> {
        &self.armature
    }
}

#[wasm_bindgen]
impl Clip {
    /// Name of the clip.
    #[wasm_bindgen(getter)]
    pub fn name(&self) -> String {
        self.inner.name().to_owned()
    }

    /// Duration, seconds.
    #[wasm_bindgen(getter)]
    pub fn duration(&self) -> f64 {
        self.inner.duration()
    }

    /// Start time, seconds of the file.
    #[wasm_bindgen(getter)]
    pub fn start(&self) -> f64 {
        self.inner.start()
    }

    /// Pose at a time in seconds of the file; `playback` is "hold", "loop" or "ping-pong".
    pub fn sample(&mut self, seconds: f64, playback: Option<String>) -> Result<Pose, Exception> {
        let mut inner = self.armature.rest().clone();
        let playback = crate::playback::playback(playback.as_deref())?;
        let sampled = self
            .inner
            .sample(seconds, playback, &mut self.cursor, &mut inner);
        sampled.map_err(raise)?;
        Ok(Pose { inner })
    }
}
