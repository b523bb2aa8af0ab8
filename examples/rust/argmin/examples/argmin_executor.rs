//! Levenberg-Marquardt of kinopt under argmin's executor: observed, interrupted, and resumed from its checkpoint.
//!
//! `cargo run --release -p kinopt-argmin-examples --example argmin_executor`
#![allow(clippy::print_stdout)]

mod seven_joint_arm;

use argmin::core::observers::{Observe, ObserverMode};
use argmin::core::{Error, Executor, KV, State};
use argmin_checkpointing_file::{CheckpointingFrequency, FileCheckpoint};
use kinopt::argmin_bridge::{BoundedProblem, ExecutorMethod, MethodState};
use kinopt::solver::LevenbergMarquardt;

/// Observer that prints iterations, and can fail at a given one.
struct Watch {
    fails_at: Option<u64>,
}

impl Observe<MethodState> for Watch {
    fn observe_iter(&mut self, state: &MethodState, seen: &KV) -> Result<(), Error> {
        let number = |key| seen.get(key).and_then(|value| value.get_float());
        println!(
            "  iteration {:2}: cost {:10.3e}, damping {:10.3e}, projected gradient {}",
            state.get_iter(),
            state.get_cost(),
            number("control").unwrap_or(f64::NAN),
            number("projected_gradient").map_or("not needed".to_owned(), |g| format!("{g:.3e}")),
        );
        match self.fails_at {
            Some(iteration) if state.get_iter() >= iteration => Err(Error::msg("power failure")),
            _ => Ok(()),
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem = seven_joint_arm::problem()?;
    let bounded = BoundedProblem::new(&problem);
    let start = bounded.start(&seven_joint_arm::START)?;
    let executor = || {
        let method = ExecutorMethod::new(LevenbergMarquardt::default());
        Executor::new(bounded.clone(), method)
            .configure(|state| state.param(start.clone()).max_iters(100))
    };

    println!("Undisturbed:");
    let watch = Watch { fails_at: None };
    let undisturbed = executor().add_observer(watch, ObserverMode::Always).run()?;
    let expected = bounded.solution(&undisturbed)?;

    println!("Interrupted:");
    let directory = std::env::temp_dir().join(format!("kinopt-{}", std::process::id()));
    let folder = directory.to_string_lossy().into_owned();
    let checkpoint = || FileCheckpoint::new(folder.as_str(), "arm", CheckpointingFrequency::Always);
    let watch = Watch { fails_at: Some(3) };
    let failed = executor()
        .add_observer(watch, ObserverMode::Always)
        .checkpointing(checkpoint())
        .run();
    println!(
        "  {}",
        failed.err().ok_or("the interruption was overlooked")?
    );

    println!("Resumed:");
    let watch = Watch { fails_at: None };
    let resumed = executor()
        .add_observer(watch, ObserverMode::Always)
        .checkpointing(checkpoint())
        .run()?;
    let solution = bounded.solution(&resumed)?;
    std::fs::remove_dir_all(&directory)?;

    seven_joint_arm::compare("ours, under argmin", &problem, &solution)?;
    assert!(solution.reached, "{}", solution.explain());
    assert_eq!(solution.q, expected.q, "the same steps to the bit");
    assert_eq!(solution.iterations, expected.iterations);
    Ok(())
}
