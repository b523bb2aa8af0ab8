//! argmin's particle swarm, which searches the whole range of the joints, on an inverse kinematics problem. kinopt's
//! Levenberg-Marquardt refines its result.
//!
//! `cargo run --release -p kinopt-argmin-examples --example argmin_particle_swarm`
#![allow(clippy::print_stdout)]

mod seven_joint_arm;

use argmin::core::Executor;
use argmin::solver::particleswarm::ParticleSwarm;
use kinopt::Solver;
use kinopt::argmin_bridge::BoundedProblem;
use kinopt::ik::Restarts;
use rand::SeedableRng;
use rand::rngs::StdRng;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem = seven_joint_arm::problem()?;

    let bounded = BoundedProblem::new(&problem);
    let window = bounded.search_box(&seven_joint_arm::START)?;
    // The default generator has a system seed; this one is reproducible.
    let swarm = ParticleSwarm::new(window, 60).with_rng_generator(StdRng::seed_from_u64(1));
    let run = Executor::new(bounded.clone(), swarm)
        .configure(|state| state.max_iters(400).target_cost(1e-14))
        .run()?;
    let solution = bounded.solution(&run)?;

    seven_joint_arm::compare("argmin particle swarm", &problem, &solution)?;
    assert!(solution.cost < 1e-2, "{}", solution.explain());

    let once = Solver::default().with_restarts(Restarts::none());
    let finished = once.solve_once(&problem, &solution.q)?;
    println!("finished from there: {}", finished.explain());
    assert!(finished.reached);
    Ok(())
}
