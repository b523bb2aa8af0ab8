//! Adapters of the solvers of this project and of argmin.
//!
//! Solvers without restarts of their own are restarted from random starts, equal for all
//! ([`attempts`](crate::attempts)). Their settings include the limits of one attempt.

mod argmin;
mod geometric;
mod lane_engine;
mod marked_run;
mod method;
mod pose_solver;

pub use argmin::ArgminAdapter;
pub use geometric::GeometricAdapter;
pub use lane_engine::LaneEngineAdapter;
pub use method::MethodAdapter;
pub use pose_solver::SolverAdapter;

use kinopt::solver::{Damping, FirstStep, GaussNewton, LevenbergMarquardt, ProjectedGradient};

use crate::Adapter;

/// Iterations of one attempt of the gradient methods, whose iterations are cheap.
const MAX_GRADIENT_STEPS: usize = 2000;
/// Iterations of one attempt of the other methods.
const MAX_STEPS: usize = 200;

/// All solvers with their default settings.
#[must_use]
pub fn all() -> Vec<Box<dyn Adapter>> {
    let halving = ProjectedGradient::default();
    let barzilai_borwein = ProjectedGradient::new(FirstStep::BarzilaiBorwein);
    let gain = LevenbergMarquardt::new(Damping::GainRatio);
    let error = LevenbergMarquardt::new(Damping::ErrorProportional);
    vec![
        Box::new(SolverAdapter::default()),
        Box::new(MethodAdapter::new(gain, MAX_STEPS)),
        Box::new(MethodAdapter::new(error, MAX_STEPS)),
        Box::new(MethodAdapter::new(GaussNewton::default(), MAX_STEPS)),
        Box::new(MethodAdapter::new(halving, MAX_GRADIENT_STEPS)),
        Box::new(MethodAdapter::new(barzilai_borwein, MAX_GRADIENT_STEPS)),
        Box::new(LaneEngineAdapter::default()),
        Box::new(ArgminAdapter::lbfgs()),
        Box::new(ArgminAdapter::trust_region()),
        Box::new(ArgminAdapter::nelder_mead()),
        Box::new(ArgminAdapter::particle_swarm()),
        Box::new(GeometricAdapter::ccd()),
        Box::new(GeometricAdapter::fabrik()),
    ]
}
