//! `kinopt fk`: forward kinematics of a configuration.

use std::path::PathBuf;

use clap::Args;
use kinopt::animation::BallPoseMap;
use serde::Serialize;

use crate::animated_armature::AnimatedArmature;
use crate::choices::first_given;
use crate::closed_by_fk::LoopDocument;
use crate::failure::Outcome;
use crate::frame_report::FrameReport;
use crate::interpolation_choice::{InterpolationChoice, playback};
use crate::loaded_model::LoadedModel;
use crate::model_options::ModelOptions;
use crate::number_format::LengthFormat;
use crate::number_list::{self, Numbers};
use crate::output;

const EXAMPLES: &str = "\
Examples:
  kinopt fk robot.urdf --q 0,-45,0,-135,0,90,45 --degrees --frame tool
                                                  the tool of a robot, joint angles in degrees
  kinopt fk leg.xml --q 0.3,0.1,0,0 --frame foot  the foot of an MJCF leg with closed rods
  kinopt fk arm.json                              the rest pose, every bone
  kinopt fk arm.json --time 1.5 --frame bone/6    the keyframes at 1.5 s, one bone
  kinopt fk arm.json --q-file solved.json --json  the q of `kinopt solve --json`
  kinopt fk fox.glb --clip Run --time 0.2         a scene's clip at 0.2 s, every node
  kinopt fk walk.bvh --time 1.5 --frame Head/tip  a capture at 1.5 s, the top of the head
  kinopt fk walk.bvh --joints ball --base-joint free --time 1.5 --json
                                                  the pose as a configuration q of ball joints";

/// Forward kinematics: placements of frames for a configuration.
///
/// Frames are links of a robot, joints and End Sites (`JOINT/tip`) of a capture, or nodes of a scene. In a rig a frame
/// is a bone: its origin is the bone's tail, and its x axis points to the tip. The tip is listed too.
///
/// The default configuration is the rest pose: all zeros, moved into the limits. Passive joints (--passive) close the
/// loops of a robot; the output q has their values.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Model file: robot .urdf or MJCF .xml, rig .json, motion capture .bvh, scene .glb or .gltf.
    #[arg(value_name = "MODEL")]
    model: PathBuf,

    /// Configuration in radians (or --degrees) and metres. Default: the rest pose.
    ///
    /// One number for each coordinate in the order of `kinopt info`, separated by commas or spaces. Prismatic joints
    /// are in metres, ball joints are quaternions w, x, y, z. Mimic joints have numbers, fixed joints do not. Limits do
    /// not apply.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, group = "configuration",
          value_parser = Numbers::parse)]
    q: Option<Numbers>,

    /// JSON file with the configuration, in radians and metres. Default: none.
    ///
    /// A list of numbers, or a document with a list under "q", such as the output of --json. If the document names
    /// joints under "joints", numbers go by name. Joints that are not named are at rest.
    #[arg(long, value_name = "FILE", group = "configuration")]
    q_file: Option<PathBuf>,

    /// Time of the rig's keyframes, the capture or the scene's clip, in seconds. Default: none.
    ///
    /// Before the first key and after the last, the pose is constant, unless --loop is given.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, group = "configuration",
          value_parser = number_list::number)]
    time: Option<f64>,

    /// With --time: clip of a scene, by name or end of the name. Default: the first.
    #[arg(long, value_name = "NAME", requires = "time")]
    clip: Option<String>,

    /// With --time: repeat the keyframes. Default: constant before the first and after the last.
    // Not `requires` alone: clap waives it for arguments that conflict with a given one.
    #[arg(long = "loop", requires = "time", conflicts_with_all = ["q", "q_file"])]
    looped: bool,

    /// With --time: linear, catmull-rom or kochanek-bartels:T,C,B. Default: that of the file.
    ///
    /// Files without an interpolation use catmull-rom. T, C and B are tension, continuity and bias of every key,
    /// usually within −1 and 1.
    #[arg(long, value_name = "NAME", requires = "time", conflicts_with_all = ["q", "q_file"],
          value_parser = InterpolationChoice::parse)]
    interpolation: Option<InterpolationChoice>,

    /// Frame to report. Default: all. Repeatable.
    ///
    /// A link of a robot, a joint of a capture, or a bone of a rig by name or number (`bone/3`). `/tip` selects the tip
    /// of a bone or the End Site of a joint.
    #[arg(long = "frame", value_name = "NAME")]
    frames: Vec<String>,

    /// Frame in which placements are reported. Default: the world, for a robot its root link.
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
    if AnimatedArmature::is_at(&arguments.model) && !arguments.model_options.makes_figure() {
        arguments
            .model_options
            .refuse(&arguments.model.display().to_string())?;
        return run_animated(arguments, json);
    }
    let mut loaded = LoadedModel::read(&arguments.model, &arguments.model_options)?;
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

fn run_animated(arguments: &Arguments, json: bool) -> Outcome<()> {
    let given = [
        ("--q", arguments.q.is_some()),
        ("--q-file", arguments.q_file.is_some()),
        ("--interpolation", arguments.interpolation.is_some()),
    ];
    let animated = AnimatedArmature::read(&arguments.model)?;
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
    if let Some(Numbers(numbers)) = &arguments.q {
        return loaded.typed_configuration(numbers, arguments.degrees, "--q");
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
