//! What `kinopt solve` is told.

use std::path::PathBuf;
use std::time::Duration;

use clap::{ArgGroup, Args};
use kinopt::Solver;
use kinopt::arm::Search;
use kinopt::ik::Restarts;
use kinopt::problem::Derivatives;
use kinopt::robot::Robot;
use kinopt::skinning::SkinningMethod;
use kinopt::solver::Stopping;

use super::arm_arguments::ArmArguments;
use super::chain_arguments::ChainArguments;
use super::out_file::OutFile;
use super::weights::FrameWeight;
use crate::failure::{Failure, Outcome};
use crate::help_headings;
use crate::joint_columns::JointColumns;
use crate::loaded_model::{LoadedModel, Moment};
use crate::method_choice::{self, JacobianRoute};
use crate::number_list;
use crate::robot_options::RobotOptions;
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
    group = ArgGroup::new("wanted").required(true).multiple(true).args(["targets", "rays", "file"])
)]
pub(crate) struct Arguments {
    /// The model: a robot's .urdf, a rig's .json, a scene's .glb or .gltf or a motion capture's .bvh file.
    #[arg(value_name = "MODEL")]
    pub(super) model: PathBuf,

    /// Where a frame should be, in metres (rigs: their own unit).
    ///
    /// Default: none. Three numbers are a point; with a quaternion w,x,y,z it is a whole pose. In a robot a frame
    /// is a link. In a rig `bone/3` or a bone's name is that bone's tip; `bone/3/tip` and
    /// `bone/3/tail` say it outright. Repeat it for several. At least one --target, --ray or
    /// --targets is needed.
    #[arg(long = "target", value_name = "FRAME=x,y,z[,qw,qx,qy,qz]", value_parser = Target::parse,
          help_heading = help_headings::TARGETS)]
    pub(super) targets: Vec<Target>,

    /// A line that a frame should lie on, in metres (rigs: their own unit).
    ///
    /// Default: none. It goes through an eye and a point (the mouse, unprojected). Frames are named as for
    /// --target. Repeat it for several.
    #[arg(long = "ray", value_name = "FRAME=ex,ey,ez:mx,my,mz", value_parser = RayTarget::parse,
          help_heading = help_headings::TARGETS)]
    pub(super) rays: Vec<RayTarget>,

    /// Many independent targets of one frame, from a JSON file.
    ///
    /// Its keys: "targets", a list of [x,y,z] or [x,y,z,qw,qx,qy,qz] in metres; and where wanted
    /// "starts", a configuration for each (radians and metres); "joint_names", which says what the
    /// starts' numbers belong to (without it they are all moving joints in the order of `kinopt
    /// info`, or the free joints from base to tip); "tip_link" and "base_link". Other keys are not
    /// looked at. Without starts each begins at --start. Targets that are missed are no failure.
    #[arg(long = "targets", value_name = "FILE", id = "file",
          conflicts_with_all = ["targets", "rays", "out"],
          help_heading = help_headings::TARGETS)]
    pub(super) file: Option<PathBuf>,

    /// The frame that --targets are for.
    ///
    /// Default: the file's tip_link, or a robot's only tip.
    // Not `requires`: clap waives that for what conflicts with an argument given.
    #[arg(long, value_name = "FRAME", conflicts_with_all = ["targets", "rays"],
          help_heading = help_headings::TARGETS)]
    pub(super) tip: Option<String>,

    /// The frame that targets are given in.
    ///
    /// Default: the base_link of a file of targets, or the world, which for a robot is its root link.
    #[arg(long, value_name = "FRAME", conflicts_with = "rays",
          help_heading = help_headings::TARGETS)]
    pub(super) base: Option<String>,

    /// Take --targets as a path: each starts from the answer before it.
    ///
    /// Default: off. The first starts from the file's first start. Steps in which a joint moves further than
    /// 0.2 rad are told (JSON: "jumps" in the summary, "continuous" where it is no flip to another
    /// branch; robots only).
    #[arg(long, conflicts_with_all = ["targets", "rays"],
          help_heading = help_headings::FOLLOWING)]
    pub(super) track: bool,

    /// Solve --targets together, which is faster; only the mean time is told. Default: one at a
    /// time, each timed alone.
    #[arg(long, conflicts_with_all = ["track", "targets", "rays"],
          help_heading = help_headings::TARGETS, hide_short_help = true)]
    pub(super) batch: bool,

    /// Solve --targets on so many threads. Default: 1.
    ///
    /// The answers are the same to the bit on any number. Times are best taken on one.
    #[arg(long, value_name = "N", conflicts_with_all = ["track", "targets", "rays"],
          value_parser = clap::value_parser!(u16).range(1..=1024),
          help_heading = help_headings::TARGETS, hide_short_help = true)]
    pub(super) threads: Option<u16>,

    #[command(flatten)]
    pub(super) arm: ArmArguments,

    #[command(flatten)]
    pub(super) chain: ChainArguments,

    /// How much a frame counts beside the others that something is asked of: its errors are multiplied
    /// by a number above 0. For several targets, rays or held tips. Default: 1 for each.
    #[arg(long = "weight", value_name = "FRAME=W", value_parser = FrameWeight::parse,
          help_heading = help_headings::TARGETS, hide_short_help = true)]
    pub(super) weights: Vec<FrameWeight>,

    /// End with exit code 3 where a target is missed, for scripts.
    ///
    /// Default: off; a miss is an answer, and the exit code 0.
    #[arg(long,
          help_heading = help_headings::OUTPUT)]
    pub(super) fail_on_miss: bool,

    /// The position of targets alone counts, even where they have a quaternion. Default: off.
    #[arg(long,
          help_heading = help_headings::TARGETS, hide_short_help = true)]
    pub(super) position_only: bool,

    /// A bone that stays where it is, or `none`.
    ///
    /// Default: the tips that a rig's file pins; in a scene the trunk, which does not turn, and the ends
    /// of the other limbs. Its tip stays; a bone that carries what has a target does not turn, nor do those above it.
    /// Repeat it for several.
    #[arg(long, value_name = "BONE",
          help_heading = help_headings::MODEL)]
    pub(super) hold: Vec<String>,

    /// Hold nothing: --hold none.
    ///
    /// Default: off.
    #[arg(long, conflicts_with = "hold",
          help_heading = help_headings::MODEL, hide_short_help = true)]
    pub(super) free: bool,

    /// Where the search starts: a word, or numbers in radians and metres.
    ///
    /// `rest` is all zeros, moved into the limits; `random` is drawn within the limits from
    /// --rng-seed; numbers are a configuration in the order of `kinopt info`: radians (degrees with
    /// --degrees) and, for sliding joints, metres. They are moved into the limits.
    #[arg(long, value_name = "NUMBERS|rest|random", default_value = "rest",
          allow_hyphen_values = true, value_parser = Start::parse,
          help_heading = help_headings::SEARCH)]
    pub(super) start: Start,

    /// Rest is how a scene or a capture is at this time of a clip, in seconds. Default: as its file has it.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true,
          value_parser = number_list::number,
          help_heading = help_headings::MODEL, hide_short_help = true)]
    pub(super) time: Option<f64>,

    /// With --time: which of a scene's clips: its name, or the end of it. Default: the first.
    #[arg(long, value_name = "NAME", requires = "time",
          help_heading = help_headings::MODEL, hide_short_help = true)]
    pub(super) clip: Option<String>,

    /// Angles in options and in text output are in degrees.
    ///
    /// Those of --start, --lock, --max-move, --posture, --interval and --velocity-limits. Default: radians.
    #[arg(long,
          help_heading = help_headings::OUTPUT)]
    pub(super) degrees: bool,

    /// Go through the general solvers with this method. Default: levenberg-marquardt where they
    /// are needed.
    #[arg(long, value_name = "NAME", value_parser = method_choice::names(),
          help_heading = help_headings::SEARCH, hide_short_help = true)]
    pub(super) solver: Option<String>,

    /// How the general solvers find derivatives. Default: analytic.
    #[arg(long, value_name = "ROUTE", value_enum,
          help_heading = help_headings::SEARCH, hide_short_help = true)]
    pub(super) jacobian: Option<JacobianRoute>,

    /// Seed of a random start and of the restarts: a whole number. Same seed, same result.
    #[arg(long, value_name = "N", default_value_t = 0,
          help_heading = help_headings::SEARCH, hide_short_help = true)]
    pub(super) rng_seed: u64,

    /// Stop after so many milliseconds with the best found.
    ///
    /// Default: no limit. For each target of its own. Results then depend on the machine. The clock runs while solving,
    /// not while reading files.
    #[arg(long, value_name = "MS", value_parser = milliseconds,
          help_heading = help_headings::LIMITS)]
    pub(super) time_limit: Option<Duration>,

    /// What counts as reached, in metres and radians.
    ///
    /// For rigs in their own unit. Default: 1e-9 of a rig's size and 1e-9 rad; 1e-6 m and rad for robots.
    #[arg(long, value_name = "T", value_parser = number_list::not_negative,
          help_heading = help_headings::LIMITS)]
    pub(super) tolerance: Option<f64>,

    /// How many attempts at most for one target, the start's own included. Default: 200 for an
    /// arm, 32 for the general solvers.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..),
          help_heading = help_headings::LIMITS, hide_short_help = true)]
    pub(super) attempts: Option<u32>,

    /// How many more attempts from other places while the targets are missed, 0 for none: --attempts
    /// less one.
    #[arg(long, value_name = "N", conflicts_with = "attempts",
          help_heading = help_headings::LIMITS, hide_short_help = true)]
    pub(super) restarts: Option<u32>,

    /// How many steps each attempt of the general solvers may take. Default: 200.
    ///
    /// The gradient methods take many small ones.
    #[arg(long, value_name = "N",
          help_heading = help_headings::LIMITS, hide_short_help = true)]
    pub(super) max_iterations: Option<u32>,

    /// Write the posed mesh: .obj, .ply or .glb; of captures the pose: .bvh.
    ///
    /// Default: not written. A mesh needs a rig or a scene that has one.
    #[arg(long, value_name = "FILE", value_parser = OutFile::parse,
          help_heading = help_headings::OUTPUT)]
    pub(super) out: Option<OutFile>,

    /// With --out: how a rig's skin weights are made up. Default: those of the file, else by heat.
    #[arg(
        long,
        value_enum,
        requires = "out",
        conflicts_with = "file",
        hide_default_value = true,
          help_heading = help_headings::MESHES, hide_short_help = true)]
    pub(super) skin_weights: Option<WeightsChoice>,

    /// With --out: how the bones move the skin.
    #[arg(long, value_name = "METHOD", requires = "out", conflicts_with = "file", default_value_t,
          value_parser = skinning_choice::parser(),
          help_heading = help_headings::MESHES, hide_short_help = true)]
    pub(super) skinning: SkinningMethod,

    #[command(flatten)]
    pub(super) robot: RobotOptions,
}

