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
        joint values for a pose of the tool (quaternion w,x,y,z)
  kinopt solve robot.urdf --target tool=0.4,0.1,0.5,0,1,0,0 --base link0 --search distinct:8
        up to eight distinct solutions; the target is in the frame of link0
  kinopt solve robot.urdf --target left_tool=0.6,0.4,0.2 --target right_tool=0.6,-0.4,0.2
        two targets at once
  kinopt solve robot.urdf --target tool=0.4,0.1,0.5,0,1,0,0 --interval z=0..0.05,rz=free
        up to 5 cm beyond the target along its z axis, any rotation about it
  kinopt solve robot.urdf --tip tool --targets poses.json --track
        a path: each solve starts from the previous solution
  kinopt solve humanoid.urdf --base-joint free --hold left_foot --hold right_foot --start bent \\
        --balance left_foot --balance right_foot --target left_hand=0.5,0.2,0.9
        a body on a free base: the feet stay, the centre of mass is above them, a hand reaches
  kinopt solve arm.json --target bone/6=0.2,0.5,0.1 --out posed.obj
        the tip of a rig's bone, and the skinned mesh
  kinopt solve walk.bvh --time 1.5 --target LeftHand=30,120,40 --out reached.bvh
        a captured pose, changed

A target that is not reached is a result: the closest pose found, its errors and the active limits
(--json: \"reached\": false).

Exit codes: 0 done, 1 failed with a one-line reason, 2 wrong usage, 3 target not reached with
--fail-on-miss.";

/// Inverse kinematics: joint values within their limits that bring frames to targets.
///
/// A single target of a robot is solved by the SIMD solver of arms, deterministically. Several targets, rays, skeletons
/// and --solver use the general solver. Rigs hold their pinned tips; scenes and captures hold the trunk and the ends of
/// other limbs (see --hold). The result q lists all moving joints in file order. Guide: docs/guide/targets.md.
#[derive(Args, Debug)]
#[command(
    after_help = "kinopt solve --help-all lists all options, with defaults, examples and exit codes.",
    after_long_help = EXAMPLES,
    group = ArgGroup::new("wanted").required(true).multiple(true).args(["targets", "rays", "file", "center_of_mass", "balance", "tasks"])
)]
pub(crate) struct Arguments {
    /// Model file: robot .urdf or MJCF .xml, rig .json, scene .glb or .gltf, motion capture .bvh.
    #[arg(value_name = "MODEL")]
    pub(super) model: PathBuf,

