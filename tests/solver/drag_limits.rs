//! Promise: a drag with a time step keeps position, velocity, acceleration and jerk limits in every frame.

use kinopt::Problem;
use kinopt::ik::{Drag, MotionLimits, crouched_configuration};
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Model};
use kinopt::problem::TaskId;
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;
use kinopt::task::{FramePose, Point, Posture, Task};
use support::arms::floating_nao;
use support::random::Random;

/// Velocity (rad/s), acceleration (rad/s²) and jerk (rad/s³) limits of joints; then m and rad of the base.
const JOINT: [f64; 3] = [3.0, 15.0, 300.0];
const LINEAR: [f64; 3] = [0.5, 3.0, 60.0];
const ANGULAR: [f64; 3] = [1.5, 8.0, 160.0];

struct Body {
    robot: Robot,
    feet: [FrameId; 2],
    hand: FrameId,
    stance: Vec<f64>,
}

impl Body {
    fn nao() -> Self {
        let robot = floating_nao();
        let model = robot.model();
        let feet = ["left_sole", "right_sole"].map(|name| model.frame(name).unwrap());
        let hand = model.frame("left_hand").unwrap();
        let up = [0.0, 0.0, 1.0];
        let stance =
            crouched_configuration(model, robot.map(), &feet, &model.neutral(), up).unwrap();
        Self {
            robot,
            feet,
            hand,
            stance,
        }
    }

    fn model(&self) -> &Model {
        self.robot.model()
    }

    fn limits(&self) -> MotionLimits {
        let limits_of = |rate: usize| {
            let mut limits = vec![JOINT[rate]; self.model().configuration_len()];
            limits[..3].fill(LINEAR[rate]);
            limits[3..7].fill(ANGULAR[rate]);
            limits
        };
        MotionLimits::unlimited(self.model().configuration_len())
            .with_velocity(limits_of(0))
            .with_acceleration(limits_of(1))
            .with_jerk(limits_of(2))
    }

    /// A drag with its feet pinned, and the position of the hand at the start.
    fn drag(&self, time_step: f64) -> (Drag, TaskId<Point>, Vector3<f64>) {
        let frames = [self.feet[0], self.feet[1], self.hand];
        let mut kinematics = ForwardKinematics::of_frames(self.model(), &frames).unwrap();
        let poses = kinematics.place(&self.stance).unwrap();
        let mut tasks = Problem::builder(self.model());
        tasks.parameters(self.robot.map().clone());
        let hand = tasks.add(Point::new(self.hand, poses[2].translation));
        for (&foot, &pose) in self.feet.iter().zip(poses) {
            tasks.add(Task::new(FramePose::new(foot, pose)).scale(10.0));
        }
        tasks.add(Posture::new(self.model(), &self.stance).upright(self.model()));
        let drag = Drag::new(tasks.build().unwrap(), &self.stance).unwrap();
        let drag = drag.with_motion_limits(time_step, &self.limits()).unwrap();
        (drag, hand, poses[2].translation)
    }

    /// Largest distance of a foot from its initial position, metres.
    fn slip(&self, q: &[f64]) -> f64 {
        let mut kinematics = ForwardKinematics::of_frames(self.model(), &self.feet).unwrap();
        let start = kinematics.place(&self.stance).unwrap().to_vec();
        let now = kinematics.place(q).unwrap();
        let deviations = start.iter().zip(now);
        deviations
            .map(|(a, b)| (a.translation - b.translation).norm())
            .fold(0.0, f64::max)
    }
}

/// Largest rates of a motion as fractions of the limits, by finite differences.
struct Rates<'a> {
    model: &'a Model,
    time_step: f64,
    last: Vec<f64>,
    /// Velocity and acceleration of the previous frame.
    before: [Vec<f64>; 2],
    largest: [f64; 3],
}

impl<'a> Rates<'a> {
    fn of(model: &'a Model, time_step: f64, start: &[f64]) -> Self {
        let n = start.len() - 1;
        Self {
            model,
            time_step,
            last: start.to_vec(),
            before: [vec![0.0; n], vec![0.0; n]],
            largest: [0.0; 3],
        }
    }

