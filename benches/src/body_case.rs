//! Standing whole bodies that balance and reach with their hands: cases from the files in
//! `benches/whole_body/`, which the comparisons read too.

use std::error::Error;
use std::path::Path;

#[cfg(feature = "collision")]
use kinopt::collision::Checker;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Masses};
use kinopt::problem::{ProblemBuilder, Targets, TaskId};
use kinopt::robot::{BaseJoint, Robot};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, Point, SupportPolygon};
use kinopt::{Problem, Solver, Workspace};
use serde_json::Value;

/// Type of a target: a position, or a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Contact {
    Point,
    Pose,
}

/// Task of one hand.
enum HandTask {
    Point(TaskId<Point>),
    Pose(TaskId<FramePose>),
}

/// A robot on a free base, with fixed feet and hands that reach.
pub struct BodyCase {
    /// Robot of the case.
    pub robot: Robot,
    /// Standing configuration.
    pub standing: Vec<f64>,
    /// Poses of its feet in the standing configuration.
    pub feet: Vec<(FrameId, Placement<f64>)>,
    /// Frames of its hands.
    pub hands: Vec<FrameId>,
    /// Corners of its soles in the world, in the standing configuration.
    pub support: Vec<Vector3<f64>>,
    feet_as: Contact,
    hands_as: Contact,
    masses: Masses,
}

/// Problem of a body with movable hand targets.
pub struct BodyProblem {
    /// Problem with tasks for feet, balance and hands.
    pub problem: Problem,
    hands: Vec<HandTask>,
}

impl BodyProblem {
    /// Targets with the hands at these placements.
    ///
    /// # Errors
    /// None.
    pub fn targets(&self, hands: &[Placement<f64>]) -> Result<Targets, Box<dyn Error>> {
        let mut targets = self.problem.targets();
        for (hand, &placement) in self.hands.iter().zip(hands) {
            match *hand {
                HandTask::Point(task) => targets.get_mut(task)?.set_target(placement.translation),
                HandTask::Pose(task) => targets.get_mut(task)?.set_target(placement),
            }
        }
        Ok(targets)
    }
}

fn contact(document: &Value, key: &str) -> Result<Contact, Box<dyn Error>> {
    match document[key].as_str() {
        Some("point") => Ok(Contact::Point),
        Some("pose") => Ok(Contact::Pose),
        _ => Err(format!("`{key}` is neither \"point\" nor \"pose\"").into()),
    }
}

impl BodyCase {
    /// Reads a case and its robot.
    ///
    /// # Errors
    /// Returns an error for missing or malformed files, and for names that the robot lacks.
    pub fn read(case: &Path, robot: &Path) -> Result<Self, Box<dyn Error>> {
        let document: Value = serde_json::from_str(&std::fs::read_to_string(case)?)?;
        let robot = Robot::reader().lenient().read(robot)?;
        let robot = robot.with_base_joint(BaseJoint::FREE)?;
        let model = robot.model();
        let mut standing = model.neutral();
        for (name, value) in document["standing"].as_object().into_iter().flatten() {
            let coordinate = model.coordinate(model.joint(name)?);
            let coordinate = coordinate.ok_or("a joint of `standing` does not move")?;
            standing[coordinate] = value.as_f64().ok_or("`standing` holds numbers")?;
        }
        let mut kinematics = ForwardKinematics::new(model);
        let placements = kinematics.place(&standing)?;
        let (mut feet, mut support) = (Vec::new(), Vec::new());
        for (name, corners) in document["feet"].as_object().ok_or("`feet` is an object")? {
            let foot = model.frame(name)?;
            let corners: Vec<[f64; 3]> = serde_json::from_value(corners.clone())?;
            feet.push((foot, placements[foot.index()]));
            support.extend(
                corners
                    .iter()
                    .map(|&corner| placements[foot.index()].apply(corner.into())),
            );
        }
        let hands: Vec<String> = serde_json::from_value(document["hands"].clone())?;
        let hands = hands.iter().map(|name| model.frame(name));
        Ok(Self {
            hands: hands.collect::<Result<_, _>>()?,
            feet_as: contact(&document, "feet_as")?,
            hands_as: contact(&document, "hands_as")?,
            masses: robot.masses()?,
            standing,
            feet,
            support,
            robot,
        })
    }

    /// Problem with fixed feet, the centre of mass over them, and targets for these frames.
    fn problem_of(&self, hands: &[FrameId]) -> Result<BodyProblem, Box<dyn Error>> {
        self.build(Problem::builder(self.robot.model()), hands)
    }

    fn build(
        &self,
        mut builder: ProblemBuilder<'_>,
        hands: &[FrameId],
    ) -> Result<BodyProblem, Box<dyn Error>> {
        builder.parameters(self.robot.map().clone());
        for &(foot, placement) in &self.feet {
            match self.feet_as {
                Contact::Point => {
                    builder.add(Point::new(foot, placement.translation));
                }
                Contact::Pose => {
                    builder.add(FramePose::new(foot, placement));
                }
            }
        }
        builder.add(SupportPolygon::new(&self.masses).with_points(self.support.iter().copied()));
        let placement = Placement::identity();
        let tasks = hands.iter().map(|&hand| match self.hands_as {
            Contact::Point => HandTask::Point(builder.add(Point::new(hand, placement.translation))),
            Contact::Pose => HandTask::Pose(builder.add(FramePose::new(hand, placement))),
        });
        Ok(BodyProblem {
            hands: tasks.collect(),
            problem: builder.build()?,
        })
    }

    /// Problem with tasks for feet, balance and hands.
    ///
    /// # Errors
    /// None for a case that was read.
    pub fn problem(&self) -> Result<BodyProblem, Box<dyn Error>> {
        self.problem_of(&self.hands)
    }

    #[cfg(feature = "collision")]
    /// The problem with collision avoidance of a checker.
    ///
    /// # Errors
    /// Returns an error for a checker of another robot.
    pub fn problem_clear_of(&self, checker: &Checker) -> Result<BodyProblem, Box<dyn Error>> {
        let mut builder = Problem::builder(self.robot.model());
        builder.keep_clear(checker);
        self.build(builder, &self.hands)
    }

    /// Configurations that balance on the feet: from random joint values within their limits, each with the next seed,
    /// solved for the feet and the centre of mass.
    ///
    /// # Errors
    /// None for a case that was read.
    pub fn balanced(&self, count: usize) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
        let model = self.robot.model();
        let BodyProblem { problem, .. } = self.problem_of(&[])?;
        let (mut workspace, solver) = (Workspace::new(), Solver::default());
        let mut balanced = Vec::new();
        for seed in 0.. {
            if balanced.len() == count {
                break;
            }
            let mut sampled = model.random_configuration(seed);
            sampled[..7].copy_from_slice(&self.standing[..7]);
            let solution = solver.solve(&problem, &sampled, &mut workspace)?;
            if solution.reached {
                balanced.push(solution.q.clone());
            }
        }
        Ok(balanced)
    }

    /// Hand poses of each of these configurations.
    ///
    /// # Errors
    /// Returns an error for a configuration of another model.
    pub fn hands_at(
        &self,
        configurations: &[Vec<f64>],
    ) -> Result<Vec<Vec<Placement<f64>>>, Box<dyn Error>> {
        let mut kinematics = ForwardKinematics::new(self.robot.model());
        let mut hand_poses = Vec::new();
        for q in configurations {
            let frames = kinematics.place(q)?;
            hand_poses.push(self.hands.iter().map(|hand| frames[hand.index()]).collect());
        }
        Ok(hand_poses)
    }
}
