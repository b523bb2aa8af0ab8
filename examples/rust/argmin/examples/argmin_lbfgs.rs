//! argmin's L-BFGS on an inverse kinematics problem with joint limits.
//!
//! `cargo run --release -p kinopt-argmin-examples --example argmin_lbfgs`
#![allow(clippy::print_stdout)]

mod seven_joint_arm;

use argmin::core::Executor;
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use kinopt::argmin_bridge::UnboundedProblem;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem = seven_joint_arm::problem()?;

    // L-BFGS has no bounds: the wrapper has unbounded variables.
    let unbounded = UnboundedProblem::new(&problem);
    let start = unbounded.start(&seven_joint_arm::START)?;
    let solver = LBFGS::new(MoreThuenteLineSearch::new(), 7);
    let run = Executor::new(unbounded.clone(), solver)
        .configure(|state| state.param(start.clone()).max_iters(200).target_cost(1e-15))
        .run();
    let solution = unbounded.solution_from(&start, run)?;

    seven_joint_arm::compare("argmin L-BFGS", &problem, &solution)?;
    assert!(solution.reached, "{}", solution.explain());
    Ok(())
}
