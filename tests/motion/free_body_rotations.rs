//! Promise: a free joint rotates smoothly through one turn and more, without singularities.

use kinopt::model::{Limits, Model};
use kinopt::motion::trajectory::{MotionProblem, MotionSolver, RateCost};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::FramePose;

#[test]
fn body_rotating_twice_follows_without_a_jump() {
    let mut builder = Model::builder("body");
    let base = builder.free("base", None, Placement::identity(), [Limits::UNBOUNDED; 3]);
    let frame = builder.frame("body", Some(base), Placement::identity());
    let model = builder.build().unwrap();
    let frames = 120;
    let at = move |frame: usize| {
        let turns = frame as f64 / frames as f64 * 4.0 * std::f64::consts::PI;
        let turned = rotation_exp(Vector3::new(0.05, 0.03, 1.0) * turns);
        Placement::new(turned, Vector3::new(turns.cos(), turns.sin(), 1.0))
    };
    for order in 1..=3 {
        let mut motion = MotionProblem::builder(&model, frames, 1.0 / 60.0);
        let follow = motion.add(FramePose::new(frame, at(0)));
        motion.follow(follow, move |frame, pose| pose.set_target(at(frame)));
        motion.rate_cost(match order {
            1 => RateCost::velocity(1e-3),
            2 => RateCost::acceleration(1e-4),
            _ => RateCost::jerk(1e-5),
        });
        motion.max_speed("base/x", 30.0);
        let motion = motion.build().unwrap();
        let solved = MotionSolver::default()
            .solve(&motion, &model.neutral())
            .unwrap();
        let expected = 4.0 * std::f64::consts::PI / frames as f64;
        let mut step = [0.0; 6];
        for pair in 0..frames - 1 {
            let [from, to] = [pair, pair + 1].map(|k| solved.row(k).unwrap());
            model.difference(from, to, &mut step).unwrap();
            let turned = Vector3::new(step[3], step[4], step[5]).norm();
            assert!(
                (turned - expected).abs() < 0.1 * expected,
                "order {order}, frame {pair}: {turned}"
            );
        }
    }
}
