//! Skeletons of animation files, for dragging.

use std::collections::BTreeSet;
use std::rc::Rc;

use kinopt::animation::{Armature as Bones, EulerPoseMap};
use kinopt::skeleton::BoneId;
use wasm_bindgen::prelude::*;

use crate::armature::Pose;
use crate::error::{Exception, raise};
use crate::skeleton::Skeleton;

/// A skeleton without limits whose angles are 0 in a given pose.
#[wasm_bindgen]
pub struct Figure {
    skeleton: Skeleton,
    angles: EulerPoseMap,
    rest_pose: kinopt::animation::Pose,
}

impl Figure {
    /// Creates a figure from an armature and its pose. The bones `turning` rotate.
    pub(crate) fn standing(
        armature: &Rc<Bones>,
        turning: &BTreeSet<BoneId>,
        pose: &Pose,
    ) -> Result<Self, Exception> {
        let armature = Bones::clone(armature);
        let armature = armature.at_rest_in(&pose.inner).map_err(raise)?;
        let skeleton = armature
            .turning_skeleton("figure", turning)
            .map_err(raise)?;
        Ok(Self {
            angles: EulerPoseMap::new(&skeleton),
            rest_pose: armature.rest().clone(),
            skeleton: skeleton.into(),
        })
    }
}

#[wasm_bindgen]
impl Figure {
    /// Skeleton, with the given pose as its rest pose.
    #[wasm_bindgen(getter)]
    pub fn skeleton(&self) -> Skeleton {
        self.skeleton.clone()
    }

    /// Pose of the armature for the angles `q`, radians.
    #[wasm_bindgen(js_name = toPose)]
    pub fn to_pose(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] q: &[f64],
    ) -> Result<Pose, Exception> {
        let expected = self.skeleton.inner.angles();
        if q.len() != expected {
            let count = q.len();
            return Err(Exception::new(&format!(
                "q has {count} numbers, expected {expected}"
            )));
        }
        let mut inner = self.rest_pose.clone();
        self.angles.pose_of(q, &mut inner).map_err(raise)?;
        Ok(Pose { inner })
    }
}
