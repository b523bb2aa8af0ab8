//! Compared solvers, behind a common interface.

mod helper;
mod k_jacobian;
mod kinopt_arm;
mod nlopt_local;
mod panoc;
mod slsqp_rust;

use std::time::{Duration, Instant};

use crate::{Failure, Query, Workload};

/// Result of a solver, with its time.
pub struct Answer {
    /// Time of the solver's call.
    pub took: Duration,
    /// Its solutions, empty after a failure; a closed form has several.
    pub solutions: Vec<Vec<f64>>,
}

/// A solver for one robot.
pub trait Rival {
    /// Name and settings of the solver.
    fn name(&self) -> String;

    /// Solves one query.
    ///
    /// # Errors
    /// Returns an error if the solver broke down, not if it found no solution.
    fn answer(&mut self, query: &Query) -> Result<Answer, Failure>;
}

/// Times a call in this process.
pub(crate) fn timed(call: impl FnOnce() -> Option<Vec<f64>>) -> Answer {
    let started = Instant::now();
    let solution = call();
    Answer {
        took: started.elapsed(),
        solutions: solution.into_iter().collect(),
    }
}

/// All solvers that support the robot, kinopt first; others are named on standard error.
///
/// # Errors
/// Returns an error if kinopt does not support the robot.
pub fn all<'a>(
    workload: &'a Workload,
    limit: Duration,
    python: Option<&str>,
) -> Result<Vec<Box<dyn Rival + 'a>>, Failure> {
    let mut rivals: Vec<Box<dyn Rival + 'a>> = kinopt_arm::searches(workload)?;
    let mut add = |name: &str, rival: Result<Box<dyn Rival + 'a>, Failure>| match rival {
        Ok(rival) => rivals.push(rival),
        Err(failure) => eprintln!("without {name}: {failure}"),
    };
    if let Some(python) = python {
        add("OptIK", helper::optik(workload, limit, python));
    }
    for setting in nlopt_local::SETTINGS {
        add("NLopt", Ok(nlopt_local::new(workload, limit, setting)));
    }
    add("slsqp", Ok(slsqp_rust::new(workload, limit)));
    add("PANOC", Ok(panoc::new(workload, limit)));
    for setting in k_jacobian::SETTINGS {
        add("k", k_jacobian::new(workload, limit, setting));
    }
    add("ik-geo", helper::ik_geo(workload));
    Ok(rivals)
}
