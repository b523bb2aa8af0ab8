//! Options of arms.

use clap::Args;
use kinopt::arm::{Axis, Search};

use super::interval::Interval;
use crate::choices::{AXES, among, first_given};
use crate::help_headings::{FOLLOWING, PREFERENCES, SEARCH, TARGETS};
use crate::number_list::{self, Numbers};

/// Default distance between distinct solutions, in radians (or metres) of joint distance.
const DISTINCT_DISTANCE: f64 = 0.5;

/// Options of an arm; some also apply to skeletons. The general solver does not accept those of an arm.
#[derive(Args, Clone, Debug)]
pub(crate) struct ArmArguments {
    /// Choice among several solutions; see docs/guide/targets.md. Default: start.
    #[arg(long, value_name = "start|first|nearest|distinct:K", value_parser = search,
          conflicts_with_all = METHOD, help_heading = SEARCH)]
    pub(super) search: Option<Search>,

    /// Largest displacement from the start, rad and m, one or one a joint. Default: none.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = SEARCH, hide_short_help = true)]
    pub(super) max_move: Option<Numbers>,

    /// Nominal posture of a robot, in radians and metres, one number a joint. Default: none.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some,
          conflicts_with_all = GENERAL, help_heading = PREFERENCES, hide_short_help = true)]
    pub(super) posture: Option<Numbers>,

    /// Axis of the target about which the frame rotates freely. Default: none.
    #[arg(long, value_name = "AXIS", value_parser = among(AXES), conflicts_with = "position_only",
          help_heading = TARGETS, hide_short_help = true)]
    pub(super) free_axis: Option<Axis>,

    /// Goal bounds in m and rad along the target's axes: x=0.01,z=0..0.05,rz=free. Default: none.
    #[arg(long = "interval", value_name = "AXIS=WIDTH,…", value_delimiter = ',',
          allow_hyphen_values = true, value_parser = Interval::parse,
          help_heading = TARGETS, hide_short_help = true)]
    pub(super) intervals: Vec<Interval>,

    /// Weight of each joint in distances, above 0; robots only. Default: 1 each.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some,
          conflicts_with_all = GENERAL, help_heading = PREFERENCES, hide_short_help = true)]
    pub(super) joint_weights: Option<Numbers>,

    /// If not reached, return the closest pose of any branch. Default: the branch of the start.
    #[arg(long, conflicts_with_all = METHOD, help_heading = SEARCH, hide_short_help = true)]
    pub(super) global_search_on_miss: bool,

    /// Follow --targets as a servo, one a control cycle, at a rate in hertz. Default: off.
    #[arg(long, value_name = "HZ", value_parser = number_list::positive,
          conflicts_with_all = ["solver", "jacobian", "max_iterations", "rays", "targets", "track", "batch", "threads", "search", "max_move", "time_limit", "attempts", "restarts", "global_search_on_miss"],
          help_heading = FOLLOWING)]
    pub(super) servo: Option<f64>,

    /// Joint velocity limits of --servo, rad/s or m/s. Default: those of the robot's files.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = FOLLOWING,
          hide_short_help = true)]
    pub(super) velocity_limits: Option<Numbers>,

    /// Joint acceleration limits of --servo, rad/s² or m/s². Default: those of the robot's files.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = FOLLOWING,
          hide_short_help = true)]
    pub(super) acceleration_limits: Option<Numbers>,

    /// Joint jerk limits of --servo, rad/s³ or m/s³. Default: those of the robot's files.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = FOLLOWING,
          hide_short_help = true)]
    pub(super) jerk_limits: Option<Numbers>,

    /// With --servo: keep the tool on straight lines between targets. Default: off.
    #[arg(long, requires = "servo", help_heading = FOLLOWING, hide_short_help = true)]
    pub(super) straight_line: bool,

    /// Metres that weigh as much as a radian out of reach. Default: a quarter of the arm's length.
    #[arg(long, value_name = "METRES", value_parser = number_list::positive,
          conflicts_with_all = GENERAL, help_heading = PREFERENCES, hide_short_help = true)]
    pub(super) metres_per_radian: Option<f64>,
}

const GENERAL: [&str; 4] = ["solver", "jacobian", "max_iterations", "rays"];
const METHOD: [&str; 3] = ["solver", "jacobian", "max_iterations"];

impl ArmArguments {
    /// The first given option that only an arm accepts, if any. Options that a `rig` or a model that `settles` accepts
    /// do not count.
    pub(super) fn given(&self, rig: bool, settles: bool) -> Option<&'static str> {
        let searched = match self.search {
            Some(Search::Start | Search::First) => !rig,
            search => search.is_some(),
        };
        first_given([
            ("--search", searched),
            ("--posture", self.posture.is_some()),
            ("--joint-weights", self.joint_weights.is_some()),
            (
                "--global-search-on-miss",
                self.global_search_on_miss && !settles,
            ),
            ("--metres-per-radian", self.metres_per_radian.is_some()),
            ("--servo", self.servo.is_some()),
        ])
    }
}

fn search(text: &str) -> Result<Search, String> {
    match text {
        "start" => return Ok(Search::Start),
        "first" => return Ok(Search::First),
        "nearest" => return Ok(Search::Nearest),
        _ => {}
    }
    let Some(numbers) = text.strip_prefix("distinct:") else {
        return Err("expected start, first, nearest or distinct:K".to_owned());
    };
    let (k, distance) = match numbers.split_once(',') {
        Some((k, distance)) => (k, number_list::not_negative(distance)?),
        None => (numbers, DISTINCT_DISTANCE),
    };
    match k.parse() {
        Ok(k) if k > 0 => Ok(Search::Distinct { k, distance }),
        _ => Err(format!(
            "`{k}` is not a number of solutions; expected 1 or more"
        )),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn searches_by_name() {
        let distinct = |k, distance| Ok(Search::Distinct { k, distance });
        assert_eq!(search("start"), Ok(Search::Start));
        assert_eq!(search("distinct:4"), distinct(4, DISTINCT_DISTANCE));
        assert_eq!(search("distinct:4,0.25"), distinct(4, 0.25));
        for bad in [
            "",
            "distinct",
            "distinct:",
            "distinct:0",
            "distinct:2,-1",
            "best",
        ] {
            assert!(search(bad).is_err(), "{bad}");
        }
    }
}
