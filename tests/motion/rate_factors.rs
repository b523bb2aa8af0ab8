//! Promise: a joint's factor in a rate cost affects only that joint, and counts like a weight.

use kinopt::model::{FrameId, Limits, Model};
use kinopt::motion::trajectory::{MotionProblem, MotionSolver, RateCost};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::Orientation;

const FRAMES: usize = 12;

/// A revolute joint and a ball joint that are not connected, each with a frame.
fn two_apart() -> (Model, [FrameId; 2]) {
    let mut builder = Model::builder("two apart");
    let z = Vector3::UNITS[2];
    let hinge = builder.revolute(
        "hinge",
        None,
        Placement::identity(),
        z,
        Limits::new(-2.0, 2.0),
    );
    let ball = builder.ball("ball", None, Placement::identity(), z, None);
    let frames = [("lid", hinge), ("head", ball)];
    let frames = frames.map(|(name, on)| builder.frame(name, Some(on), Placement::identity()));
    (builder.build().unwrap(), frames)
}

/// Final configurations and cost of joints that should rotate back and forth under a cost of rates.
fn followed(cost: RateCost) -> (Vec<Vec<f64>>, f64) {
    let (model, frames) = two_apart();
    let mut motion = MotionProblem::builder(&model, FRAMES, 0.1);
    for (frame, axis) in frames.into_iter().zip([[0.0, 0.0, 1.0], [0.5, 0.4, 0.3]]) {
        let at = move |frame: usize| {
            let angle = (frame as f64 * 1.3).sin();
            rotation_exp(Vector3::from(axis) * angle)
        };
        let task = motion.add(Orientation::new(frame, at(0)));
        motion.follow(task, move |frame, point| point.set_target(at(frame)));
    }
    motion.rate_cost(cost);
    let motion = motion.build().unwrap();
    let solved = MotionSolver::default();
    let solved = solved.solve(&motion, &model.neutral()).unwrap();
    let frames = (0..FRAMES).map(|frame| solved.row(frame).unwrap().to_vec());
    (frames.collect(), solved.report.cost_of_rates())
}

/// Largest difference of some coordinates in any frame.
fn largest_difference(a: &[Vec<f64>], b: &[Vec<f64>], coordinates: std::ops::Range<usize>) -> f64 {
    let rows = a.iter().zip(b);
    let pairs = rows.flat_map(|(a, b)| coordinates.clone().map(|k| (a[k] - b[k]).abs()));
    pairs.fold(0.0, f64::max)
}

#[test]
fn factor_affects_only_its_joint() {
    let (hinge, ball) = (0..1, 1..5);
    let make: [fn(f64) -> RateCost; 3] =
        [RateCost::velocity, RateCost::acceleration, RateCost::jerk];
    for (make, weight) in make.into_iter().zip([0.05, 0.005, 0.0005]) {
        let [(plain, _), (strong, cost)] =
            [weight, 3.0 * weight].map(|weight| followed(make(weight)));
        let apart = [&hinge, &ball].map(|joint| largest_difference(&plain, &strong, joint.clone()));
        assert!(apart.iter().all(|apart| *apart > 1e-2), "{apart:?}");
        for (name, kind_range, other) in [("hinge", &hinge, &ball), ("ball", &ball, &hinge)] {
            let (mixed, _) = followed(make(weight).scale(name, 3.0));
            let [difference, other] = [
                largest_difference(&mixed, &strong, kind_range.clone()),
                largest_difference(&mixed, &plain, other.clone()),
            ];
            assert!(
                difference < 1e-6 && other < 1e-6,
                "{name}: {difference} {other}"
            );
        }
        let both = make(weight).scale("hinge", 3.0).scale("ball", 3.0);
        let (_, reported) = followed(both);
        assert!((reported - cost).abs() < 1e-6 * cost, "{reported} {cost}");
    }
}
