//! Custom method: Powell's dogleg, as a struct outside the library. The library runs the loop around its steps:
//! derivatives, bounds, convergence tests, restarts and reports.
//!
//! `cargo run --release --example own_method`
#![allow(clippy::print_stdout)]

use std::error::Error;

use kinopt::model::{Limits, Model};
use kinopt::solver::{Iterate, Method, SolverState, Step};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use kinopt::{Problem, Solver};
use nalgebra::DVector;

/// Minimises the linear model ½‖r + JΔ‖² within a radius. The step goes along the gradient, then towards the minimum
/// (Powell 1970; Nocedal & Wright 2006, section 4.1).
struct Dogleg {
    first_radius: f64,
}

impl Method for Dogleg {
    /// Trust-region radius, in units of x.
    type State = f64;

    fn name(&self) -> &'static str {
        "dogleg"
    }

    fn needs_jacobian(&self) -> bool {
        true
    }

    fn begin(&self, radius: &mut f64, _: &SolverState) {
        *radius = self.first_radius;
    }

    fn step(&self, radius: &mut f64, at: &mut Iterate<'_>) -> Step {
        // Variables in the active set do not move.
        let free = at.free().to_vec();
        let jacobian = at.jacobian().select_columns(&free);
        let residual = DVector::from_column_slice(at.residual());
        let gradient = jacobian.tr_mul(&residual);
        let curvature = (&jacobian * &gradient).norm_squared();
        let steepest = &gradient * (-gradient.norm_squared() / curvature);
        let Ok(newton) = jacobian.svd(true, true).solve(&-residual, 1e-9) else {
            return Step::Stuck;
        };
        let step = if newton.norm() <= *radius {
            newton
        } else if steepest.norm() >= *radius {
            steepest.normalize() * *radius
        } else {
            // ‖steepest + t · leg‖ = radius
            let leg = newton - &steepest;
            let (a, b) = (leg.norm_squared(), steepest.dot(&leg));
            let remaining = *radius * *radius - steepest.norm_squared();
            &steepest + &leg * (((b * b + a * remaining).sqrt() - b) / a)
        };

        at.step_mut().fill(0.0);
        for (&variable, moved) in free.iter().zip(&step) {
            at.step_mut()[variable] = *moved;
        }
        at.project_step();
        let predicted_decrease = at.cost() - at.model_cost();
        let decrease = at.cost() - at.evaluate_trial();
        if decrease < 0.25 * predicted_decrease {
            *radius *= 0.25;
        } else if decrease > 0.75 * predicted_decrease {
            *radius *= 2.0;
        }
        if decrease > 0.0 {
            at.accept();
            Step::Taken
        } else {
            Step::Refused
        }
    }

    fn control(&self, radius: &f64) -> f64 {
        *radius
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut builder = Model::builder("three links");
    let link = Placement::translation(Vector3::new(0.4, 0.0, 0.0));
    let limits = Limits::new(-2.0, 2.0);
    let (mut joint, mut at) = (None, Placement::identity());
    for (name, axis) in [("pan", 2), ("lift", 1), ("elbow", 1)] {
        joint = Some(builder.revolute(name, joint, at, Vector3::UNITS[axis], limits));
        at = if name == "pan" {
            Placement::identity()
        } else {
            link
        };
    }
    let tip = builder.frame("tip", joint, link);
    let model = builder.build()?;

    let solver = Solver::new(Dogleg { first_radius: 0.5 });
    for target in [[0.3, 0.4, 0.2], [0.0, 0.9, 0.6]] {
        let mut tasks = Problem::builder(&model);
        tasks.add(Point::new(tip, target));
        let solution = solver.solve_once(&tasks.build()?, &[0.1, 0.2, 0.3])?;
        println!("{target:?} by {}: {}", solver.method(), solution.explain());
        assert_eq!(solution.reached, !solution.is_out_of_reach());
    }
    Ok(())
}
