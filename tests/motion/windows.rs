//! Promise: a long clip costs as much per frame as a short one, and in windows it moves as it does as a whole.

use kinopt::motion::clip::{MotionSolver, MotionTermination, Windows};

use crate::walker::Walker;

#[test]
fn windows_agree_with_the_whole_and_at_their_seams() {
    let walker = Walker::new();
    let motion = walker.swaying(70, None);
    let solver = MotionSolver::default().with_tolerance(1e-9);
    let whole = solver.solve(&motion, &walker.stance).unwrap();
    let windows = Windows {
        frames: 25,
        ahead: 30,
    };
    let cut = solver
        .with_windows(Some(windows))
        .solve(&motion, &walker.stance)
        .unwrap();
    for solved in [&whole, &cut] {
        assert_eq!(solved.termination(), MotionTermination::Stationary);
        for q in solved.q().chunks(motion.configuration_len()) {
            assert!(walker.model().is_within_limits(q));
        }
    }
    let apart = whole.q().iter().zip(cut.q()).map(|(a, b)| (a - b).abs());
    let apart = apart.fold(0.0, f64::max);
    assert!(apart < 1e-4, "{apart} rad apart");
    let dearer = cut.cost() / whole.cost() - 1.0;
    assert!(dearer.abs() < 1e-5, "{dearer:e}");
}

#[test]
fn work_grows_with_the_frames_and_no_faster() {
    let walker = Walker::new();
    let windows = Windows {
        frames: 20,
        ahead: 10,
    };
    let solver = MotionSolver::default()
        .with_tolerance(1e-4)
        .with_windows(Some(windows));
    let per_frame = [40, 200].map(|frames| {
        let solved = solver
            .solve(&walker.swaying(frames, None), &walker.stance)
            .unwrap();
        solved.counts().factored_frames as f64 / frames as f64
    });
    assert!(
        per_frame[1] < 1.3 * per_frame[0] + 1.0,
        "{per_frame:?} factorised a frame"
    );
}
