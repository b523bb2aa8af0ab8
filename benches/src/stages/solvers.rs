//! Iterations of each method on a skeleton of 22 bones with five tips. One run is a search of a few iterations towards
//! tips of a random pose, from rest; the element is an iteration with its evaluations.

use std::error::Error;
use std::hint::black_box;

use kinopt::problem::Evaluation;
use kinopt::solver::{
    Damping, FirstStep, GaussNewton, LevenbergMarquardt, Method, ProjectedGradient, Silent,
    SolverState, Stopping, minimise,
};

use super::{Run, Stage};
use crate::figure::five_tips;

const ITERATIONS: usize = 5;

pub(super) fn stages() -> Vec<Stage> {
    let stage = |name, build| Stage {
        name,
        elements: ITERATIONS as u64,
        unit: "iteration",
        build,
    };
    vec![
        stage("iteration, Levenberg-Marquardt", || {
            search(LevenbergMarquardt::new(Damping::GainRatio))
        }),
        stage("iteration, Levenberg-Marquardt by error", || {
            search(LevenbergMarquardt::new(Damping::ErrorProportional))
        }),
        stage("iteration, Gauss-Newton", || search(GaussNewton::default())),
        stage("iteration, projected gradient", || {
            search(ProjectedGradient::new(FirstStep::BarzilaiBorwein))
        }),
    ]
}

fn search(method: impl Method + 'static) -> Result<Run, Box<dyn Error>> {
    let (problem, start) = five_tips()?;
    let mut x = vec![0.0; problem.variables()];
    problem.parameters().reduce(&start, &mut x)?;
    let stopping = Stopping::default().with_max_iterations(ITERATIONS);
    let mut scratch = problem.scratch();
    let mut memory = SolverState::default();
    let mut run = move || {
        let mut evaluation = Evaluation::new(&problem, &mut scratch);
        let outcome = minimise(
            &mut evaluation,
            &method,
            &x,
            &stopping,
            &mut Silent,
            &mut memory,
        )
        .expect("settings in range");
        black_box(outcome.iterations)
    };
    if run() != ITERATIONS {
        return Err("the search ends before its iterations are made".into());
    }
    Ok(Box::new(move || {
        run();
    }))
}
