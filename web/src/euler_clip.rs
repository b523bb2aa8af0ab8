//! Keyframes of a rig: angles by time.

use std::rc::Rc;

use wasm_bindgen::prelude::*;

use crate::error::{Exception, raise};

/// Keyframes of the angles of a rig's bones.
#[wasm_bindgen]
pub struct EulerClip {
    rig: Rc<kinopt::io::rig::Rig>,
}

impl EulerClip {
    pub(crate) fn of(rig: &Rc<kinopt::io::rig::Rig>) -> Self {
        let rig = Rc::clone(rig);
        Self { rig }
    }
}

#[wasm_bindgen]
impl EulerClip {
    /// True without keys.
    #[wasm_bindgen(getter, js_name = isEmpty)]
    pub fn is_empty(&self) -> bool {
        self.rig.clip.is_empty()
    }

    /// First and last key time, seconds; empty without keys.
    #[wasm_bindgen(getter, js_name = timeSpan)]
    pub fn time_span(&self) -> Vec<f64> {
        self.rig.clip.time_span().map_or_else(Vec::new, Vec::from)
    }

    /// Stacked angles at a time, radians; `playback` is "hold", "loop" or "ping-pong".
    pub fn sample(&self, seconds: f64, playback: Option<String>) -> Result<Vec<f64>, Exception> {
        let mut q = vec![0.0; self.rig.skeleton.angles()];
        let playback = crate::playback::playback(playback.as_deref())?;
        self.rig
            .clip
            .sample(seconds, playback, &mut q)
            .map_err(raise)?;
        Ok(q)
    }
}
