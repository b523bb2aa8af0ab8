//! What a search needs to go on later, bit for bit, in another process.

use serde::{Deserialize, Serialize};

use super::{Counts, LeastSquares, Method, SolverState};

/// A search between two iterations. What x alone decides (residual, derivatives) is not kept:
/// evaluating it again gives the same bits.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Snapshot {
    x: Vec<f64>,
    column_norm: f64,
    flat_steps: usize,
    best_x: Vec<f64>,
    best_cost: f64,
    /// Residuals, Jacobians, gradients.
    counts: [usize; 3],
}

impl SolverState {
    /// Keeps what cannot be evaluated again.
    pub(crate) fn snapshot(&self) -> Snapshot {
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

    /// Stands where the snapshot was taken, derivatives included. Returns false, and is of no use,
    /// if the snapshot or the method's state is of a problem of another size or outside these bounds.
    pub(crate) fn restore<M: Method>(
        &mut self,
        problem: &mut dyn LeastSquares,
        (method, own): (&M, &M::State),
        snapshot: &Snapshot,
    ) -> bool {
        let n = problem.variables();
        let Snapshot { x, best_x, .. } = snapshot;
        if x.len() != n || best_x.len() != n || !method.fits(own, n) {
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
