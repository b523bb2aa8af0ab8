//! FABRIK in space, pass by pass: a chain of five bones reaches for several points. FABRIK and cyclic coordinate
//! descent then solve the chain as a skeleton with ball joints, watched by an observer.
//!
//! `cargo run --example reaching`: FABRIK's error falls by a factor with every pass, slowly if the chain is nearly
//! stretched. For a target out of reach it falls to the remaining distance at once.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::ops::ControlFlow;

use kinopt::Problem;
use kinopt::geometric::{Ccd, Fabrik, Geometric, fabrik};
use kinopt::model::Limits;
use kinopt::skeleton::{Bone, Skeleton};
use kinopt::solver::Iteration;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Quantity, Task};

const LENGTHS: [f64; 5] = [1.0, 0.9, 0.8, 0.6, 0.4];
const TOLERANCE: f64 = 1e-3;

/// Chain at rest, along x.
fn chain() -> Vec<Vector3<f64>> {
    let mut at = 0.0;
    let mut points = vec![Vector3::zero()];
    for length in LENGTHS {
        at += length;
        points.push(Vector3::new(at, 0.0, 0.0));
    }
    points
}

/// The chain as bones with ball joints.
fn skeleton() -> Result<Skeleton, Box<dyn Error>> {
    let mut builder = Skeleton::builder("chain");
    let mut parent = None;
    for (k, (tail, length)) in chain().into_iter().zip(LENGTHS).enumerate() {
        parent = Some(builder.add(Bone {
            name: format!("bone {k}"),
            parent,
            length,
            model_from_rest: Placement::translation(tail),
            limits: [Limits::new(-3.1, 3.1); 3],
        }));
    }
    Ok(builder.build()?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let targets = [
        ("near", Vector3::new(0.8, 1.2, 1.0)),
        ("far", Vector3::new(-1.0, 2.4, 2.2)),
        ("out of reach", Vector3::new(0.0, 3.0, 4.0)),
    ];
    println!("the tip's distance from the target after each pass");
    for (name, target) in targets {
        let mut points = chain();
        let mut misses = vec![(points[LENGTHS.len()] - target).norm()];
        // One pass at a time; the points can be drawn between passes.
        while misses.len() <= 50 {
            let pass = fabrik(&mut points, target, TOLERANCE, 1);
            misses.push(pass.miss);
            if pass.miss <= TOLERANCE || pass.passes == 0 {
                break;
            }
        }
        let distances: Vec<String> = misses.iter().map(|miss| format!("{miss:.4}")).collect();
        println!("{name}: {}", distances.join(" "));
        for point in &points {
            println!("    ({:7.4}, {:7.4}, {:7.4})", point.x, point.y, point.z);
        }
    }

    let skeleton = skeleton()?;
    let tip = skeleton.tip(skeleton.bone("bone 4")?);
    let start = vec![0.05; skeleton.angles()];
    let solvers: [&dyn Geometric; 2] = [&Fabrik::default(), &Ccd::default()];
    for (name, target) in &targets[..2] {
        let mut tasks = Problem::builder(skeleton.model());
        tasks.add(Task::new(Point::new(tip, *target)).tolerance(Quantity::Metres, TOLERANCE));
        let problem = tasks.build()?;
        for solver in solvers {
            let mut misses = Vec::new();
            let mut watch = |iteration: &Iteration<'_>| {
                // The cost is half the squared distance.
                misses.push(format!("{:.4}", (2.0 * iteration.cost).sqrt()));
                ControlFlow::Continue(())
            };
            let solution = solver.solve_question((&problem).into(), &start, &mut watch)?;
            println!("{name}, {}: {}", solver.name(), misses.join(" "));
            println!(
                "    reached: {}, iterations: {}",
                solution.reached, solution.iterations
            );
        }
    }
    Ok(())
}
