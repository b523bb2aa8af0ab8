//! Promise: a window of a clip continues from the frames kept of the previous one. Costs of positions, velocities and
//! accelerations across the seam count in it, according to the normal equations of its frames.

use kinopt::model::{Limits, Model};
use kinopt::motion::trajectory::{
    MotionProblem, MotionSolver, MotionTermination, RateCost, Windows,
};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use nalgebra::{DMatrix, DVector};

const FRAMES: usize = 40;
const TIME_STEP_S: f64 = 0.1;

/// Target: outwards for some frames and back for the rest, in metres.
fn target(frame: usize) -> f64 {
    if (8..13).contains(&frame) { 0.8 } else { 0.0 }
}

/// A prismatic joint that follows this target, with a cost of differences of an order.
fn motion(order: usize, weight: f64) -> MotionProblem {
    let mut builder = Model::builder("slide");
    let limits = Limits::new(-5.0, 5.0);
    let x = Vector3::UNITS[0];
    let slide = builder.prismatic("slide", None, Placement::identity(), x, limits);
    let tip = builder.frame("tip", Some(slide), Placement::identity());
    let model = builder.build().unwrap();
    let mut motion = MotionProblem::builder(&model, FRAMES, TIME_STEP_S);
    let point = motion.add(Point::new(tip, Vector3::zero()));
    motion.follow(point, |frame, point| {
        point.set_target(Vector3::UNITS[0] * target(frame))
    });
    motion.rate_cost(match order {
        1 => RateCost::velocity(weight),
        2 => RateCost::acceleration(weight),
        _ => RateCost::jerk(weight),
    });
    motion.build().unwrap()
}

/// Minimum of ½ Σ (x − target)² + ½ Σ (w Δᵏx / Δtᵏ)² over the frames from `begin` to `end`. Those before `begin` are
/// given.
fn least_squares_window(
    x: &[f64],
    begin: usize,
    end: usize,
    order: usize,
    weight: f64,
) -> DVector<f64> {
    let coefficients: &[f64] =
        [&[-1.0, 1.0][..], &[1.0, -2.0, 1.0], &[-1.0, 3.0, -3.0, 1.0]][order - 1];
    let w = weight / TIME_STEP_S.powi(order as i32);
    let n = end - begin;
    let (mut normal, mut right) = (DMatrix::identity(n, n), DVector::zeros(n));
    for k in 0..n {
        right[k] = target(begin + k);
    }
    for first in begin.saturating_sub(order)..end - order {
        let frames = || {
            coefficients
                .iter()
                .enumerate()
                .map(|(k, by)| (first + k, w * by))
        };
        for (frame, by) in frames().filter(|(frame, _)| *frame >= begin) {
            for (other, with) in frames() {
                match other.checked_sub(begin) {
                    Some(free) => normal[(frame - begin, free)] += by * with,
                    None => right[frame - begin] -= by * with * x[other],
                }
            }
        }
    }
    normal.lu().solve(&right).unwrap()
}

#[test]
fn windows_continue_from_the_kept_frames() {
    let (frames, ahead) = (10, 4);
    for (order, weight) in [(1, 0.3), (2, 0.05), (3, 0.01)] {
        let motion = motion(order, weight);
        let solver = MotionSolver::default().with_tolerance(1e-12);
        let whole = solver.solve(&motion, &[0.0]).unwrap();
        let expected = least_squares_window(&[], 0, FRAMES, order, weight);
        let deviation_of = |ours: &[f64], theirs: &[f64]| {
            let apart = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs());
            apart.fold(0.0, f64::max)
        };
        assert!(
            deviation_of(&whole.q, expected.as_slice()) < 1e-6,
            "order {order}"
        );

        let mut expected = vec![0.0; FRAMES];
        let mut begin = 0;
        while begin < FRAMES {
            let end = (begin + frames + ahead).min(FRAMES);
            let window = least_squares_window(&expected, begin, end, order, weight);
            expected[begin..end].copy_from_slice(window.as_slice());
            begin = if end == FRAMES { end } else { begin + frames };
        }
        // Without an effect of the seams it would be another motion.
        assert!(deviation_of(&expected, &whole.q) > 1e-3, "order {order}");
        let cut = solver.with_windows(Some(Windows::new(frames, ahead)));
        let cut = cut.solve(&motion, &[0.0]).unwrap();
        assert_eq!(cut.report.termination(), MotionTermination::Stationary);
        let deviation_of = deviation_of(&cut.q, &expected);
        assert!(deviation_of < 1e-6, "order {order}: off by {deviation_of}");
    }
}
