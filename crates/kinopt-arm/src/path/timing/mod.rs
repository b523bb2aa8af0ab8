//! Time-optimal trajectories along solved paths.
//!
//! 1. Rows are divided at stops: before and after each reconfiguration.
//! 2. Corners divide the rest into smooth stretches ([`corners`]).
//! 3. A cubic spline over joint length goes through the rows of each stretch ([`fit`]).
//! 4. Corners are blended within a tolerance, or the arm stops there ([`blends`]).
//! 5. Reachability analysis on a grid gives the fastest profile under velocity and acceleration limits ([`profile`]).
//!    With jerk limits, an interior-point method computes a slower one ([`jerk`]).

mod blends;
mod cell;
mod constraints;
mod corners;
mod cubic_curve;
mod easing;
mod fit;
mod grid;
mod jerk;
mod limits;
mod profile;
mod timed_spline;
mod tool_motion;

pub use limits::TimingLimits;
pub use timed_spline::{TimedSpline, TrajectoryPoint};

use super::PathError;
use crate::arm::JointPath;
use cell::GridCell;
use corners::{MIN_TANGENT_DISTANCE, Rows};
use cubic_curve::CubicCurve;
use easing::SmoothstepEasing;
use grid::Grid;
use kinopt_kinematics::Trajectory;
use profile::PathRateLimits;
use timed_spline::Motion;
use tool_motion::{ToolLimits, ToolMotion};

/// Distance below which rows count as equal, radians or metres of joint length.
const ROW_DISTANCE_TOLERANCE: f64 = 1e-9;
/// Minimum number of grid cells of a curve.
const MIN_CELLS: usize = 100;

impl<R> JointPath<R> {
    /// Computes the time of each row, seconds, starting at 0, under joint velocity and acceleration limits.
    ///
    /// Limits are in rad/s and rad/s², or m/s and m/s²; infinity means no limit.
    /// [`Arm::velocity_limits`](crate::arm::Arm::velocity_limits) and
    /// [`Arm::acceleration_limits`](crate::arm::Arm::acceleration_limits) have those of an arm. See
    /// [`trajectory`](Self::trajectory).
    ///
    /// # Errors
    /// Returns the errors of [`trajectory`](Self::trajectory).
    pub fn times(
        &self,
        velocity_limits: &[f64],
        acceleration_limits: &[f64],
    ) -> Result<Vec<f64>, PathError> {
        let limits = TimingLimits::new(velocity_limits, acceleration_limits);
        Ok(self.trajectory(&limits)?.times)
    }

