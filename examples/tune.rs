//! scratch
#[path = "../benches/support/mod.rs"]
mod support;
use kinopt::ik::Restarts;
use kinopt::solver::*;
use kinopt::task::{Point, Quantity};
use kinopt::{Problem, Solver, Workspace};
use std::time::Instant;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problems = 5000;
    let (skeleton, tips) = support::figure(2, 4);
    let size = skeleton.size();
    let mut builder = Problem::builder(skeleton.model());
    let tasks: Vec<_> = tips
        .iter()
        .map(|&tip| builder.add(Point::new(skeleton.tip(tip), [0.0; 3])))
        .collect();
    builder.tolerance(Quantity::Metres, 1e-8 * size);
    let mut problem = builder.build()?;
    let mut random = support::Sequence::new(0.5);
    let limits: Vec<_> = skeleton.model().limits().collect();
    let targets: Vec<Vec<_>> = (0..problems)
        .map(|_| {
            let q: Vec<f64> = limits
                .iter()
                .map(|l| l.lower + (l.upper - l.lower) * random.unit())
                .collect();
            let pose = skeleton.pose(&q);
            tips.iter().map(|&tip| pose.tip(&skeleton, tip)).collect()
        })
        .collect();
    let rest = skeleton.model().neutral();
    let mut workspace = Workspace::new();
    let powerless: Vec<bool> = {
        let mut scratch = problem.scratch();
        let mut ev = kinopt::problem::Evaluation::new(&problem, &mut scratch);
        let n = problem.variables();
        let mut j0 = nalgebra::DMatrix::zeros(problem.rows(), n);
        let mut j1 = j0.clone();
        let mut x = vec![0.0; n];
        problem.parameters().reduce(&rest, &mut x);
        ev.jacobian(&x, &mut j0);
        let mut r2 = support::Sequence::new(0.35);
        for k in 0..n {
            x[k] = problem.lower()[k] + (problem.upper()[k] - problem.lower()[k]) * r2.unit();
        }
        ev.jacobian(&x, &mut j1);
        let mut p = vec![false; rest.len()];
        for k in 0..n {
            if j0.column(k).norm() < 1e-9 && j1.column(k).norm() > 1e-9 {
                p[problem.parameters().leaders()[k]] = true;
            }
        }
        println!("powerless {}", p.iter().filter(|b| **b).count());
        p
    };
    for only in [false] {
        for nudge in [0.15] {
            for patience in [Some(10)] {
                let solver = Solver::new(LevenbergMarquardt::default())
                    .with_restarts(Restarts::none())
                    .with_stopping(Stopping::default().with_patience(patience));
                let (mut solved, mut steps, mut ssteps) = (0, 0, 0);
                let mut r2 = support::Sequence::new(0.25);
                let t = Instant::now();
                for target in &targets {
                    for (&task, &at) in tasks.iter().zip(target) {
                        problem.residual_mut(task).ok_or("x")?.set_target(at);
                    }
                    let start: Vec<f64> = rest
                        .iter()
                        .zip(&limits)
                        .zip(&powerless)
                        .map(|((r, l), p)| {
                            r + if only && !p { 0.0 } else { nudge }
                                * (l.lower + (l.upper - l.lower) * r2.unit() - r)
                        })
                        .collect();
                    let solution = solver.solve(&problem, &start, &mut workspace)?;
                    if solution.reached {
                        solved += 1;
                        ssteps += solution.iterations;
                    }
                    steps += solution.iterations;
                }
                println!(
                    "only {only} nudge {nudge} patience {patience:?}: solved {:.1}% steps {:.1}, of solved {:.1}, us/step {:.2}",
                    solved as f64 * 0.02,
                    steps as f64 / 5000.0,
                    ssteps as f64 / solved.max(1) as f64,
                    t.elapsed().as_secs_f64() * 1e6 / steps as f64
                );
            }
        }
    }
    Ok(())
}
