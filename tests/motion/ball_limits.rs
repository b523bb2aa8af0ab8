//! Promise: ball joints and free joints keep their cones, twist limits, total angles and velocity limits in every frame
//! of a motion. The test checks their quaternions. The joints reach the same minima as revolute and prismatic joints
//! with equal limits.

use kinopt::model::{BallLimits, FrameId, JointId, Limits, Model, ModelBuilder, ParameterMap};
use kinopt::motion::Trajectory;
use kinopt::motion::trajectory::{
    MotionBound, MotionError, MotionProblem, MotionProblemBuilder, MotionReport, MotionSolver,
    MotionTermination, RateCost, Windows,
};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use kinopt::task::{FramePose, Point};

const STEP: f64 = 1.0 / 30.0;
const FRAMES: usize = 40;

/// w, x, y, z.
type Quaternion = [f64; 4];

/// Rotation from one quaternion to the other in the rotated axes, with w ≥ 0.
fn between(a: Quaternion, b: Quaternion) -> Quaternion {
    let [w, x, y, z] = [a[0], -a[1], -a[2], -a[3]];
    let [v, p, q, r] = b;
    let components = [
        w * v - x * p - y * q - z * r,
        w * p + x * v + y * r - z * q,
        w * q - x * r + y * v + z * p,
        w * r + x * q - y * p + z * v,
    ];
    components.map(|part| if components[0] < 0.0 { -part } else { part })
}

fn angle(turn: Quaternion) -> f64 {
    let [w, x, y, z] = turn;
    2.0 * (x * x + y * y + z * z).sqrt().atan2(w.abs())
}

fn quaternion(q: &[f64], at: usize) -> Quaternion {
    [0, 1, 2, 3].map(|k| q[at + k])
}

/// Swing about y and z in radians, and the twist about x, of a rotation R = swing · twist.
fn parts(q: Quaternion) -> [f64; 3] {
    let [w, x, y, z] = if q[0] < 0.0 { q.map(|part| -part) } else { q };
    let twist = 2.0 * x.atan2(w);
    let length = w.hypot(x);
    let (c, s) = (w / length, x / length);
    // swing = R · twist⁻¹.
    let (sy, sz) = (y * c - z * s, z * c + y * s);
    let sin = sy.hypot(sz);
    let swing = 2.0 * sin.atan2(length);
    match sin > 0.0 {
        true => [swing * sy / sin, swing * sz / sin, twist],
        false => [0.0, 0.0, twist],
    }
}

/// One joint with one frame at a distance of a metre along x and another across.
fn single_joint(add: impl Fn(&mut ModelBuilder) -> JointId) -> (Model, [FrameId; 2]) {
    let mut builder = Model::builder("one joint");
    let joint = add(&mut builder);
    let tip = builder.frame(
        "tip",
        Some(joint),
        Placement::translation(Vector3::UNITS[0]),
    );
    let side = builder.frame(
        "side",
        Some(joint),
        Placement::translation(Vector3::UNITS[1]),
    );
    (builder.build().unwrap(), [tip, side])
}

fn ball(limits: Option<BallLimits>) -> (Model, [FrameId; 2]) {
    let x = Vector3::UNITS[0];
    single_joint(move |builder| builder.ball("hip", None, Placement::identity(), x, limits))
}

fn hinge(limits: Limits) -> (Model, [FrameId; 2]) {
    let z = Vector3::UNITS[2];
    single_joint(move |builder| builder.revolute("hip", None, Placement::identity(), z, limits))
}

/// A motion whose frames follow a rotation smoothly.
fn following(
    (model, frames): &(Model, [FrameId; 2]),
    count: usize,
    turn: impl Fn(usize) -> Vector3<f64> + Send + Sync + Copy + 'static,
    limit: impl Fn(&mut MotionProblemBuilder),
) -> Result<MotionProblem, MotionError> {
    let mut motion = MotionProblem::builder(model, count, STEP);
    for (frame, at) in frames.iter().zip(Vector3::UNITS) {
        let point = motion.add(Point::new(*frame, at));
        motion.follow(point, move |frame, point| {
            point.set_target(rotation_exp(turn(frame)) * at);
        });
    }
    motion.rate_cost(RateCost::acceleration(1e-4));
    limit(&mut motion);
    motion.build()
}

