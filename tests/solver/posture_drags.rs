//! Promise: drags of whole bodies with a posture do not oscillate.

use kinopt::Problem;
use kinopt::ik::{Drag, crouched_configuration};
use kinopt::kinematics::ForwardKinematics;
use kinopt::spatial::Vector3;
use kinopt::task::{FramePose, Point, Posture, Task};
use support::arms::floating_nao;

/// Smallest steps of two consecutive frames that count as a reversal, radians.
const MIN_REVERSAL_STEP: f64 = 0.01;

/// Trajectory of a hand on a circle in the y-z plane, after a straight segment along x.
struct Course {
    hand: &'static str,
    /// Metres.
    ahead: f64,
    /// Metres.
    radius: f64,
    /// Angle per frame, radians.
    angle: f64,
    upright: bool,
}

impl Course {
    fn offset(&self, frame: u32) -> Vector3<f64> {
        let angle = self.angle * f64::from(frame);
        let ahead = self.ahead * (angle / 1.5).min(1.0);
        Vector3::new(
            ahead,
            self.radius * angle.sin(),
            self.radius * (angle.cos() - 1.0),
        )
    }

    /// Number of frames in which a joint of a standing NAO reverses, and number of missed frames.
    fn reversals(&self) -> (usize, usize) {
        let robot = floating_nao();
        let model = robot.model();
        let frames = ["left_sole", "right_sole", self.hand];
        let frames = frames.map(|name| model.frame(name).unwrap());
        let up = [0.0, 0.0, 1.0];
        let stance =
            crouched_configuration(model, robot.map(), &frames[..2], &model.neutral(), up).unwrap();
        let mut kinematics = ForwardKinematics::of_frames(model, &frames).unwrap();
        let poses = kinematics.place(&stance).unwrap();
        let start = poses[2].translation;
        let mut tasks = Problem::builder(model);
        tasks.parameters(robot.map().clone());
        let hand = tasks.add(Point::new(frames[2], start));
        for (&foot, &pose) in frames.iter().zip(&poses[..2]) {
            tasks.add(Task::new(FramePose::new(foot, pose)).scale(10.0));
        }
        let posture = Posture::new(model, &stance);
        tasks.add(match self.upright {
            true => posture.upright(model),
            false => posture,
        });
        let mut drag = Drag::new(tasks.build().unwrap(), &stance).unwrap();
        let mut steps = [vec![0.0; stance.len() - 1], vec![0.0; stance.len() - 1]];
        let (mut reversals, mut missed) = (0, 0);
        let mut last = drag.q().to_vec();
        for frame in 0..400 {
            let target = start + self.offset(frame);
            drag.target_mut(hand).unwrap().set_target(target);
            missed += usize::from(!drag.advance().reached);
            let [step, before] = &mut steps;
            model.difference(&last, drag.q(), step).unwrap();
            let mut both = step.iter().zip(before.iter());
            let reverses = |a: f64, b: f64| a * b < 0.0 && a.abs().min(b.abs()) > MIN_REVERSAL_STEP;
            reversals += usize::from(both.any(|(a, b)| reverses(*a, *b)));
            last.copy_from_slice(drag.q());
            steps.swap(0, 1);
        }
        (reversals, missed)
    }
}

#[test]
fn posture_drag_within_reach_never_reverses() {
    let slow = 1.0 / 40.0;
    for (hand, ahead, radius, angle, upright) in [
        ("left_hand", 0.2, 0.1, slow, true),
        ("left_hand", 0.2, 0.1, slow, false),
        ("right_hand", 0.15, 0.12, 2.0 * slow, true),
    ] {
        let course = Course {
            hand,
            ahead,
            radius,
            angle,
            upright,
        };
        let counts = course.reversals();
        assert_eq!(counts, (0, 0), "{hand} {ahead} {radius} upright {upright}");
    }
}
