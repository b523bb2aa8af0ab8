//! Cartesian paths of arms, solved with the fewest reconfigurations.

use std::ffi::{CString, c_char};

use kinopt::arm::JointPath;
use kinopt::motion::path::{CartesianPath, PathReport};
use kinopt_bindings::names::miss_reason;
use kinopt_bindings::option::names;
use kinopt_bindings::option::path::{PathOptions, options};
use serde_json::Value;

use crate::arm::KinoptArm;
use crate::error::{Failure, KinoptStatus, guard, of_json};
use crate::pointer;
use crate::settings::settings;

/// Joint path: one configuration for each point. It is immutable.
pub struct KinoptJointPath {
    pub(crate) inner: JointPath<PathReport>,
    /// Reasons of the missed points.
    reasons: Vec<CString>,
    /// Pairs of the blocked steps.
    pairs: Vec<CString>,
}

impl KinoptJointPath {
    fn new(inner: JointPath<PathReport>) -> Self {
        let PathReport {
            missed, blocked, ..
        } = &inner.report;
        let reasons = missed.iter().map(|missed| miss_reason(&missed.reason));
        let pairs = blocked.iter().map(|blocked| blocked.by.to_string());
        Self {
            reasons: reasons.map(|reason| pointer::kept_text(&reason)).collect(),
            pairs: pairs.map(|pair| pointer::kept_text(&pair)).collect(),
            inner,
        }
    }
}

/// A step of a path in which a joint moves farther than its bound.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct KinoptJointJump {
    /// Index of the row after the step.
    pub index: usize,
    /// Index of the joint.
    pub joint: usize,
    /// Radians; of a prismatic joint the equivalent angle.
    pub distance: f64,
    /// True if the arm leaves its branch.
    pub reconfiguration: bool,
}

/// A point that the tool does not reach, or reaches only in collision: see `kinopt_joint_path_missed_reason`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct KinoptMissedPoint {
    /// Index of the row.
    pub index: usize,
    /// Error beyond the goal bounds, metres. It is within the tolerance if the tool reaches the pose in collision.
    pub position_error: f64,
    /// Error beyond the goal bounds, radians. It is within the tolerance if the tool reaches the pose in collision.
    pub orientation_error: f64,
}

/// Options of a path that the interface does not have.
const ELSEWHERE: [(&str, &str); 2] = [("tools", NO_TOOLS), ("tool_of_points", NO_TOOLS)];
const NO_TOOLS: &str = "a path of the C interface has one tool, that of its arm";

/// Solves a path of placements of the tool in the base: fewest reconfigurations, then the shortest.
///
/// `settings`: `traversal` ("open", "cyclic", "any-start"), `start`, `end`, `joint_weights`, `max_step`, `samples`, `times`,
/// `keep_times`. Points that are not reached are no error: see `kinopt_joint_path_reached`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_arm_solve_path(
    arm: *const KinoptArm,
    base_from_tools: *const f64,
    point_count: usize,
    settings: *const c_char,
    path: *mut *mut KinoptJointPath,
) -> KinoptStatus {
    guard(|| unsafe {
        let arm = &pointer::object(arm, "arm")?.inner;
        let points = pointer::placements(base_from_tools, point_count, "base_from_tools")?;
        let mut known = names(&options());
        known.retain(|name| ELSEWHERE.iter().all(|(other, _)| other != name));
        let settings = self::settings(settings, "option of a path", &known, &ELSEWHERE)?;
        let options = PathOptions::of(&settings, arm).map_err(of_json)?;
        let points = options
            .path::<Value>(CartesianPath::new(points)?)
            .map_err(of_json)?;
        let inner = options.solve(arm, [], &points)?;
        pointer::give(path, KinoptJointPath::new(inner), "path")
    })
}

/// Frees a joint path.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_free(path: *mut KinoptJointPath) {
    unsafe { pointer::free(path) }
}

/// True if all points are reached without reconfigurations, and all steps are collision-free; false for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_reached(path: *const KinoptJointPath) -> bool {
    let path = unsafe { pointer::object(path, "path") };
    path.is_ok_and(|path| path.inner.reached())
}