    /// Computes the time-optimal trajectory along the rows, from rest to rest.
    ///
    /// The arm also stops before and after each [reconfiguration](kinopt_solver::ik::JointJump::reconfiguration), which is timed by the same
    /// limits.
    ///
    /// The joints follow a cubic spline over joint length, within 1e-5 (radians or metres) of every row. Rows more than
    /// 0.03 apart are interpolated. Corners are blended within
    /// [`corner_tolerance`](TimingLimits::with_corner_tolerance). The result does not depend on the sampling density of
    /// the path.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # #[cfg(feature = "urdf")] {
    /// use kinopt::Arm;
    /// use kinopt::motion::path::{CartesianPath, PathSolver, TimingLimits};
    /// use kinopt::robot::Robot;
    /// use kinopt::spatial::{Placement, Vector3};
    ///
    /// let robot = Robot::read("models/franka_panda.urdf")?;
    /// let arm = Arm::new(&robot, "base", "flange")?;
    /// let begin = arm.base_from_tool(&[0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8])?;
    /// let along = |k: u32| Vector3::new(0.0, 0.005 * f64::from(k), 0.0);
    /// let points = (0..=60).map(|k| Placement::new(begin.rotation, begin.translation + along(k)));
    /// let path = CartesianPath::new(points.collect::<Vec<_>>())?;
    /// let solution = PathSolver::new(&arm).solve(&path)?;
    ///
    /// let limits = TimingLimits::of(&arm)
    ///     .with_acceleration_limits(&[5.0; 7])
    ///     .with_tool_linear_limits(0.25, 2.0);
    /// let trajectory = solution.trajectory(&limits)?;
    /// let middle = trajectory.report.at(0.5 * trajectory.duration());
    /// assert!(middle.velocity.iter().zip(arm.velocity_limits()).all(|(v, limit)| v.abs() <= *limit));
    /// # }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if a limit or option is out of its range, or if the number of limits differs from that of
    /// joints. Returns an error for a row that is not finite, for tool limits without an arm, and for steps that no
    /// finite acceleration limit bounds. Returns an error for [unreached rows](Self::unreached), unless the limits
    /// [allow them](TimingLimits::with_unreached_allowed).
    pub fn trajectory(
        &self,
        limits: &TimingLimits<'_>,
    ) -> Result<Trajectory<TimedSpline>, PathError> {
        let joint_count = self.nq;
        limits.check(joint_count)?;
        if let (Some(&first), false) = (self.unreached.first(), limits.unreached_allowed) {
            return Err(PathError::Unreached {
                count: self.unreached.len(),
                rows: self.rows().len(),
                first,
            });
        }
        let rows: Vec<&[f64]> = match joint_count {
            0 => Vec::new(),
            _ => self.rows().collect(),
        };
        let lengths = lengths(&rows);
        if let Some(row) = lengths.iter().position(|length| !length.is_finite()) {
            return Err(PathError::Row { row });
        }
        let mut spline = TimedSpline {
            joints: joint_count,
            first: rows
                .first()
                .map_or(vec![0.0; joint_count], |row| row.to_vec()),
            motions: Vec::new(),
            duration: 0.0,
        };
        let mut times = Vec::with_capacity(rows.len());
        times.extend(rows.first().map(|_| 0.0));
        let mut first = 0;
        while first + 1 < rows.len() {
            // A reconfiguration is a motion of its own.
            let mut jumps = self.jumps.iter().filter(|jump| jump.reconfiguration);
            let last = match jumps.find(|jump| jump.index > first).map(|jump| jump.index) {
                Some(row) if row >= rows.len() => rows.len() - 1,
                Some(row) if row == first + 1 => row,
                Some(row) => row - 1,
                None => rows.len() - 1,
            };
            spline.append(&rows, &lengths, first..=last, limits, &mut times)?;
            first = last;
        }
        Ok(Trajectory {
            times,
            q: self.q.clone(),
            nq: self.nq,
            report: spline,
        })
    }
}

impl TimedSpline {
    /// Appends the motion along consecutive rows, from rest to rest, and the times of these rows.
    fn append(
        &mut self,
        rows: &[&[f64]],
        lengths: &[f64],
        range: std::ops::RangeInclusive<usize>,
        limits: &TimingLimits<'_>,
        times: &mut Vec<f64>,
    ) -> Result<(), PathError> {
        let start = self.duration;
        let added = self.motions.len();
        let mut distinct = vec![*range.start()];
        let inner = range.clone().skip(1);
        let mut last = lengths[*range.start()];
        for row in inner {
            if lengths[row] - last > ROW_DISTANCE_TOLERANCE {
                distinct.push(row);
                last = lengths[row];
            }
        }
        if distinct.len() > 1 {
            let total_length = lengths.last().copied().unwrap_or(0.0);
            for curve in curves(
                rows,
                lengths,
                &distinct,
                self.joints,
                limits.corner_tolerance,
            ) {
                let fraction = (curve.end() - curve.start()) / total_length;
                let cells = (limits.grid_points as f64 * fraction).ceil() as usize;
                let motion = timed(curve, cells.max(MIN_CELLS), limits, self.duration)
                    .map_err(|problem| problem.at_row(lengths, limits))?;
                self.duration += motion.duration();
                self.motions.push(motion);
            }
        }
        let motions = &self.motions[added..];
        let end = lengths[*range.end()];
        for row in range.skip(1) {
            let s = lengths[row];
            if end - s <= ROW_DISTANCE_TOLERANCE {
                times.push(self.duration);
                continue;
            }
            let after = motions.partition_point(|motion| motion.curve.start() <= s);
            let time = motions
                .get(after.saturating_sub(1))
                .map_or(start, |motion| motion.time + motion.time_at(s));
            times.push(time.min(self.duration));
        }
        Ok(())
    }
}

/// Returns the joint length from the first row to each row. It is not finite from the first invalid row on.
fn lengths(rows: &[&[f64]]) -> Vec<f64> {
    let mut length = match rows.first() {
        Some(row) => 0.0 * row.iter().sum::<f64>(),
        None => 0.0,
    };
    let start = length;
    let steps = rows.windows(2).map(|pair| {
        let moves = pair[1].iter().zip(pair[0]).map(|(b, a)| b - a);
        length += moves.map(|delta| delta * delta).sum::<f64>().sqrt();
        length
    });
    let first = rows.first().map(|_| start);
    first.into_iter().chain(steps).collect()
}

