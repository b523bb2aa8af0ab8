//! Promises of kinopt-bindings: options, tasks and methods by name.
#![allow(clippy::unwrap_used, clippy::panic)]

mod clip_ik;
mod jobs;
mod methods;
mod options;
mod problem_texts;
mod retarget_folders;
mod tasks;
