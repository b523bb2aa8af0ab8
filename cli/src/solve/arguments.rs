//! Arguments of `kinopt solve`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{ArgGroup, Args};
use kinopt::problem::Derivatives;
use kinopt::skinning::SkinningMethod;

use super::arm_arguments::ArmArguments;
use super::balance::BalanceArguments;
use super::chain_arguments::ChainArguments;
use super::levels::LevelArguments;
use super::obstacles::ObstacleArguments;
use super::out_file::OutFile;
use super::weights::FrameWeight;
use crate::choices::among;
use crate::help_headings::{FOLLOWING, LIMITS, MESHES, MODEL, OUTPUT, SEARCH, TARGETS};
use crate::method_choice::{self, JACOBIAN_ROUTES};
use crate::model_options::ModelOptions;
use crate::number_list;
use crate::skinning_choice;
use crate::target::{RayTarget, Start, Target};
use crate::weights_choice::WeightsChoice;

const EXAMPLES: &str = "\
Examples:
  kinopt solve robot.urdf --target tool=0.4,0.1,0.5,0,1,0,0
        joint values for a pose of a robot's tool (quaternion w,x,y,z)
  kinopt solve robot.urdf --target tool=0.4,0.1,0.5,0,1,0,0 --base link0 --search distinct:8
        up to eight answers that differ; the target is given in the frame of link0
  kinopt solve robot.urdf --target left_tool=0.6,0.4,0.2 --target right_tool=0.6,-0.4,0.2
        both arms of a robot at once
  kinopt solve robot.urdf --target tool=0.4,0.1,0.5,0,1,0,0 --tool 0,0,0.12 --lock joint3=0
        for the tip of a drill that long on it, with a joint held
  kinopt solve robot.urdf --target tool=0.4,0.1,0.5,0,1,0,0 --interval z=0..0.05,rz=free
        up to 5 cm further along the target's z axis, and turned about it at will
  kinopt solve humanoid.urdf --base-joint free --hold left_foot --hold right_foot --start bent \\
        --balance left_foot --balance right_foot --target left_hand=0.5,0.2,0.9
        a whole body on a free base: feet stay, the centre of mass over them, a hand reaches
  kinopt solve humanoid.urdf --base-joint free --hold left_foot --hold right_foot --tasks tasks.json
        what a file asks: a gaze, a frame's velocity, a coupling, manipulability, a posture (see --tasks)
  kinopt solve robot.urdf --tip tool --targets poses.json --search first --json
        many poses, each on its own (see --targets)
  kinopt solve robot.urdf --tip tool --targets path.json --track
        a path: every step starts from the one before
  kinopt solve robot.urdf --tip tool --targets path.json --servo 1000 --json
        a thousand targets a second, no joint faster than its velocity limit
  kinopt solve arm.json --target bone/6=0.2,0.5,0.1
        bring a tip to a point; tips pinned in the rig stay where they are
  kinopt solve fox.glb --hold b_Hip_01 --target b_LeftHand_011=10,15,30
        the hips do not turn, nothing else is held (--hold none: nothing at all)
  kinopt solve man.json --free --target bone/9=0.5,1.2,0.3 --target bone/13=-0.5,1.2,0.3
        two hands at once, nothing pinned
  kinopt solve arm.json --target bone/6=0.2,0.5,0.1,1,0,0,0 --out posed.obj
        a whole pose (quaternion w,x,y,z), and the skinned mesh
  kinopt solve fox.glb --target b_LeftHand_011=10,15,30 --out dragged.glb
        a scene's joint, and its skinned meshes
  kinopt solve walk.bvh --time 1.5 --target LeftHand=30,120,40 --out reached.bvh
        a captured pose, and the pose that came of it
  kinopt solve arm.json --ray bone/6=0,0.5,3:0.2,0.5,0 --json
        a tip onto the viewing ray through two points

