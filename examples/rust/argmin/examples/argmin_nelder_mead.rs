//! argmin's Nelder-Mead, which needs no derivatives, on an inverse kinematics problem with joint limits. It converges
//! slowly, and the comparison shows the benefit of derivatives.
//!
//! `cargo run --release -p kinopt-argmin-examples --example argmin_nelder_mead`
#![allow(clippy::print_stdout)]

mod seven_joint_arm;

use argmin::core::Executor;
use argmin::solver::neldermead::NelderMead;
use kinopt::argmin_bridge::BoundedProblem;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem = seven_joint_arm::problem()?;

    // Outside the bounds the cost is that of the nearest point inside.
    let bounded = BoundedProblem::new(&problem);
    let simplex = bounded.simplex(&seven_joint_arm::START)?;
    let run = Executor::new(bounded.clone(), NelderMead::new(simplex))
        .configure(|state| state.max_iters(5000).target_cost(1e-14))
        .run()?;
    let solution = bounded.solution(&run)?;

    seven_joint_arm::compare("argmin Nelder-Mead", &problem, &solution)?;
    assert!(solution.cost < 1e-6, "{}", solution.explain());
    Ok(())
}
