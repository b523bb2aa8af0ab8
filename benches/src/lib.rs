//! Common code of the benches: models built in code, and deterministic numbers.
#![allow(clippy::expect_used)]

mod animated;
mod arm_poses;
mod baseline;
mod body_case;
mod body_miss;
mod drag;
mod figure;
mod sequence;
mod stages;
mod thread_time;

pub use animated::{Keying, armature, clip};
pub use arm_poses::{ArmPoses, chain, random_configuration, random_poses, smooth_path};
pub use baseline::Baseline;
pub use body_case::{BodyCase, BodyProblem};
pub use body_miss::BodyMiss;
pub use drag::{DragScene, at_ease, drag_targets};
pub use figure::{every_angle_free, figure, random_targets};
pub use sequence::Sequence;
pub use stages::{Run, Stage, cloud_of_points, panda_among, shell_of_primitives, stages};
pub use thread_time::ThreadTime;
