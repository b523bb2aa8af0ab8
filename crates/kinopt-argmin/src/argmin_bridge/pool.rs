//! Evaluation of a problem through a shared reference, from any thread.

use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::DMatrix;

use kinopt_solver::problem::{ProblemInstance, Scratch};

/// Memory of one evaluation.
#[derive(Debug)]
pub(super) struct EvaluationBuffers {
    pub(super) scratch: Scratch,
    pub(super) x: Vec<f64>,
    pub(super) residual: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    pub(super) jacobian: DMatrix<f64>,
}

/// Pool of unused buffers, shared by clones.
///
/// A thread takes one, or creates one if none is left, and puts it back. The lock is held only for that.
#[derive(Clone, Debug, Default)]
pub(super) struct Pool(Arc<Mutex<Vec<EvaluationBuffers>>>);

impl Pool {
    pub(super) fn with<T>(
        &self,
        instance: ProblemInstance<'_>,
        work: impl FnOnce(&mut EvaluationBuffers) -> T,
    ) -> T {
        let problem = instance.problem();
        let lock_pool = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let unused = lock_pool().pop();
        let mut buffers = unused.unwrap_or_else(|| EvaluationBuffers {
            scratch: problem.scratch(),
            x: vec![0.0; problem.variables()],
            residual: vec![0.0; problem.rows()],
            gradient: vec![0.0; problem.variables()],
            jacobian: DMatrix::zeros(problem.rows(), problem.variables()),
        });
        let result = work(&mut buffers);
        lock_pool().push(buffers);
        result
    }
}
