//! From targets to configurations: `kinopt solve`, `body`, `batch`, `track`, `servo` and `reach`.

pub(crate) mod arguments;
mod arm_backend;
pub(crate) mod axis_intervals;
mod backend;
mod balance;
pub(crate) mod base;
pub(crate) mod body;
mod derivative;
mod general_backend;
mod goals;
mod held_frames;
mod job;
mod levels;
pub(crate) mod locked_joints;
pub(crate) mod many;
mod max_move;
pub(crate) mod obstacles;
pub(crate) mod one;
mod out_file;
mod pose_finder;
mod query;
pub(crate) mod reach;
mod report;
mod self_motion;
mod settings;
mod task_builder;
mod task_name;
mod weights;

pub(crate) use arm_backend::held;