fn count(count: u32) -> usize {
    usize::try_from(count).unwrap_or(usize::MAX)
}

/// A time limit that a clock can hold: above zero, at most 30 years.
fn milliseconds(text: &str) -> Result<Duration, String> {
    let milliseconds = number_list::positive(text)?;
    if milliseconds > 1e12 {
        return Err(format!("`{text}` is above 1e12 ms"));
    }
    Duration::try_from_secs_f64(milliseconds * 1e-3).map_err(|error| error.to_string())
}

impl Arguments {
    /// When a figure is as the search finds it.
    pub(super) fn moment(&self) -> Option<Moment<'_>> {
        let clip = self.clip.as_deref();
        self.time.map(|time| Moment { time, clip })
    }

    /// How many attempts at most, as typed.
    pub(super) fn attempts(&self) -> Option<u32> {
        self.attempts
            .or_else(|| self.restarts.map(|restarts| restarts.saturating_add(1)))
    }

    /// Whether a figure settles from where it stands before anything is searched for.
    pub(super) fn settles(&self) -> bool {
        let plain = self.solver.is_none() && self.max_iterations.is_none();
        plain && self.arm.search != Some(Search::First)
    }

    /// The derivatives of the general solvers.
    pub(super) fn derivatives(&self) -> Derivatives {
        self.jacobian.map(Derivatives::from).unwrap_or_default()
    }

    /// A length in metres (rigs: their own unit), and radians.
    pub(super) fn tolerances(&self, loaded: &LoadedModel) -> (f64, f64) {
        match self.tolerance {
            Some(tolerance) => (tolerance, tolerance),
            None => loaded.default_tolerances(),
        }
    }

    /// The limits of the general solver's attempts.
    pub(super) fn stopping(&self) -> Stopping {
        let mut stopping = Stopping::default();
        if let Some(iterations) = self.max_iterations {
            stopping = stopping.with_max_iterations(count(iterations));
        }
        match self.time_limit {
            Some(limit) => stopping.with_time_limit(limit),
            None => stopping,
        }
    }

    /// The general solver with its limits.
    pub(super) fn general_solver(&self) -> Solver {
        let mut restarts = Restarts::default().with_seed(self.rng_seed);
        if let Some(attempts) = self.attempts() {
            restarts = restarts.with_attempts(count(attempts));
        }
        let solver = match &self.solver {
            Some(name) => method_choice::solver(name),
            None => Solver::default(),
        };
        solver
            .with_stopping(self.stopping())
            .with_restarts(restarts)
    }

    /// The robot whose arm answers, or none for the general solvers.
    ///
    /// # Errors
    /// An option that only the arm understands where it does not answer.
    pub(super) fn arm_of<'l>(&self, loaded: &'l LoadedModel) -> Outcome<Option<&'l Robot>> {
        // clap's `requires` would not ask for an option that another forbids.
        if self.arm.velocity_limits.is_some() && self.arm.servo.is_none() {
            return Err(Failure::usage("--velocity-limits is for --servo"));
        }
        let general =
            self.solver.is_some() || self.jacobian.is_some() || self.max_iterations.is_some();
        let one_frame = self.file.is_some() || (self.targets.len() == 1 && self.rays.is_empty());
        match (&loaded.robot, self.arm.given(loaded.rig.is_some())) {
            (Some(_), _) if one_frame && !general && !self.weights.is_empty() => {
                Err(Failure::usage(
                    "--weight is for several targets or held tips; beside a single target's position \
                     --metres-per-radian weighs its orientation",
                ))
            }
            (Some(robot), _) if one_frame && !general => Ok(Some(robot)),
            (_, None) => Ok(None),
            (None, Some("--search")) => Err(Failure::usage(format!(
                "--search of a {} is start or first; the others are for robots",
                loaded.kind()
            ))),
            (None, Some(option)) => Err(Failure::usage(format!(
                "{option} is for robots, and {} is a {}",
                loaded.file,
                loaded.kind()
            ))),
            (Some(_), Some(option)) => Err(Failure::usage(format!(
                "{option} is for one --target or for --targets, not for {} targets at once",
                self.targets.len()
            ))),
        }
    }

    /// Holds the joints that are not to move.
    pub(super) fn hold(&self, loaded: &mut LoadedModel) -> Outcome<()> {
        if !self.chain.holds() {
            return Ok(());
        }
        let all = loaded.model.degrees_of_freedom();
        let start = match &self.start {
            // Numbers for an arm's own joints say nothing of the others.
            Start::Numbers(numbers) if loaded.robot.is_some() && numbers.len() != all => {
                loaded.rest()
            }
            _ => self.start(loaded, None)?,
        };
        let held = self.chain.held(loaded, &start, self.degrees)?;
        loaded.held = Some(Box::new(held));
        Ok(())
    }

    /// Ends with a code of its own where --fail-on-miss wants it and targets were missed.
    pub(super) fn told_misses(&self, missed: usize, targets: usize) -> Outcome<()> {
        if missed == 0 || !self.fail_on_miss {
            return Ok(());
        }
        let what = match targets {
            1 => "the target was missed".to_owned(),
            _ => format!("{missed} of {targets} targets were missed"),
        };
        Err(Failure::Missed(what))
    }

    /// Where the search starts, within the limits; `arm` has the columns of an arm's own joints, which
    /// may be typed alone.
    pub(super) fn start(
        &self,
        loaded: &LoadedModel,
        arm: Option<JointColumns>,
    ) -> Outcome<Vec<f64>> {
        let start = match &self.start {
            Start::Rest => return Ok(loaded.rest()),
            Start::Random => loaded.model.random_configuration(self.rng_seed),
            Start::Numbers(numbers) => {
                let columns = arm.filter(|columns| {
                    numbers.len() == columns.width()
                        && numbers.len() != loaded.model.degrees_of_freedom()
                });
                let typed = match columns {
                    Some(columns) => columns.typed(numbers, self.degrees),
                    None => loaded.typed_configuration(numbers, self.degrees, "--start")?,
                };
                loaded.note_outside_limits(&typed, "the search starts within them");
                typed
            }
        };
        Ok(loaded.within_limits(&start))
    }
}