    fn push(&mut self, q: &[f64]) {
        let mut step = vec![0.0; q.len() - 1];
        self.model.difference(&self.last, q, &mut step).unwrap();
        // Position of the base in world coordinates.
        for k in 0..3 {
            step[k] = q[k] - self.last[k];
        }
        self.last.copy_from_slice(q);
        let velocity: Vec<f64> = step.iter().map(|step| step / self.time_step).collect();
        let change = |now: &[f64], before: &[f64]| -> Vec<f64> {
            let both = now.iter().zip(before);
            both.map(|(a, b)| (a - b) / self.time_step).collect()
        };
        let acceleration = change(&velocity, &self.before[0]);
        let jerk = change(&acceleration, &self.before[1]);
        for (rate, values) in [&velocity, &acceleration, &jerk].into_iter().enumerate() {
            let norm = |part: &[f64]| part.iter().map(|v| v * v).sum::<f64>().sqrt();
            let joints = values[6..].iter().map(|v| v.abs() / JOINT[rate]);
            let base = [
                norm(&values[..3]) / LINEAR[rate],
                norm(&values[3..6]) / ANGULAR[rate],
            ];
            let largest = joints.chain(base).fold(0.0, f64::max);
            self.largest[rate] = self.largest[rate].max(largest);
        }
        self.before = [velocity, acceleration];
    }
}

#[test]
fn limits_of_all_rates_hold_for_wild_targets() {
    let body = Body::nao();
    for (seed, time_step) in [(1, 0.01), (2, 0.004), (3, 0.02)] {
        let (mut drag, hand, start) = body.drag(time_step);
        let mut random = Random::new(seed);
        let mut rates = Rates::of(body.model(), time_step, drag.q());
        let mut target = start;
        for frame in 0..300 {
            // Jumps within and beyond the reach, then noise.
            if frame % 60 == 0 {
                let mut by = || random.within(-0.25, 0.25);
                target = start + Vector3::new(by(), by(), by());
            }
            let mut noise = || random.within(-0.002, 0.002);
            let noisy = target + Vector3::new(noise(), noise(), noise());
            drag.target_mut(hand).unwrap().set_target(noisy);
            drag.advance();
            assert_eq!(drag.q(), drag.solution().q);
            for (value, limits) in drag.q().iter().zip(body.model().limits()) {
                assert!(limits.contains(*value));
            }
            rates.push(drag.q());
        }
        let [velocity, acceleration, jerk] = rates.largest;
        assert!(velocity <= 1.0 + 1e-9, "{seed}: {velocity}");
        assert!(acceleration <= 1.0 + 1e-7, "{seed}: {acceleration}");
        assert!(jerk <= 1.0 + 1e-5, "{seed}: {jerk}");
        assert!(velocity > 0.3 && acceleration > 0.9, "{seed}: too slow");
    }
}

#[test]
fn smooth_target_within_limits_keeps_feet_in_place() {
    let (body, time_step) = (Body::nao(), 0.01);
    let (mut drag, hand, start) = body.drag(time_step);
    let (mut slip, mut lag) = (0.0_f64, 0.0_f64);
    for frame in 0..600 {
        let time = f64::from(frame) * time_step;
        let angle = 0.5 * time * (time / 2.0).min(1.0);
        let offset = Vector3::new(0.05 * angle.sin(), 0.0, 0.05 * (angle.cos() - 1.0));
        drag.target_mut(hand).unwrap().set_target(start + offset);
        lag = lag.max(drag.advance().position_error().unwrap());
        slip = slip.max(body.slip(drag.q()));
    }
    assert!(slip < 1e-3 && lag < 2e-3, "slip {slip}, lag {lag}");
}

#[test]
fn target_that_rests_is_reached_at_rest() {
    let body = Body::nao();
    let (mut drag, hand, start) = body.drag(0.01);
    let target = start + Vector3::new(0.08, 0.0, -0.05);
    drag.target_mut(hand).unwrap().set_target(target);
    assert!(!drag.advance().reached && drag.is_speed_limited());
    let solution = drag.follow(500);
    assert!(solution.reached, "{}", solution.explain());
    for _ in 0..200 {
        drag.advance();
    }
    let q = drag.q().to_vec();
    drag.advance();
    let moved = drag.q().iter().zip(&q).map(|(a, b)| (a - b).abs());
    assert!(moved.fold(0.0, f64::max) < 1e-5 && drag.solution().reached);
    assert!(body.slip(drag.q()) < 1e-4);
}

#[test]
fn bad_motion_limits_name_the_option() {
    let body = Body::nao();
    let (drag, ..) = body.drag(0.01);
    let refused = |time_step: f64, limits: &MotionLimits| {
        let drag = drag.clone().with_motion_limits(time_step, limits);
        drag.map(|_| ()).unwrap_err().to_string()
    };
    assert!(refused(0.0, &body.limits()).contains("time_step"));
    let short = body.limits().with_jerk([1.0]);
    assert!(refused(0.01, &short).contains("jerk_limits has 1 numbers"));
    let zero = vec![0.0; body.stance.len()];
    let still = body.limits().with_acceleration(zero);
    assert!(refused(0.01, &still).contains("acceleration_limits"));
}
