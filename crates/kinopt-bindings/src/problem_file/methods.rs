//! Methods of the general solver and routes of its derivatives, by name.

use kinopt::Solver;
use kinopt::problem::Derivatives;
use kinopt::solver::{Damping, FirstStep, GaussNewton, LevenbergMarquardt, ProjectedGradient};

/// All solvers; the first is the default.
fn solvers() -> [Solver; 5] {
    [
        Solver::new(LevenbergMarquardt::new(Damping::GainRatio)),
        Solver::new(LevenbergMarquardt::new(Damping::ErrorProportional)),
        Solver::new(GaussNewton::default()),
        Solver::new(ProjectedGradient::default()),
        Solver::new(ProjectedGradient::new(FirstStep::BarzilaiBorwein)),
    ]
}

/// Names of the methods.
pub fn names() -> [&'static str; 5] {
    solvers().each_ref().map(Solver::method)
}

/// Solver of a name of [`names`].
pub fn solver(name: &str) -> Solver {
    let selected = solvers().into_iter().find(|solver| solver.method() == name);
    selected.unwrap_or_default()
}

/// Routes of derivatives.
pub const DERIVATIVES: [(&str, Derivatives); 4] = [
    ("analytic", Derivatives::Analytic),
    ("dual", Derivatives::Dual),
    ("fd", Derivatives::ForwardDifference),
    ("central", Derivatives::CentralDifference),
];
