//! Arguments of `kinopt path`.

use std::path::PathBuf;

use clap::Args;
use kinopt::motion::path::{QuaternionOrder, Traversal};
use kinopt::spatial::Placement;
use kinopt::task::Axis;

use crate::choices::{AXES, Choice, among};
use crate::help_headings::{LIMITS, MODEL, OUTPUT, PREFERENCES, TARGETS};
use crate::model_options::ModelOptions;
use crate::number_list::{self, Numbers};
use crate::solve::chain_arguments::ChainArguments;
use crate::solve::interval::Interval;
use crate::solve::obstacles::ObstacleArguments;
use crate::target;

const EXAMPLES: &str = "\
Examples:
  kinopt path robot.urdf weld.csv --tip tool
        joints for a path, and where a branch had to be left
  kinopt path robot.urdf weld.csv --tip tool --out joints.csv
        the joints as a table, a row a point
  kinopt path robot.urdf weld.csv --tip tool --free-axis z --world cell.json --margin 0.01 --json
        the tool turns about its own axis at will; all stays a centimetre clear of the cell
  kinopt path robot.urdf contour.csv --tip tool --traversal any-start
        a closed contour, entered wherever that saves a reconfiguration
  kinopt path robot.urdf weld.csv --tip tool --joint-limits joint_limits.yaml --out timed.csv
        with times that keep velocities and accelerations
  kinopt path robot.urdf path.csv --tip tool --at 0.5,0,0.3,0,1,0,0
        the table's numbers are of a frame that stands there in the base

Exit codes: 0 done (points that are missed are an answer), 1 failed, 2 wrong usage, 3 a point was missed and --fail-on-miss
was given.";

