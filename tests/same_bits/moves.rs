//! Promise: so it is for searches that may go only so far from where they start, by number and by angle.
#![allow(clippy::unwrap_used)]

use kinopt::ik::{MoveLimits, Restarts, SolveError};
use kinopt::model::JointId;
use kinopt::problem::ProblemInstance;
use kinopt::solver::Stopping;
use kinopt::{Solver, Workspace};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::searches::problems;

/// Searches that may go only so far from where they start.
fn moves() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(153));
    for free in [false, true] {
        let (model, problems) = problems(&mut random, free);
        let balls: Vec<bool> = model
            .moving_joints()
            .iter()
            .map(|id: &JointId| model.joints()[id.index()].kind.is_ball())
            .collect();
        let solver = Solver::default().with_restarts(Restarts::default().with_attempts(2));
        let solver = solver.with_stopping(Stopping::default().with_max_iterations(12));
        let mut workspace = Workspace::new();
        for (number, (problem, start)) in problems.iter().enumerate() {
            let mut limits = match number % 3 {
                0 => MoveLimits::by_angle(problem, 0.3, start).unwrap(),
                1 => MoveLimits::by_angle(problem, 0.02, start).unwrap(),
                _ => {
                    let own = |k: usize| {
                        if balls[k] {
                            [0.2, 0.0][number / 3 % 2]
                        } else {
                            [0.1, 0.0, 0.4][k % 3]
                        }
                    };
                    let most: Vec<f64> = (0..start.len()).map(own).collect();
                    MoveLimits::new(problem, &most, start).unwrap()
                }
            };
            for step in 0..2 {
                let question = ProblemInstance::from(problem).with_moves(&limits).unwrap();
                digest.doubles(question.lower().iter().chain(question.upper()).copied());
                let solution = solver.solve(question, start, &mut workspace).unwrap();
                digest.told(solution);
                if step == 0 {
                    limits.start_at(problem, &solution.q).unwrap();
                }
            }
        }
        let (problem, start) = &problems[0];
        let n = start.len();
        let mut uneven = vec![0.1; n];
        uneven[model.coordinate(model.joint("waist").unwrap()).unwrap() + 1] = 0.2;
        let all: [Result<MoveLimits, SolveError>; 7] = [
            MoveLimits::new(problem, &[0.1], start),
            MoveLimits::new(problem, &vec![-0.1; n], start),
            MoveLimits::new(problem, &uneven, start),
            MoveLimits::new(problem, &vec![0.1; n], &start[1..]),
            MoveLimits::by_angle(problem, 0.0, start),
            MoveLimits::by_angle(problem, f64::NAN, start),
            MoveLimits::by_angle(problem, 0.1, &[]),
        ];
        all.into_iter().for_each(|own| digest.refusal(own));
        let limits = MoveLimits::by_angle(&problems[1].0, 0.1, start).unwrap();
        digest.refusal(ProblemInstance::from(problem).with_moves(&limits));
    }
    digest.value()
}

#[test]
fn of_moves() {
    check(&[("searches that may go only so far", moves())]);
}
