//! What stands still over some frames.

use std::ops::Range;

use crate::model::FrameId;
use crate::spatial::Vector3;

/// Points of a frame that stand still over a span of a motion, wherever they stand: a place is found with the motion.
/// Where they should stand, a task says.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    pub(super) frame: FrameId,
    pub(super) points: Vec<Vector3<f64>>,
    pub(super) span: Range<usize>,
}

impl Contact {
    /// The frame's origin stands still over the frames of `span`.
    #[must_use]
    pub fn new(frame: FrameId, span: Range<usize>) -> Self {
        Self {
            frame,
            points: vec![Vector3::zero()],
            span,
        }
    }

    setters! {
        /// These points instead, in the frame's coordinates, metres: three that are on no line hold its pose.
        pub fn at(mut self, points: impl IntoIterator<Item = impl Into<Vector3<f64>>>) {
            self.points = points.into_iter().map(Into::into).collect();
        }
    }

    getters! {
        /// What stands still.
        pub fn frame(&self) -> FrameId = self.frame;
        /// Over which frames.
        pub fn span(&self) -> Range<usize> = self.span.clone();
        /// The points of it, in its own coordinates, metres.
        pub fn points(&self) -> &[Vector3<f64>] = &self.points;
    }

    /// Whether it stands still from a frame of the motion to the next.
    pub(super) fn holds_from(&self, frame: usize) -> bool {
        self.span.contains(&frame) && self.span.contains(&(frame + 1))
    }
}
