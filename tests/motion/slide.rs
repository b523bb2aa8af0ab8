//! A tool on a slide, for motions whose answer is read from their question.

use kinopt::model::{FrameId, Limits, Model};
use kinopt::spatial::{Placement, Vector3};

/// A slide along x, a metre either way, and the frame of its tool.
pub(crate) fn slide() -> (Model, FrameId) {
    rail(1.0)
}

/// The same so many metres either way.
pub(crate) fn rail(half: f64) -> (Model, FrameId) {
    let mut builder = Model::builder("slide");
    let (at, room) = (Placement::identity(), Limits::new(-half, half));
    let slide = builder.prismatic("slide", None, at, Vector3::UNITS[0], room);
    let tool = builder.frame("tool", Some(slide), at);
    (builder.build().unwrap(), tool)
}
