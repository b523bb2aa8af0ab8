//! Arm and its single queries.

use std::sync::{Arc, Mutex, OnceLock};

use super::coordinates::Coordinates;
use super::default_start::middle_of;
use super::options::Options;
use super::rate_limits::RateLimits;
use super::seed_table::SeedTable;
use super::serial_chain::Serial;
use super::workspace::ArmWorkspace;
use super::{ArmError, QueryError};
use crate::simd_ik::PoseSolver;
use kinopt_kinematics::clock::Instant;
use kinopt_kinematics::model::{JointId, Limits};
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::ik::Solution;
use kinopt_solver::problem::ReportNames;

/// Inverse kinematics of the tool of a robot arm. It is immutable, `Send` and `Sync`: share it between threads.
///
/// A configuration has one number per free joint between base and tip, in that order ([`joints`](Self::joints)),
/// radians or metres. A mimic joint whose source is outside the chain is represented by its source. Targets are
/// `base_from_tool`, metres.
///
/// Equal queries give bitwise equal results on any number of threads, unless there is a time limit. A joint with a
/// range of a revolution or more ends as near to the start as whole revolutions allow. Whole revolutions are first
/// taken off a start beyond a million radians, where sines lose digits.
#[derive(Clone, Debug)]
pub struct Arm {
    pub(super) serial: Serial,
    pub(super) options: Options,
    pub(super) simd_solver: Option<PoseSolver>,
    pub(super) coordinates: Coordinates,
    pub(super) names: Arc<ReportNames>,
    /// Radians that a radian or metre of each joint counts as.
    pub(super) scale: Vec<f64>,
    pub(super) rates: RateLimits<f64>,
    pub(super) default_start: Vec<f64>,
    /// Sampled configurations of a chain that the SIMD solver does not support, built on first use.
    pub(super) seeds: OnceLock<SeedTable>,
    /// Collision avoidance, if the arm has a checker.
    #[cfg(feature = "collision")]
    pub(super) collisions: Option<std::sync::Arc<super::collision_avoidance::CollisionAvoidance>>,
    workspaces: Workspaces,
}

/// Pool of workspaces for queries that the SIMD solver alone does not finish.
#[allow(clippy::vec_box, reason = "kilobytes, moved twice a question")]
#[derive(Debug)]
struct Workspaces(Mutex<Vec<Box<ArmWorkspace>>>);

/// A clone begins with an empty pool.
impl Clone for Workspaces {
    fn clone(&self) -> Self {
        Self(Mutex::default())
    }
}

