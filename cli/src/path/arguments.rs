//! Arguments of `kinopt path`.

use std::path::PathBuf;

use clap::Args;
use kinopt::motion::path::Traversal;
use kinopt::spatial::Placement;

use crate::choices::among;
use crate::failure::Outcome;
use crate::help_headings::{LIMITS, MODEL, OUTPUT, TARGETS};
use crate::model_options::ModelOptions;
use crate::problem::Problem;
use crate::problem::body::Lock;
use crate::problem::interval::Interval;
use crate::problem::number_list::{self, Numbers};
use crate::problem::target;
use crate::solve::arguments::{set, set_list, with_problem_note};

const EXAMPLES: &str = "\
Examples:
  kinopt path robot.urdf weld.csv --tip tool --out joints.csv
  kinopt path robot.urdf weld.csv --tip tool --interval rz=free --world cell.json --margin 0.01
  kinopt path robot.urdf contour.csv --tip tool --traversal any-start
  kinopt path robot.urdf weld.csv --tip tool --joint-limits joint_limits.yaml --out timed.csv

A reconfiguration is a step in which a joint moves more than --max-step. The report bounds the
deviation from straight segments. Columns of the table and JSON fields: docs/guide/paths.md.";

/// Joint path for a Cartesian path of a robot's tool, with the fewest reconfigurations.
#[derive(Args, Debug)]
#[command(after_help = with_problem_note(EXAMPLES))]
pub(crate) struct Arguments {
    /// Robot file: .urdf or MJCF .xml.
    #[arg(value_name = "ROBOT")]
    pub(super) robot: PathBuf,

    /// CSV table of points: x,y,z, optionally a quaternion, time and tool.
    #[arg(value_name = "PATH.csv")]
    pub(super) path: PathBuf,

    /// Frame that follows the path. Default: the robot's only tip.
    #[arg(long, value_name = "FRAME", help_heading = TARGETS)]
    tip: Option<String>,

    /// Frame in which the path is given. Default: the robot's root link.
    #[arg(long, value_name = "FRAME", help_heading = TARGETS)]
    base: Option<String>,

    /// Placement of the table's frame in the base: x,y,z[,qw,qx,qy,qz].
    #[arg(long, value_name = "PLACEMENT", allow_hyphen_values = true,
          value_parser = target::parse_placement, help_heading = TARGETS)]
    pub(super) at: Option<Placement<f64>>,

    /// open, cyclic (ends in its first q) or any-start. Default: open.
    #[arg(long, value_name = "TRAVERSAL", value_parser = among(TRAVERSALS), default_value = "open",
          hide_default_value = true, hide_possible_values = true, help_heading = TARGETS)]
    pub(super) traversal: Traversal,

    /// Configuration at the first point, one number a joint. Default: any.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, help_heading = TARGETS)]
    pub(super) start: Option<Numbers>,

    /// Configuration at the last point. Default: any.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, help_heading = TARGETS)]
    pub(super) end: Option<Numbers>,

    /// Ignore orientations. Default: off if the table has them.
    #[arg(long, help_heading = TARGETS)]
    position_only: bool,

    /// Goal bounds in m and rad: x=0.01,z=0..0.05,rz=free.
    #[arg(long, value_name = "AXIS=WIDTH,…", value_delimiter = ',', allow_hyphen_values = true,
          help_heading = TARGETS)]
    interval: Vec<Interval>,

    /// Avoid self-collisions and the obstacles of a .json or MoveIt .yaml file.
    #[arg(long, value_name = "FILE", help_heading = TARGETS)]
    world: Option<PathBuf>,

    /// Required distance in metres; without --world between links. Default: 0.
    #[arg(long, value_name = "M", value_parser = number_list::not_negative, help_heading = TARGETS)]
    margin: Option<f64>,

    /// Tool placement in the tip: x,y,z[,qw,qx,qy,qz].
    #[arg(long, value_name = "PLACEMENT", allow_hyphen_values = true,
          value_parser = target::parse_placement, help_heading = MODEL)]
    tool: Option<Placement<f64>>,

    /// Lock a joint at a value, or at its rest value. Repeatable.
    #[arg(long, value_name = "JOINT[=VALUE]", help_heading = MODEL)]
    lock: Vec<Lock>,

    /// Joint limits as in MoveIt's joint_limits.yaml. Default: the robot's file.
    #[arg(long, value_name = "FILE", help_heading = MODEL)]
    joint_limits: Option<PathBuf>,

    #[command(flatten)]
    model_options: ModelOptions,

    /// Largest displacement in a step, in radians or weighted metres. Default: 0.2 rad.
    #[arg(long, value_name = "ANGLE", value_parser = number_list::positive, help_heading = LIMITS)]
    max_step: Option<f64>,

    /// Count steps above velocity limits, by the table's times, as reconfigurations.
    #[arg(long, help_heading = LIMITS)]
    pub(super) keep_times: bool,

    /// Joint acceleration limits of the times, rad/s² or m/s².
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, help_heading = LIMITS)]
    pub(super) accelerations: Option<Numbers>,

    /// Tolerance in metres and radians. Default: 1e-6.
    #[arg(long, value_name = "T", value_parser = number_list::positive, help_heading = LIMITS)]
    tolerance: Option<f64>,

    /// Write the rows to a .csv file, or the report to a .json file.
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    pub(super) out: Option<PathBuf>,

    /// Exit with code 3 if a point is not reached.
    #[arg(long, help_heading = OUTPUT)]
    pub(super) fail_on_miss: bool,

    /// Angles in options are degrees. Default: radians.
    #[arg(long, help_heading = OUTPUT)]
    pub(super) degrees: bool,
}

impl Arguments {
    /// Problem of the file with these arguments.
    pub(super) fn problem(&self) -> Outcome<Problem> {
        let mut problem = self.model_options.problem()?;
        let Problem {
            goal,
            model,
            collisions,
            ..
        } = &mut problem;
        set(&mut goal.tip, self.tip.as_ref());
        set(&mut goal.base, self.base.as_ref());
        set(&mut goal.tool, self.tool.as_ref());
        goal.position_only |= self.position_only;
        let intervals = self.interval.iter();
        let intervals = intervals.map(|interval| interval.typed(self.degrees));
        set_list(&mut goal.interval, intervals);
        let locks = self.lock.iter().map(|lock| lock.typed(self.degrees));
        set_list(&mut model.lock, locks);
        set(&mut model.joint_limits, self.joint_limits.as_ref());
        set(&mut collisions.world, self.world.as_ref());
        set(&mut collisions.margin, self.margin.as_ref());
        set(&mut problem.solve.tolerance, self.tolerance.as_ref());
        Ok(problem)
    }

    /// Largest joint displacement of a step, in radians.
    pub(super) fn max_step(&self) -> f64 {
        match (self.max_step, self.degrees) {
            (Some(step), true) => step.to_radians(),
            (Some(step), false) => step,
            (None, _) => 0.2,
        }
    }
}

/// Values of `--traversal`.
const TRAVERSALS: [(&str, Traversal); 3] = [
    ("open", Traversal::Open),
    ("cyclic", Traversal::Cyclic),
    ("any-start", Traversal::AnyStart),
];
