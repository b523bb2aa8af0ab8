//! Methods of solvers by name, with their settings.

use kinopt::geometric::{Ccd, Elbow, Fabrik, Geometric, TwoBone};
use kinopt::ik::Restarts;
use kinopt::problem::ProblemInstance;
use kinopt::solver::{
    Damping, FirstStep, GaussNewton, LevenbergMarquardt, Observer, ProjectedGradient, Stopping,
};
use kinopt::{Solution, Solver, Workspace};

use crate::error::ErrorKind;
use crate::names::named;
use crate::option::solver::SolverOptions;
use crate::value::{Arguments, ErrorOf, OrRaise, Value};

/// Methods that need no settings. `two_bone` needs its elbow.
pub const METHODS: [&str; 5] = [
    "levenberg-marquardt",
    "gauss-newton",
    "projected-gradient",
    "ccd",
    "fabrik",
];

/// A method with its settings and limits.
pub enum SolverMethod {
    /// A method that minimises.
    Optimiser(Solver),
    /// A geometric method.
    Geometric(Box<dyn Geometric>),
}

impl SolverMethod {
    /// Reads the method of a name from its settings; `None` for an unknown name.
    ///
    /// # Errors
    /// If a setting has another type or is out of range, or the method does not support the limits.
    pub fn of<A: Arguments>(
        name: &str,
        settings: &A,
        limits: &SolverOptions,
    ) -> Result<Option<Self>, ErrorOf<A>> {
        let solver = |solver: Solver| {
            let solver = solver.with_stopping(limits.stopping(Stopping::default()));
            Self::Optimiser(solver.with_restarts(limits.restarts(Restarts::default())))
        };
        Ok(Some(match name {
            "levenberg-marquardt" => solver(Solver::new(levenberg_marquardt(settings)?)),
            "gauss-newton" => solver(Solver::new(gauss_newton(settings)?)),
            "projected-gradient" => solver(Solver::new(projected_gradient(settings)?)),
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
            "two_bone" if limits.any_of_stopping() || limits.any_of_restarts() => {
                let message = "the two-bone method takes one step and has no limits";
                return Err(invalid::<A>(message.to_owned()));
            }
            "two_bone" => Self::Geometric(Box::new(TwoBone::new(elbow(settings)?))),
            _ => return Ok(None),
        }))
    }

    /// Name of the method.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Optimiser(solver) => solver.method(),
            Self::Geometric(method) => method.name(),
        }
    }

    /// Solves one query.
    ///
    /// # Errors
    /// If the start has another length or is not finite, or the method does not support the problem.
    pub fn solve<V: Value>(
        &self,
        instance: ProblemInstance<'_>,
        start: &[f64],
        workspace: &mut Workspace,
        observer: &mut dyn Observer,
    ) -> Result<Solution, V::Error> {
        match self {
            Self::Optimiser(solver) => solver
                .solve_observed(instance, start, workspace, observer)
                .or_raise::<V>()
                .cloned(),
            Self::Geometric(method) => method
                .solve_question(instance, start, observer)
                .or_raise::<V>(),
        }
    }
}

fn levenberg_marquardt<A: Arguments>(settings: &A) -> Result<LevenbergMarquardt, ErrorOf<A>> {
    let rules = [
        ("gain_ratio", Damping::GainRatio),
        ("error_proportional", Damping::ErrorProportional),
    ];
    let method = match settings.get("damping")? {
        Some(rule) => {
            let rule = named("damping rule", &rule.name("damping")?, &rules);
            LevenbergMarquardt::new(rule.or_raise::<A::Value>()?)
        }
        None => LevenbergMarquardt::default(),
    };
    Ok(match settings.get("initial_damping")? {
        Some(initial) => {
            let initial = initial.number("initial_damping")?;
            method.with_initial_damping(positive::<A>("initial_damping", initial)?)
        }
        None => method,
    })
}

fn gauss_newton<A: Arguments>(settings: &A) -> Result<GaussNewton, ErrorOf<A>> {
    let method = GaussNewton::default();
    let Some(tolerance) = settings.get("rank_tolerance")? else {
        return Ok(method);
    };
    let tolerance = tolerance.number("rank_tolerance")?;
    match (f64::EPSILON..=0.5).contains(&tolerance) {
        true => Ok(method.with_rank_tolerance(tolerance)),
        false => Err(invalid::<A>(format!(
            "rank_tolerance is {tolerance}, which is not between the machine's epsilon and 0.5"
        ))),
    }
}

fn projected_gradient<A: Arguments>(settings: &A) -> Result<ProjectedGradient, ErrorOf<A>> {
    let Some(first) = settings.get("first_step")? else {
        return Ok(ProjectedGradient::default());
    };
    let first = match first.as_text() {
        Some(rule) => {
            let rules = [("barzilai_borwein", FirstStep::BarzilaiBorwein)];
            named("first step", &rule, &rules).or_raise::<A::Value>()?
        }
        None => FirstStep::Fixed(positive::<A>("first_step", first.number("first_step")?)?),
    };
    Ok(ProjectedGradient::new(first))
}

/// Reads the bend direction of a limb: a side, or a pole in metres.
fn elbow<A: Arguments>(settings: &A) -> Result<Elbow, ErrorOf<A>> {
    let elbow = settings.required("elbow")?;
    if let Some(side) = elbow.as_text() {
        let sides = [("positive", Elbow::Positive), ("negative", Elbow::Negative)];
        return named("side of an elbow", &side, &sides).or_raise::<A::Value>();
    }
    let pole: [f64; 3] = elbow.array("elbow")?;
    match pole.iter().find(|number| !number.is_finite()) {
        Some(bad) => Err(invalid::<A>(format!(
            "elbow holds {bad}, which is not a finite number"
        ))),
        None => Ok(Elbow::Towards(pole.into())),
    }
}

/// Default limits of an attempt of the geometric methods.
fn sweeps() -> Stopping {
    let stopping = Stopping::default().with_max_iterations(500);
    stopping.with_patience(Some(60))
}

/// Default restarts of the geometric methods.
fn sweep_restarts() -> Restarts {
    Restarts::default().with_steps(2000)
}

fn positive<A: Arguments>(name: &str, value: f64) -> Result<f64, ErrorOf<A>> {
    match value > 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(invalid::<A>(format!(
            "{name} is {value}, which is not a positive finite number"
        ))),
    }
}

fn invalid<A: Arguments>(message: String) -> ErrorOf<A> {
    A::Value::error(ErrorKind::InvalidValue, message)
}