A target that is out of reach is no failure: the closest pose found is printed with what each
target misses by and which limits hold it back (--json: \"reached\": false).

Exit codes: 0 done, 1 failed (a file, or a name or number that the model does not have; one line says
which), 2 wrong usage, 3 a target was missed and --fail-on-miss was given.";

/// Joint angles, within their limits, that bring frames to targets (inverse kinematics).
///
/// One --target of a robot, and its --targets, go through the arm's front door: the lane engine with
/// numbered attempts, always the same answer for the same question. Several --target, --ray, rigs
/// and anything with --solver go through the general solvers. In a rig the other tips that the file
/// pins (ik_constraints) are held where they are at the start. In a scene all joints of skins, in motion
/// capture those with channels, turn freely and their tips are where they stand; the trunk up to where the limbs branch off does not
/// turn, and the ends of the other limbs are held. --hold says otherwise.
///
/// In the output q lists all moving joints in the order of the file (for a robot their names are
/// beside it under "joints"), those that cannot matter at their start.
#[derive(Args, Debug)]
#[command(
    after_help = "kinopt solve --help lists all options, with defaults, examples and exit codes.",
    after_long_help = EXAMPLES,
    group = ArgGroup::new("wanted").required(true).multiple(true).args(["targets", "rays", "file", "center_of_mass", "balance", "tasks"])
)]
pub(crate) struct Arguments {
    /// The model: a robot's .urdf or MJCF .xml, a rig's .json, a scene's .glb or .gltf or a motion capture's .bvh file.
    #[arg(value_name = "MODEL")]
    pub(super) model: PathBuf,

