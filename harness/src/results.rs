//! Everything that a bench found, as it goes into `results.json`.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::jacobian_cost::JacobianCost;
use crate::{HarnessError, TaskError};

/// One bench.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// Where the numbers come from; filled in by whoever runs the bench.
    pub provenance: Provenance,
    /// What was solved on.
    pub model: ModelSummary,
    /// What was asked.
    pub setting: Setting,
    /// How many problems every solver was asked; fewer than in the setting after an interruption.
    pub problems: usize,
    /// One for each solver and derivative route.
    pub runs: Vec<Run>,
    /// The way of each run through the chosen problem.
    pub courses: Vec<ConvergenceHistory>,
    /// What one Jacobian costs by each route on chains of more and more bones.
    pub jacobian_cost: Vec<JacobianCost>,
}

/// Who measured, when and where.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The program and its version.
    pub tool: String,
    /// RFC 3339.
    pub date: String,
    /// The machine.
    pub machine: Machine,
    /// What was typed, if anything.
    pub command: String,
}

/// A machine.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor's name for itself.
    pub cpu: String,
    /// How many threads it runs at once.
    pub cores: usize,
}

/// The model in figures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelSummary {
    /// Its name.
    pub name: String,
    /// Free variables.
    pub variables: usize,
    /// What tolerances are shares of, in metres (rigs: their own unit).
    pub size: f64,
    /// The frames that have targets.
    pub frames: Vec<String>,
    /// Whether orientations count.
    pub turns: bool,
}

/// What was asked, and what was allowed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// Problems in the set.
    pub problems: usize,
    /// What everything random comes from.
    pub seed: u64,
    /// Solved within so much of the size, and so many radians.
    pub tolerance: f64,
    /// The wall-clock limit of one problem, in seconds.
    pub time_limit: f64,
    /// What times are measured by.
    pub clock: String,
    /// Attempts of each solver without restarts of its own.
    pub attempts: usize,
    /// Shares of the size, and radians: when each was reached is in the records, in this order.
    pub accuracies: Vec<f64>,
    /// The problem whose course is kept.
    pub chosen: usize,
}

/// One solver by one derivative route.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The solver's name.
    pub solver: String,
    /// Where it comes from.
    pub family: String,
    /// The derivative route, if it takes any.
    pub route: Option<String>,
    /// How the solver was set up.
    pub about: String,
    /// Why it sat out.
    pub sat_out: Option<String>,
    /// Whether it marks its way; otherwise every accuracy has the time of the end.
    pub traced: bool,
    /// One a problem; empty where it sat out.
    pub records: Vec<Record>,
}

impl Run {
    /// The solver, and its route in brackets.
    #[must_use]
    pub fn title(&self) -> String {
        match &self.route {
            Some(route) => format!("{} ({route})", self.solver),
            None => self.solver.clone(),
        }
    }

    /// How many problems were solved in time.
    #[must_use]
    pub fn solved(&self) -> usize {
        self.records.iter().filter(|record| record.counts()).count()
    }
}

/// One answer to one problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The problem's position in the set.
    pub problem: usize,
    /// By forward kinematics and the limits at the configuration that came back.
    pub solved: bool,
    /// Whether the solver said so.
    pub claimed: bool,
    /// Within the limits to the bit, followers following.
    pub within_limits: bool,
    /// The largest error of any target: a share of the size, or radians. `None`: not finite.
    pub error: Option<f64>,
    /// ½ Σ‖W r‖². `None`: not finite.
    pub cost: Option<f64>,
    /// One a frame.
    pub tasks: Vec<TaskError>,
    /// Joints that stand on a limit.
    pub active_limits: Vec<String>,
    /// Steps of all attempts together.
    pub iterations: usize,
    /// Attempts made.
    pub attempts: usize,
    /// Residual evaluations.
    pub residuals: usize,
    /// Jacobian evaluations.
    pub jacobians: usize,
    /// Gradient evaluations without a Jacobian.
    pub gradients: usize,
    /// Time of the plain ask, in microseconds.
    pub micros: f64,
    /// Whether it took too long to count.
    pub late: bool,
    /// When each accuracy of the setting was first reached, in microseconds; `None` where never.
    pub micros_to: Vec<Option<f64>>,
}

impl Record {
    /// Solved, and in time.
    #[must_use]
    pub fn counts(&self) -> bool {
        self.solved && !self.late
    }

    /// The time of an answer that counts, in microseconds.
    #[must_use]
    pub fn solved_micros(&self) -> Option<f64> {
        self.counts().then_some(self.micros)
    }
}

/// The lowest cost so far by steps, all attempts one after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConvergenceHistory {
    /// The solver's name.
    pub solver: String,
    /// The derivative route, if it takes any.
    pub route: Option<String>,
    /// Steps and ½ Σ‖W r‖²: at the start, where it fell, and at the end.
    pub points: Vec<(usize, f64)>,
}

impl Results {
    /// Writes everything as JSON.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_json(&self, path: impl AsRef<Path>) -> Result<(), HarnessError> {
        let mut text = serde_json::to_string(self)?;
        text.push('\n');
        let path = path.as_ref();
        std::fs::write(path, text).map_err(|source| HarnessError::Write {
            path: path.to_owned(),
            source,
        })
    }
}
