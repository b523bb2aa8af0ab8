//! The arm, and single questions to it.

use std::sync::{Arc, Mutex, OnceLock};

use super::coordinates::Coordinates;
use super::core_seeds::SeedTable;
use super::default_start::middle_of;
use super::options::Options;
use super::rate_limits::RateLimits;
use super::serial_chain::Serial;
use super::workspace::ArmWorkspace;
use super::{ArmError, QueryError, Reply};
use crate::clock::Instant;
use crate::ik::Solution;
use crate::lanes::PoseSolver;
use crate::model::{JointId, Limits};
use crate::problem::ReportNames;
use crate::spatial::Placement;

/// An arm that answers pose questions. It never changes, and is `Send` and `Sync`: share it.
///
/// Everywhere at this door a configuration has one number for each free joint between base and
/// tip, in that order ([`joints`](Self::joints)), radians or metres; a joint that follows one
/// outside the chain is known by the one it follows. Targets are `base_from_tool`, metres.
///
/// The same question has the same answer bit for bit on any number of threads, unless there is a
/// time limit. Joints that turn without limits, or further than a turn, come out as near to the
/// start as whole turns bring them; from a start beyond a million radians, where sines lose their
/// digits, as near to the start less whole turns (within half a turn of zero).
#[derive(Clone, Debug)]
pub struct Arm {
    pub(super) serial: Serial,
    pub(super) options: Options,
    pub(super) lanes: Option<PoseSolver>,
    pub(super) coordinates: Coordinates,
    pub(super) names: Arc<ReportNames>,
    /// What a radian or metre of each joint counts as, radians.
    pub(super) scale: Vec<f64>,
    pub(super) rates: RateLimits<f64>,
    pub(super) default_start: Vec<f64>,
    /// Seeds of a chain that the lane engine cannot express, made for the first question that needs
    /// them.
    pub(super) seeds: OnceLock<SeedTable>,
    /// What it keeps clear of.
    #[cfg(feature = "collision")]
    pub(super) collisions: Option<std::sync::Arc<super::keep_clear::KeepClear>>,
    workspaces: Workspaces,
}

/// Memory of the slower ways, taken out while one is under way.
#[allow(clippy::vec_box, reason = "kilobytes, moved twice a question")]
#[derive(Debug)]
struct Workspaces(Mutex<Vec<Box<ArmWorkspace>>>);

/// A copy makes its own.
impl Clone for Workspaces {
    fn clone(&self) -> Self {
        Self(Mutex::default())
    }
}

impl Arm {
    pub(super) fn assemble(
        serial: Serial,
        options: Options,
        lanes: Option<PoseSolver>,
        coordinates: Coordinates,
        rates: RateLimits<f64>,
        tip: &str,
    ) -> Result<Self, ArmError> {
        let workspace = ArmWorkspace::new(&serial, &options)?;
        let names = ReportNames {
            tasks: vec![format!("pose of `{tip}`")],
            task_frames: vec![Some(tip.to_owned())],
            ..(**workspace.question.problem.names()).clone()
        };
        Ok(Self {
            rates,
            default_start: (serial.map.lower().iter().zip(serial.map.upper()))
                .map(|(&lower, &upper)| middle_of(Limits::new(lower, upper)))
                .collect(),
            scale: serial.scales(options.metres_per_radian),
            serial,
            options,
            lanes,
            coordinates,
            names: Arc::new(names),
            seeds: OnceLock::new(),
            #[cfg(feature = "collision")]
            collisions: None,
            workspaces: Workspaces(Mutex::new(vec![Box::new(workspace)])),
        })
    }

    /// The same arm for another chain and other options, which leave joints and names as they are.
    pub(super) fn changed(
        &self,
        serial: Serial,
        options: Options,
        lanes: Option<PoseSolver>,
    ) -> Result<Self, ArmError> {
        let (coordinates, rates) = (self.coordinates.clone(), self.rates.clone());
        let tip = self.names.task_frames.first().cloned().flatten();
        let tip = tip.unwrap_or_default();
        let changed = Self::assemble(serial, options, lanes, coordinates, rates, &tip)?;
        Ok(Self {
            default_start: self.default_start.clone(),
            ..changed
        })
    }

    /// Names of the free joints, base to tip: the order of a configuration.
    pub fn joints(&self) -> impl ExactSizeIterator<Item = &str> {
        self.names.variables.iter().map(String::as_str)
    }

    getters! {
        /// Ids of the free joints in the model the arm was built from, base to tip.
        pub fn joint_ids(&self) -> &[JointId] = &self.serial.joints;
        /// Acceleration limits of the free joints, base to tip, rad/s² or m/s², infinite for none: those of the robot's
        /// [files](crate::robot::Robot::acceleration_limit), and of the mimic joints that a free joint drives.
        pub fn acceleration_limits(&self) -> &[f64] = &self.rates.acceleration;
        /// Jerk limits of the free joints, base to tip, rad/s³ or m/s³, infinite for none, by the same rules.
        pub fn jerk_limits(&self) -> &[f64] = &self.rates.jerk;
        /// Number of free joints: the length of a configuration.
        pub fn joint_count(&self) -> usize = self.serial.joints.len();
    }