    /// Where a frame should be, in metres (rigs: their own unit).
    ///
    /// Default: none. Three numbers are a point; with a quaternion w,x,y,z it is a whole pose. In a robot a frame
    /// is a link. In a rig `bone/3` or a bone's name is that bone's tip; `bone/3/tip` and
    /// `bone/3/tail` say it outright. Repeat it for several. At least one --target, --ray, --targets,
    /// --center-of-mass, --balance or --tasks is needed.
    #[arg(long = "target", value_name = "FRAME=x,y,z[,qw,qx,qy,qz]", value_parser = Target::parse,
          help_heading = TARGETS)]
    pub(super) targets: Vec<Target>,

    /// A line that a frame should lie on, in metres (rigs: their own unit).
    ///
    /// Default: none. It goes through an eye and a point (the mouse, unprojected). Frames are named as for
    /// --target. Repeat it for several.
    #[arg(long = "ray", value_name = "FRAME=ex,ey,ez:mx,my,mz", value_parser = RayTarget::parse,
          help_heading = TARGETS)]
    pub(super) rays: Vec<RayTarget>,

    /// Many independent targets of one frame, from a JSON file.
    ///
    /// Its keys: "targets", a list of [x,y,z] or [x,y,z,qw,qx,qy,qz] in metres; and where wanted
    /// "starts", a configuration for each (radians and metres); "joint_names", which says what the
    /// starts' numbers belong to (without it they are all moving joints in the order of `kinopt
    /// info`, or the free joints from base to tip); "tip_link" and "base_link". Other keys are not
    /// looked at. Without starts each begins at --start. Targets that are missed are no failure.
    #[arg(long = "targets", value_name = "FILE", id = "file",
          conflicts_with_all = ["targets", "rays", "out"], help_heading = TARGETS)]
    pub(super) file: Option<PathBuf>,

    /// The frame that --targets are for.
    ///
    /// Default: the file's tip_link, or a robot's only tip.
    // Not `requires`: clap waives it for arguments that conflict with a given one.
    #[arg(long, value_name = "FRAME", conflicts_with_all = ["targets", "rays"], help_heading = TARGETS)]
    pub(super) tip: Option<String>,

    /// The frame that targets are given in.
    ///
    /// Default: the base_link of a file of targets, or the world, which for a robot is its root link.
    #[arg(long, value_name = "FRAME", conflicts_with = "rays", help_heading = TARGETS)]
    pub(super) base: Option<String>,

    /// Take --targets as a path: each starts from the answer before it.
    ///
    /// Default: off. The first starts from the file's first start. Steps in which a joint moves further than
    /// 0.2 rad are told (JSON: "jumps" in the summary, "continuous" where it is no flip to another
    /// branch; robots only).
    #[arg(long, conflicts_with_all = ["targets", "rays"], help_heading = FOLLOWING)]
    pub(super) track: bool,

    /// Solve --targets together, which is faster; only the mean time is told. Default: one at a
    /// time, each timed alone.
    #[arg(long, conflicts_with_all = ["track", "targets", "rays"], help_heading = TARGETS,
          hide_short_help = true)]
    pub(super) batch: bool,

    /// Solve --targets on so many threads. Default: 1.
    ///
    /// The answers are the same to the bit on any number. Times are best taken on one.
    #[arg(long, value_name = "N", conflicts_with_all = ["track", "targets", "rays"],
          value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = TARGETS,
          hide_short_help = true)]
    pub(super) threads: Option<u16>,

    /// More of what is asked, from a JSON file: a list of objects, each with its "task".
    ///
    /// Default: none. `{"task": "gaze", "frame", "axis", "half_angle", "target" or "direction"}`: an axis of a frame
    /// points into a cone; "look at" ("frame", "axis", "target") without room; "frame velocity" ("frame", "time_step_s", "linear", "angular"), since where the start
    /// has it; "joint coupling" ("coefficients" by joint, "offset"); "manipulability" ("frame", "least", and where
    /// wanted "base" and "of": "pose", "position" or "orientation"); "posture" (near "q", or else the start;
    /// "joint_weights" by joint, "by range" for an equal share of each joint's range, or "upright"). Each may have a "name", a
    /// "weight" that multiplies its errors, a "tolerance", a "role", "goal" or "preference", and a "level". Radians, metres,
    /// seconds.
    #[arg(long, value_name = "FILE", help_heading = TARGETS, hide_short_help = true)]
    pub(super) tasks: Option<PathBuf>,

    #[command(flatten)]
    pub(super) balance: BalanceArguments,

    #[command(flatten)]
    pub(super) obstacles: ObstacleArguments,

    #[command(flatten)]
    pub(super) arm: ArmArguments,

    #[command(flatten)]
    pub(super) chain: ChainArguments,

    /// How much a frame counts beside the others that something is asked of: its errors are multiplied
    /// by a number above 0. For several targets, rays or held tips. Default: 1 for each.
    #[arg(long = "weight", value_name = "FRAME=W", value_parser = FrameWeight::parse,
          help_heading = TARGETS, hide_short_help = true)]
    pub(super) weights: Vec<FrameWeight>,

    #[command(flatten)]
    pub(super) levels: LevelArguments,

    /// End with exit code 3 where a target is missed, for scripts.
    ///
    /// Default: off; a miss is an answer, and the exit code 0.
    #[arg(long, help_heading = OUTPUT)]
    pub(super) fail_on_miss: bool,

    /// Tell how the answer moves with each target, its derivative by it. Default: off.
    ///
    /// A row for each joint, radians and metres; a column for each number of the target: along and about its own axes. JSON:
    /// "derivative" with "differentiability", "velocity" (the rows) and "by_target" by frame. Look at "differentiability" first: only where it
    /// is "unique" is the answer a smooth function of the target.
    #[arg(long, conflicts_with_all = ["track", "batch", "servo", "max_move"], help_heading = OUTPUT,
          hide_short_help = true)]
    pub(super) derivative: bool,

    /// The position of targets alone counts, even where they have a quaternion. Default: off.
    #[arg(long, help_heading = TARGETS, hide_short_help = true)]
    pub(super) position_only: bool,

    /// A bone, or a robot's link, that stays where it is, or `none`.
    ///
    /// Default: the tips that a rig's file pins; in a scene the trunk, which does not turn, and the ends
    /// of the other limbs; of a robot nothing. Its tip stays, and as it is turned a link and what of a figure on a free base this names; a bone that carries what has a target does not turn, nor do those above it.
    /// On a free base what is held counts ten times as much as targets do on one level (--no-priorities), unless --weight says otherwise, and the body
    /// keeps upright and near its start where the targets leave room.
    /// Repeat it for several.
    #[arg(long, value_name = "NAME", help_heading = MODEL)]
    pub(super) hold: Vec<String>,

    /// Hold nothing: --hold none.
    ///
    /// Default: off.
    #[arg(long, conflicts_with = "hold", help_heading = MODEL, hide_short_help = true)]
    pub(super) free: bool,

    /// Where the search starts: a word, or numbers in radians and metres.
    ///
    /// `default` of a robot's arm is its state `ready` or `home` in the SRDF file (--srdf), else the middle of its joints' limits
    /// and 0 of joints without limits; everything else is at rest. `rest` is all zeros, moved into the limits; `bent` the same with the knees of a body on a free base bent a
    /// little over what --hold names, so that it crouches rather than bows; `random` is drawn within the limits from
    /// --rng-seed; numbers are a configuration in the order of `kinopt info`: radians (degrees with
    /// --degrees) and, for sliding joints, metres. They are moved into the limits.
    #[arg(long, value_name = "NUMBERS|default|rest|bent|random", default_value = "default", allow_hyphen_values = true,
          value_parser = Start::parse, help_heading = SEARCH)]
    pub(super) start: Start,

    /// Rest is how a scene or a capture is at this time of a clip, in seconds. Default: as its file has it.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = number_list::number,
          help_heading = MODEL, hide_short_help = true)]
    pub(super) time: Option<f64>,

    /// With --time: which of a scene's clips: its name, or the end of it. Default: the first.
    #[arg(long, value_name = "NAME", requires = "time", help_heading = MODEL, hide_short_help = true)]
    pub(super) clip: Option<String>,

    /// Angles in options and in text output are in degrees.
    ///
    /// Those of --start, --lock, --max-move, --posture, --interval and --velocity-limits. Default: radians.
    #[arg(long, help_heading = OUTPUT)]
    pub(super) degrees: bool,

    /// Go through the general solvers with this method. Default: levenberg-marquardt where they
    /// are needed.
    #[arg(long, value_name = "NAME", value_parser = method_choice::names(), help_heading = SEARCH,
          hide_short_help = true)]
    pub(super) solver: Option<String>,

    /// How the general solvers find derivatives. Default: analytic.
    #[arg(long, value_name = "ROUTE", value_parser = among(JACOBIAN_ROUTES), help_heading = SEARCH, hide_short_help = true)]
    pub(super) jacobian: Option<Derivatives>,

    /// Seed of a random start and of the restarts: a whole number. Same seed, same result.
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = SEARCH, hide_short_help = true)]
    pub(super) rng_seed: u64,

    /// Stop after so many milliseconds with the best found.
    ///
    /// Default: no limit. For each target of its own. Results then depend on the machine. The clock runs while solving,
    /// not while reading files.
    #[arg(long, value_name = "MS", value_parser = number_list::milliseconds, help_heading = LIMITS)]
    pub(super) time_limit: Option<Duration>,

    /// What counts as reached, in metres and radians.
    ///
    /// For rigs in their own unit. Default: 1e-9 of a rig's size and 1e-9 rad; 1e-6 m and rad for robots.
    #[arg(long, value_name = "T", value_parser = number_list::not_negative, help_heading = LIMITS)]
    pub(super) tolerance: Option<f64>,

    /// How many attempts at most for one target, the start's own included. Default: 200 for an
    /// arm, 32 for the general solvers.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..),
          help_heading = LIMITS, hide_short_help = true)]
    pub(super) attempts: Option<u32>,

    /// How many more attempts from other places while the targets are missed, 0 for none: --attempts
    /// less one.
    #[arg(long, value_name = "N", conflicts_with = "attempts", help_heading = LIMITS,
          hide_short_help = true)]
    pub(super) restarts: Option<u32>,

    /// How many steps each attempt of the general solvers may take. Default: 200.
    ///
    /// The gradient methods take many small ones.
    #[arg(long, value_name = "N", help_heading = LIMITS, hide_short_help = true)]
    pub(super) max_iterations: Option<u32>,

    /// Write the posed mesh: .obj, .ply or .glb; of captures the pose: .bvh.
    ///
    /// Default: not written. A mesh needs a rig or a scene that has one.
    #[arg(long, value_name = "FILE", value_parser = OutFile::parse, help_heading = OUTPUT)]
    pub(super) out: Option<OutFile>,

    /// Add the pose of a scene as a clip of one key to this .glb or .gltf file, which keeps all that it holds.
    ///
    /// Where there is no such file, to a copy of the model's. Default: not written.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["out", "file"], help_heading = OUTPUT, hide_short_help = true)]
    pub(super) into: Option<PathBuf>,

    /// With --into: what the clip is called. Default: pose.
    #[arg(long, value_name = "NAME", requires = "into", help_heading = OUTPUT, hide_short_help = true)]
    pub(super) clip_name: Option<String>,

    /// With --out: how a rig's skin weights are made up. Default: those of the file, else by heat.
    #[arg(long, value_enum, requires = "out", conflicts_with = "file", hide_default_value = true,
          help_heading = MESHES, hide_short_help = true)]
    pub(super) skin_weights: Option<WeightsChoice>,

    /// With --out: how the bones move the skin.
    #[arg(long, value_name = "METHOD", requires = "out", conflicts_with = "file", default_value_t,
          value_parser = skinning_choice::parser(), help_heading = MESHES, hide_short_help = true)]
    pub(super) skinning: SkinningMethod,

    #[command(flatten)]
    pub(super) model_options: ModelOptions,
}
