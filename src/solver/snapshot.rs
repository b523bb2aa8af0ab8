//! What a search needs to go on later, bit for bit, in another process.

use serde::{Deserialize, Serialize};

use super::curvature::Curvature;
use super::{Counts, LeastSquares, Memory, Method};

/// A search between two iterations. What x alone decides (residual, derivatives) is not kept:
/// evaluating it again gives the same bits.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Snapshot {
    x: Vec<f64>,
    column_norm: f64,
    damping: f64,
    damping_growth: f64,
    damping_per_cost: f64,
    flat_steps: usize,
    previous_x: Vec<f64>,
    previous_gradient: Vec<f64>,
    recent_costs: Vec<f64>,
    best_x: Vec<f64>,
    best_cost: f64,
    curvature: Curvature,
    /// Residuals, Jacobians, gradients.
    counts: [usize; 3],
}

impl Memory {
    /// Keeps what cannot be evaluated again.
    pub(crate) fn snapshot(&self) -> Snapshot {
        Snapshot {
            x: self.x.clone(),
            column_norm: self.column_norm,
            damping: self.damping,
            damping_growth: self.damping_growth,
            damping_per_cost: self.damping_per_cost,
            flat_steps: self.flat_steps,
            previous_x: self.previous_x.clone(),
            previous_gradient: self.previous_gradient.clone(),
            recent_costs: self.recent_costs.clone(),
            best_x: self.best_x.clone(),
            best_cost: self.best_cost,
            curvature: self.curvature.clone(),
            counts: [
                self.counts.residuals,
                self.counts.jacobians,
                self.counts.gradients,
            ],
        }
    }

    /// Stands where the snapshot was taken, derivatives included. Returns false, and is of no use,
    /// if the snapshot is of a problem of another size or outside these bounds.
    pub(crate) fn restore(
        &mut self,
        problem: &mut dyn LeastSquares,
        method: &dyn Method,
        snapshot: &Snapshot,
    ) -> bool {
        let n = problem.variables();
        let Snapshot {
            x,
            previous_x,
            previous_gradient,
            best_x,
            ..
        } = snapshot;
        let fits = [x, previous_x, previous_gradient, best_x]
            .iter()
            .all(|vector| vector.len() == n);
        if !fits || !snapshot.curvature.fits(n) {
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
        self.damping = snapshot.damping;
        self.damping_growth = snapshot.damping_growth;
        self.damping_per_cost = snapshot.damping_per_cost;
        self.flat_steps = snapshot.flat_steps;
        self.previous_x.copy_from_slice(previous_x);
        self.previous_gradient.copy_from_slice(previous_gradient);
        self.recent_costs.extend_from_slice(&snapshot.recent_costs);
        self.best_x.copy_from_slice(best_x);
        self.best_cost = snapshot.best_cost;
        self.curvature.clone_from(&snapshot.curvature);
        let [residuals, jacobians, gradients] = snapshot.counts;
        self.counts += Counts {
            residuals,
            jacobians,
            gradients,
        };
        true
    }
}
