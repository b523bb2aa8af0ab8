//! Custom residuals: structs outside the library, written once over the scalar type. All their derivatives are exact,
//! without manual derivation.
//!
//! There are two residuals. A standing figure keeps its centre of mass over its foot, in two rows. Its hand stays on
//! a ring (a torus) in the air, in one row.
//!
//! `cargo run --release --example own_residual`
#![allow(clippy::print_stdout)]

use std::error::Error;

use kinopt::model::{FrameId, Limits, Model, ModelError};
use kinopt::problem::{Derivatives, Evaluation};
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Description, Inputs, Posture, Quantity, Residual, RowBlock, Task};
use kinopt::{Problem, Scalar, Solver};
use nalgebra::DMatrix;

/// Keeps a frame's origin on the surface of a torus around the vertical axis through `centre`: (√(x² + y²) − R)² + z²
/// = r². The residual is a distance, in metres.
#[derive(Clone)]
struct OnTorus {
    frame: FrameId,
    centre: Vector3<f64>,
    /// Distance of the tube's centre line from the centre, metres.
    ring: f64,
    /// Radius of the tube, metres.
    tube: f64,
}

impl Residual for OnTorus {
    fn inputs(&self) -> Inputs {
        Inputs::frames([self.frame])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        let Vector3 { x, y, z } = frames[0].translation - Vector3::constant(self.centre);
        let outwards = (x * x + y * y).sqrt() - S::constant(self.ring);
        residual[0] = (outwards * outwards + z * z).sqrt() - S::constant(self.tube);
    }

    fn description(&self) -> Description {
        Description::new("torus")
    }
}

/// Keeps the centre of mass of several frames above a point of the floor.
#[derive(Clone)]
struct Balance {
    /// Frames at the parts' centres of mass, and their masses in kilograms.
    parts: Vec<(FrameId, f64)>,
    /// Point on the floor, metres.
    support: [f64; 2],
}

impl Residual for Balance {
    fn inputs(&self) -> Inputs {
        Inputs::frames(self.parts.iter().map(|&(frame, _)| frame))
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 2)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        let total: f64 = self.parts.iter().map(|&(_, mass)| mass).sum();
        let mut centre = Vector3::zero();
        for (frame, &(_, mass)) in frames.iter().zip(&self.parts) {
            centre += frame.translation * S::constant(mass / total);
        }
        residual[0] = centre.x - S::constant(self.support[0]);
        residual[1] = centre.y - S::constant(self.support[1]);
    }

    fn description(&self) -> Description {
        Description::new("balance")
    }
}

/// Figure on one foot.
struct Figure {
    model: Model,
    hand: FrameId,
    /// Frames at the centres of mass, and masses in kilograms.
    parts: Vec<(FrameId, f64)>,
}

/// Ankle, knee, hip, shoulder and elbow; three of them rotate about two axes.
fn figure() -> Result<Figure, ModelError> {
    let mut builder = Model::builder("figure");
    let (x, y) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 0.0));
    let up = |height| Placement::translation(Vector3::new(0.0, 0.0, height));
    let limits = Limits::new(-1.2, 1.2);

    let ankle_roll = builder.revolute("ankle roll", None, up(0.08), x, Limits::new(-0.4, 0.4));
    let ankle = builder.revolute(
        "ankle",
        Some(ankle_roll),
        up(0.0),
        y,
        Limits::new(-0.6, 0.6),
    );
    let knee = builder.revolute("knee", Some(ankle), up(0.42), y, Limits::new(-2.2, 0.0));
    let hip_roll = builder.revolute("hip roll", Some(knee), up(0.42), x, limits);
    let hip = builder.revolute("hip", Some(hip_roll), up(0.0), y, limits);
    let shoulder = Placement::translation(Vector3::new(0.0, 0.2, 0.5));
    let shoulder_roll = builder.revolute("shoulder roll", Some(hip), shoulder, x, limits);
    let shoulder = builder.revolute("shoulder", Some(shoulder_roll), up(0.0), y, limits);
    let elbow = builder.revolute("elbow", Some(shoulder), up(0.3), y, Limits::new(0.0, 2.4));

    let parts = vec![
        (builder.frame("shank", Some(ankle), up(0.25)), 8.0),
        (builder.frame("thigh", Some(knee), up(0.25)), 14.0),
        (builder.frame("trunk", Some(hip), up(0.3)), 45.0),
        (builder.frame("upper arm", Some(shoulder), up(0.15)), 4.0),
        (builder.frame("forearm", Some(elbow), up(0.12)), 3.0),
    ];
    let hand = builder.frame("hand", Some(elbow), up(0.3));
    let model = builder.build()?;
    Ok(Figure { model, hand, parts })
}

/// Largest difference between the Jacobians at `x` by two derivative modes.
fn disagreement(problem: &Problem, x: &[f64], one: Derivatives, other: Derivatives) -> f64 {
    let mut scratch = problem.scratch();
    let mut jacobian = |route| {
        let problem = problem.clone().with_derivatives(route);
        let mut jacobian = DMatrix::zeros(problem.rows(), problem.variables());
        Evaluation::new(&problem, &mut scratch).jacobian(x, &mut jacobian);
        jacobian
    };
    (jacobian(one) - jacobian(other)).amax()
}

fn main() -> Result<(), Box<dyn Error>> {
    let Figure { model, hand, parts } = figure()?;
    let start = vec![0.05, 0.1, -0.3, 0.0, 0.3, 0.2, 0.5, 0.8];

    let mut builder = Problem::builder(&model);
    let ring = OnTorus {
        frame: hand,
        centre: Vector3::new(0.35, 0.3, 1.3),
        ring: 0.2,
        tube: 0.05,
    };
    let support = [0.0, 0.0];
    builder.add(Task::new(ring).named("hand on the ring"));
    builder.add(Task::new(Balance { parts, support }).named("balance over the foot"));
    builder.add(Task::new(Posture::new(&model, &start)).weight(Quantity::JointUnits, 1e-4));
    let problem = builder.build()?;

    // Exact derivatives agree to rounding, and finite differences to their accuracy.
    let routes = [
        (Derivatives::Dual, 1e-13),
        (Derivatives::CentralDifference, 1e-9),
        (Derivatives::ForwardDifference, 1e-6),
    ];
    for (route, within) in routes {
        let difference = disagreement(&problem, &start, Derivatives::Analytic, route);
        println!("analytic and {route:?} Jacobians differ by {difference:.1e}");
        assert!(difference < within);
    }

    let solution = Solver::default().solve_once(&problem, &start)?;
    println!("{}", solution.explain());
    for task in solution.tasks() {
        let error = task
            .position_error()
            .map_or(String::new(), |m| format!(": {m:.1e} m"));
        println!("  {}{error}", task.name);
    }
    assert!(solution.reached);

    // The target is out of reach: the foot is fixed.
    let Figure { model, hand, parts } = figure()?;
    let mut builder = Problem::builder(&model);
    let unreachable = OnTorus {
        frame: hand,
        centre: Vector3::new(1.6, 0.0, 0.4),
        ring: 0.2,
        tube: 0.05,
    };
    builder.add(Task::new(unreachable).named("hand on the far ring"));
    builder.add(Task::new(Balance { parts, support }).named("balance over the foot"));
    let solution = Solver::default().solve_once(&builder.build()?, &start)?;
    println!("{}", solution.explain());
    assert!(!solution.reached);
    for (joint, q) in model.limits().zip(&solution.q) {
        assert!(joint.contains(*q));
    }
    Ok(())
}
