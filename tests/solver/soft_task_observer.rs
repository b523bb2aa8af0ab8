//! Promise: an observer of soft tasks gets the length of each step.

use std::ops::ControlFlow;

use kinopt::solver::Iteration;
use kinopt::task::{Point, Posture};
use kinopt::{Problem, Solver, Workspace};
use support::{planar_arm, planar_tip};

#[test]
fn observed_step_lengths_are_exact() {
    let links = [1.0, 0.8, 0.6, 0.5];
    let model = planar_arm(&links, Some((-2.5, 2.5)));
    let start = [0.3, 0.6, -0.4, 0.5];
    let tip = model.frame("tip").unwrap();
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, planar_tip(&links, &start)));
    tasks.add(Posture::new(&model, &[1.0, -0.5, 1.2, -0.3]));
    let problem = tasks.build().unwrap();
    let mut seen: Vec<(usize, f64, Vec<f64>)> = Vec::new();
    let mut watch = |iteration: &Iteration<'_>| {
        seen.push((iteration.index, iteration.step, iteration.x.to_vec()));
        ControlFlow::Continue(())
    };
    let mut workspace = Workspace::new();
    Solver::default()
        .solve_observed(&problem, &start, &mut workspace, &mut watch)
        .unwrap();
    let mut steps = 0;
    for pair in seen.windows(2) {
        let (before, now) = (&pair[0], &pair[1]);
        if now.0 == before.0 + 1 {
            let moves = now.2.iter().zip(&before.2).map(|(a, b)| (a - b).abs());
            let longest = moves.fold(0.0, f64::max);
            steps += usize::from(longest > 0.0);
            assert!((now.1 - longest).abs() < 1e-12, "{}: {longest}", now.1);
        }
    }
    assert!(steps > 2, "{steps}");
}
