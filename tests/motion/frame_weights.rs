//! Promise: a task with weight zero in a frame is not reported as unreached there, for any target. A weighted task is
//! reported for its frame, and counts there by its weight.

use crate::slide::{rail, slide};
use kinopt::ik::Side;
use kinopt::motion::trajectory::{MotionBound, MotionProblem, MotionSolver, RateCost};
use kinopt::task::{Point, Task};

const FRAMES: usize = 9;

#[test]
fn unweighted_frame_is_not_reported_as_unreached() {
    let (model, tool) = slide();
    // In the middle, two metres out of reach.
    let target_at = |frame: usize| if (3..6).contains(&frame) { 3.0 } else { 0.5 };
    for is_required in [false, true] {
        let mut motion = MotionProblem::builder(&model, FRAMES, 0.1);
        let task = motion.add(Point::new(tool, [0.0; 3]));
        motion.follow(task, move |frame, point| {
            point.set_target([target_at(frame), 0.0, 0.0])
        });
        let weight = |frame| f64::from(u8::from(is_required || target_at(frame) < 1.0));
        let weights: Vec<f64> = (0..FRAMES).map(weight).collect();
        motion.weights(task, &weights);
        motion.rate_cost(RateCost::acceleration(1e-6));
        let motion = motion.build().unwrap();
        let solved = MotionSolver::default().solve(&motion, &[0.0]).unwrap();
        assert_eq!(solved.report.reached(), !is_required);
        for frame in 0..FRAMES {
            let missed: Vec<f64> = solved.report.missed(frame).map(|miss| miss.error).collect();
            match is_required && target_at(frame) > 1.0 {
                true => assert!((missed[0] - 2.0).abs() < 1e-3, "{frame}: {missed:?}"),
                false if is_required => assert!(missed.iter().all(|error| *error < 1e-2)),
                false => assert!(missed.is_empty(), "{frame}: {missed:?}"),
            }
        }
    }
}

/// A single task is weighted as one among several.
#[test]
fn frame_weights_of_a_single_task_count() {
    let (model, tool) = slide();
    let solved = [false, true].map(|with_second| {
        let mut motion = MotionProblem::builder(&model, FRAMES, 0.1);
        if with_second {
            // With a negligible weight.
            motion.add(Task::new(Point::new(tool, [0.0; 3])).scale(1e-9));
        }
        let task = motion.add(Point::new(tool, [0.0; 3]));
        motion.follow(task, |frame, point| {
            point.set_target([if frame % 2 == 0 { -0.4 } else { 0.4 }, 0.0, 0.0])
        });
        let weights: Vec<f64> = (0..FRAMES).map(|k| 0.3 + 0.5 * (k % 4) as f64).collect();
        motion.weights(task, &weights);
        motion.rate_cost(RateCost::velocity(0.1));
        let motion = motion.build().unwrap();
        MotionSolver::default().solve(&motion, &[0.0]).unwrap()
    });
    let apart = solved[0].q.iter().zip(&solved[1].q);
    let apart = apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-6, "{apart} m");
}

/// A distant limit is active in no frame, however coarse the solver's tolerance is. A limit that is reached is active.
#[test]
fn distant_position_limit_is_inactive() {
    let (model, tool) = slide();
    let target_at = |frame: usize| if frame < 6 { 0.3 } else { 1.5 };
    for tolerance in [1e-2, 1e-4, 1e-7] {
        let mut motion = MotionProblem::builder(&model, 12, 0.1);
        let task = motion.add(Point::new(tool, [0.0; 3]));
        motion.follow(task, move |frame, point| {
            point.set_target([target_at(frame), 0.0, 0.0])
        });
        motion.rate_cost(RateCost::velocity(1e-4));
        let motion = motion.build().unwrap();
        let solver = MotionSolver::default().with_tolerance(tolerance);
        let solved = solver.solve(&motion, &[0.0]).unwrap();
        for frame in 0..12 {
            let held: Vec<Side> = solved
                .report
                .active_limits(frame)
                .map(|limit| limit.side)
                .collect();
            match frame < 6 {
                true => assert!(held.is_empty(), "{tolerance} {frame}: {held:?}"),
                false => assert_eq!(held, [Side::Upper], "{tolerance} {frame}"),
            }
        }
    }
}

/// A velocity limit that is not reached is inactive, however long the rail is. One that is reached is active.
#[test]
fn unreached_velocity_limit_is_inactive() {
    let (model, tool) = rail(1e3);
    for (step, held) in [(0.05, false), (0.15, true)] {
        for tolerance in [1e-3, 1e-5, 1e-7] {
            let mut motion = MotionProblem::builder(&model, 12, 0.1);
            let task = motion.add(Point::new(tool, [0.0; 3]));
            motion.follow(task, move |frame, point| {
                point.set_target([step * frame as f64, 0.0, 0.0])
            });
            motion.max_speed("slide", 1.0);
            motion.rate_cost(RateCost::velocity(1e-3));
            let motion = motion.build().unwrap();
            let solver = MotionSolver::default().with_tolerance(tolerance);
            let solved = solver.solve(&motion, &[0.0]).unwrap();
            // The last velocity may be lower, because no frame follows.
            for frame in 1..11 {
                let reported: Vec<_> = solved.report.active_limits(frame).collect();
                let speeds = reported.iter().map(|limit| (limit.bound, limit.side));
                let speeds: Vec<_> = speeds.collect();
                match held {
                    true => assert_eq!(speeds, [(MotionBound::Speed, Side::Upper)]),
                    false => assert!(speeds.is_empty(), "{tolerance} {frame}: {speeds:?}"),
                }
            }
        }
    }
}
