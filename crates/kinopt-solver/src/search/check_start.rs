//! Checks of the start of a search.

use super::SolveError;
use crate::problem::{Problem, ProblemInstance};
use kinopt_kinematics::model::{BallVariables, quaternion_at};

/// Checks the length of a start, that its coordinates of variables are finite, and that its quaternions are not zero.
#[doc(hidden)]
pub fn check_start(problem: &Problem, start: &[f64]) -> Result<(), SolveError> {
    if start.len() != problem.configuration_len() {
        return Err(SolveError::StartLength {
            model: problem.names().model.clone(),
            given: start.len(),
            expected: problem.configuration_len(),
        });
    }
    let map = problem.parameters();
    let leaders = map.leaders();
    let bad = leaders.iter().position(|&c| !start[c].is_finite());
    if let Some(variable) = bad {
        return Err(SolveError::StartNotFinite {
            joint: problem.names().variables[variable].clone(),
            value: start[leaders[variable]],
        });
    }
    let no_rotation = |ball: &&BallVariables| quaternion_at(&start[ball.coordinate..]).is_none();
    match map.balls().iter().find(no_rotation) {
        None => Ok(()),
        Some(ball) => Err(SolveError::StartNoRotation {
            // The variables of a ball joint with limits are named as its swing and its twist.
            joint: problem.names().variables[ball.variable]
                .trim_end_matches(" swing")
                .to_owned(),
        }),
    }
}

/// The variables of a configuration, projected into the bounds.
#[doc(hidden)]
pub fn variables_at(instance: ProblemInstance<'_>, q: &[f64]) -> Result<Vec<f64>, SolveError> {
    let problem = instance.problem;
    check_start(problem, q)?;
    let mut x = vec![0.0; problem.variables()];
    problem.parameters().gather(q, &mut x);
    instance.space().project(&mut x);
    Ok(x)
}
