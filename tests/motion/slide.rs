//! A tool on a slide, for motions whose answer is read from their question.

use kinopt::model::{FrameId, Limits, Model};
use kinopt::spatial::{Placement, Vector3};

/// A slide along x, a metre either way, and the frame of its tool.
pub(crate) fn slide() -> (Model, FrameId) {
    let mut builder = Model::builder("slide");
    let (at, room) = (Placement::identity(), Limits::new(-1.0, 1.0));
    let slide = builder.prismatic("slide", None, at, Vector3::UNITS[0], room);
    let tool = builder.frame("tool", Some(slide), at);
    (builder.build().unwrap(), tool)
}
