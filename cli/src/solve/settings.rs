//! Settings of solvers and models, from a problem.

use kinopt::arm::Search;
use kinopt::ik::crouched_configuration;
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;
use kinopt_bindings::problem_file::start::{SolutionChoice, Start};
use kinopt_bindings::problem_file::{BodySettings, ModelSettings, ProblemSettings, SolveSettings};

use super::balance::up_axis;
use super::goals::Goals;
use super::held_frames;
use super::job::{Job, Mode};
use super::locked_joints::held_joints;
use crate::choices::first_given;
use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::joint_columns::JointColumns;
use crate::loaded_model::{LoadedModel, Moment};
use crate::model_options::read_srdf;

/// Time of a clip at which a skeleton is at rest.
pub(super) fn moment(model: &ModelSettings) -> Option<Moment<'_>> {
    let clip = model.clip.as_deref();
    model.time.map(|time| Moment { time, clip })
}

impl LoadedModel {
    /// Tolerances: a length in metres (skeletons: the file's unit), and an angle in radians.
    pub(super) fn tolerances(&self, solve: &SolveSettings) -> (f64, f64) {
        match solve.tolerance {
            Some(tolerance) => (tolerance, tolerance),
            None => self.default_tolerances(),
        }
    }

    /// Locks joints as the model settings say.
    pub(super) fn lock_joints(&mut self, problem: &ProblemSettings) -> Outcome<()> {
        if !problem.model.locks() {
            return Ok(());
        }
        let all = self.model.configuration_len();
        let start = match &problem.solve.start {
            // Numbers for the joints of an arm do not define the others.
            Start::Numbers(numbers) if self.robot.is_some() && numbers.values.len() != all => {
                self.rest()
            }
            _ => self.start(problem, None, &self.rest())?,
        };
        let held = held_joints(&problem.model, self, &start)?;
        self.held = Some(Box::new(held));
        Ok(())
    }

    /// Reads the SRDF file, if one is given.
    pub(crate) fn read_srdf(&mut self, settings: &ModelSettings) -> Outcome<()> {
        let Some(file) = &settings.srdf else {
            return match &settings.group {
                Some(_) => Err(usage!("`group` needs `srdf`")),
                None => Ok(()),
            };
        };
        let Some(robot) = &self.robot else {
            return Err(usage!("{}: `srdf` is for robots", self.file));
        };
        self.srdf = Some(Box::new(read_srdf(settings, file, robot)?));
        Ok(())
    }

    /// Rest configuration with slightly bent knees above the held frames.
    fn bent(&self, body: &BodySettings) -> Outcome<Vec<f64>> {
        if self.model.free_joints().is_empty() {
            return Err(usage!(
                "--start bent needs a free base (--base-joint free) and feet named by --hold"
            ));
        }
        let hold = body.hold.iter();
        let named = hold.filter(|name| *name != held_frames::NOTHING);
        let feet = named.map(|name| self.frame(name, BareName::Tip));
        let feet = feet.collect::<Result<Vec<_>, _>>()?;
        let (parameters, up) = (self.parameters(), Vector3::UNITS[up_axis(body, self)]);
        let rest = self.rest();
        Ok(crouched_configuration(
            &self.model,
            &parameters,
            &feet,
            &rest,
            up,
        )?)
    }

    /// Start configuration within the limits. `arm` has the columns of an arm's joints, which may be typed alone.
    /// `default` is the start without --start.
    pub(super) fn start(
        &self,
        problem: &ProblemSettings,
        arm: Option<JointColumns>,
        default: &[f64],
    ) -> Outcome<Vec<f64>> {
        let start = match &problem.solve.start {
            Start::Default => return Ok(default.to_vec()),
            Start::Rest => return Ok(self.rest()),
            Start::Bent => return self.bent(&problem.body),
            Start::Random => self.model.random_configuration(problem.solve.rng_seed),
            Start::Numbers(numbers) => {
                let (values, degrees) = (numbers.values.as_slice(), numbers.degrees);
                let columns = arm.filter(|columns| {
                    values.len() == columns.width()
                        && values.len() != self.model.configuration_len()
                });
                let typed = match columns {
                    Some(columns) => columns.typed(values, degrees),
                    None => self.typed_configuration(values, degrees, "--start")?,
                };
                self.note_outside_limits(
                    &typed,
                    "the search starts at the nearest values within them",
                );
                typed
            }
        };
        Ok(self.within_limits(&start))
    }
}

