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
        joint path for a Cartesian path, with its reconfigurations
  kinopt path robot.urdf weld.csv --tip tool --out joints.csv
        joint values as a table, one row a point
  kinopt path robot.urdf weld.csv --tip tool --free-axis z --world cell.json --margin 0.01 --json
        any rotation about the tool axis, 1 cm from all obstacles
  kinopt path robot.urdf contour.csv --tip tool --traversal any-start
        a closed contour, with the best start point
  kinopt path robot.urdf weld.csv --tip tool --joint-limits joint_limits.yaml --out timed.csv
        with times within velocity and acceleration limits
  kinopt path robot.urdf path.csv --tip tool --at 0.5,0,0.3,0,1,0,0
        a path in a frame with this placement in the base

Exit codes: 0 done, 1 failed with a one-line reason, 2 wrong usage, 3 point not reached with
--fail-on-miss.";

/// Joint path for a Cartesian path of a robot's tool, with the fewest reconfigurations.
///
/// The path is a CSV table: x,y,z, optionally a quaternion, time and tool. A header names the columns. Without one, 7
/// columns are x,y,z,qw,qx,qy,qz, and 8 have a time first.
///
/// The solution has the fewest reconfigurations, then the shortest joint path. A reconfiguration is a step in which a
/// joint moves more than --max-step. The report bounds the deviation from the straight segments. It also lists points
/// that are not reached, and steps that may collide.
///
/// JSON fields and details: docs/guide/paths.md.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Robot file: .urdf or MJCF .xml.
    #[arg(value_name = "ROBOT")]
    pub(super) robot: PathBuf,

    /// Path: CSV table of points.
    #[arg(value_name = "PATH.csv")]
    pub(super) path: PathBuf,

    /// Frame that follows the path. Default: the robot's only tip.
    #[arg(long, value_name = "FRAME", help_heading = TARGETS)]
    pub(super) tip: Option<String>,

    /// Frame in which the path is given. Default: the world, for a robot its root link.
    #[arg(long, value_name = "FRAME", help_heading = TARGETS)]
    pub(super) base: Option<String>,

    /// Placement of the table's frame in the base, in metres. Default: identity.
    #[arg(long, value_name = "x,y,z[,qw,qx,qy,qz]", allow_hyphen_values = true,
          value_parser = target::parse_placement, help_heading = TARGETS)]
    pub(super) at: Option<Placement<f64>>,

    /// Order of quaternions without a header. Default: w-first.
    #[arg(long, value_name = "ORDER", value_parser = among(ORDERS), default_value = "w-first", hide_default_value = true, help_heading = TARGETS)]
    pub(super) order: QuaternionOrder,

    /// Placement of tool 1, 2, ... (table column `tool`) in the tip. Default: none. Repeatable.
    #[arg(long = "add-tool", value_name = "x,y,z[,qw,qx,qy,qz]", allow_hyphen_values = true,
          value_parser = target::parse_placement, help_heading = TARGETS)]
    pub(super) other_tools: Vec<Placement<f64>>,

    /// Traversal: open, cyclic (ends in its first q) or any-start (closed path). Default: open.
    #[arg(long, value_name = "TRAVERSAL", value_parser = among(TRAVERSALS), default_value = "open", hide_default_value = true, help_heading = TARGETS)]
    pub(super) traversal: Traversal,

    /// Configuration at the first point, in radians (--degrees) and metres. Default: any.
    ///
    /// One number for each free joint from base to tip, or for each moving joint in the order of `kinopt info`.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = TARGETS)]
    pub(super) start: Option<Numbers>,

    /// Configuration at the last point, in the format of --start. Default: any.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = TARGETS)]
    pub(super) end: Option<Numbers>,

    /// Ignore orientations. Default: off, unless the table has no orientations.
    #[arg(long, help_heading = TARGETS)]
    pub(super) position_only: bool,

    /// Axis of each point about which the tool rotates freely. Default: none.
    #[arg(long, value_name = "AXIS", value_parser = among(AXES), conflicts_with = "position_only", help_heading = TARGETS)]
    pub(super) free_axis: Option<Axis>,

    /// Goal bounds in m and rad along each point's axes: x=0.01,z=0..0.05,rz=free. Default: none.
    #[arg(long = "interval", value_name = "AXIS=WIDTH,…", value_delimiter = ',', allow_hyphen_values = true,
          value_parser = Interval::parse, help_heading = TARGETS)]
    pub(super) intervals: Vec<Interval>,

    #[command(flatten)]
    pub(super) obstacles: ObstacleArguments,

    #[command(flatten)]
    pub(super) chain: ChainArguments,

    /// Largest joint displacement in a step, in radians or weighted metres. Default: 0.2 rad.
    #[arg(long, value_name = "ANGLE", value_parser = number_list::positive, help_heading = LIMITS)]
    max_step: Option<f64>,

    /// Count steps above velocity limits, by the table's times, as reconfigurations. Default: off.
    #[arg(long, help_heading = LIMITS)]
    pub(super) keep_times: bool,

    /// Joint acceleration limits of the times, rad/s² or m/s². Default: --joint-limits.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = LIMITS)]
    pub(super) accelerations: Option<Numbers>,

    /// Largest number of configurations of a point, 4 to 4096. Default: 256.
    #[arg(long, value_name = "N", default_value_t = 256, hide_default_value = true, help_heading = LIMITS)]
    pub(super) samples: usize,

    /// Tolerance in metres and radians. Default: 1e-6.
    #[arg(long, value_name = "T", value_parser = number_list::positive, help_heading = LIMITS)]
    pub(super) tolerance: Option<f64>,

    /// Weight of each joint in lengths, above 0, one a joint or one for all. Default: 1.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = PREFERENCES)]
    pub(super) joint_weights: Option<Numbers>,

    /// Write the rows to a .csv file, or the report to a .json file. Default: no file.
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    pub(super) out: Option<PathBuf>,

    /// Exit with code 3 if a point is not reached. Default: off.
    #[arg(long, help_heading = OUTPUT)]
    pub(super) fail_on_miss: bool,

    /// Angles in options are degrees. Default: radians.
    #[arg(long, help_heading = MODEL)]
    pub(super) degrees: bool,

    #[command(flatten)]
    pub(super) model_options: ModelOptions,
}

impl Arguments {
    /// Largest joint displacement of a step, in radians.
    pub(super) fn max_step(&self) -> f64 {
        match (self.max_step, self.degrees) {
            (Some(step), true) => step.to_radians(),
            (Some(step), false) => step,
            (None, _) => 0.2,
        }
    }
}

/// Values of `--order`.
const ORDERS: [Choice<QuaternionOrder>; 2] = [
    ("w-first", "qw, qx, qy, qz", QuaternionOrder::WFirst),
    ("w-last", "qx, qy, qz, qw", QuaternionOrder::WLast),
];

/// Values of `--traversal`.
const TRAVERSALS: [Choice<Traversal>; 3] = [
    ("open", "", Traversal::Open),
    ("cyclic", "", Traversal::Cyclic),
    ("any-start", "", Traversal::AnyStart),
];