    /// The bounds of the free joints, base to tip, radians or metres.
    pub fn limits(&self) -> impl ExactSizeIterator<Item = Limits> + '_ {
        let map = &self.serial.map;
        map.lower()
            .iter()
            .zip(map.upper())
            .map(|(&lower, &upper)| Limits::new(lower, upper))
    }

    /// Where the tool stands at a configuration.
    ///
    /// # Errors
    /// A configuration of the wrong length, or one that is not finite.
    pub fn base_from_tool(&self, q: &[f64]) -> Result<Placement<f64>, QueryError> {
        self.check_length("q", q.len(), self.joint_count())?;
        self.check_finite("q", q)?;
        if let Some(chain) = &self.serial.chain {
            return Ok(chain.tip_at(q));
        }
        self.with_workspace(|workspace| workspace.base_from_tool(&self.serial, q))
    }

    /// Solves for one target from one start (which may lie outside the limits and is then projected
    /// into them). A target that is not reached is answered by the nearest place on the start's own
    /// way, unless the arm searches
    /// [everywhere](super::ArmBuilder::with_global_search_on_miss) or for the
    /// [first](super::Search::First).
    ///
    /// # Errors
    /// A start of the wrong length or not finite; a target that is not a rigid motion. A target out
    /// of reach is none: see [`Solution::reached`] and [`Solution::explain`].
    pub fn solve(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
        start: &[f64],
    ) -> Result<Solution, QueryError> {
        let mut solution = Solution::default();
        self.solve_into(base_from_tool, start, &mut solution)?;
        Ok(solution)
    }

    /// As [`solve`](Self::solve), into a solution whose memory is used again: after the first few
    /// questions nothing is allocated for a target that is reached.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub fn solve_into(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
        start: &[f64],
        solution: &mut Solution,
    ) -> Result<(), QueryError> {
        let target = base_from_tool.into();
        self.check_length("the start", start.len(), self.joint_count())?;
        self.check_query(0, &target, start)?;
        self.answer(&self.query(&target, start), solution)?;
        Ok(())
    }

    pub(super) fn deadline(&self) -> Option<Instant> {
        // A limit beyond what the clock can tell is none.
        let limit = self.options.time_limit?;
        Instant::now().checked_add(limit)
    }

    /// Changes all memory that is not in use.
    #[cfg(feature = "collision")]
    pub(super) fn for_each_workspace(&mut self, change: impl FnMut(&mut Box<ArmWorkspace>)) {
        let workspaces = self.workspaces.0.get_mut();
        let workspaces = workspaces.unwrap_or_else(std::sync::PoisonError::into_inner);
        workspaces.iter_mut().for_each(change);
    }

    /// Runs something with memory of its own.
    pub(super) fn with_workspace<R>(&self, run: impl FnOnce(&mut ArmWorkspace) -> R) -> Reply<R> {
        let lock = || {
            self.workspaces
                .0
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner)
        };
        let taken = lock().pop();
        let mut workspace = match taken {
            Some(workspace) => workspace,
            None => Box::new(ArmWorkspace::new(&self.serial, &self.options)?),
        };
        let result = run(&mut workspace);
        lock().push(workspace);
        Ok(result)
    }

    pub(super) fn check_length(
        &self,
        what: &'static str,
        given: usize,
        expected: usize,
    ) -> Reply<()> {
        if given == expected {
            return Ok(());
        }
        Err(QueryError::Length {
            what,
            given,
            expected,
            joints: self.joint_count(),
        })
    }

    /// Of one configuration, or of several one after another.
    #[allow(
        clippy::eq_op,
        reason = "what is not finite leaves itself no zero, and all are asked at once"
    )]
    pub(super) fn check_finite(&self, what: &'static str, q: &[f64]) -> Reply<()> {
        let all = q
            .iter()
            .fold(0, |left, value| left | (value - value).to_bits());
        if all == 0 {
            return Ok(());
        }
        match q.iter().position(|value| !value.is_finite()) {
            None => Ok(()),
            Some(bad) => Err(QueryError::NotFinite {
                what,
                joint: self.joint_name(bad % self.joint_count()),
                value: q[bad],
            }),
        }
    }

    fn joint_name(&self, joint: usize) -> String {
        self.names.variables.get(joint).cloned().unwrap_or_default()
    }

    pub(super) fn check_query(
        &self,
        query: usize,
        target: &Placement<f64>,
        start: &[f64],
    ) -> Reply<()> {
        if let Some(bad) = start.iter().position(|value| !value.is_finite()) {
            return Err(QueryError::StartNotFinite {
                query,
                joint: self.joint_name(bad),
                value: start[bad],
            });
        }
        // Quick for the everyday case, and the same limit as the lane engine's.
        match target.check_rigid(0.9e-6) {
            Ok(()) => Ok(()),
            Err(problem) => Err(QueryError::Target { query, problem }),
        }
    }
}
