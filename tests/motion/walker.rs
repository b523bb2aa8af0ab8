//! A small humanoid on a free base that sways and steps, as a motion of a number of frames.

use kinopt::ik::crouched_configuration;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Model};
use kinopt::motion::trajectory::{Contact, MotionProblem, RateCost};
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;
use kinopt::task::{FramePose, Point, Posture, Task};
use support::arms::floating_nao;

/// Frames per second.
pub(crate) const RATE: f64 = 60.0;

/// Points of the right foot that a contact locks, in its frame.
pub(crate) const SOLE: [[f64; 3]; 3] = [[0.05, 0.02, 0.0], [0.05, -0.02, 0.0], [-0.05, 0.0, 0.0]];

pub(crate) struct Walker {
    pub(crate) robot: Robot,
    pub(crate) stance: Vec<f64>,
    pub(crate) feet: [FrameId; 2],
}

impl Walker {
    pub(crate) fn new() -> Self {
        let robot = floating_nao();
        let model = robot.model();
        let feet = ["left_sole", "right_sole"].map(|name| model.frame(name).unwrap());
        let up = Vector3::UNITS[2];
        let stance =
            crouched_configuration(model, robot.map(), &feet, &model.neutral(), up).unwrap();
        Self {
            stance,
            feet,
            robot,
        }
    }

    pub(crate) fn model(&self) -> &Model {
        self.robot.model()
    }

    /// The right hand follows a wave. The left foot has a fixed target; that of the right one moves by 2 cm unless it
    /// is in contact.
    pub(crate) fn swaying(
        &self,
        frames: usize,
        held: Option<std::ops::Range<usize>>,
    ) -> MotionProblem {
        let model = self.model();
        let mut kinematics = ForwardKinematics::new(model);
        let placed = kinematics.place(&self.stance).unwrap();
        let mut motion = MotionProblem::builder(model, frames, 1.0 / RATE);
        motion.parameters(self.robot.map().clone());
        motion.max_speeds_of(&self.robot);
        let hand = model.frame("right_hand").unwrap();
        let at = placed[hand.index()].translation;
        let reach = motion.add(Point::new(hand, at));
        motion.follow(reach, move |frame, point| {
            let phase = frame as f64 / RATE * 4.0;
            point.set_target(
                at + Vector3::new(0.05 * phase.sin(), 0.03 * phase.cos(), 0.04 * phase.sin()),
            );
        });
        let [left, right] = self.feet;
        motion.add(Task::new(FramePose::new(left, placed[left.index()])).scale(10.0));
        let stood = placed[right.index()];
        let step = motion.add(FramePose::new(right, stood));
        motion.follow(step, move |frame, pose| {
            let phase = frame as f64 / RATE * 3.0;
            let mut target = stood;
            target.translation += Vector3::new(0.02 * phase.sin(), 0.02 * phase.cos(), 0.0);
            pose.set_target(target);
        });
        motion.add(Task::new(Posture::new(model, &self.stance)).scale(0.05));
        motion.rate_cost(RateCost::acceleration(2e-5));
        if let Some(span) = held {
            motion.contact(Contact::new(right, span).at(SOLE));
        }
        motion.build().unwrap()
    }
}
