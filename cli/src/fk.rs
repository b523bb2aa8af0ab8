//! `kinopt fk`: forward kinematics of a configuration.

use std::path::PathBuf;

use clap::Args;
use kinopt::animation::BallPoseMap;
use kinopt_bindings::problem_file::number_list::{self, Numbers};
use kinopt_bindings::problem_file::{BoneHinges, HingeChoice, ModelSettings};
use serde::Serialize;

use crate::animated_armature::AnimatedArmature;
use crate::choices::first_given;
use crate::closed_by_fk::LoopDocument;
use crate::failure::Outcome;
use crate::frame_report::FrameReport;
use crate::interpolation_choice::{InterpolationChoice, playback};
use crate::loaded_model::LoadedModel;
use crate::model_options::{ModelOptions, refuse_robot_settings};
use crate::number_format::LengthFormat;
use crate::output;

const EXAMPLES: &str = "\
Examples:
  kinopt fk robot.urdf --q 0,-45,0,-135,0,90,45 --degrees --frame tool
  kinopt fk leg.xml --q 0.3,0.1,0,0 --frame foot
  kinopt fk arm.json --time 1.5 --frame bone/6
  kinopt fk arm.json --q-file solved.json --json
  kinopt fk walk.bvh --time 1.5 --frame Head/tip
  kinopt fk walk.bvh --problem balls.json --time 1.5 --json

A configuration has one number for each coordinate in the order of `kinopt info`. A document with
`joints` and `q` has numbers by name; joints that it does not name are at rest. Frames are links
of a robot, joints and End Sites (JOINT/tip) of a capture, nodes of a scene, or bones of a rig.
Loops and ball joints are keys of the --problem file, such as {\"model\": {\"joints\": \"ball\"}}.";

/// Forward kinematics: placements of frames for a configuration.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Model file: robot .urdf or MJCF .xml, rig .json, motion capture .bvh, scene .glb, .gltf or .vrm.
    #[arg(value_name = "MODEL")]
    model: PathBuf,

    /// Configuration in radians (or --degrees) and metres. Default: the rest pose.
    #[arg(
        long,
        value_name = "NUMBERS",
        allow_hyphen_values = true,
        group = "configuration"
    )]
    q: Option<Numbers>,

    /// JSON list of numbers, or a document with `q`, as of --json.
    #[arg(long, value_name = "FILE", group = "configuration")]
    q_file: Option<PathBuf>,

    /// Time of keyframes, of a capture or of a clip, in seconds.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, group = "configuration",
          value_parser = number_list::number)]
    time: Option<f64>,

    /// With --time: clip of a scene, by name or end of the name. Default: the first.
    #[arg(long, value_name = "NAME", requires = "time")]
    clip: Option<String>,

    /// With --time: repeat the keyframes. Default: constant outside them.
    // Not `requires` alone: clap waives it for arguments that conflict with a given one.
    #[arg(long = "loop", requires = "time", conflicts_with_all = ["q", "q_file"])]
    looped: bool,

    /// With --time: linear, catmull-rom or kochanek-bartels:T,C,B.
    #[arg(long, value_name = "NAME", requires = "time", conflicts_with_all = ["q", "q_file"],
          value_parser = InterpolationChoice::parse)]
    interpolation: Option<InterpolationChoice>,

    /// Frame to report. Default: all. Repeatable.
    #[arg(long = "frame", value_name = "NAME")]
    frames: Vec<String>,

    /// Frame in which placements are reported. Default: the world.
    #[arg(long, value_name = "NAME")]
    base: Option<String>,

    /// The angles of --q are degrees. Default: radians.
    #[arg(long, requires = "q", conflicts_with_all = ["time", "q_file"])]
    degrees: bool,

    #[command(flatten)]
    model_options: ModelOptions,
}

