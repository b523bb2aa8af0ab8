//! The solvers under comparison, each behind the same question.

mod helper;
mod k_jacobian;
mod kinopt_arm;
mod nlopt_local;
mod panoc;
mod slsqp_rust;

use std::time::{Duration, Instant};

use crate::{Failure, Query, Workload};

/// What a solver gave, and how long it took.
pub struct Answer {
    /// The time of the solver's own call.
    pub took: Duration,
    /// What it holds to be solutions, none where it gave up; a closed form has several.
    pub solutions: Vec<Vec<f64>>,
}

/// A solver that is set up for one robot.
pub trait Rival {
    /// The solver and its settings in a few words.
    fn name(&self) -> String;

    /// Answers one question.
    ///
    /// # Errors
    /// A solver that broke down, not one that found nothing.
    fn answer(&mut self, query: &Query) -> Result<Answer, Failure>;
}

/// Times a call in this process.
pub(crate) fn timed(call: impl FnOnce() -> Option<Vec<f64>>) -> Answer {
    let begun = Instant::now();
    let solution = call();
    Answer {
        took: begun.elapsed(),
        solutions: solution.into_iter().collect(),
    }
}

/// Every solver that can take the robot, kinopt first; what cannot is named on standard error.
///
/// # Errors
/// kinopt itself refusing the robot.
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
