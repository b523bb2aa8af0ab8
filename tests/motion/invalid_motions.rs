//! Promise: an invalid motion problem is an error that names the fault, and limits hold at fixed ends.

use kinopt::model::{Limits, Model};
use kinopt::motion::trajectory::{
    Contact, MotionBound, MotionError, MotionProblem, MotionProblemBuilder, MotionSolver, RateCost,
};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Task};
use support::fault_tables::ExpectedError;

type AddTasks<'a> = &'a dyn Fn(&mut MotionProblemBuilder);

fn arm() -> Model {
    let mut builder = Model::builder("arm");
    let z = Vector3::UNITS[2];
    let link = Placement::translation(Vector3::UNITS[0]);
    let limits = Limits::new(-2.0, 2.0);
    let shoulder = builder.revolute("shoulder", None, Placement::identity(), z, limits);
    let elbow = builder.revolute("elbow", Some(shoulder), link, z, limits);
    builder.frame("tip", Some(elbow), link);
    builder.build().unwrap()
}

fn build_motion(
    model: &Model,
    frames: usize,
    ask: impl Fn(&mut MotionProblemBuilder),
) -> Result<MotionProblem, MotionError> {
    let mut motion = MotionProblem::builder(model, frames, 0.01);
    motion.add(Point::new(model.frame("tip").unwrap(), [1.0, 1.0, 0.0]));
    ask(&mut motion);
    motion.build()
}

