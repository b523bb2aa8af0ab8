//! The stages of the library one by one, each with its own input, made in code or from the shipped
//! models. The criterion bench times them and the instruction counter counts them: both see the
//! same work.

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

/// A stage: something to be run again and again.
pub struct Stage {
    /// Its name in tables and on the command line.
    pub name: &'static str,
    /// How many of `unit` one run is.
    pub elements: u64,
    /// What is counted.
    pub unit: &'static str,
    build: fn() -> Result<Run, Box<dyn Error>>,
}

impl Stage {
    /// Makes the input, which may take long.
    ///
    /// # Errors
    /// A model that cannot be read or a problem that cannot be built.
    pub fn build(&self) -> Result<Run, Box<dyn Error>> {
        (self.build)()
    }
}

/// All stages, from the bottom up.
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

/// A stage of which one run is one.
fn single(name: &'static str, build: fn() -> Result<Run, Box<dyn Error>>) -> Stage {
    Stage {
        name,
        elements: 1,
        unit: "run",
        build,
    }
}
