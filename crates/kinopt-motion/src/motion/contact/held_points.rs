//! Contacts of a trajectory.

use std::ops::Range;

use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::spatial::Vector3;

/// Points of a coordinate frame that stay fixed in the world over a span of samples.
///
/// The solver finds their position. Use a task to prescribe it.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    pub(in crate::motion) frame: FrameId,
    pub(in crate::motion) points: Vec<Vector3<f64>>,
    pub(in crate::motion) span: Range<usize>,
}

impl Contact {
    /// Creates a contact of the frame's origin over the samples of `span`.
    #[must_use]
    pub fn new(frame: FrameId, span: Range<usize>) -> Self {
        Self {
            frame,
            points: vec![Vector3::zero()],
            span,
        }
    }

    /// Sets the points in the frame's coordinates, metres. Three points that are not collinear fix the frame's
    /// pose.
    #[must_use]
    pub fn at(mut self, points: impl IntoIterator<Item = impl Into<Vector3<f64>>>) -> Self {
        self.points = points.into_iter().map(Into::into).collect();
        self
    }

    /// Coordinate frame of the contact.
    #[must_use]
    pub fn frame(&self) -> FrameId {
        self.frame
    }

    /// Range of samples of the contact.
    #[must_use]
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Points in the frame's coordinates, metres.
    #[must_use]
    pub fn points(&self) -> &[Vector3<f64>] {
        &self.points
    }

    /// Returns whether the contact is active at a sample and the next.
    pub(in crate::motion) fn is_active_over_step(&self, frame: usize) -> bool {
        self.span.contains(&frame) && self.span.contains(&(frame + 1))
    }
}