fn solved(motion: &MotionProblem, start: &[f64]) -> Trajectory<MotionReport> {
    let solved = MotionSolver::default().solve(motion, start).unwrap();
    assert_eq!(
        solved.report.termination(),
        MotionTermination::Stationary,
        "{} iterations",
        solved.report.iterations()
    );
    solved
}

fn assert_equal_cost(a: &Trajectory<MotionReport>, b: &Trajectory<MotionReport>) {
    assert!(
        (a.report.cost() / b.report.cost() - 1.0).abs() < 1e-6,
        "{} and {}",
        a.report.cost(),
        b.report.cost()
    );
}

/// Largest rotation between consecutive frames.
fn fastest(solved: &Trajectory<MotionReport>, at: usize) -> f64 {
    let frames: Vec<_> = (0..solved.rows().len())
        .map(|frame| quaternion(solved.row(frame).unwrap(), at))
        .collect();
    frames
        .windows(2)
        .map(|pair| angle(between(pair[0], pair[1])))
        .fold(0.0, f64::max)
}

fn turn_about_z(frame: usize) -> Vector3<f64> {
    Vector3::new(0.0, 0.0, if frame < FRAMES / 2 { -0.4 } else { 1.1 })
}

#[test]
fn ball_joint_keeps_velocity_limits_like_a_revolute() {
    let fast = |motion: &mut MotionProblemBuilder| _ = motion.max_speed("hip", 2.5);
    let (ball, hinge) = (ball(None), hinge(Limits::new(-3.0, 3.0)));
    let of_ball = following(&ball, FRAMES, turn_about_z, fast).unwrap();
    let of_ball = solved(&of_ball, &ball.0.neutral());
    let of_hinge = following(&hinge, FRAMES, turn_about_z, fast).unwrap();
    let of_hinge = solved(&of_hinge, &[0.0]);
    assert_equal_cost(&of_ball, &of_hinge);
    let fastest = fastest(&of_ball, 0);
    assert!(fastest <= 2.5 * STEP && fastest > 2.49 * STEP, "{fastest}");
    let held = (0..FRAMES).flat_map(|frame| of_ball.report.active_limits(frame));
    let held: Vec<_> = held.map(|limit| (limit.joint, limit.bound)).collect();
    assert!(
        !held.is_empty()
            && held
                .iter()
                .all(|limit| *limit == ("hip", MotionBound::Speed)),
        "{held:?}"
    );
}

/// A free joint that follows positions and orientations.
fn free_body(
    target_at: impl Fn(usize) -> Placement<f64> + Send + Sync + 'static,
    limit: impl Fn(&mut MotionProblemBuilder),
) -> (Model, MotionProblem) {
    let mut builder = Model::builder("body");
    let base = builder.free("base", None, Placement::identity(), [Limits::UNBOUNDED; 3]);
    let frame = builder.frame("body", Some(base), Placement::identity());
    let model = builder.build().unwrap();
    let mut motion = MotionProblem::builder(&model, FRAMES, STEP);
    let follow = motion.add(FramePose::new(frame, target_at(0)));
    motion.follow(follow, move |frame, pose| pose.set_target(target_at(frame)));
    motion.rate_cost(RateCost::acceleration(1e-3));
    limit(&mut motion);
    let motion = motion.build().unwrap();
    (model, motion)
}

#[test]
fn free_joint_keeps_velocity_limits_in_any_direction() {
    let jump = |frame: usize| {
        let by = if frame < FRAMES / 2 { -1.0 } else { 1.0 };
        let turned = rotation_exp(Vector3::new(0.3, -0.5, 0.4) * by);
        Placement::new(turned, Vector3::new(0.4 * by, 0.3 * by, -0.1))
    };
    let (model, motion) = free_body(jump, |motion| _ = motion.max_free_speed("base", 0.9, 1.4));
    for solver in [
        MotionSolver::default(),
        MotionSolver::default().with_windows(Some(Windows::new(15, 10))),
    ] {
        let solved = solver.solve(&motion, &model.neutral()).unwrap();
        assert_eq!(solved.report.termination(), MotionTermination::Stationary);
        let mut fastest_slide = 0.0_f64;
        for pair in solved.rows().collect::<Vec<_>>().windows(2) {
            let by = [0, 1, 2].map(|k| pair[1][k] - pair[0][k]);
            fastest_slide = fastest_slide.max(by.iter().map(|by| by * by).sum::<f64>().sqrt());
        }
        let fastest = fastest(&solved, 3);
        assert!(fastest <= 1.4 * STEP && fastest > 1.39 * STEP, "{fastest}");
        assert!(
            fastest_slide <= 0.9 * STEP && fastest_slide > 0.89 * STEP,
            "{fastest_slide}"
        );
        let held = |name| {
            (0..FRAMES).any(|frame| {
                solved
                    .report
                    .active_limits(frame)
                    .any(|active| active.joint == name)
            })
        };
        assert!(held("base/x") && held("base/rotation"));
        // Each limit once, although windows overlap.
        for frame in 0..FRAMES {
            let reported = solved.report.active_limits(frame);
            let reported: Vec<_> = reported
                .map(|active| (active.joint, active.bound, active.side))
                .collect();
            for (k, active) in reported.iter().enumerate() {
                assert!(
                    !reported[..k].contains(active),
                    "frame {frame}: {reported:?}"
                );
            }
        }
    }
}

