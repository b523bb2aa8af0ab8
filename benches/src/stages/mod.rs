//! Stages of the library, each with its own input, built in code or from the shipped models. The criterion bench times
//! them and the instruction counter counts them.

mod arms;
mod derivatives;
mod geometric;
mod kinematics;
mod lanes;
mod levels;
mod obstacles;
mod posing;
mod solvers;

use std::error::Error;

pub use obstacles::{cloud_of_points, panda_among, shell_of_primitives};

/// One run of a stage.
pub type Run = Box<dyn FnMut()>;

/// A stage: a function for repeated runs.
pub struct Stage {
    /// Name in tables and on the command line.
    pub name: &'static str,
    /// Number of `unit`s in one run.
    pub elements: u64,
    /// Name of the counted unit.
    pub unit: &'static str,
    build: fn() -> Result<Run, Box<dyn Error>>,
}

impl Stage {
    /// Creates the input, which can take long.
    ///
    /// # Errors
    /// Returns an error for a model that cannot be read or a problem that cannot be built.
    pub fn build(&self) -> Result<Run, Box<dyn Error>> {
        (self.build)()
    }
}

/// All stages, from low to high level.
#[must_use]
pub fn stages() -> Vec<Stage> {
    [
        kinematics::stages(),
        solvers::stages(),
        levels::stages(),
        lanes::stages(),
        arms::stages(),
        obstacles::stages(),
        derivatives::stages(),
        geometric::stages(),
        posing::stages(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// A stage with one element for each run.
fn single(name: &'static str, build: fn() -> Result<Run, Box<dyn Error>>) -> Stage {
    Stage {
        name,
        elements: 1,
        unit: "run",
        build,
    }
}