#[derive(Serialize)]
struct Document<'a> {
    q: &'a [f64],
    #[serde(skip_serializing_if = "Option::is_none")]
    joints: Option<Vec<&'a str>>,
    frames: &'a FrameReport,
    /// Loops of a robot, if any.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    loops: &'a [LoopDocument],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
}

#[derive(Serialize)]
struct AnimatedDocument<'a> {
    /// Time in seconds; `None` for the rest pose.
    time: Option<f64>,
    frames: &'a FrameReport,
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let mut settings = arguments.model_options.problem()?.model;
    if AnimatedArmature::is_at(&arguments.model) && !settings.makes_figure() {
        refuse_robot_settings(&settings, &arguments.model.display().to_string())?;
        return run_animated(arguments, &settings, json);
    }
    if arguments.time.is_some() && settings.hinges.is_none() {
        // A keyframe may rotate a knee about any axis.
        settings.hinges = Some(BoneHinges::Choice(HingeChoice::None));
    }
    let mut loaded = LoadedModel::read(&arguments.model, &settings)?;
    if !AnimatedArmature::is_at(&arguments.model) {
        loaded.refuse_clip(arguments.clip.as_deref())?;
    }
    loaded.interpolate_keyframes(arguments.interpolation)?;
    let mut q = configuration(&loaded, arguments)?;
    let loops = loaded.close_loops(&mut q)?;
    let frames = loaded.frame_report(&arguments.frames, arguments.base.as_deref(), &q)?;
    let consequence = "the frames use the numbers as given";
    loaded.note_outside_limits(&q, consequence);
    loaded.note_loose_followers(&q, consequence);
    let document = || Document {
        q: &q,
        joints: loaded.documented_joints(),
        frames: &frames,
        loops: &loops,
        notes: loaded.notes(),
    };
    let text = || frames.text(LengthFormat::of_size(loaded.size()));
    output::result(json, document, text)
}

fn run_animated(arguments: &Arguments, settings: &ModelSettings, json: bool) -> Outcome<()> {
    let given = [
        ("--q", arguments.q.is_some()),
        ("--q-file", arguments.q_file.is_some()),
        ("--interpolation", arguments.interpolation.is_some()),
    ];
    let animated = AnimatedArmature::read_for(&arguments.model, settings)?;
    if let Some(option) = first_given(given) {
        let (file, kind) = (&animated.file, animated.kind);
        return Err(usage!(
            "{file}: {option} is for robots and rigs; --time poses a {kind}"
        ));
    }
    let pose = match arguments.time {
        Some(time) => {
            let clip = animated.clip(arguments.clip.as_deref())?;
            animated.pose_at(clip, time, playback(arguments.looped))?
        }
        None => animated.armature.rest().clone(),
    };
    let frames = animated.frame_report(&arguments.frames, arguments.base.as_deref(), &pose)?;
    let document = || AnimatedDocument {
        time: arguments.time,
        frames: &frames,
    };
    let lengths = LengthFormat::of_size(animated.size()?);
    output::result(json, document, || frames.text(lengths))
}

fn configuration(loaded: &LoadedModel, arguments: &Arguments) -> Outcome<Vec<f64>> {
    if let Some(numbers) = &arguments.q {
        return loaded.typed_configuration(&numbers.values, arguments.degrees, "--q");
    }
    if let Some(path) = &arguments.q_file {
        return loaded.configuration_file(path);
    }
    match (arguments.time, &loaded.balls) {
        (Some(time), Some(balls)) if AnimatedArmature::is_at(&arguments.model) => {
            let animated = AnimatedArmature::read(&arguments.model)?;
            let clip = animated.clip(arguments.clip.as_deref())?;
            let pose = animated.pose_at(clip, time, playback(arguments.looped))?;
            let mut q = Vec::new();
            BallPoseMap::new(&animated.armature, balls).configuration_of(&pose, &mut q)?;
            Ok(q)
        }
        (Some(time), _) => loaded.keyframes_at(time, playback(arguments.looped)),
        (None, _) => Ok(loaded.rest()),
    }
}
