//! Promise: a long clip costs as much per frame as a short one, and its motion in windows is that of the whole.

use crate::slide::slide;
use kinopt::motion::trajectory::{
    MotionProblem, MotionSolver, MotionTermination, RateCost, Windows,
};
use kinopt::task::Point;

use crate::walker::Walker;

#[test]
fn windows_agree_with_the_whole_and_at_their_seams() {
    let walker = Walker::new();
    let motion = walker.swaying(70, None);
    let solver = MotionSolver::default().with_tolerance(1e-9);
    let whole = solver.solve(&motion, &walker.stance).unwrap();
    let windows = Windows::new(25, 30);
    let cut = solver
        .with_windows(Some(windows))
        .solve(&motion, &walker.stance)
        .unwrap();
    for solved in [&whole, &cut] {
        assert_eq!(solved.report.termination(), MotionTermination::Stationary);
        for q in solved.rows() {
            assert!(walker.model().is_within_limits(q));
        }
    }
    let apart = whole.q.iter().zip(&cut.q).map(|(a, b)| (a - b).abs());
    let apart = apart.fold(0.0, f64::max);
    assert!(apart < 1e-4, "{apart} rad apart");
    let dearer = cut.report.cost() / whole.report.cost() - 1.0;
    assert!(dearer.abs() < 1e-5, "{dearer:e}");
}

#[test]
fn work_grows_linearly_with_the_frames() {
    let walker = Walker::new();
    let windows = Windows::new(20, 10);
    let solver = MotionSolver::default()
        .with_tolerance(1e-4)
        .with_windows(Some(windows));
    let per_frame = [40, 200].map(|frames| {
        let solved = solver
            .solve(&walker.swaying(frames, None), &walker.stance)
            .unwrap();
        solved.report.counts().factored_frames as f64 / frames as f64
    });
    assert!(
        per_frame[1] < 1.3 * per_frame[0] + 1.0,
        "{per_frame:?} factorised a frame"
    );
}

/// Among windows with different terminations, one that did not converge counts, at any position.
#[test]
fn unconverged_window_is_reported() {
    let (model, tool) = slide();
    // Back and forth beyond the limits at first, then still.
    let to_and_fro = |frames: usize| {
        let mut motion = MotionProblem::builder(&model, frames, 0.1);
        let task = motion.add(Point::new(tool, [0.0; 3]));
        motion.follow(task, |frame, point| {
            let x = if frame < 10 {
                1.5 * (frame as f64 * 2.0).sin()
            } else {
                0.0
            };
            point.set_target([x, 0.0, 0.0]);
        });
        motion.rate_cost(RateCost::acceleration(1e-3));
        motion.build().unwrap()
    };
    let windows = Windows::new(12, 3);
    let (first, all) = (to_and_fro(15), to_and_fro(60));
    let mut cut = 0;
    for limit in 1..30 {
        let solver = MotionSolver::default().with_max_iterations(limit);
        let alone = solver.solve(&first, &[0.0]).unwrap().report.termination();
        let solver = solver.with_windows(Some(windows));
        let reported = solver.solve(&all, &[0.0]).unwrap().report.termination();
        if alone == MotionTermination::IterationLimit {
            cut += 1;
            assert_eq!(reported, MotionTermination::IterationLimit, "{limit}");
        }
    }
    assert!(cut > 5, "{cut}");
}
