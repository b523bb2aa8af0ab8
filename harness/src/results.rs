//! Results of a bench, in the form of `results.json`.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::jacobian_cost::JacobianCost;
use crate::{HarnessError, TaskError};

/// Results of one bench.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// Origin of the numbers; set by the caller.
    pub provenance: Provenance,
    /// Model of the problem set.
    pub model: ModelSummary,
    /// Problem set and budget.
    pub setting: Setting,
    /// Number of problems that every solver has finished; lower than in the setting after an interruption.
    pub problems: usize,
    /// One for each solver and derivative mode.
    pub runs: Vec<Run>,
    /// Convergence history of each run on the chosen problem.
    pub courses: Vec<ConvergenceHistory>,
    /// Cost of one Jacobian by derivative mode on chains of increasing length.
    pub jacobian_cost: Vec<JacobianCost>,
}

/// Origin of a measurement.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Program with its version.
    pub tool: String,
    /// Date in RFC 3339.
    pub date: String,
    /// Machine of the measurement.
    pub machine: Machine,
    /// Command line, if any.
    pub command: String,
}

/// Hardware of a measurement.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Name of the processor.
    pub cpu: String,
    /// Number of hardware threads.
    pub cores: usize,
}

/// Summary of the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelSummary {
    /// Name of the model.
    pub name: String,
    /// Number of free variables.
    pub variables: usize,
    /// Size, in metres (for rigs, the rig's unit). Tolerances are relative to it.
    pub size: f64,
    /// Names of the frames with targets.
    pub frames: Vec<String>,
    /// True if orientations count.
    pub turns: bool,
}

/// Problem set and budget of a bench.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// Number of problems in the set.
    pub problems: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Tolerance: relative to the size, and in radians.
    pub tolerance: f64,
    /// Wall-clock limit of one problem, in seconds.
    pub time_limit: f64,
    /// Clock of the measurements.
    pub clock: String,
    /// Number of attempts of each solver without restarts of its own.
    pub attempts: usize,
    /// Accuracies, relative to the size and in radians. The records list their times in this order.
    pub accuracies: Vec<f64>,
    /// Index of the problem with recorded convergence history.
    pub chosen: usize,
}

/// One solver with one derivative mode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Name of the solver.
    pub solver: String,
    /// Family of the solver.
    pub family: String,
    /// Derivative mode, if any.
    pub route: Option<String>,
    /// Settings of the solver.
    pub about: String,
    /// Reason why the solver did not take part, if any.
    pub sat_out: Option<String>,
    /// True if the solver makes marks; otherwise every accuracy has its total time.
    pub traced: bool,
    /// One for each problem; empty if the solver did not take part.
    pub records: Vec<Record>,
}

impl Run {
    /// Name of the solver, with its derivative mode in parentheses.
    #[must_use]
    pub fn title(&self) -> String {
        match &self.route {
            Some(route) => format!("{} ({route})", self.solver),
            None => self.solver.clone(),
        }
    }

    /// Number of problems solved in time.
    #[must_use]
    pub fn solved(&self) -> usize {
        self.records.iter().filter(|record| record.counts()).count()
    }
}

/// Result for one problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Index of the problem in the set.
    pub problem: usize,
    /// True if solved, by forward kinematics and the limits at the returned configuration.
    pub solved: bool,
    /// True if the solver reported success.
    pub claimed: bool,
    /// True if exactly within the limits, and mimic joints satisfy their relations.
    pub within_limits: bool,
    /// Largest error of any target: relative to the size, or in radians. `None`: not finite.
    pub error: Option<f64>,
    /// ½ Σ‖W r‖². `None`: not finite.
    pub cost: Option<f64>,
    /// Errors, one for each frame.
    pub tasks: Vec<TaskError>,
    /// Names of the joints at a limit.
    pub active_limits: Vec<String>,
    /// Iterations of all attempts together.
    pub iterations: usize,
    /// Number of attempts.
    pub attempts: usize,
    /// Residual evaluations.
    pub residuals: usize,
    /// Jacobian evaluations.
    pub jacobians: usize,
    /// Gradient evaluations without a Jacobian.
    pub gradients: usize,
    /// Time of the untraced solve, in microseconds.
    pub micros: f64,
    /// True if the solve took too long to count.
    pub late: bool,
    /// Time to each accuracy of the setting, in microseconds; `None` if it was not reached.
    pub micros_to: Vec<Option<f64>>,
}

impl Record {
    /// True if solved in time.
    #[must_use]
    pub fn counts(&self) -> bool {
        self.solved && !self.late
    }

    /// Time of a solve that counts, in microseconds.
    #[must_use]
    pub fn solved_micros(&self) -> Option<f64> {
        self.counts().then_some(self.micros)
    }
}

/// Lowest cost so far by iterations, over all attempts in sequence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConvergenceHistory {
    /// Name of the solver.
    pub solver: String,
    /// Derivative mode, if any.
    pub route: Option<String>,
    /// Iterations and ½ Σ‖W r‖²: at the start, where it decreased, and at the end.
    pub points: Vec<(usize, f64)>,
}

impl Results {
    /// Writes all results as JSON.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
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
