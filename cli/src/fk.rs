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
                                                  a robot's tool, for joint angles in degrees
  kinopt fk leg.xml --q 0.3,0.1,0,0 --frame foot  an MJCF leg's foot: rods close, as its motors stand
  kinopt fk arm.json                              the rest pose, every bone
  kinopt fk arm.json --time 1.5 --frame bone/6    the keyframes after 1.5 s, one bone
  kinopt fk arm.json --q-file solved.json --json  the q that `kinopt solve --json` printed
  kinopt fk fox.glb --clip Run --time 0.2         a scene's clip after 0.2 s, every node
  kinopt fk walk.bvh --time 1.5 --frame Head/tip  a capture after 1.5 s, the top of the head
  kinopt fk walk.bvh --joints ball --base-joint free --time 1.5 --json
                                                  the same pose as a configuration q of ball joints";

/// Where the frames stand for a configuration (forward kinematics).
///
/// For a robot a frame is a link. For a rig it is a bone's own: its origin at the bone's tail, x
/// towards the tip; the tip is given beside it. For motion capture it is a joint, or an End Site,
/// called `JOINT/tip`; for a scene it is a node. Without --q, --q-file and --time it is the rest
/// pose: all zeros, moved into the limits where they exclude zero. Of a robot with loops the passive joints
/// (--passive) follow the others, from the values given for them; q in the output is what came of it.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The model: a robot's .urdf or MJCF .xml, a rig's .json, a motion capture's .bvh or a scene's .glb or .gltf file.
    #[arg(value_name = "MODEL")]
    model: PathBuf,

    /// The configuration, in radians (or --degrees) and metres. Default: the rest pose.
    ///
    /// In the order of `kinopt info`, separated by commas or spaces; only sliding joints are in metres, and a
    /// ball joint's quaternion is w, x, y, z. For a robot these are all moving joints in the
    /// order of the file, joints that follow others among them; fixed joints have no number. Limits
    /// are not enforced.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, group = "configuration",
          value_parser = Numbers::parse)]
    q: Option<Numbers>,

    /// A JSON file with the configuration, in radians and metres. Default: none.
    ///
    /// It holds a list of numbers, or a document with one under "q", such as `--json` prints. With
    /// names of joints under "joints" beside it, numbers go by name: any order, and a robot's joints
    /// that are not named stay at rest.
    #[arg(long, value_name = "FILE", group = "configuration")]
    q_file: Option<PathBuf>,

    /// Take the rig's keyframes, the captured motion or the scene's clip at this time, in seconds. Default: none.
    ///
    /// Before the first and after the last key the pose is held, unless --loop.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, group = "configuration",
          value_parser = number_list::number)]
    time: Option<f64>,

    /// With --time: which of a scene's clips: its name, or the end of it. Default: the first.
    #[arg(long, value_name = "NAME", requires = "time")]
    clip: Option<String>,

    /// With --time: repeat the keyframes instead of holding the ends. Default: off.
    // Not `requires` alone: clap waives it for arguments that conflict with a given one.
    #[arg(long = "loop", requires = "time", conflicts_with_all = ["q", "q_file"])]
    looped: bool,

    /// With --time: what runs between keys, whatever the file says: `linear`, `catmull-rom` or
    /// `kochanek-bartels:T,C,B`. Default: as the file says, else catmull-rom.
    ///
    /// T, C and B are tension, continuity and bias at every key, usually within −1 and 1.
    #[arg(long, value_name = "NAME", requires = "time", conflicts_with_all = ["q", "q_file"],
          value_parser = InterpolationChoice::parse)]
    interpolation: Option<InterpolationChoice>,

    /// A frame to report; repeat it for several. Default: all of them.
    ///
    /// In a robot it is a link's name. In a rig `bone/3` or a bone's name is the bone at its tail,
    /// `bone/3/tip` at its tip. In motion capture it is a joint's name, `NAME/tip` its End Site.
    #[arg(long = "frame", value_name = "NAME")]
    frames: Vec<String>,

    /// Report where the frames stand in this frame. Default: in the world, which for a robot is
    /// its root link.
    #[arg(long, value_name = "NAME")]
    base: Option<String>,

    /// The angles of --q are in degrees. Default: radians.
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
    /// Of a robot that has any.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    loops: &'a [LoopDocument],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
}

#[derive(Serialize)]
struct AnimatedDocument<'a> {
    /// In seconds; none at rest.
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
    let consequence = "the frames are those of the numbers as given";
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
            "{file}: {option} is for robots and rigs; {kind} is posed by --time"
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