/// Number of rows; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_row_count(path: *const KinoptJointPath) -> usize {
    let path = unsafe { pointer::object(path, "path") };
    path.map_or(0, |path| path.inner.rows().len())
}

/// Configurations, one after another, valid as long as the path; their number of numbers is written to `length`, unless that
/// is null. Null for a path without rows.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_q(
    path: *const KinoptJointPath,
    length: *mut usize,
) -> *const f64 {
    let path = unsafe { pointer::object(path, "path") };
    let q = path.map_or(&[][..], |path| &path.inner.q);
    unsafe { pointer::kept_numbers(q, length) }
}

/// Number of jumps; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_jump_count(path: *const KinoptJointPath) -> usize {
    let path = unsafe { pointer::object(path, "path") };
    path.map_or(0, |path| path.inner.jumps.len())
}

/// Writes a jump.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_jump(
    path: *const KinoptJointPath,
    index: usize,
    jump: *mut KinoptJointJump,
) -> KinoptStatus {
    guard(|| unsafe {
        let jumps = &pointer::object(path, "path")?.inner.jumps;
        let found = entry(jumps, index, "jumps")?;
        let found = KinoptJointJump {
            index: found.index,
            joint: found.joint,
            distance: found.distance,
            reconfiguration: found.reconfiguration,
        };
        pointer::write(jump, found, "jump")
    })
}

/// Number of points that are not reached, or only in collision; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_missed_count(path: *const KinoptJointPath) -> usize {
    let path = unsafe { pointer::object(path, "path") };
    path.map_or(0, |path| path.inner.report.missed.len())
}

/// Writes a point that is not reached, or only in collision.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_missed(
    path: *const KinoptJointPath,
    index: usize,
    missed: *mut KinoptMissedPoint,
) -> KinoptStatus {
    guard(|| unsafe {
        let all = &pointer::object(path, "path")?.inner.report.missed;
        let found = entry(all, index, "missed points")?;
        let found = KinoptMissedPoint {
            index: found.index,
            position_error: found.position_error,
            orientation_error: found.orientation_error,
        };
        pointer::write(missed, found, "missed")
    })
}

/// Reason why a point is not reached, such as "collision of link `hand` and obstacle `box`", valid as long as the path; null
/// for an index out of range. `index` counts the missed points.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_missed_reason(
    path: *const KinoptJointPath,
    index: usize,
) -> *const c_char {
    let path = unsafe { pointer::object(path, "path") };
    pointer::text_at(path.map_or(&[], |path| &path.reasons), index)
}

/// Number of steps between rows that are not proven collision-free; 0 for null.
///
/// `kinopt_joint_path_trajectory` counts the rows of missed points and the rows after these steps, each row once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_blocked_count(path: *const KinoptJointPath) -> usize {
    let path = unsafe { pointer::object(path, "path") };
    path.map_or(0, |path| path.inner.report.blocked.len())
}

/// Writes the index of the row after a step that is not proven collision-free; 0 for the step that closes a cyclic path.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_blocked(
    path: *const KinoptJointPath,
    index: usize,
    row: *mut usize,
) -> KinoptStatus {
    guard(|| unsafe {
        let all = &pointer::object(path, "path")?.inner.report.blocked;
        let found = entry(all, index, "blocked steps")?.index;
        pointer::write(row, found, "row")
    })
}

/// Colliding pair of a step that is not proven collision-free, valid as long as the path; null for an index out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_blocked_pair(
    path: *const KinoptJointPath,
    index: usize,
) -> *const c_char {
    let path = unsafe { pointer::object(path, "path") };
    pointer::text_at(path.map_or(&[], |path| &path.pairs), index)
}

fn entry<'a, T>(all: &'a [T], index: usize, kind: &str) -> Result<&'a T, Failure> {
    let count = all.len();
    all.get(index)
        .ok_or_else(|| Failure::invalid(format!("`index` is {index}, the path has {count} {kind}")))
}
