//! Promises of kinopt-bindings: options, tasks and methods by name.

mod methods;
mod options;
mod tasks;
