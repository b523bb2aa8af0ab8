//! Problem of the argmin examples: an arm of seven joints, as common in research, with a target pose of its flange.

use kinopt::ik::Solution;
use kinopt::model::{Limits, Model, ModelError};
use kinopt::problem::ProblemError;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::FramePose;
use kinopt::{Problem, Solver};

/// Start configuration of every search, radians.
pub(crate) const START: [f64; 7] = [0.1, 0.3, -0.2, -1.0, 0.2, 0.6, 0.0];

/// A configuration with the target pose, radians. Other solutions exist.
const POSED: [f64; 7] = [0.7, 0.8, -0.4, -1.4, 0.5, 1.1, -0.6];

/// Height of each joint above the previous one, metres.
const LINKS: [f64; 7] = [0.34, 0.0, 0.4, 0.0, 0.4, 0.0, 0.126];

/// Arm with the axes z y z y z y z, and limits of ±170° and ±120° alternately.
pub(crate) fn arm() -> Result<Model, ModelError> {
    let mut builder = Model::builder("seven joint arm");
    let mut parent = None;
    for (k, height) in LINKS.into_iter().enumerate() {
        let placement = Placement::translation(Vector3::new(0.0, 0.0, height));
        let (axis, limit) = match k % 2 {
            0 => (Vector3::new(0.0, 0.0, 1.0), 170.0_f64),
            _ => (Vector3::new(0.0, 1.0, 0.0), 120.0_f64),
        };
        let limits = Limits::new(-limit.to_radians(), limit.to_radians());
        parent = Some(builder.revolute(format!("joint {k}"), parent, placement, axis, limits));
    }
    let flange = Placement::translation(Vector3::new(0.0, 0.0, 0.05));
    builder.frame("flange", parent, flange);
    builder.build()
}

/// Problem with the flange pose of `POSED` as the target.
pub(crate) fn problem() -> Result<Problem, Box<dyn std::error::Error>> {
    let model = arm()?;
    let flange = model.frame("flange")?;
    let world_from_flange = placement_of_flange(&model, &POSED);
    let mut builder = Problem::builder(&model);
    builder.add(FramePose::new(flange, world_from_flange));
    let problem: Result<Problem, ProblemError> = builder.build();
    Ok(problem?)
}

/// Forward kinematics of the straight chain, written out as an independent check.
fn placement_of_flange(model: &Model, q: &[f64]) -> Placement<f64> {
    let mut world_from_joint = Placement::identity();
    for (joint, &angle) in model.joints().iter().zip(q) {
        let turn = kinopt::spatial::Matrix3::rotation(joint.axis, angle.sin_cos());
        world_from_joint =
            world_from_joint * joint.parent_from_joint * Placement::new(turn, Vector3::zero());
    }
    world_from_joint * Placement::translation(Vector3::new(0.0, 0.0, 0.05))
}

/// Prints a solution of argmin next to kinopt's Levenberg-Marquardt from the same start. Checks that both keep the
/// limits.
pub(crate) fn compare(
    name: &str,
    problem: &Problem,
    solution: &Solution,
) -> Result<(), Box<dyn std::error::Error>> {
    let ours = Solver::default().solve_once(problem, &START)?;
    println!(
        "{:24} {:>10} {:>12} {:>12} {:>6} {:>6} {:>6}  ends",
        "", "cost", "m", "rad", "iter", "r", "J,g"
    );
    for (name, solution) in [(name, solution), ("our levenberg-marquardt", &ours)] {
        let task = solution.tasks().next().ok_or("no task")?;
        println!(
            "{name:24} {:10.3e} {:12.3e} {:12.3e} {:6} {:6} {:6}  {}",
            solution.cost,
            task.position_error().unwrap_or(f64::NAN),
            task.orientation_error().unwrap_or(f64::NAN),
            solution.iterations,
            solution.counts.residuals,
            solution.counts.jacobians + solution.counts.gradients,
            solution.termination,
        );
        let limits = problem.lower().iter().zip(problem.upper());
        let mut within = solution.q.iter().zip(limits);
        assert!(within.all(|(q, (lower, upper))| lower <= q && q <= upper));
    }
    Ok(())
}
