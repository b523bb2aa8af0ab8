//! Snapshot of a search, to resume it in another process with bitwise equal results.

use serde::{Deserialize, Serialize};

use super::{Counts, LeastSquares, Method, SolverState};

/// A search between two iterations.
///
/// It excludes the residual and the derivatives: their evaluation at x gives the same bits again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[doc(hidden)]
pub struct Snapshot {
    x: Vec<f64>,
    column_norm: f64,
    flat_steps: usize,
    best_x: Vec<f64>,
    best_cost: f64,
    /// Evaluations of residuals, Jacobians and gradients.
    counts: [usize; 3],
}

impl SolverState {
    /// Snapshot of the data that cannot be evaluated again.
    #[doc(hidden)]
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            x: self.x.clone(),
            column_norm: self.column_norm,
            flat_steps: self.flat_steps,
            best_x: self.best_x.clone(),
            best_cost: self.best_cost,
            counts: [
                self.counts.residuals,
                self.counts.jacobians,
                self.counts.gradients,
            ],
        }
    }

    /// Restores a snapshot, derivatives included.
    ///
    /// Returns false, with an unusable state, if the snapshot or the method's state belongs to a problem of another
    /// size or other bounds.
    #[doc(hidden)]
    pub fn restore<M: Method>(
        &mut self,
        problem: &mut dyn LeastSquares,
        (method, method_state): (&M, &M::State),
        snapshot: &Snapshot,
    ) -> bool {
        let n = problem.variables();
        let Snapshot { x, best_x, .. } = snapshot;
        if x.len() != n || best_x.len() != n || !method.fits(method_state, n) {
            return false;
        }
        self.start_at(problem, x);
        if self.x != *x {
            return false;
        }
        if method.needs_jacobian() {
            self.differentiate(problem);
        } else {
            self.differentiate_cost(problem);
        }
        self.column_norm = snapshot.column_norm;
        self.flat_steps = snapshot.flat_steps;
        self.best_x.copy_from_slice(best_x);
        self.best_cost = snapshot.best_cost;
        let [residuals, jacobians, gradients] = snapshot.counts;
        self.counts += Counts {
            residuals,
            jacobians,
            gradients,
        };
        true
    }
}
