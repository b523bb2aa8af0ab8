//! All solver methods, as methods and as solvers.

use kinopt::Solver;
use kinopt::solver::{
    AnyMethod, Damping, FirstStep, GaussNewton, LevenbergMarquardt, ProjectedGradient,
};

pub fn methods() -> Vec<Box<dyn AnyMethod>> {
    vec![
        Box::new(LevenbergMarquardt::new(Damping::GainRatio)),
        Box::new(LevenbergMarquardt::new(Damping::ErrorProportional)),
        Box::new(GaussNewton::default()),
        Box::new(ProjectedGradient::new(FirstStep::Fixed(10_000.0))),
        Box::new(ProjectedGradient::new(FirstStep::BarzilaiBorwein)),
    ]
}

/// The methods in the same order, as solvers.
pub fn solvers() -> Vec<Solver> {
    vec![
        Solver::new(LevenbergMarquardt::new(Damping::GainRatio)),
        Solver::new(LevenbergMarquardt::new(Damping::ErrorProportional)),
        Solver::new(GaussNewton::default()),
        Solver::new(ProjectedGradient::new(FirstStep::Fixed(10_000.0))),
        Solver::new(ProjectedGradient::new(FirstStep::BarzilaiBorwein)),
    ]
}