/// Returns curves through rows. The arm stops at their ends.
fn curves(
    rows: &[&[f64]],
    lengths: &[f64],
    distinct: &[usize],
    joints: usize,
    corner_tolerance: f64,
) -> Vec<CubicCurve> {
    let rows: Vec<&[f64]> = distinct.iter().map(|row| rows[*row]).collect();
    let lengths: Vec<f64> = distinct.iter().map(|row| lengths[*row]).collect();
    let corners = corners::corners(Rows {
        rows: &rows,
        lengths: &lengths,
        reach: MIN_TANGENT_DISTANCE,
    });
    let firsts = [0].into_iter().chain(corners.iter().copied());
    let lasts = corners.iter().copied().chain([rows.len() - 1]);
    let stretches = firsts.zip(lasts).map(|(first, last)| {
        let stretch = Rows {
            rows: &rows[first..=last],
            lengths: &lengths[first..=last],
            reach: MIN_TANGENT_DISTANCE,
        };
        fit::fit(stretch, joints)
    });
    blends::joined(stretches.collect(), corner_tolerance)
}

/// Reason why a curve cannot be timed.
enum TimingProblem {
    /// No limit bounds the acceleration at a curve parameter.
    Unbounded(f64, CubicCurve),
    Query(crate::arm::QueryError),
}

impl TimingProblem {
    fn at_row(self, lengths: &[f64], limits: &TimingLimits<'_>) -> PathError {
        match self {
            Self::Unbounded(s, curve) => {
                let jets = curve.jets(curve.piece(s), s).map(|jet| jet.first.abs());
                let fastest = jets.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
                PathError::Unbounded {
                    joint: limits.joint_name(fastest.map_or(0, |(joint, _)| joint)),
                    row: lengths.partition_point(|length| *length <= s),
                }
            }
            Self::Query(error) => error.into(),
        }
    }
}

/// Computes the fastest motion along a curve, from rest to rest.
fn timed(
    curve: CubicCurve,
    cells: usize,
    limits: &TimingLimits<'_>,
    time: f64,
) -> Result<Motion, TimingProblem> {
    let grid = Grid::new(&curve, cells);
    let tool = limits.arm.filter(|_| limits.tool != ToolLimits::NONE);
    let tool = tool.map(|arm| ToolMotion::new(arm, limits.tool, &curve, &grid));
    let tool = tool.transpose().map_err(TimingProblem::Query)?;
    let rates = PathRateLimits {
        velocity: &limits.velocity,
        acceleration: &limits.acceleration,
        tool: tool.as_ref(),
    };
    let squared_speeds = match profile::squared_speeds(&grid, rates) {
        Ok(speeds) => speeds,
        Err(cell) => return Err(TimingProblem::Unbounded(grid.points[cell], curve)),
    };
    if let Some(jerk) = limits
        .jerk
        .as_deref()
        .filter(|jerk| jerk.iter().any(|j| j.is_finite()))
    {
        let limits = jerk::JerkLimits {
            velocity: &limits.velocity,
            acceleration: &limits.acceleration,
            jerk,
            tool: limits
                .arm
                .filter(|_| limits.tool != ToolLimits::NONE)
                .map(|arm| (arm, limits.tool)),
        };
        let easing = SmoothstepEasing::new(curve.start(), curve.end());
        let cells = jerk::cells(&curve, &easing, cells.div_ceil(2), limits)
            .map_err(TimingProblem::Query)?;
        return Ok(Motion {
            time,
            curve,
            easing: Some(easing),
            cells,
        });
    }
    let mut motion = Motion {
        time,
        curve,
        easing: None,
        cells: Vec::with_capacity(grid.cells()),
    };
    let mut elapsed = 0.0;
    for cell in 0..grid.cells() {
        let (from, to) = (squared_speeds[cell], squared_speeds[cell + 1]);
        let length = grid.step(cell);
        let cell = GridCell {
            start: grid.points[cell],
            length,
            speed: from.sqrt(),
            acceleration: (to - from) / (2.0 * length),
            slope: 0.0,
            time: elapsed,
        };
        elapsed += cell.time_to(length);
        motion.cells.push(cell);
    }
    Ok(motion)
}
