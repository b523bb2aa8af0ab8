//! Settings of solvers and models, from a problem.

use std::num::NonZeroU32;

use kinopt::Solver;
use kinopt::arm::Search;
use kinopt::ik::{Restarts, crouched_configuration};
use kinopt::robot::Robot;
use kinopt::solver::Stopping;
use kinopt::spatial::Vector3;

use super::goals::Goals;
use super::held_frames;
use super::job::{Job, Mode};
use crate::choices::first_given;
use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::joint_columns::JointColumns;
use crate::loaded_model::{LoadedModel, Moment};
use crate::problem::start::Start;
use crate::problem::{Problem, methods};

fn count(count: u32) -> usize {
    usize::try_from(count).unwrap_or(usize::MAX)
}

impl Problem {
    /// Time of a clip at which a skeleton is at rest.
    pub(super) fn moment(&self) -> Option<Moment<'_>> {
        let clip = self.model.clip.as_deref();
        self.model.time.map(|time| Moment { time, clip })
    }

    /// Largest number of attempts, if given.
    pub(super) fn attempts(&self) -> Option<u32> {
        self.solve.attempts.map(NonZeroU32::get)
    }

    /// True if a setting selects the general solver.
    fn selects_general_solver(&self) -> bool {
        let solve = &self.solve;
        solve.solver.is_some() || solve.jacobian.is_some() || solve.max_iterations.is_some()
    }

    /// True if a skeleton converges from its start before any search.
    pub(super) fn settles(&self) -> bool {
        let solve = &self.solve;
        let plain =
            solve.solver.is_none() && solve.max_iterations.is_none() && solve.max_move.is_none();
        plain && solve.search != Some(Search::First)
    }

    /// Tolerances: a length in metres (skeletons: the file's unit), and an angle in radians.
    pub(super) fn tolerances(&self, loaded: &LoadedModel) -> (f64, f64) {
        match self.solve.tolerance {
            Some(tolerance) => (tolerance, tolerance),
            None => loaded.default_tolerances(),
        }
    }

    /// Limits of the general solver's attempts.
    pub(super) fn stopping(&self) -> Stopping {
        let mut stopping = Stopping::default();
        if let Some(iterations) = self.solve.max_iterations {
            stopping = stopping.with_max_iterations(count(iterations));
        }
        match self.solve.time_limit {
            Some(limit) => stopping.with_time_limit(limit),
            None => stopping,
        }
    }

    /// General solver with its limits.
    pub(super) fn general_solver(&self) -> Solver {
        let mut restarts = Restarts::default().with_seed(self.solve.rng_seed);
        if let Some(attempts) = self.attempts() {
            restarts = restarts.with_attempts(count(attempts));
        }
        let solver = match &self.solve.solver {
            Some(name) => methods::solver(name),
            None => Solver::default(),
        };
        solver
            .with_stopping(self.stopping())
            .with_restarts(restarts)
    }

    /// Locks joints as the model settings say.
    pub(super) fn lock_joints(&self, loaded: &mut LoadedModel) -> Outcome<()> {
        if !self.model.locks() {
            return Ok(());
        }
        let all = loaded.model.configuration_len();
        let start = match &self.solve.start {
            // Numbers for the joints of an arm do not define the others.
            Start::Numbers(numbers) if loaded.robot.is_some() && numbers.values.len() != all => {
                loaded.rest()
            }
            _ => self.start(loaded, None, &loaded.rest())?,
        };
        let held = self.model.held(loaded, &start)?;
        loaded.held = Some(Box::new(held));
        Ok(())
    }

    /// Reads the SRDF file, if one is given.
    pub(crate) fn read_srdf(&self, loaded: &mut LoadedModel) -> Outcome<()> {
        let Some(file) = &self.model.srdf else {
            return match &self.model.group {
                Some(_) => Err(usage!("`group` needs `srdf`")),
                None => Ok(()),
            };
        };
        let Some(robot) = &loaded.robot else {
            return Err(usage!("{}: `srdf` is for robots", loaded.file));
        };
        loaded.srdf = Some(Box::new(self.model.read_srdf(file, robot)?));
        Ok(())
    }

    /// Rest configuration with slightly bent knees above the held frames.
    fn bent(&self, loaded: &LoadedModel) -> Outcome<Vec<f64>> {
        if loaded.model.free_joints().is_empty() {
            return Err(usage!(
                "--start bent needs a free base (--base-joint free) and feet named by --hold"
            ));
        }
        let hold = self.body.hold.iter();
        let named = hold.filter(|name| *name != held_frames::NOTHING);
        let feet = named.map(|name| loaded.frame(name, BareName::Tip));
        let feet = feet.collect::<Result<Vec<_>, _>>()?;
        let (parameters, up) = (
            loaded.parameters(),
            Vector3::UNITS[self.body.up_axis(loaded)],
        );
        let rest = loaded.rest();
        Ok(crouched_configuration(
            &loaded.model,
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
        loaded: &LoadedModel,
        arm: Option<JointColumns>,
        default: &[f64],
    ) -> Outcome<Vec<f64>> {
        let start = match &self.solve.start {
            Start::Default => return Ok(default.to_vec()),
            Start::Rest => return Ok(loaded.rest()),
            Start::Bent => return self.bent(loaded),
            Start::Random => loaded.model.random_configuration(self.solve.rng_seed),
            Start::Numbers(numbers) => {
                let (values, degrees) = (numbers.values.as_slice(), numbers.degrees);
                let columns = arm.filter(|columns| {
                    values.len() == columns.width()
                        && values.len() != loaded.model.configuration_len()
                });
                let typed = match columns {
                    Some(columns) => columns.typed(values, degrees),
                    None => loaded.typed_configuration(values, degrees, "--start")?,
                };
                loaded.note_outside_limits(
                    &typed,
                    "the search starts at the nearest values within them",
                );
                typed
            }
        };
        Ok(loaded.within_limits(&start))
    }
}

impl Job<'_> {
    /// Checks settings that depend on each other or on the subcommand.
    pub(super) fn check_settings(&self) -> Outcome<()> {
        let Problem { goal, solve, .. } = self.problem;
        if self.problem.model.clip.is_some() && self.problem.model.time.is_none() {
            return Err(usage!("`clip` needs `time`"));
        }
        let with_derivative = match self.mode {
            Mode::One(_) => solve.max_move.is_none(),
            Mode::Batch(_, options) => solve.max_move.is_none() && !options.together,
            Mode::Track(_) | Mode::Servo(..) => false,
        };
        if self.problem.output.derivative && !with_derivative {
            return Err(usage!(
                "`derivative` is for single solves without --max-move"
            ));
        }
        if let Mode::One(_) = self.mode {
            let body = &self.problem.body;
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
        let general = problem.selects_general_solver()
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
                "--search of a {} is start or first; nearest and distinct are for robots",
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
            Some(Search::Start | Search::First) => !rig,
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
        ])
    }
}