#[test]
fn invalid_motions_are_named() {
    let model = arm();
    let tip = model.frame("tip").unwrap();
    let reported = |frames, ask: &dyn Fn(&mut MotionProblemBuilder)| {
        build_motion(&model, frames, ask).unwrap_err().to_string()
    };
    let jerk = RateCost::jerk(1.0).scale("wrist", 2.0);
    let backwards = RateCost::velocity(-1.0);
    let below = Task::new(Point::new(tip, [0.0; 3]))
        .named("gaze")
        .at_level(2);
    let wrong: [(AddTasks<'_>, &[&str]); 9] = [
        (
            &|motion| _ = motion.add(below.clone()),
            &["gaze", "level 2"],
        ),
        (
            &|motion| _ = motion.max_speed("wrist", 1.0),
            &["wrist", "elbow"],
        ),
        (
            &|motion| _ = motion.max_speed("elbow", 0.0),
            &["max_speed", "positive"],
        ),
        (
            &|motion| _ = motion.rate_cost(jerk.clone()),
            &["wrist", "elbow"],
        ),
        (&|motion| _ = motion.rate_cost(backwards.clone()), &["-1"]),
        (
            &|motion| _ = motion.first(&[3.0, 0.0]),
            &["shoulder", "3", "-2"],
        ),
        (&|motion| _ = motion.last(&[0.0]), &["1", "2"]),
        (
            &|motion| _ = motion.contact(Contact::new(tip, 1..9)),
            &["1 to 9", "3 frames"],
        ),
        (
            &|motion| _ = motion.contact(Contact::new(tip, 1..2)),
            &["1 to 2"],
        ),
    ];
    for (ask, words) in wrong {
        let reported = reported(3, ask);
        assert!(
            words.iter().all(|word| reported.contains(word)),
            "{reported}"
        );
    }
    // In the first task as in any other.
    let mut first = MotionProblem::builder(&model, 3, 0.01);
    first.add(below.clone().at_level(1));
    first.add(Point::new(tip, [1.0, 1.0, 0.0]));
    first.build().says("gaze");
    assert_eq!(
        reported(0, &|_| {}),
        "the trajectory has no frames: at least one is needed"
    );
    for (weights, words) in [(&[1.0][..], "instead of 2"), (&[1.0, f64::NAN], "frame 1")] {
        let reported = reported(2, &|motion| {
            let point = motion.add(Point::new(tip, [0.0; 3]));
            motion.weights(point, weights);
        });
        assert!(reported.contains(words), "{reported}");
    }
}

#[test]
fn fixed_ends_too_far_apart_are_an_error() {
    let model = arm();
    let fixed = |speed: f64| {
        let motion = build_motion(&model, 11, |motion| {
            motion
                .first(&[0.0, 0.0])
                .last(&[0.0, 1.0])
                .max_speed("elbow", speed);
            motion.rate_cost(RateCost::acceleration(1e-3));
        });
        MotionSolver::default().solve(&motion.unwrap(), &[0.0, 0.0])
    };
    assert_eq!(
        fixed(9.0).unwrap_err(),
        MotionError::TooFar {
            joint: "elbow".to_owned()
        }
    );
    let solved = fixed(10.5).unwrap();
    assert_eq!(solved.row(0).unwrap(), [0.0, 0.0]);
    assert_eq!(solved.row(10).unwrap(), [0.0, 1.0]);
    let speeds = |frame: usize| {
        solved
            .report
            .active_limits(frame)
            .any(|limit| limit.joint == "elbow" && limit.bound == MotionBound::Speed)
    };
    assert!((1..11).any(speeds));
    for pair in solved.rows().collect::<Vec<_>>().windows(2) {
        assert!((pair[1][1] - pair[0][1]).abs() / 0.01 <= 10.5);
    }
}

#[test]
fn targets_not_finite_are_reported_with_their_frame() {
    let model = arm();
    let tip = model.frame("tip").unwrap();
    let mut motion = MotionProblem::builder(&model, 5, 0.01);
    let point = motion.add(Point::new(tip, [1.0, 0.0, 0.0]));
    motion.follow(point, |frame, point| {
        let x = if frame == 3 { f64::NAN } else { 1.0 };
        point.set_target([x, 0.0, 0.0]);
    });
    let failed = MotionSolver::default().solve(&motion.build().unwrap(), &[0.1, 0.1]);
    assert_eq!(failed.unwrap_err(), MotionError::NotFinite { frame: 3 });
}

#[test]
fn single_frame_is_a_motion() {
    let model = arm();
    let motion = build_motion(&model, 1, |motion| {
        motion.rate_cost(RateCost::jerk(1.0));
    })
    .unwrap();
    let solved = MotionSolver::default().solve(&motion, &[0.1, 0.1]).unwrap();
    assert!(
        solved.report.cost() < 1e-12 && solved.report.reached(),
        "{}",
        solved.report.cost()
    );
}

/// The lowest of several velocity limits of a joint counts, in any order.
#[test]
fn lowest_of_several_velocity_limits_counts() {
    let model = arm();
    for speeds in [
        vec![0.5],
        vec![0.5, 2.0],
        vec![2.0, 0.5],
        vec![2.0, 0.5, 1.0],
    ] {
        let motion = build_motion(&model, 12, |motion| {
            for &speed in &speeds {
                motion.max_speed("shoulder", speed);
            }
            motion.first(&[1.5, 0.4]);
        });
        let motion = motion.unwrap();
        let solved = MotionSolver::default().solve(&motion, &[1.5, 0.4]).unwrap();
        let places: Vec<f64> = (0..12).map(|frame| solved.row(frame).unwrap()[0]).collect();
        let changes = places.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let largest = changes.fold(0.0, f64::max);
        assert!((largest - 0.005).abs() < 1e-6, "{speeds:?}: {largest}");
    }
}

/// A fixed end outside of a ball joint's cone, total angle or twist limits is an error.
#[test]
fn fixed_ball_joint_beyond_any_limit_is_an_error() {
    use kinopt::model::BallLimits;
    let limits = BallLimits::cone(0.8, Limits::new(-0.5, 0.7)).with_angle(0.9);
    let mut builder = Model::builder("ball");
    let x = Vector3::UNITS[0];
    let ball = builder.ball("hip", None, Placement::identity(), x, Some(limits));
    builder.frame("tip", Some(ball), Placement::translation(x));
    let model = builder.build().unwrap();
    let held = |turn: [f64; 3]| {
        let angle = turn.iter().map(|v| v * v).sum::<f64>().sqrt();
        let [a, b, c] = turn.map(|v| v * (0.5 * angle).sin() / angle.max(1e-12));
        build_motion(&model, 3, |motion| {
            motion.last(&[(0.5 * angle).cos(), a, b, c]);
        })
    };
    for within in [
        [0.69, 0.0, 0.0],
        [-0.49, 0.0, 0.0],
        [0.0, 0.79, 0.0],
        [0.0, 0.0, -0.79],
        [0.4, 0.5, 0.5],
    ] {
        assert!(held(within).is_ok(), "{within:?}");
    }
    for beyond in [
        [0.71, 0.0, 0.0],
        [-0.51, 0.0, 0.0],
        [0.0, 0.81, 0.0],
        [0.0, 0.0, -0.81],
        [0.6, 0.5, 0.5],
    ] {
        let error = held(beyond).unwrap_err();
        assert!(matches!(error, MotionError::FixedBeyond { .. }), "{error}");
    }
}
