//! Whole bodies with unreachable targets.

use std::error::Error;

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Joint, Limits};
use kinopt::robot::Robot;
use kinopt::scalar::Scalar;
use kinopt::skeleton::BoneId;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{
    Description, FramePose, Inputs, LocalJacobian, Point, Quantity, Residual, RowBlock,
};
use kinopt::{Model, Problem, Skeleton};

/// A body with unreachable problems.
pub struct BodyMiss {
    /// Name for the output.
    pub name: String,
    /// Start of each solve.
    pub start: Vec<f64>,
    /// Problems with their descriptions.
    pub problems: Vec<(&'static str, Problem)>,
}

/// Keeps the mean position of some frames above a point.
#[derive(Clone)]
struct Balance {
    frames: Vec<FrameId>,
    above: [f64; 2],
    by_hand: bool,
}

impl Residual for Balance {
    fn inputs(&self) -> Inputs {
        Inputs::frames(self.frames.clone())
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 2)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        let mut centre = Vector3::<S>::zero();
        for frame in frames {
            centre += frame.translation;
        }
        let share = S::constant(1.0 / frames.len() as f64);
        residual[0] = centre.x * share - S::constant(self.above[0]);
        residual[1] = centre.y * share - S::constant(self.above[1]);
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        _joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        let share = 1.0 / frames.len() as f64;
        for k in (0..frames.len()).filter(|_| self.by_hand) {
            jacobian.linear_mut(k)[0] = Vector3::new(share, 0.0, 0.0);
            jacobian.linear_mut(k)[1] = Vector3::new(0.0, share, 0.0);
        }
        self.by_hand
    }

    fn description(&self) -> Description {
        Description::new("balance")
    }
}

impl BodyMiss {
    /// A skeleton whose second tip has a target far out of reach while the others stay.
    #[must_use]
    pub fn of_figure(name: &str, skeleton: &Skeleton, tips: &[BoneId]) -> Self {
        let start = crate::at_ease(skeleton);
        let pose = skeleton.pose(&start).expect("a pose of its own bones");
        let size = skeleton.size();
        let problem = |distance: f64| {
            let mut builder = Problem::builder(skeleton.model());
            for (k, &tip) in tips.iter().enumerate() {
                let mut position = pose.tip(skeleton, tip).expect("a pose of its own bones");
                if k == 1 {
                    position += Vector3::new(0.7, 0.5, 0.2) * (distance * size);
                }
                builder.add(Point::new(skeleton.tip(tip), position));
            }
            builder.build()
        };
        let problems = [("a little out of reach", 0.3), ("far out of reach", 2.0)];
        let built = problems
            .map(|(what, distance)| (what, problem(distance).expect("its tasks are valid")));
        Self {
            name: name.to_owned(),
            problems: built.into(),
            start,
        }
    }

    /// A robot on a floating base: both feet stay, the centre of its links stays above them, and a hand has a target
    /// out of reach.
    ///
    /// # Errors
    /// Returns an error for a robot without links named after its left and right foot and hand.
    pub fn of_robot(name: &str, robot: &Robot) -> Result<Self, Box<dyn Error>> {
        let fixed = robot.model();
        let mut builder = Model::builder(name);
        let [x, y, z] = Vector3::UNITS;
        let (identity, position_limits) = (Placement::identity(), Limits::new(-2.0, 2.0));
        let rotation_limits = Limits::new(-1.5, 1.5);
        let mut base = None;
        for (part, axis) in [("base x", x), ("base y", y), ("base z", z)] {
            base = Some(builder.prismatic(part, base, identity, axis, position_limits));
        }
        for (part, axis) in [("base yaw", z), ("base pitch", y), ("base roll", x)] {
            base = Some(builder.revolute(part, base, identity, axis, rotation_limits));
        }
        let mut ids = Vec::new();
        for joint in fixed.joints() {
            let parent = joint.parent.map_or(base, |id| ids.get(id.index()).copied());
            let (name, parent_from_joint) = (joint.name.clone(), joint.parent_from_joint);
            let (kind, axis, limits) = (joint.kind, joint.axis, joint.limits);
            ids.push(builder.joint(Joint::new(
                name,
                parent,
                parent_from_joint,
                kind,
                axis,
                limits,
            )));
        }
        for frame in fixed.frames() {
            let parent = frame.joint.map_or(base, |id| ids.get(id.index()).copied());
            builder.frame(frame.name.clone(), parent, frame.joint_from_frame);
        }
        let model = builder.build()?;
        let start = model.neutral();
        let pick = |words: [&[&str]; 2]| -> Result<FrameId, Box<dyn Error>> {
            let matches_words = |name: &str| {
                words
                    .iter()
                    .all(|alternatives| alternatives.iter().any(|word| name.contains(word)))
            };
            let frame = model
                .frame_ids()
                .find(|id| matches_words(&model.frames()[id.index()].name));
            frame.ok_or_else(|| format!("{name}: no link like {words:?}").into())
        };
        let foot: &[&str] = &["sole", "ankle_roll", "ankle"];
        let hand: &[&str] = &[
            "gripper_left_base",
            "hand_palm",
            "wrist_yaw",
            "elbow",
            "gripper",
        ];
        let feet = [pick([&["left"], foot])?, pick([&["right"], foot])?];
        let hand = pick([&["left"], hand])?;
        let placements = ForwardKinematics::new(&model).place(&start)?.to_vec();
        let links: Vec<FrameId> = model
            .frame_ids()
            .filter(|id| model.frames()[id.index()].joint.is_some())
            .collect();
        let mut problems = Vec::new();
        for (description, distance, balanced) in [
            ("a hand 0.5 m away", 0.5, false),
            ("a hand 0.5 m away, balanced", 0.5, true),
            ("a hand 3 m away", 3.0, false),
            ("a hand 3 m away, balanced", 3.0, true),
        ] {
            let mut builder = Problem::builder(&model);
            for foot in feet {
                builder.add(FramePose::new(foot, placements[foot.index()]));
            }
            if balanced {
                let centre = links.iter().fold(Vector3::new(0.0, 0.0, 0.0), |sum, id| {
                    sum + placements[id.index()].translation * (1.0 / links.len() as f64)
                });
                builder.add(Balance {
                    frames: links.clone(),
                    above: [centre.x, centre.y],
                    by_hand: true,
                });
            }
            let position =
                placements[hand.index()].translation + Vector3::new(distance, 0.3, distance);
            builder.add(Point::new(hand, position));
            problems.push((description, builder.build()?));
        }
        Ok(Self {
            name: name.to_owned(),
            start,
            problems,
        })
    }
}