    /// Target of a frame: a position in metres (rigs: their unit), or a pose. Repeatable.
    #[arg(long = "target", value_name = "FRAME=x,y,z[,qw,qx,qy,qz]", value_parser = Target::parse,
          help_heading = TARGETS)]
    pub(super) targets: Vec<Target>,

    /// Line from an eye through a point, in metres, on which a frame should lie. Repeatable.
    #[arg(long = "ray", value_name = "FRAME=ex,ey,ez:mx,my,mz", value_parser = RayTarget::parse,
          help_heading = TARGETS)]
    pub(super) rays: Vec<RayTarget>,

    /// Many targets of one frame from a JSON file; format in docs/guide/targets.md.
    #[arg(long = "targets", value_name = "FILE", id = "file",
          conflicts_with_all = ["targets", "rays", "out"], help_heading = TARGETS)]
    pub(super) file: Option<PathBuf>,

    /// Frame of --targets. Default: tip_link of the file, or the robot's only tip.
    // Not `requires`: clap waives it for arguments that conflict with a given one.
    #[arg(long, value_name = "FRAME", conflicts_with_all = ["targets", "rays"], help_heading = TARGETS)]
    pub(super) tip: Option<String>,

    /// Frame in which targets are given. Default: base_link of the file, or the world.
    #[arg(long, value_name = "FRAME", conflicts_with = "rays", help_heading = TARGETS)]
    pub(super) base: Option<String>,

    /// Solve --targets as a path, each from the previous solution. Default: off.
    #[arg(long, conflicts_with_all = ["targets", "rays"], help_heading = FOLLOWING)]
    pub(super) track: bool,

    /// Solve --targets in one batch, faster; reports only the mean time. Default: one at a time.
    #[arg(long, conflicts_with_all = ["track", "targets", "rays"], help_heading = TARGETS,
          hide_short_help = true)]
    pub(super) batch: bool,

    /// Number of threads for --targets, 1 to 1024; results do not depend on it. Default: 1.
    #[arg(long, value_name = "N", conflicts_with_all = ["track", "targets", "rays"],
          value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = TARGETS,
          hide_short_help = true)]
    pub(super) threads: Option<u16>,

    /// More tasks from a JSON file: gaze, posture, ...; format in docs/guide/whole-bodies.md.
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

    /// Factor of a frame's errors, above 0, for targets, rays or held tips. Default: 1.
    #[arg(long = "weight", value_name = "FRAME=W", value_parser = FrameWeight::parse,
          help_heading = TARGETS, hide_short_help = true)]
    pub(super) weights: Vec<FrameWeight>,

    #[command(flatten)]
    pub(super) levels: LevelArguments,

    /// Exit with code 3 if a target is not reached. Default: code 0.
    #[arg(long, help_heading = OUTPUT)]
    pub(super) fail_on_miss: bool,

    /// Report the derivative of the solution by each target; see docs/guide/derivatives.md.
    #[arg(long, conflicts_with_all = ["track", "batch", "servo", "max_move"], help_heading = OUTPUT,
          hide_short_help = true)]
    pub(super) derivative: bool,

    /// Ignore the orientation of targets. Default: off.
    #[arg(long, help_heading = TARGETS, hide_short_help = true)]
    pub(super) position_only: bool,

    /// Link or bone that keeps its pose, or `none`; see docs/guide/dragging.md. Repeatable.
    #[arg(long, value_name = "NAME", help_heading = MODEL)]
    pub(super) hold: Vec<String>,

    /// Hold nothing, as --hold none. Default: off.
    #[arg(long, conflicts_with = "hold", help_heading = MODEL, hide_short_help = true)]
    pub(super) free: bool,

    /// Start configuration: a word, or numbers in radians and metres; see docs/guide/targets.md.
    #[arg(long, value_name = "NUMBERS|default|rest|bent|random", default_value = "default", allow_hyphen_values = true,
          value_parser = Start::parse, help_heading = SEARCH)]
    pub(super) start: Start,

    /// Rest pose of a scene or capture: time of a clip, in seconds. Default: that of the file.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = number_list::number,
          help_heading = MODEL, hide_short_help = true)]
    pub(super) time: Option<f64>,

    /// With --time: clip of a scene, by name or end of the name. Default: the first.
    #[arg(long, value_name = "NAME", requires = "time", help_heading = MODEL, hide_short_help = true)]
    pub(super) clip: Option<String>,

    /// Angles in options and text output are degrees. Default: radians.
    #[arg(long, help_heading = OUTPUT)]
    pub(super) degrees: bool,

    /// Use the general solver with this method. Default if needed: levenberg-marquardt.
    #[arg(long, value_name = "NAME", value_parser = method_choice::names(), help_heading = SEARCH,
          hide_short_help = true)]
    pub(super) solver: Option<String>,

    /// Derivatives of the general solver. Default: analytic.
    #[arg(long, value_name = "ROUTE", value_parser = among(JACOBIAN_ROUTES), help_heading = SEARCH, hide_short_help = true)]
    pub(super) jacobian: Option<Derivatives>,

    /// Seed of the random generator, a whole number.
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = SEARCH, hide_short_help = true)]
    pub(super) rng_seed: u64,

    /// Time limit of a target, in milliseconds; makes results machine-dependent. Default: none.
    #[arg(long, value_name = "MS", value_parser = number_list::milliseconds, help_heading = LIMITS)]
    pub(super) time_limit: Option<Duration>,

    /// Tolerance in metres and radians. Default: 1e-6; skeletons: 1e-9 of their size and 1e-9 rad.
    #[arg(long, value_name = "T", value_parser = number_list::not_negative, help_heading = LIMITS)]
    pub(super) tolerance: Option<f64>,

    /// Largest number of attempts for a target. Default: 200 for an arm, 32 in the general solver.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..),
          help_heading = LIMITS, hide_short_help = true)]
    pub(super) attempts: Option<u32>,

    /// Largest number of attempts after the first, 0 for none; --attempts less one.
    #[arg(long, value_name = "N", conflicts_with = "attempts", help_heading = LIMITS,
          hide_short_help = true)]
    pub(super) restarts: Option<u32>,

    /// Largest number of iterations of an attempt of the general solver. Default: 200.
    #[arg(long, value_name = "N", help_heading = LIMITS, hide_short_help = true)]
    pub(super) max_iterations: Option<u32>,

    /// Write the posed mesh (.obj, .ply, .glb), or the pose of a capture (.bvh). Default: no file.
    #[arg(long, value_name = "FILE", value_parser = OutFile::parse, help_heading = OUTPUT)]
    pub(super) out: Option<OutFile>,

    /// Add the pose as a clip of one key to a .glb or .gltf, or to a copy of the model's file.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["out", "file"], help_heading = OUTPUT, hide_short_help = true)]
    pub(super) into: Option<PathBuf>,

    /// With --into: name of the clip. Default: pose.
    #[arg(long, value_name = "NAME", requires = "into", help_heading = OUTPUT, hide_short_help = true)]
    pub(super) clip_name: Option<String>,

    /// With --out: method of a rig's skin weights. Default: those of the file, else heat.
    #[arg(long, value_enum, requires = "out", conflicts_with = "file", hide_default_value = true,
          help_heading = MESHES, hide_short_help = true)]
    pub(super) skin_weights: Option<WeightsChoice>,

    /// With --out: skinning method.
    #[arg(long, value_name = "METHOD", requires = "out", conflicts_with = "file", default_value_t,
          value_parser = skinning_choice::parser(), help_heading = MESHES, hide_short_help = true)]
    pub(super) skinning: SkinningMethod,

    #[command(flatten)]
    pub(super) model_options: ModelOptions,
}
