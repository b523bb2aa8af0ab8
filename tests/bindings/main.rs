//! Promises of kinopt-bindings: options, tasks and methods by name.

mod jobs;
mod methods;
mod options;
mod tasks;
