//! Methods of Python, with their limits.

use kinopt::geometric::{Ccd, Elbow, Fabrik, Geometric, TwoBone};
use kinopt::ik::Restarts;
use kinopt::problem::ProblemInstance;
use kinopt::solver::{
    Damping, FirstStep, GaussNewton, LevenbergMarquardt, Observer, ProjectedGradient, Stopping,
};
use kinopt::{Solution, Solver, Workspace};
use kinopt_bindings::names::named;
use kinopt_bindings::option::solver::SolverOptions;
use pyo3::prelude::*;

use crate::arrays;
use crate::error::{OrRaise, invalid};

/// Solver engine.
pub(super) enum Engine {
    Optimiser(Solver),
    Geometric(Box<dyn Geometric>),
}

impl Engine {
    /// Reads a method: an instance of a class in `kinopt.methods`, or a name.
    pub(super) fn of(method: &Bound<'_, PyAny>, limits: &SolverOptions) -> PyResult<Self> {
        let kind = match method.extract::<String>() {
            Ok(name) => return Self::named(&name, method.py(), limits),
            Err(_) => method.getattr_opt("_kind")?,
        };
        let Some(kind) = kind else {
            return Err(invalid(format!(
                "method must be one of kinopt.methods or its name, not {}",
                method.repr()?
            )));
        };
        let solver = |solver: Solver| {
            let solver = solver.with_stopping(limits.stopping(Stopping::default()));
            Self::Optimiser(solver.with_restarts(limits.restarts(Restarts::default())))
        };
        let kind: String = kind.extract()?;
        Ok(match kind.as_str() {
            "levenberg-marquardt" => {
                let rules = [
                    ("gain_ratio", Damping::GainRatio),
                    ("error_proportional", Damping::ErrorProportional),
                ];
                let damping: String = method.getattr("damping")?.extract()?;
                let method_ =
                    LevenbergMarquardt::new(named("damping rule", &damping, &rules).or_raise()?);
                solver(Solver::new(match number(method, "initial_damping")? {
                    Some(initial) if initial > 0.0 && initial.is_finite() => {
                        method_.with_initial_damping(initial)
                    }
                    Some(initial) => return Err(not_positive("initial_damping", initial)),
                    None => method_,
                }))
            }
            "gauss-newton" => solver(Solver::new(match number(method, "rank_tolerance")? {
                Some(tolerance) if (f64::EPSILON..=0.5).contains(&tolerance) => {
                    GaussNewton::default().with_rank_tolerance(tolerance)
                }
                Some(tolerance) => {
                    return Err(invalid(format!(
                        "rank_tolerance is {tolerance}, which is not between the machine's epsilon and 0.5"
                    )));
                }
                None => GaussNewton::default(),
            })),
            "projected-gradient" => {
                let first = method.getattr("first_step")?;
                let first = match first.extract::<f64>() {
                    Ok(step) if step > 0.0 && step.is_finite() => FirstStep::Fixed(step),
                    Ok(step) => return Err(not_positive("first_step", step)),
                    Err(_) => {
                        let rules = [("barzilai_borwein", FirstStep::BarzilaiBorwein)];
                        named("first step", &first.extract::<String>()?, &rules).or_raise()?
                    }
                };
                solver(Solver::new(ProjectedGradient::new(first)))
            }
            "ccd" => {
                let mut method = Ccd::default();
                if limits.any_of_stopping() {
                    method = method.with_stopping(limits.stopping(sweeps()));
                }
                if limits.any_of_restarts() {
                    method = method.with_restarts(limits.restarts(sweep_restarts()));
                }
                Self::Geometric(Box::new(method))
            }
            "fabrik" => {
                let mut method = Fabrik::default();
                if limits.any_of_stopping() {
                    method = method.with_stopping(limits.stopping(sweeps()));
                }
                if limits.any_of_restarts() {
                    method = method.with_restarts(limits.restarts(sweep_restarts()));
                }
                Self::Geometric(Box::new(method))
            }
            "two_bone" => {
                if limits.any_of_stopping() || limits.any_of_restarts() {
                    return Err(invalid(
                        "the two-bone method takes one step and has no limits",
                    ));
                }
                let elbow = method.getattr("elbow")?;
                let elbow = match elbow.extract::<String>() {
                    Ok(side) => {
                        let sides = [("positive", Elbow::Positive), ("negative", Elbow::Negative)];
                        named("side of an elbow", &side, &sides).or_raise()?
                    }
                    Err(_) => {
                        let pole: [f64; 3] = arrays::array(&elbow, "elbow")?;
                        if let Some(bad) = pole.iter().find(|number| !number.is_finite()) {
                            return Err(invalid(format!(
                                "elbow holds {bad}, which is not a finite number"
                            )));
                        }
                        Elbow::Towards(pole.into())
                    }
                };
                Self::Geometric(Box::new(TwoBone::new(elbow)))
            }
            _ => {
                return Err(invalid(format!(
                    "method must be one of kinopt.methods or its name, not {}",
                    method.repr()?
                )));
            }
        })
    }

    /// Creates a method with its default settings.
    fn named(name: &str, py: Python<'_>, limits: &SolverOptions) -> PyResult<Self> {
        let classes = [
            ("levenberg-marquardt", "LevenbergMarquardt"),
            ("gauss-newton", "GaussNewton"),
            ("projected-gradient", "ProjectedGradient"),
            ("ccd", "Ccd"),
            ("fabrik", "Fabrik"),
        ];
        let class = named("method", name, &classes).or_raise()?;
        let method = py.import("kinopt.methods")?.getattr(class)?.call0()?;
        Self::of(&method, limits)
    }

    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Optimiser(solver) => solver.method(),
            Self::Geometric(method) => method.name(),
        }
    }

    /// Solves one query.
    pub(super) fn solve(
        &self,
        instance: ProblemInstance<'_>,
        start: &[f64],
        workspace: &mut Workspace,
        observer: &mut dyn Observer,
    ) -> PyResult<Solution> {
        match self {
            Self::Optimiser(solver) => solver
                .solve_observed(instance, start, workspace, observer)
                .or_raise()
                .cloned(),
            Self::Geometric(method) => method.solve_question(instance, start, observer).or_raise(),
        }
    }
}

/// Default limits of the geometric methods.
fn sweeps() -> Stopping {
    let stopping = Stopping::default().with_max_iterations(500);
    stopping.with_patience(Some(60))
}

fn sweep_restarts() -> Restarts {
    Restarts::default().with_steps(2000)
}

/// Reads an optional number of a method.
fn number(method: &Bound<'_, PyAny>, name: &str) -> PyResult<Option<f64>> {
    let value = method.getattr(name)?;
    match value.is_none() {
        true => Ok(None),
        false => arrays::number(&value, name).map(Some),
    }
}

fn not_positive(name: &str, value: f64) -> PyErr {
    invalid(format!(
        "{name} is {value}, which is not a positive finite number"
    ))
}