impl Job<'_> {
    /// Checks settings that depend on each other or on the subcommand.
    pub(super) fn check_settings(&self) -> Outcome<()> {
        let ProblemSettings { goal, solve, .. } = self.problem;
        if self.problem.model.clip.is_some() && self.problem.model.time.is_none() {
            return Err(usage!("`clip` needs `time`"));
        }
        let with_derivative = match self.mode {
            Mode::One(_) => solve.max_move.is_none(),
            Mode::Batch(_, options) => solve.max_move.is_none() && !options.together,
            Mode::Track(_) | Mode::Servo(..) | Mode::Reach(..) => false,
        };
        if self.problem.output.derivative && !with_derivative {
            return Err(usage!(
                "`derivative` is for single solves without --max-move"
            ));
        }
        if let Mode::One(_) | Mode::Reach(None, ..) = self.mode {
            let body = &self.problem.body;
            if goal.target.is_empty() && matches!(self.mode, Mode::Reach(..)) {
                return Err(usage!(
                    "no targets: give --target FRAME=x,y,z[,qw,qx,qy,qz] or --targets FILE"
                ));
            }
            let is_empty = goal.target.is_empty() && goal.ray.is_empty();
            return match is_empty && self.problem.tasks.is_empty() && !body.has_centre_of_mass() {
                true => Err(usage!(
                    "nothing to solve: give --target FRAME=x,y,z[,qw,qx,qy,qz], or `tasks` in a --problem file"
                )),
                false => Ok(()),
            };
        }
        if !goal.target.is_empty() || !goal.ray.is_empty() {
            return Err(usage!(
                "--targets: the problem file has `target` or `ray`, which are for kinopt solve and body"
            ));
        }
        let Mode::Servo(..) = self.mode else {
            return Ok(());
        };
        let given = first_given([
            ("`search`", solve.search.is_some()),
            ("`max_move`", solve.max_move.is_some()),
            ("`time_limit`", solve.time_limit.is_some()),
            ("`attempts`", solve.attempts.is_some()),
            ("`global_search_on_miss`", solve.global_search_on_miss),
        ]);
        match given {
            Some(setting) => Err(usage!("{setting} does not apply to kinopt servo")),
            None => Ok(()),
        }
    }

    /// Robot whose arm solves the query, or `None` for the general solver.
    ///
    /// # Errors
    /// An option of arms for a query of the general solver.
    pub(super) fn robot_with_arm<'l>(
        &self,
        loaded: &'l LoadedModel,
        goals: &Goals<'_>,
    ) -> Outcome<Option<&'l Robot>> {
        let problem = self.problem;
        let general = problem.solve.selects_general_solver()
            || problem.body.has_centre_of_mass()
            || !problem.body.level.is_empty()
            || !problem.tasks.is_empty()
            || (!problem.body.hold.is_empty() && loaded.rig.is_none())
            || goals.need_more_than_an_arm(loaded);
        let (targets, rays) = (goals.targets.len(), problem.goal.ray.len());
        let one_frame = (targets, rays) == (1, 0);
        // Solvers that converge from the start configuration.
        let settles =
            loaded.rig.is_some() || problem.solve.solver.is_none() && (general || !one_frame);
        let of_an_arm = self.setting_of_arms(loaded.rig.is_some(), settles);
        match (&loaded.robot, of_an_arm) {
            (Some(_), _) if one_frame && !general && !problem.body.weight.is_empty() => {
                Err(usage!(
                    "--weight is for several targets or held tips; for a single target, \
                     `metres_per_radian` weighs orientation against position"
                ))
            }
            (Some(robot), _) if one_frame && !general => Ok(Some(robot)),
            (_, None) => Ok(None),
            (None, Some("--search")) => Err(usage!(
                "--search of a {} is start or first; nearest and all are for robots",
                loaded.kind()
            )),
            (None, Some(option)) => Err(usage!(
                "{option} is for robots; {} is a {}",
                loaded.file,
                loaded.kind()
            )),
            (Some(_), Some(option)) => Err(usage!(
                "{option} is for one target of an arm; {targets} targets at once, held frames, balance, `solver`, a free \
                 base and ball joints need the general solver"
            )),
        }
    }

    /// First given setting that only an arm accepts, if any. Settings that a `rig` or a model that `settles` accepts do
    /// not count.
    fn setting_of_arms(&self, rig: bool, settles: bool) -> Option<&'static str> {
        let solve = &self.problem.solve;
        let searched = match solve.search {
            Some(SolutionChoice::One(Search::Start | Search::First)) => !rig,
            search => search.is_some(),
        };
        first_given([
            ("--search", searched),
            ("--posture", solve.posture.is_some()),
            ("`joint_weights`", solve.joint_weights.is_some()),
            (
                "`global_search_on_miss`",
                solve.global_search_on_miss && !settles,
            ),
            ("`metres_per_radian`", solve.metres_per_radian.is_some()),
            ("kinopt servo", matches!(self.mode, Mode::Servo(..))),
            ("kinopt reach", matches!(self.mode, Mode::Reach(..))),
        ])
    }
}
