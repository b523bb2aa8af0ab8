//! Settings of solvers and models, from the arguments.

use kinopt::Solver;
use kinopt::arm::Search;
use kinopt::ik::{Restarts, crouched_configuration};
use kinopt::problem::Derivatives;
use kinopt::robot::Robot;
use kinopt::solver::Stopping;
use kinopt::spatial::Vector3;

use super::arguments::Arguments;
use super::goals::Goals;
use super::held_frames;
use crate::failure::{Failure, Outcome};
use crate::frame_name::BareName;
use crate::joint_columns::JointColumns;
use crate::loaded_model::{LoadedModel, Moment};
use crate::method_choice;
use crate::target::Start;

fn count(count: u32) -> usize {
    usize::try_from(count).unwrap_or(usize::MAX)
}

impl Arguments {
    /// Time of a clip at which a skeleton is at rest.
    pub(super) fn moment(&self) -> Option<Moment<'_>> {
        let clip = self.clip.as_deref();
        self.time.map(|time| Moment { time, clip })
    }

    /// Largest number of attempts, as typed.
    pub(super) fn attempts(&self) -> Option<u32> {
        self.attempts
            .or_else(|| self.restarts.map(|restarts| restarts.saturating_add(1)))
    }

    /// True if a skeleton converges from its start before any search.
    pub(super) fn settles(&self) -> bool {
        let plain =
            self.solver.is_none() && self.max_iterations.is_none() && self.arm.max_move.is_none();
        plain && self.arm.search != Some(Search::First)
    }

    /// Derivatives of the general solver.
    pub(super) fn derivatives(&self) -> Derivatives {
        self.jacobian.unwrap_or_default()
    }

    /// Tolerances: a length in metres (skeletons: the file's unit), and an angle in radians.
    pub(super) fn tolerances(&self, loaded: &LoadedModel) -> (f64, f64) {
        match self.tolerance {
            Some(tolerance) => (tolerance, tolerance),
            None => loaded.default_tolerances(),
        }
    }

    /// Limits of the general solver's attempts.
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

    /// General solver with its limits.
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

    /// Robot whose arm solves the query, or `None` for the general solver.
    ///
    /// # Errors
    /// An option of arms for a query of the general solver.
    pub(super) fn arm_of<'l>(
        &self,
        loaded: &'l LoadedModel,
        goals: &Goals<'_>,
    ) -> Outcome<Option<&'l Robot>> {
        // Checked here, because clap's `requires` ignores options that another one forbids.
        let limits = [
            ("--velocity-limits", &self.arm.velocity_limits),
            ("--acceleration-limits", &self.arm.acceleration_limits),
            ("--jerk-limits", &self.arm.jerk_limits),
        ];
        for (option, given) in limits {
            if given.is_some() && self.arm.servo.is_none() {
                return Err(usage!("{option} is for --servo"));
            }
        }
        let general = self.solver.is_some()
            || self.jacobian.is_some()
            || self.max_iterations.is_some()
            || self.balance.given()
            || self.levels.given()
            || self.tasks.is_some()
            || (!self.hold.is_empty() && loaded.rig.is_none())
            || goals.need_more_than_an_arm(loaded);
        let one_frame = self.file.is_some() || (self.targets.len() == 1 && self.rays.is_empty());
        // Solvers that converge from the start configuration.
        let settles = loaded.rig.is_some() || self.solver.is_none() && (general || !one_frame);
        let of_an_arm = self.arm.given(loaded.rig.is_some(), settles);
        match (&loaded.robot, of_an_arm) {
            (Some(_), _) if one_frame && !general && !self.weights.is_empty() => Err(usage!(
                "--weight is for several targets or held tips; for a single target, \
                     --metres-per-radian weighs orientation against position"
            )),
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
                "{option} is for one --target or for --targets, not for {} targets at once, a free base or ball joints",
                self.targets.len()
            )),
        }
    }

    /// Locks the joints of the options.
    pub(super) fn hold(&self, loaded: &mut LoadedModel) -> Outcome<()> {
        if !self.chain.holds() {
            return Ok(());
        }
        let all = loaded.model.configuration_len();
        let start = match &self.start {
            // Numbers for the joints of an arm do not define the others.
            Start::Numbers(numbers) if loaded.robot.is_some() && numbers.len() != all => {
                loaded.rest()
            }
            _ => self.start(loaded, None, &loaded.rest())?,
        };
        let held = self.chain.held(loaded, &start, self.degrees)?;
        loaded.held = Some(Box::new(held));
        Ok(())
    }

    /// Rest configuration with slightly bent knees above the held frames.
    fn bent(&self, loaded: &LoadedModel) -> Outcome<Vec<f64>> {
        if loaded.model.free_joints().is_empty() {
            return Err(usage!(
                "--start bent needs a free base (--base-joint free) and feet named by --hold"
            ));
        }
        let named = self
            .hold
            .iter()
            .filter(|name| *name != held_frames::NOTHING);
        let feet = named.map(|name| loaded.frame(name, BareName::Tip));
        let feet = feet.collect::<Result<Vec<_>, _>>()?;
        let (parameters, up) = (loaded.parameters(), Vector3::UNITS[self.balance.up(loaded)]);
        let rest = loaded.rest();
        Ok(crouched_configuration(
            &loaded.model,
            &parameters,
            &feet,
            &rest,
            up,
        )?)
    }

    /// Returns an error with its own exit code if --fail-on-miss is given and targets are not reached.
    pub(super) fn fail_on_misses(&self, missed: usize, targets: usize) -> Outcome<()> {
        if missed == 0 || !self.fail_on_miss {
            return Ok(());
        }
        let what = match targets {
            1 => "the target was not reached".to_owned(),
            _ => format!("{missed} of {targets} targets were not reached"),
        };
        Err(Failure::Missed(what))
    }

    /// Start configuration within the limits. `arm` has the columns of an arm's joints, which may be typed alone.
    /// `default` is the start without --start.
    pub(super) fn start(
        &self,
        loaded: &LoadedModel,
        arm: Option<JointColumns>,
        default: &[f64],
    ) -> Outcome<Vec<f64>> {
        let start = match &self.start {
            Start::Default => return Ok(default.to_vec()),
            Start::Rest => return Ok(loaded.rest()),
            Start::Bent => return self.bent(loaded),
            Start::Random => loaded.model.random_configuration(self.rng_seed),
            Start::Numbers(numbers) => {
                let columns = arm.filter(|columns| {
                    numbers.len() == columns.width()
                        && numbers.len() != loaded.model.configuration_len()
                });
                let typed = match columns {
                    Some(columns) => columns.typed(numbers, self.degrees),
                    None => loaded.typed_configuration(numbers, self.degrees, "--start")?,
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
