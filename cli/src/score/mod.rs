//! `kinopt score`: figures of a robot's motion from any program.

mod report;
mod score_options;

use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::collision::Checker;
use kinopt::motion::retarget::FootShapes;
use kinopt::motion::score::MotionScorer;
use kinopt::robot::{BaseJoint, Robot};
use kinopt_bindings::motion_file::{MotionReading, RobotMotion};
use kinopt_bindings::problem_file::{ProblemSettings, number_list};

use self::score_options::{QuaternionArgument, ScoreOptions, SubjectOptions};
use crate::collision_options::shapes;
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::model_options::ModelOptions;
use crate::output;

const EXAMPLES: &str = "\
Examples:
  kinopt score walk.csv g1.urdf --subject walk.bvh
  kinopt score walk.npz g1.urdf --subject walk.bvh --weights sliding=2,jerk=0 --json
  kinopt score walk.glb g1.urdf --collisions

Compares limb directions and positions of hands and feet with the subject. Without --subject, only
foot sliding, ground penetration, jerk, limits and collisions are measured. A robot that has no base
joint gets a free one. .csv: x, y, z, quaternion x, y, z, w, joints, as of Unitree's LAFAN1; other
formats and the figures: docs/guide/scores.md. The total is a sum of weighted terms: less is better.";

/// Frames per second of a motion without a rate: that of Unitree's retargeted LAFAN1.
const DEFAULT_RATE: f64 = 30.0;

/// Score a robot's motion: direction errors, foot sliding, penetration, jerk, limits, collisions.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Motion of the robot: .csv, .npz, .json, .glb or .gltf.
    #[arg(value_name = "MOTION")]
    motion: PathBuf,

    /// Robot .urdf or .xml.
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,

    /// Frames per second of the motion. Default: file, else subject, else 30.
    #[arg(long, value_name = "N", value_parser = number_list::positive)]
    fps: Option<f64>,

    /// Quaternion of the base, xyzw or wxyz. Default: xyzw for .csv without names.
    #[arg(long, value_enum, value_name = "ORDER", hide_possible_values = true)]
    quaternion: Option<QuaternionArgument>,

    #[command(flatten)]
    subject: SubjectOptions,

    #[command(flatten)]
    score: ScoreOptions,

    #[command(flatten)]
    model_options: ModelOptions,
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let problem = arguments.model_options.problem()?;
    let robot = read_robot(&arguments.robot, &problem)?;
    let subject = arguments.subject.read(&arguments.robot, &robot)?;
    let subject_rate = subject
        .as_ref()
        .map(|subject| subject.source.capture.frame_rate());
    let reading = MotionReading {
        quaternion: arguments.quaternion.map(Into::into),
        frame_rate: arguments
            .fps
            .or_else(|| scene_rate(&arguments.motion, subject_rate)),
        clip: None,
    };
    let motion = RobotMotion::read(&robot, &arguments.motion, &reading)?;
    let file = arguments.motion.display();
    let rate = motion.frame_rate.or(subject_rate).unwrap_or_else(|| {
        output::message(&format!(
            "note: {file}: no frame rate given, {DEFAULT_RATE} frames per second assumed; --fps changes it"
        ));
        DEFAULT_RATE
    });
    let scorer = match &subject {
        Some(subject) => {
            let (capture, up) = (&subject.source.capture, subject.source.up);
            MotionScorer::of_subject(&robot, capture, &subject.map, up)
                .map_err(|error| failure!("{}: {error}", subject.file))?
        }
        None => MotionScorer::new(&robot),
    };
    let mut scorer = arguments
        .score
        .apply(scorer.with_shapes(FootShapes::of_files(&robot)));
    if arguments.score.collisions {
        let model = shapes(&problem.collisions, &robot)?;
        scorer = scorer.with_collisions(&Checker::sampled(model));
    }
    let score = scorer.score(&motion.q, rate);
    let score = score.map_err(|error| failure!("{file}: {error}"))?;
    output::result(json, || &score, || report::text(&file.to_string(), &score))
}

/// Samples of a scene have the rate of the subject.
fn scene_rate(motion: &Path, subject_rate: Option<f64>) -> Option<f64> {
    let is_scene = motion.extension().is_some_and(|extension| {
        ["glb", "gltf", "vrm"]
            .iter()
            .any(|scene| extension.eq_ignore_ascii_case(scene))
    });
    subject_rate.filter(|_| is_scene)
}

/// Reads the robot, on a free base if neither file nor options have a base joint.
fn read_robot(path: &Path, problem: &ProblemSettings) -> Outcome<Robot> {
    let loaded = LoadedModel::read(path, &problem.model)?;
    let lacks = || usage!("{}: the file is not a robot", loaded.file);
    let robot = Robot::clone(loaded.robot.as_ref().ok_or_else(lacks)?);
    match problem.model.base_joint.is_none() && !robot.moves_as_a_whole() {
        true => Ok(robot.with_base_joint(BaseJoint::FREE)?),
        false => Ok(robot),
    }
}
