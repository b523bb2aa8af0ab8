//! Options of the arm solver only.

use clap::Args;
use kinopt::arm::{Axis, Search};

use super::interval::Interval;
use crate::choices::{AXES, among, first_given};
use crate::help_headings::{FOLLOWING, PREFERENCES, SEARCH, TARGETS};
use crate::number_list::{self, Numbers};

/// How far apart distinct solutions are unless said otherwise, in radians (or metres) of joint
/// distance.
const APART: f64 = 0.5;

/// Options of robots' single frames, some of figures too; those of an arm do not go with the general solvers.
#[derive(Args, Clone, Debug)]
pub(crate) struct ArmArguments {
    /// Which of several answers is wanted. Default: start.
    ///
    /// Of a rig, scene or capture: `start`, where the figure comes to as it settles from its start, in
    /// small steps, as a drag does; other places are searched only where that misses, and taken only
    /// where they reach, which is told. `first`: a search from several places at once, as with
    /// --solver and --max-iterations. Of a robot:
    ///
    /// `start`: the one that the start's own attempt comes to, others only where it fails; `first`:
    /// whichever is fastest; `nearest` to the start by the root of the summed squares of the joints'
    /// moves; `distinct:K`: up to K, nearest first, that are more than 0.5 (radians and metres)
    /// apart, or more than D with `distinct:K,D`.
    #[arg(long, value_name = "start|first|nearest|distinct:K", value_parser = search,
          conflicts_with_all = METHOD, help_heading = SEARCH)]
    pub(super) search: Option<Search>,

    /// How far each joint may move from the start, in radians (--degrees) and metres: one number,
    /// or one a joint. Default: as far as its limits.
    ///
    /// One number a joint goes by all moving joints in the order of `kinopt info`, or, of an arm, by the free
    /// joints from base to tip. Of a ball, whose four numbers are the same, it is the angle that it turns by. A body or a
    /// figure does not settle on the way then; of a path each step counts from the one before.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = SEARCH, hide_short_help = true)]
    pub(super) max_move: Option<Numbers>,

    /// A configuration to come close to where the target leaves room, in radians (--degrees) and
    /// metres. Robots only. Default: none.
    ///
    /// Numbers as for --max-move. It goes with the searches start and first.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some,
          conflicts_with_all = GENERAL, help_heading = PREFERENCES, hide_short_help = true)]
    pub(super) posture: Option<Numbers>,

    /// An axis of the target's frame about which its frame may turn freely (a drill, a suction cup).
    /// Default: none. Of several targets each that has an orientation.
    #[arg(long, value_name = "AXIS", value_parser = among(AXES), conflicts_with = "position_only",
          help_heading = TARGETS, hide_short_help = true)]
    pub(super) free_axis: Option<Axis>,

    /// Room on axes of the target's frame, separated by commas: in metres along x, y, z, in radians
    /// (--degrees) about them as rx, ry, rz. Default: none.
    ///
    /// `x=0.01` is 1 cm either way, `x=-0.01..0.03` from 1 cm before the target to 3 cm beyond it,
    /// `x=free` anywhere. Turns are either way: `rz=0.5`, `rz=free`. A target without an orientation
    /// has the axes of --base. Of several targets each has this room, in turns those with an orientation.
    #[arg(long = "interval", value_name = "AXIS=WIDTH,…", value_delimiter = ',',
          allow_hyphen_values = true, value_parser = Interval::parse,
          help_heading = TARGETS, hide_short_help = true)]
    pub(super) intervals: Vec<Interval>,

    /// What a radian or metre of each joint weighs where answers are compared (--search nearest and
    /// distinct, --posture): numbers above 0 as for --max-move. Robots only. Default: 1 for each.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some,
          conflicts_with_all = GENERAL, help_heading = PREFERENCES, hide_short_help = true)]
    pub(super) joint_weights: Option<Numbers>,

    /// Answer a miss by the best place anywhere.
    ///
    /// A robot's path whose branch ends goes on by a jump. Default: a miss stays near the start, a path on
    /// its branch.
    #[arg(long, conflicts_with_all = METHOD, help_heading = SEARCH, hide_short_help = true)]
    pub(super) global_search_on_miss: bool,

    /// Follow --targets as a servo does: one a tick, so many ticks a second.
    ///
    /// Robots only. Default: off. It begins at the first start; every tick keeps the position, velocity, acceleration and jerk limits of
    /// the joints (the files', or --velocity-limits, --acceleration-limits and --jerk-limits). Told: how ticks ended, top speeds, the error
    /// at last (JSON: every tick's q, velocity, errors and what held which joint). --fail-on-miss counts
    /// the last target.
    #[arg(long, value_name = "HZ", value_parser = number_list::positive,
          conflicts_with_all = ["solver", "jacobian", "max_iterations", "rays", "targets", "track", "batch", "threads", "search", "max_move", "time_limit", "attempts", "restarts", "global_search_on_miss"],
          help_heading = FOLLOWING)]
    pub(super) servo: Option<f64>,

    /// Velocity limits of the joints for --servo, radians (--degrees) or metres a second: numbers as for --max-move. Default: those of
    /// the robot's files.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = FOLLOWING,
          hide_short_help = true)]
    pub(super) velocity_limits: Option<Numbers>,

    /// Acceleration limits of the joints for --servo, radians (--degrees) or metres a second squared: numbers as for --max-move.
    /// Default: those of the robot's files.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = FOLLOWING,
          hide_short_help = true)]
    pub(super) acceleration_limits: Option<Numbers>,

    /// Jerk limits of the joints for --servo, radians (--degrees) or metres a second cubed: numbers as for --max-move. Default: those
    /// of the robot's files.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, value_parser = Numbers::parse_some, help_heading = FOLLOWING,
          hide_short_help = true)]
    pub(super) jerk_limits: Option<Numbers>,

    /// Keep the tool on the straight line to each target of --servo, slower rather than off it.
    #[arg(long, requires = "servo", help_heading = FOLLOWING, hide_short_help = true)]
    pub(super) straight_line: bool,

    /// Metres that weigh as much as a radian where a target is out of reach. Robots only. Default: a
    /// quarter of the arm's length.
    #[arg(long, value_name = "METRES", value_parser = number_list::positive,
          conflicts_with_all = GENERAL, help_heading = PREFERENCES, hide_short_help = true)]
    pub(super) metres_per_radian: Option<f64>,
}

const GENERAL: [&str; 4] = ["solver", "jacobian", "max_iterations", "rays"];
const METHOD: [&str; 3] = ["solver", "jacobian", "max_iterations"];

impl ArmArguments {
    /// The first of the options that was given, if any; of a `rig`, and of what `settles` from where it stands, those that it understands
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
        None => (numbers, APART),
    };
    match k.parse() {
        Ok(k) if k > 0 => Ok(Search::Distinct { k, distance }),
        _ => Err(format!("`{k}` is not a number of answers of at least 1")),
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
        assert_eq!(search("distinct:4"), distinct(4, APART));
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
