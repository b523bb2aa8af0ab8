//! argmin's trust region, with either of its subproblem solvers, on an inverse kinematics problem
//! with joint limits.
//!
//! `cargo run --release -p kinopt-argmin-examples --example argmin_trust_region`
#![allow(clippy::print_stdout)]

mod seven_joint_arm;

use argmin::core::Executor;
use argmin::solver::trustregion::{Dogleg, Steihaug, TrustRegion};
use kinopt::argmin_bridge::UnboundedProblem;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem = seven_joint_arm::problem()?;
    let unbounded = UnboundedProblem::new(&problem);
    let start = unbounded.start(&seven_joint_arm::START)?;

    // A trust region has no test of its own for having arrived: give it a cost to reach.
    let steihaug = TrustRegion::new(Steihaug::new().with_max_iters(20));
    let run = Executor::new(unbounded.clone(), steihaug)
        .configure(|state| state.param(start.clone()).max_iters(100).target_cost(1e-15))
        .run();
    let by_steihaug = unbounded.solution_from(&start, run)?;

    // argmin 0.11's dogleg has no leg for a steepest-descent step longer than the radius, and stands
    // still there; near enough to the target it is as good as the other.
    let run = Executor::new(unbounded.clone(), TrustRegion::new(Dogleg::new()))
        .configure(|state| state.param(start.clone()).max_iters(100).target_cost(1e-15))
        .run();
    let by_dogleg = unbounded.solution_from(&start, run)?;

    seven_joint_arm::compare("argmin trust, Steihaug", &problem, &by_steihaug)?;
    seven_joint_arm::compare("argmin trust, dogleg", &problem, &by_dogleg)?;
    assert!(by_steihaug.reached && by_dogleg.reached);
    Ok(())
}