impl Arm {
    pub(super) fn assemble(
        serial: Serial,
        options: Options,
        simd_solver: Option<PoseSolver>,
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
            simd_solver,
            coordinates,
            names: Arc::new(names),
            seeds: OnceLock::new(),
            #[cfg(feature = "collision")]
            collisions: None,
            workspaces: Workspaces(Mutex::new(vec![Box::new(workspace)])),
        })
    }

    /// The same arm with another chain and other options, which leave joints and names as they are.
    pub(super) fn changed(
        &self,
        serial: Serial,
        options: Options,
        simd_solver: Option<PoseSolver>,
    ) -> Result<Self, ArmError> {
        let (coordinates, rates) = (self.coordinates.clone(), self.rates.clone());
        let tip = self.names.task_frames.first().cloned().flatten();
        let tip = tip.unwrap_or_default();
        let changed = Self::assemble(serial, options, simd_solver, coordinates, rates, &tip)?;
        Ok(Self {
            default_start: self.default_start.clone(),
            ..changed
        })
    }

    /// Names of the free joints, base to tip: the order of a configuration.
    pub fn joints(&self) -> impl ExactSizeIterator<Item = &str> {
        self.names.variables.iter().map(String::as_str)
    }

    /// Ids of the free joints in the source model, base to tip.
    #[must_use]
    pub fn joint_ids(&self) -> &[JointId] {
        &self.serial.joints
    }

    /// Acceleration limits of the free joints, base to tip, rad/s² or m/s²; infinite for none.
    ///
    /// They come from the robot's [files](kinopt_robot::robot::Robot::acceleration_limit), and include the limits of the
    /// mimic joints that a free joint drives.
    #[must_use]
    pub fn acceleration_limits(&self) -> &[f64] {
        &self.rates.acceleration
    }

    /// Jerk limits of the free joints and of the mimic joints that they drive, base to tip, rad/s³ or m/s³;
    /// infinite for none.
    #[must_use]
    pub fn jerk_limits(&self) -> &[f64] {
        &self.rates.jerk
    }

    /// Number of free joints, the length of a configuration.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.serial.joints.len()
    }

    /// Position limits of the free joints, base to tip, radians or metres.
    pub fn limits(&self) -> impl ExactSizeIterator<Item = Limits> + '_ {
        let map = &self.serial.map;
        map.lower()
            .iter()
            .zip(map.upper())
            .map(|(&lower, &upper)| Limits::new(lower, upper))
    }

    /// Pose of the tool in the base frame at a configuration.
    ///
    /// # Errors
    /// Returns an error for a configuration of the wrong length or with a value that is not finite.
    pub fn base_from_tool(&self, q: &[f64]) -> Result<Placement<f64>, QueryError> {
        self.check_length("q", q.len(), self.joint_count())?;
        self.check_finite("q", q)?;
        if let Some(chain) = &self.serial.chain {
            return Ok(chain.tip_at(q));
        }
        self.with_workspace(|workspace| workspace.base_from_tool(&self.serial, q))
    }

    /// Solves for one target from one start. A start outside the limits is clamped to them.
    ///
    /// If the target is not reached, the result is the closest pose reached from the start. An arm that searches
    /// [globally](super::ArmBuilder::with_global_search_on_miss) or for the [first](super::Search::First) solution
    /// returns the best of all attempts instead.
    ///
    /// # Errors
    /// Returns an error for a start of the wrong length or not finite, or a target that is not a rigid motion. An
    /// unreachable target is not an error: see [`Solution::reached`] and [`Solution::explain`].
    pub fn solve(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
        start: &[f64],
    ) -> Result<Solution, QueryError> {
        let mut solution = Solution::default();
        self.solve_into(base_from_tool, start, &mut solution)?;
        Ok(solution)
    }

    /// Solves as [`solve`](Self::solve) does, into an existing solution.
    ///
    /// After the first few queries nothing is allocated for a target that is reached.
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve).
    pub fn solve_into(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
        start: &[f64],
        solution: &mut Solution,
    ) -> Result<(), QueryError> {
        let target = base_from_tool.into();
        self.check_length("the start", start.len(), self.joint_count())?;
        self.check_query(0, &target, start)?;
        self.solve_query(&self.query(&target, start), solution)?;
        Ok(())
    }

    pub(super) fn deadline(&self) -> Option<Instant> {
        // A limit beyond the range of the clock counts as none.
        let limit = self.options.time_limit?;
        Instant::now().checked_add(limit)
    }

    /// Changes all workspaces of the pool.
    #[cfg(feature = "collision")]
    pub(super) fn for_each_workspace(&mut self, change: impl FnMut(&mut Box<ArmWorkspace>)) {
        let workspaces = self.workspaces.0.get_mut();
        let workspaces = workspaces.unwrap_or_else(std::sync::PoisonError::into_inner);
        workspaces.iter_mut().for_each(change);
    }

    /// Runs a function with a workspace from the pool, or with a new one.
    pub(super) fn with_workspace<R>(
        &self,
        run: impl FnOnce(&mut ArmWorkspace) -> R,
    ) -> Result<R, QueryError> {
        let lock = || {
            self.workspaces
                .0
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner)
        };
        let pooled = lock().pop();
        let mut workspace = match pooled {
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
    ) -> Result<(), QueryError> {
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

    /// Checks one configuration, or several in sequence.
    #[allow(
        clippy::eq_op,
        reason = "what is not finite leaves itself no zero, and all are asked at once"
    )]
    pub(super) fn check_finite(&self, what: &'static str, q: &[f64]) -> Result<(), QueryError> {
        let nonzero_bits = q
            .iter()
            .fold(0, |left, value| left | (value - value).to_bits());
        if nonzero_bits == 0 {
            return Ok(());
        }
        match q.iter().position(|value| !value.is_finite()) {
            None => Ok(()),
            Some(index) => Err(QueryError::NotFinite {
                what,
                joint: self.joint_name(index % self.joint_count()),
                value: q[index],
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
    ) -> Result<(), QueryError> {
        if let Some(index) = start.iter().position(|value| !value.is_finite()) {
            return Err(QueryError::StartNotFinite {
                query,
                joint: self.joint_name(index),
                value: start[index],
            });
        }
        // Fast for exact rotations; slightly stricter than the SIMD solver's limit of 1e-6.
        match target.check_rigid(0.9e-6) {
            Ok(()) => Ok(()),
            Err(problem) => Err(QueryError::Target { query, problem }),
        }
    }
}