/// For coupled prismatic joints the total displacement counts: with half of x along y it is √5 / 2 of that along x.
#[test]
fn coupled_free_joint_keeps_its_velocity_limit() {
    let mut builder = Model::builder("body");
    let base = builder.free("base", None, Placement::identity(), [Limits::UNBOUNDED; 3]);
    let frame = builder.frame("body", Some(base), Placement::identity());
    let model = builder.build().unwrap();
    let [x, y] = ["base/x", "base/y"].map(|name| model.joint(name).unwrap());
    let mut motion = MotionProblem::builder(&model, FRAMES, STEP);
    let map = ParameterMap::builder(&model).with_coupled(y, x, 0.5, 0.0);
    motion.parameters(map.build().unwrap());
    let point = motion.add(Point::new(frame, [0.0; 3]));
    motion.follow(point, |frame, point| {
        let along = if frame < FRAMES / 2 { -0.5 } else { 0.5 };
        point.set_target(Vector3::new(along, 0.5 * along, 0.0));
    });
    motion.rate_cost(RateCost::acceleration(1e-3));
    motion.max_free_speed("base", 0.9, 3.0);
    let solved = solved(&motion.build().unwrap(), &model.neutral());
    let rows: Vec<&[f64]> = solved.rows().collect();
    let steps = rows.windows(2).map(|pair| {
        let [a, b] = [0, 1].map(|k| pair[1][k] - pair[0][k]);
        a.hypot(b)
    });
    let fastest = steps.fold(0.0, f64::max);
    assert!(fastest <= 0.9 * STEP && fastest > 0.89 * STEP, "{fastest}");
}

#[test]
fn free_and_axis_velocity_limits_have_equal_minima() {
    let jump = |frame: usize| {
        Placement::translation(Vector3::new(
            if frame < FRAMES / 2 { -0.5 } else { 0.5 },
            0.0,
            0.0,
        ))
    };
    let costs = [
        free_body(jump, |motion| _ = motion.max_free_speed("base", 0.9, 3.0)),
        free_body(jump, |motion| _ = motion.max_speed("base/x", 0.9)),
    ];
    let [one, other] = costs.map(|(model, motion)| solved(&motion, &model.neutral()));
    assert_equal_cost(&one, &other);
    assert!(one.report.active_limits(FRAMES / 2).count() > 0);
}

#[test]
fn ball_joint_stays_on_its_cone_like_a_revolute() {
    let cone = BallLimits::cone(0.7, Limits::new(-0.5, 0.5));
    let (ball, hinge) = (ball(Some(cone)), hinge(Limits::new(-0.7, 0.7)));
    let of_ball = following(&ball, FRAMES, turn_about_z, |_| ()).unwrap();
    let of_ball = solved(&of_ball, &ball.0.neutral());
    let of_hinge = following(&hinge, FRAMES, turn_about_z, |_| ()).unwrap();
    assert_equal_cost(&of_ball, &solved(&of_hinge, &[0.0]));
    let last = parts(quaternion(of_ball.row(FRAMES - 1).unwrap(), 0));
    assert!((last[1] - 0.7).abs() < 1e-4, "{last:?}");
    let held: Vec<_> = of_ball
        .report
        .active_limits(FRAMES - 1)
        .map(|limit| (limit.joint, limit.bound))
        .collect();
    assert_eq!(held, [("hip swing", MotionBound::Position)]);
}

