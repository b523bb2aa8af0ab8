//! A model in another unit of length.

use super::Model;
use crate::spatial::Placement;

impl Model {
    /// The same model with all lengths times a factor: positions of joints, frames and loops, and limits of prismatic
    /// joints.
    #[doc(hidden)]
    pub fn scaled(&self, factor: f64) -> Self {
        let scale = |placement: &mut Placement<f64>| {
            placement.translation = placement.translation * factor;
        };
        let mut model = self.clone();
        for joint in &mut model.joints {
            scale(&mut joint.parent_from_joint);
            if joint.kind.slides() {
                joint.limits.lower *= factor;
                joint.limits.upper *= factor;
            }
        }
        for frame in &mut model.frames {
            scale(&mut frame.joint_from_frame);
        }
        for closed in &mut model.loops {
            closed.frame_from_place.iter_mut().for_each(scale);
        }
        model
    }

    /// Multiplies the values of prismatic joints in consecutive configurations.
    #[doc(hidden)]
    pub fn scale_slides(&self, factor: f64, q: &mut [f64]) {
        let slides: Vec<usize> = self.slides().collect();
        for q in q.chunks_exact_mut(self.moving.len().max(1)) {
            for &slide in &slides {
                q[slide] *= factor;
            }
        }
    }

    /// Indices of the coordinates of a configuration that are lengths.
    #[doc(hidden)]
    pub fn slides(&self) -> impl Iterator<Item = usize> + '_ {
        let moving = self.moving.iter().enumerate();
        let slides = moving.filter(|(_, id)| self.joints[id.index()].kind.slides());
        slides.map(|(coordinate, _)| coordinate)
    }
}