/// Joints for a whole path of a robot's tool, with the fewest reconfigurations.
///
/// The path is a table: x,y,z and a quaternion, with a time or without, in the columns that its header names (x, pos_x,
/// target-POS_X, qw, rot_w, time, tool, …); without names 7 columns are x,y,z,qw,qx,qy,qz, and 8 the same after a time. How it was
/// read is told on standard error.
///
/// Branches are followed from all along the path; chosen is what leaves its branch least often, then the shortest, and
/// the freedom that is left is spent on shortening it. A reconfiguration is a step in which a joint moves further than
/// --max-step. Told beside it: how far the tool is at most from the straight way between two points while all joints move evenly,
/// a bound and not samples; the points that are missed and why; the steps that are not surely free of --world.
///
/// JSON: "q" (a row a point, all moving joints, named in "joints"), "reconfigurations" (how many), "reconfigured_at" (a list
/// of "index", the row that the step leads to, "joint", "distance", "length"), "length", "largest_deviation" (metres), "largest_turn" (radians),
/// with "…_at", the row that the step leads to, "missed", "blocked", "entry", "times" (seconds: the table's, or those of --accelerations).
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The robot's .urdf or MJCF .xml file.
    #[arg(value_name = "ROBOT")]
    pub(super) robot: PathBuf,

    /// The path, a table of points.
    #[arg(value_name = "PATH.csv")]
    pub(super) path: PathBuf,

    /// The frame that follows the path. Default: the robot's only tip.
    #[arg(long, value_name = "FRAME", help_heading = TARGETS)]
    pub(super) tip: Option<String>,

    /// The frame that the path is given in. Default: the world, which for a robot is its root link.
    #[arg(long, value_name = "FRAME", help_heading = TARGETS)]
    pub(super) base: Option<String>,

    /// Where the table's own frame stands in the base. Default: there.
    #[arg(long, value_name = "x,y,z[,qw,qx,qy,qz]", allow_hyphen_values = true,
          value_parser = target::parse_placement, help_heading = TARGETS)]
    pub(super) at: Option<Placement<f64>>,

    /// The order of a quaternion that no header names. Default: w-first.
    #[arg(long, value_name = "ORDER", value_parser = among(ORDERS), default_value = "w-first", hide_default_value = true, help_heading = TARGETS)]
    pub(super) order: QuaternionOrder,

    /// Another tool, where it stands in the tip: the table's column `tool` says which points are for it, 0 being --tool, 1 the
    /// first of these and so on; give it again for more. Default: none.
    #[arg(long = "add-tool", value_name = "x,y,z[,qw,qx,qy,qz]", allow_hyphen_values = true,
          value_parser = target::parse_placement, help_heading = TARGETS)]
    pub(super) other_tools: Vec<Placement<f64>>,

    /// How the path is gone: open, cyclic (back to where it began, in the configuration that it began in), or any-start (round
    /// once from whichever point is best). Default: open.
    #[arg(long, value_name = "TRAVERSAL", value_parser = among(TRAVERSALS), default_value = "open", hide_default_value = true, help_heading = TARGETS)]
    pub(super) traversal: Traversal,

    /// The configuration that it begins in, in radians (--degrees) and metres; it must stand at the first point. Default: any.
    ///
    /// One number for each free joint from base to tip, or for each moving joint in the order of `kinopt info`.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = TARGETS)]
    pub(super) start: Option<Numbers>,

    /// The same at the last point. Default: any.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = TARGETS)]
    pub(super) end: Option<Numbers>,

    /// Positions alone count. Default: off, unless the table has no orientations.
    #[arg(long, help_heading = TARGETS)]
    pub(super) position_only: bool,

    /// An axis of each point's frame about which the tool may turn freely. Default: none.
    #[arg(long, value_name = "AXIS", value_parser = among(AXES), conflicts_with = "position_only", help_heading = TARGETS)]
    pub(super) free_axis: Option<Axis>,

    /// Room on axes of each point's frame, as of `kinopt solve`: `x=0.01`, `z=0..0.05`, `rz=free`. Default: none.
    #[arg(long = "interval", value_name = "AXIS=WIDTH,…", value_delimiter = ',', allow_hyphen_values = true,
          value_parser = Interval::parse, help_heading = TARGETS)]
    pub(super) intervals: Vec<Interval>,

    #[command(flatten)]
    pub(super) obstacles: ObstacleArguments,

    #[command(flatten)]
    pub(super) chain: ChainArguments,

    /// The furthest that a joint may move from point to point on the same branch, in radians (--degrees); slides by the metres that
    /// weigh as much. Default: 0.2 rad.
    #[arg(long, value_name = "ANGLE", value_parser = number_list::positive, help_heading = LIMITS)]
    max_step: Option<f64>,

    /// A step in which a joint would be faster than its velocity limit, by the table's times, is a reconfiguration too. Default: off.
    #[arg(long, help_heading = LIMITS)]
    pub(super) keep_times: bool,

    /// Largest joint accelerations for the times of the rows, in radians (--degrees) or metres a second squared. The times are the shortest
    /// within these and the joints' velocity limits. One number for all, or as for --start. Default: those of --joint-limits, where it has any.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = LIMITS)]
    pub(super) accelerations: Option<Numbers>,

    /// Configurations that are known of a place at most, from 4 to 4096: more find more, and take longer. Default: 256.
    #[arg(long, value_name = "N", default_value_t = 256, hide_default_value = true, help_heading = LIMITS)]
    pub(super) samples: usize,

    /// What counts as reached, in metres and radians. Default: 1e-6.
    #[arg(long, value_name = "T", value_parser = number_list::positive, help_heading = LIMITS)]
    pub(super) tolerance: Option<f64>,

    /// What a radian or metre of each joint weighs in lengths: numbers above 0 as for --start, or one for all. Default: 1.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = PREFERENCES)]
    pub(super) joint_weights: Option<Numbers>,

    /// Write the rows to a file: .csv (a row a point, joints by name, after the time where there is one) or .json (as --json prints).
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    pub(super) out: Option<PathBuf>,

    /// End with exit code 3 where a point is missed. Default: off.
    #[arg(long, help_heading = OUTPUT)]
    pub(super) fail_on_miss: bool,

    /// Angles in options are in degrees. Default: radians.
    #[arg(long, help_heading = MODEL)]
    pub(super) degrees: bool,

    #[command(flatten)]
    pub(super) model_options: ModelOptions,
}

impl Arguments {
    /// Radians.
    pub(super) fn max_step(&self) -> f64 {
        match (self.max_step, self.degrees) {
            (Some(step), true) => step.to_radians(),
            (Some(step), false) => step,
            (None, _) => 0.2,
        }
    }
}

/// `--order`.
const ORDERS: [Choice<QuaternionOrder>; 2] = [
    ("w-first", "qw, qx, qy, qz", QuaternionOrder::WFirst),
    ("w-last", "qx, qy, qz, qw", QuaternionOrder::WLast),
];

/// `--traversal`.
const TRAVERSALS: [Choice<Traversal>; 3] = [
    ("open", "", Traversal::Open),
    ("cyclic", "", Traversal::Cyclic),
    ("any-start", "", Traversal::AnyStart),
];