#[test]
fn all_ball_joint_limits_hold_together() {
    let twist = Limits::new(-0.3, 0.6);
    let y = Vector3::UNITS[1];
    let limits = [
        BallLimits::cone(0.8, twist),
        BallLimits::elliptic(y, [0.4, 1.2], twist),
        BallLimits::elliptic(y, [0.4, 1.2], Limits::UNBOUNDED),
        BallLimits::cone(0.8, twist).with_angle(0.9),
        BallLimits::within_angle(0.9),
    ];
    // Targets in all directions, far outside of all limits, and with a jump.
    let wild = |frame: usize| {
        let at = frame as f64 * 0.15 + if frame < 17 { 0.0 } else { 1.0 };
        Vector3::new(
            1.4 * (2.0 * at).sin(),
            1.7 * at.cos(),
            1.7 * (1.3 * at).sin(),
        )
    };
    for (k, limits) in limits.into_iter().enumerate() {
        let ball = ball(Some(limits));
        for speed in [None, Some(2.0)] {
            let motion = following(&ball, FRAMES, wild, |motion| {
                if let Some(speed) = speed {
                    motion.max_speed("hip", speed);
                }
            });
            let solved = solved(&motion.unwrap(), &ball.0.neutral());
            let mut farthest = [0.0_f64; 3];
            for q in solved.rows() {
                let [first, second, twist] = parts(quaternion(q, 0));
                let share = (first / limits.swing[0]).hypot(second / limits.swing[1]);
                farthest[0] = farthest[0].max(share);
                farthest[1] =
                    farthest[1].max((limits.twist.lower - twist).max(twist - limits.twist.upper));
                farthest[2] = farthest[2].max(angle(quaternion(q, 0)));
                assert!(ball.0.is_within_limits(q));
            }
            if k < 4 {
                assert!(
                    farthest[0] <= 1.0 && farthest[1] <= 0.0,
                    "{k} {speed:?}: {farthest:?}"
                );
            }
            if let Some(angle) = limits.angle {
                assert!(farthest[2] <= angle, "{k} {speed:?}: {farthest:?}");
            }
            assert!(
                farthest[0] > 0.99 || farthest[2] > 0.89,
                "{k} {speed:?}: {farthest:?}"
            );
            if let Some(speed) = speed {
                let fastest = fastest(&solved, 0);
                assert!(
                    fastest <= speed * STEP && fastest > 0.99 * speed * STEP,
                    "{k}: {fastest}"
                );
            }
        }
    }
}

/// A configuration of the ball joint.
fn rotated(by: [f64; 3]) -> Vec<f64> {
    let angle = by.iter().map(|by| by * by).sum::<f64>().sqrt();
    let sin = (0.5 * angle).sin() / angle;
    vec![(0.5 * angle).cos(), by[0] * sin, by[1] * sin, by[2] * sin]
}

#[test]
fn fixed_ends_are_met_or_reported_as_too_far() {
    let ball = ball(Some(BallLimits::cone(1.0, Limits::new(-1.0, 1.0))));
    let ends = [rotated([0.0, 0.0, -0.9]), rotated([0.0, 0.0, 0.9])];
    let between = |speed: f64, ends: &[Vec<f64>; 2]| {
        let motion = following(&ball, 13, turn_about_z, |motion| {
            motion
                .first(&ends[0])
                .last(&ends[1])
                .max_speed("hip", speed);
        });
        MotionSolver::default().solve(&motion?, &ball.0.neutral())
    };
    // 1.8 rad in 12 steps.
    let min_speed = 1.8 / 12.0 / STEP;
    let too_far = MotionError::TooFar {
        joint: "hip".to_owned(),
    };
    assert_eq!(between(0.999 * min_speed, &ends).unwrap_err(), too_far);
    for speed in [1.001 * min_speed, 1.5 * min_speed] {
        let solved = between(speed, &ends).unwrap();
        for (frame, end) in [(0, &ends[0]), (12, &ends[1])] {
            let deviation = angle(between_frames(&solved, frame, end));
            assert!(deviation < 1e-15, "{deviation}");
        }
        assert!(fastest(&solved, 0) <= speed * STEP);
    }
    // Both ends on a limit, of swing and of twist, with an inward motion between them.
    let edge = [rotated([1.0, 0.0, 0.0]), rotated([0.0, 1.0, 0.0])];
    let solved = between(6.0, &edge).unwrap();
    assert!(solved.rows().all(|q| ball.0.is_within_limits(q)));
    let reported = |q: [f64; 3]| {
        between(6.0, &[rotated(q), ends[1].clone()])
            .unwrap_err()
            .to_string()
    };
    let swung = reported([0.0, 1.2, 0.0]);
    assert!(
        swung.contains("hip swing") && swung.contains("1.2"),
        "{swung}"
    );
    let twisted = reported([-1.3, 0.0, 0.0]);
    assert!(
        twisted.contains("hip twist") && twisted.contains("[-1, 1]"),
        "{twisted}"
    );
}

