//! Recorded poses, for a clip.

use std::rc::Rc;

use kinopt::animation::Armature as Bones;
use wasm_bindgen::prelude::*;

use crate::armature::{Armature, Pose};
use crate::clip::Clip;
use crate::error::{Exception, raise};

/// Poses of an armature, recorded one after another at a fixed rate. Dragged or solved poses become a clip.
#[wasm_bindgen]
pub struct Recording {
    armature: Rc<Bones>,
    fps: f64,
    poses: Vec<kinopt::animation::Pose>,
}

#[wasm_bindgen]
impl Recording {
    /// Starts a recording of an armature's poses, at `fps` a second.
    #[wasm_bindgen(constructor)]
    pub fn new(armature: &Armature, fps: f64) -> Result<Self, Exception> {
        if !(fps > 0.0 && fps.is_finite()) {
            return Err(Exception::new(&format!("fps must be above 0, not {fps}")));
        }
        Ok(Self {
            armature: Rc::clone(&armature.inner),
            fps,
            poses: Vec::new(),
        })
    }

    /// Appends the next pose.
    pub fn add(&mut self, pose: &Pose) -> Result<(), Exception> {
        let (count, expected) = (pose.inner.bones(), self.armature.bones());
        if count != expected {
            let message = format!("the pose has {count} bones, expected {expected}");
            return Err(Exception::new(&message));
        }
        self.poses.push(pose.inner.clone());
        Ok(())
    }

    /// Number of poses.
    #[wasm_bindgen(getter)]
    pub fn frames(&self) -> usize {
        self.poses.len()
    }

    /// Clip through the poses, with linear interpolation.
    pub fn clip(&self, name: &str) -> Result<Clip, Exception> {
        let frames = 0..self.poses.len();
        let times: Vec<f32> = frames.map(|k| (k as f64 / self.fps) as f32).collect();
        let clip =
            kinopt::animation::Clip::through_poses(name, &self.armature, &times, &self.poses);
        Ok(Clip::new(clip.map_err(raise)?, &self.armature))
    }

    /// BVH text of the poses.
    #[wasm_bindgen(js_name = toBvh)]
    pub fn to_bvh(&self) -> Result<String, Exception> {
        kinopt::io::bvh::poses_to_text(&self.armature, &self.poses, self.fps).map_err(raise)
    }
}
