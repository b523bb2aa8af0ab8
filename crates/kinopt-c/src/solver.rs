//! Solvers of problems.

use std::ffi::c_char;

use kinopt::ik::Restarts;
use kinopt::solver::Stopping;
use kinopt::{Solver, Workspace};
use kinopt_bindings::Value;
use kinopt_bindings::option::names;
use kinopt_bindings::option::solver::{SolverOptions, options};

use crate::error::{KinoptStatus, guard, of_json};
use crate::pointer;
use crate::problem::KinoptProblem;
use crate::settings::settings;
use crate::solution::KinoptSolution;
use crate::targets::KinoptTargets;

/// Levenberg-Marquardt solver with its workspace. One thread uses it at a time.
pub struct KinoptSolver {
    inner: Solver,
    workspace: Workspace,
}

/// Creates a solver.
///
/// `settings`: `max_iterations`, `gradient_tolerance`, `step_tolerance`, `patience`, `time_limit` (seconds), `attempts`,
/// `seed`, `agreeing`, `restart_steps`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_solver_new(
    settings: *const c_char,
    solver: *mut *mut KinoptSolver,
) -> KinoptStatus {
    guard(|| unsafe {
        let settings = self::settings(settings, "option of a solver", &names(&options()), &[])?;
        let mut options = SolverOptions::of(&settings).map_err(of_json)?;
        if let Some(patience) = settings.get("patience") {
            let steps = patience
                .whole("patience", u64::from(u32::MAX))
                .map_err(of_json)?;
            options.patience = Some(usize::try_from(steps).ok());
        }
        let inner = Solver::default()
            .with_stopping(options.stopping(Stopping::default()))
            .with_restarts(options.restarts(Restarts::default()));
        let workspace = Workspace::new();
        pointer::give(solver, KinoptSolver { inner, workspace }, "solver")
    })
}

/// Frees a solver.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_solver_free(solver: *mut KinoptSolver) {
    unsafe { pointer::free(solver) }
}

/// Solves a problem from a configuration of the robot. `targets` null is those of the tasks. A target that is not reached is
/// no error.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_solver_solve(
    solver: *mut KinoptSolver,
    problem: *const KinoptProblem,
    targets: *const KinoptTargets,
    start: *const f64,
    start_length: usize,
    solution: *mut KinoptSolution,
) -> KinoptStatus {
    guard(|| unsafe {
        let KinoptSolver { inner, workspace } = pointer::object_mut(solver, "solver")?;
        let problem = &pointer::object(problem, "problem")?.inner;
        let targets = pointer::optional_object(targets, "targets")?;
        let start = pointer::array(start, start_length, "start")?;
        let solution = pointer::object_mut(solution, "solution")?;
        let solved = match targets {
            Some(targets) => {
                let instance = problem.instance(&targets.inner).map_err(of_json)?;
                inner.solve(instance, start, workspace)?
            }
            None => inner.solve(&problem.inner, start, workspace)?,
        };
        solution.inner.clone_from(solved);
        Ok(())
    })
}
