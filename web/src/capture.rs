//! Motion capture from BVH.

use std::collections::BTreeSet;
use std::rc::Rc;

use kinopt::skeleton::BoneId;
use wasm_bindgen::prelude::*;

use crate::armature::{Armature, Pose};
use crate::clip::Clip;
use crate::figure::Figure;
use crate::raise;

/// Content of a BVH file.
#[wasm_bindgen]
pub struct MotionCapture {
    armature: Armature,
    clip: kinopt::animation::Clip,
    turning: BTreeSet<BoneId>,
    frames: usize,
    frame_time: f64,
    notes: Vec<String>,
}

#[wasm_bindgen]
impl MotionCapture {
    /// Reads the bytes of a BVH file; `name` is used in messages and names the clip.
    #[wasm_bindgen(js_name = fromBytes)]
    pub fn from_bytes(data: &[u8], name: Option<String>) -> Result<Self, JsError> {
        let name = name.as_deref().unwrap_or("capture.bvh");
        let read = kinopt::io::bvh::from_bytes(data, name).map_err(raise)?;
        let turning = read.turning_bones();
        Ok(Self {
            turning,
            armature: Armature {
                inner: Rc::new(read.armature),
            },
            clip: read.clip,
            frames: read.frames,
            frame_time: read.frame_time,
            notes: read.notes.iter().map(ToString::to_string).collect(),
        })
    }

    /// Armature with a bone for each joint and End Site.
    #[wasm_bindgen(getter)]
    pub fn armature(&self) -> Armature {
        self.armature.clone()
    }

    /// Motion as a clip.
    #[wasm_bindgen(getter)]
    pub fn clip(&self) -> Clip {
        Clip::new(self.clip.clone(), &self.armature.inner)
    }

    /// Number of capture frames.
    #[wasm_bindgen(getter)]
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Time from one capture frame to the next, seconds.
    #[wasm_bindgen(getter, js_name = frameTime)]
    pub fn frame_time(&self) -> f64 {
        self.frame_time
    }

    /// Parts of the file that the reader ignored.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// A skeleton to drag, with the given pose as its rest pose.
    pub fn figure(&self, pose: &Pose) -> Result<Figure, JsError> {
        Figure::standing(&self.armature.inner, &self.turning, pose)
    }
}
