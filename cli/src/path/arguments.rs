//! Arguments of `kinopt path`.

use std::path::PathBuf;

use clap::Args;
use kinopt::motion::path::{Curve, Traversal};
use kinopt::spatial::Placement;
use kinopt_bindings::names::named;
use kinopt_bindings::problem_file::ProblemSettings;
use kinopt_bindings::problem_file::number_list::{self, Numbers};
use kinopt_bindings::problem_file::target;

use crate::choices::among;
use crate::failure::Outcome;
use crate::help_headings::{LIMITS, OUTPUT, TARGETS};
use crate::model_options::JointLimitsArgument;
use crate::solve::arguments::{QueryArguments, TipArguments, with_problem_note};

const EXAMPLES: &str = "\
Examples:
  kinopt path robot.urdf weld.csv --tip tool --out joints.csv
  kinopt path robot.urdf weld.csv --tip tool --interval rz=free --world cell.json --margin 0.01
  kinopt path robot.urdf contour.csv --tip tool --traversal any-start
  kinopt path robot.urdf keys.csv --tip tool --curve spline:0.005
  kinopt path robot.urdf weld.csv --tip tool --joint-limits joint_limits.yaml --out timed.csv

A reconfiguration is a step in which a joint moves more than --max-step. The report bounds the
deviation from straight segments. Columns of the table and JSON fields: docs/guide/paths.md.";

/// Joint path for a Cartesian path of a robot's tool, with the fewest reconfigurations.
#[derive(Args, Debug)]
#[command(after_help = with_problem_note(EXAMPLES))]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(super) query: QueryArguments,

    /// CSV table of points: x,y,z, optionally a quaternion, time and tool.
    #[arg(value_name = "PATH.csv")]
    pub(super) path: PathBuf,

    /// Placement of the table's frame in the base: x,y,z[,qw,qx,qy,qz].
    #[arg(long, value_name = "PLACEMENT", allow_hyphen_values = true,
          value_parser = target::parse_placement, help_heading = TARGETS)]
    pub(super) at: Option<Placement<f64>>,

    /// open, cyclic (ends in its first q) or any-start. Default: open.
    #[arg(long, value_name = "TRAVERSAL", value_parser = among(TRAVERSALS), default_value = "open",
          hide_default_value = true, hide_possible_values = true, help_heading = TARGETS)]
    pub(super) traversal: Traversal,

    /// straight, arc or spline through the rows. Default step: 0.01 m.
    #[arg(long, value_name = "CURVE[:STEP]", value_parser = curve, help_heading = TARGETS)]
    pub(super) curve: Option<(Curve, f64)>,

    /// Configuration at the first point, one number a joint. Default: any.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, help_heading = TARGETS)]
    pub(super) start: Option<Numbers>,

    /// Configuration at the last point. Default: any.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, help_heading = TARGETS)]
    pub(super) end: Option<Numbers>,

    #[command(flatten)]
    tip: TipArguments,

    #[command(flatten)]
    joint_limits: JointLimitsArgument,

    /// Largest joint displacement in a step. Default: 0.2 rad.
    #[arg(long, value_name = "ANGLE", value_parser = number_list::positive, help_heading = LIMITS)]
    max_step: Option<f64>,

    /// Joint acceleration limits of the times, rad/s² or m/s².
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, help_heading = LIMITS)]
    pub(super) accelerations: Option<Numbers>,

    /// Write the rows to a .csv file, or the report to a .json file.
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    pub(super) out: Option<PathBuf>,
}

impl Arguments {
    /// Problem of the file with these arguments.
    pub(super) fn problem(&self) -> Outcome<ProblemSettings> {
        self.query.problem(&[&self.tip, &self.joint_limits])
    }

    /// Largest joint displacement of a step, in radians.
    pub(super) fn max_step(&self) -> f64 {
        match (self.max_step, self.query.degrees) {
            (Some(step), true) => step.to_radians(),
            (Some(step), false) => step,
            (None, _) => 0.2,
        }
    }
}

/// Default largest distance of the points on a curve, metres.
const DEFAULT_STEP: f64 = 0.01;

/// Parses `CURVE` or `CURVE:STEP`.
fn curve(text: &str) -> Result<(Curve, f64), String> {
    let (name, step) = match text.split_once(':') {
        Some((name, step)) => (name, number_list::positive(step)?),
        None => (text, DEFAULT_STEP),
    };
    match named("curve", name, &CURVES) {
        Ok(curve) => Ok((curve, step)),
        Err(unknown) => Err(unknown.to_string()),
    }
}

/// Values of `--curve`.
const CURVES: [(&str, Curve); 3] = [
    ("straight", Curve::Straight),
    ("arc", Curve::Arc),
    ("spline", Curve::Spline),
];

/// Values of `--traversal`.
const TRAVERSALS: [(&str, Traversal); 3] = [
    ("open", Traversal::Open),
    ("cyclic", Traversal::Cyclic),
    ("any-start", Traversal::AnyStart),
];