fn between_frames(solved: &Trajectory<MotionReport>, frame: usize, other: &[f64]) -> Quaternion {
    between(
        quaternion(solved.row(frame).unwrap(), 0),
        quaternion(other, 0),
    )
}

#[test]
fn start_beyond_all_limits_is_moved_within_them() {
    // The second twist range is very narrow.
    for twist in [Limits::new(0.2, 0.5), Limits::new(0.2, 0.2002)] {
        let limits = BallLimits::cone(0.6, twist).with_angle(0.7);
        let ball = ball(Some(limits));
        let motion = following(&ball, FRAMES, turn_about_z, |motion| {
            _ = motion.max_speed("hip", 1.0)
        });
        let motion = motion.unwrap();
        let far: Vec<f64> = (0..FRAMES)
            .flat_map(|frame| rotated([1.3, if frame % 2 == 0 { -1.5 } else { 1.5 }, 0.8]))
            .collect();
        let near = MotionSolver::default().solve_near(&motion, &far).unwrap();
        assert_eq!(near.report.termination(), MotionTermination::Stationary);
        assert_equal_cost(&near, &solved(&motion, &ball.0.neutral()));
        assert!(near.rows().all(|q| ball.0.is_within_limits(q)));
    }
}

#[test]
fn free_joint_speed_errors_name_the_joint() {
    let mut builder = Model::builder("body");
    let base = builder.free("base", None, Placement::identity(), [Limits::UNBOUNDED; 3]);
    builder.frame("body", Some(base), Placement::identity());
    let model = builder.build().unwrap();
    let reported = |name: &str, linear: f64, angular: f64| {
        let mut motion = MotionProblem::builder(&model, 3, STEP);
        motion.max_free_speed(name, linear, angular);
        motion.build().unwrap_err().to_string()
    };
    let unknown = reported("bose", 1.0, 1.0);
    assert!(
        unknown.contains("bose") && unknown.contains("base"),
        "{unknown}"
    );
    for (linear, angular) in [(0.0, 1.0), (1.0, -1.0), (f64::NAN, 1.0)] {
        assert!(reported("base", linear, angular).contains("max_free_speed"));
    }
}

/// A twist without limits takes the shorter rotation from one fixed end to the other.
#[test]
fn unlimited_twist_takes_the_shorter_rotation() {
    let model = {
        let mut builder = Model::builder("spinner");
        let x = Vector3::UNITS[0];
        let limits = BallLimits::cone(0.5, Limits::UNBOUNDED);
        let ball = builder.ball("hip", None, Placement::identity(), x, Some(limits));
        builder.frame("tip", Some(ball), Placement::translation(x));
        builder.build().unwrap()
    };
    let twisted = |angle: f64| [(0.5 * angle).cos(), (0.5 * angle).sin(), 0.0, 0.0];
    let mut motion = MotionProblem::builder(&model, 7, STEP);
    motion.add(Point::new(model.frame("tip").unwrap(), [1.0, 0.0, 0.0]));
    // 0.28 rad in one direction and 6 in the other; at most 0.6 are available.
    motion.first(&twisted(3.0)).last(&twisted(-3.0));
    motion.max_speed("hip", 0.1 / STEP);
    let motion = motion.build().unwrap();
    let solved = MotionSolver::default().solve(&motion, &twisted(3.0));
    let solved = solved.unwrap();
    for frame in 1..7 {
        let [before, now] = [frame - 1, frame].map(|k| quaternion(solved.row(k).unwrap(), 0));
        let moved = angle(between(before, now));
        assert!(moved <= 0.1 + 1e-9, "frame {frame}: {moved}");
    }
}
