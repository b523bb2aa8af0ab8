//! Solvers and derivative routes by name.

use clap::ValueEnum;
use clap::builder::PossibleValuesParser;
use kinopt::Solver;
use kinopt::problem::Derivatives;
use kinopt::solver::{Damping, FirstStep, GaussNewton, LevenbergMarquardt, ProjectedGradient};

/// Every solver there is; the first is the default.
fn solvers() -> [Solver; 5] {
    [
        Solver::new(LevenbergMarquardt::new(Damping::GainRatio)),
        Solver::new(LevenbergMarquardt::new(Damping::ErrorProportional)),
        Solver::new(GaussNewton::default()),
        Solver::new(ProjectedGradient::default()),
        Solver::new(ProjectedGradient::new(FirstStep::BarzilaiBorwein)),
    ]
}

/// Accepts the names that the methods give themselves.
pub(crate) fn names() -> PossibleValuesParser {
    PossibleValuesParser::new(solvers().iter().map(Solver::method).collect::<Vec<_>>())
}

/// The solver of a name that [`names`] accepted.
pub(crate) fn solver(name: &str) -> Solver {
    let found = solvers().into_iter().find(|solver| solver.method() == name);
    found.unwrap_or_default()
}

/// `--jacobian`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum JacobianRoute {
    /// Geometric, exact, fastest
    Analytic,
    /// Forward-mode dual numbers, exact
    Dual,
    /// Forward differences
    Fd,
    /// Central differences
    Central,
}

impl From<JacobianRoute> for Derivatives {
    fn from(route: JacobianRoute) -> Self {
        match route {
            JacobianRoute::Analytic => Self::Analytic,
            JacobianRoute::Dual => Self::Dual,
            JacobianRoute::Fd => Self::ForwardDifference,
            JacobianRoute::Central => Self::CentralDifference,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_the_library_s() {
        assert_eq!(solvers()[0].method(), Solver::default().method());
        for known in solvers() {
            assert_eq!(solver(known.method()).method(), known.method());
        }
    }
}
