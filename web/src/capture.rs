//! Motion capture from BVH.

use std::collections::BTreeSet;
use std::rc::Rc;

use kinopt::io::bvh::{self, BvhChannel, BvhFormat};
use kinopt::skeleton::BoneId;
use wasm_bindgen::prelude::*;

use crate::armature::{Armature, Pose};
use crate::clip::Clip;
use crate::error::{Exception, raise};
use crate::figure::Figure;

/// Content of a BVH file.
#[wasm_bindgen]
pub struct MotionCapture {
    armature: Armature,
    clip: kinopt::animation::Clip,
    turning: BTreeSet<BoneId>,
    frames: usize,
    frame_time: f64,
    channels: Vec<Vec<BvhChannel>>,
    notes: Vec<String>,
}

#[wasm_bindgen]
impl MotionCapture {
    /// Reads the bytes of a BVH file; `name` is used in messages and names the clip.
    #[wasm_bindgen(js_name = fromBytes)]
    pub fn from_bytes(data: &[u8], name: Option<String>) -> Result<Self, Exception> {
        let name = name.as_deref().unwrap_or("capture.bvh");
        let read = bvh::from_bytes(data, name).map_err(raise)?;
        let turning = read.turning_bones();
        Ok(Self {
            turning,
            armature: Armature {
                inner: Rc::new(read.armature),
            },
            clip: read.clip,
            frames: read.frames,
            frame_time: read.frame_time,
            channels: read.channels,
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

    /// Repairs made by the reader: truncated or surplus frames, renamed joints, bytes that are not UTF-8.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// The text of a BVH file of the capture, with its own channels, frames and frame time.
    #[wasm_bindgen(js_name = toBvh)]
    pub fn to_bvh(&self) -> Result<String, Exception> {
        let format = BvhFormat::of_frame_time(self.frame_time).with_channels(&self.channels);
        bvh::to_text(&self.armature.inner, &self.clip, format).map_err(raise)
    }

    /// A figure to drag, with the given pose as its rest pose.
    pub fn figure(&self, pose: &Pose) -> Result<Figure, Exception> {
        Figure::standing(&self.armature.inner, &self.turning, pose)
    }
}
