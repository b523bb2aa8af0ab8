//! Solvers and derivative modes by name.

use clap::builder::PossibleValuesParser;
use kinopt::Solver;
use kinopt::problem::Derivatives;
use kinopt::solver::{Damping, FirstStep, GaussNewton, LevenbergMarquardt, ProjectedGradient};

use crate::choices::Choice;

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

/// Parser of the names of methods.
pub(crate) fn names() -> PossibleValuesParser {
    PossibleValuesParser::new(solvers().iter().map(Solver::method).collect::<Vec<_>>())
}

/// Solver of a name that [`names`] accepted.
pub(crate) fn solver(name: &str) -> Solver {
    let selected = solvers().into_iter().find(|solver| solver.method() == name);
    selected.unwrap_or_default()
}

/// Derivative modes of `--jacobian`.
pub(crate) const JACOBIAN_ROUTES: [Choice<Derivatives>; 4] = [
    (
        "analytic",
        "Geometric, exact, fastest",
        Derivatives::Analytic,
    ),
    (
        "dual",
        "Forward-mode dual numbers, exact",
        Derivatives::Dual,
    ),
    ("fd", "Forward differences", Derivatives::ForwardDifference),
    (
        "central",
        "Central differences",
        Derivatives::CentralDifference,
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_method_is_the_library_default() {
        assert_eq!(solvers()[0].method(), Solver::default().method());
        for known in solvers() {
            assert_eq!(solver(known.method()).method(), known.method());
        }
    }
}
