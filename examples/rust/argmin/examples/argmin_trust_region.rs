//! argmin's trust region with both subproblem solvers, on an inverse kinematics problem with joint limits.
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

    // A trust region has no convergence test, so it needs a target cost.
    let steihaug = TrustRegion::new(Steihaug::new().with_max_iters(20));
    let run = Executor::new(unbounded.clone(), steihaug)
        .configure(|state| state.param(start.clone()).max_iters(100).target_cost(1e-15))
        .run();
    let by_steihaug = unbounded.solution_from(&start, run)?;

    // argmin 0.11's dogleg makes no progress if the steepest-descent step is longer than the radius. Near the target
    // both subproblem solvers are equally good.
    let run = Executor::new(unbounded.clone(), TrustRegion::new(Dogleg::new()))
        .configure(|state| state.param(start.clone()).max_iters(100).target_cost(1e-15))
        .run();
    let by_dogleg = unbounded.solution_from(&start, run)?;

    seven_joint_arm::compare("argmin trust, Steihaug", &problem, &by_steihaug)?;
    seven_joint_arm::compare("argmin trust, dogleg", &problem, &by_dogleg)?;
    assert!(by_steihaug.reached && by_dogleg.reached);
    Ok(())
}
