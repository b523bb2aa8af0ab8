//! A tool on a prismatic joint, for motions whose solution follows directly from the problem.

use kinopt::model::{FrameId, Limits, Model};
use kinopt::spatial::{Placement, Vector3};

/// A prismatic joint along x, with a range of a metre in both directions, and the frame of its tool.
pub(crate) fn slide() -> (Model, FrameId) {
    rail(1.0)
}

/// The same with a range of `half` metres in both directions.
pub(crate) fn rail(half: f64) -> (Model, FrameId) {
    let mut builder = Model::builder("slide");
    let (at, limits) = (Placement::identity(), Limits::new(-half, half));
    let slide = builder.prismatic("slide", None, at, Vector3::UNITS[0], limits);
    let tool = builder.frame("tool", Some(slide), at);
    (builder.build().unwrap(), tool)
}
