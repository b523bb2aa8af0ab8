//! Cartesian paths of arms, solved with the fewest reconfigurations.

use std::ffi::c_char;

use kinopt::arm::JointPath;
use kinopt::motion::path::{CartesianPath, PathReport};
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

/// A point that is not reached.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct KinoptMissedPoint {
    /// Index of the row.
    pub index: usize,
    /// Error beyond the goal bounds, metres.
    pub position_error: f64,
    /// Error beyond the goal bounds, radians.
    pub orientation_error: f64,
}

/// Options that are objects of the interface.
const OBJECTS: [&str; 2] = ["tools", "tool_of_points"];

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
        known.retain(|name| !OBJECTS.contains(name));
        let settings = self::settings(settings, "option of a path", &known)?;
        let options = PathOptions::of(&settings, arm).map_err(of_json)?;
        let points = options
            .path::<Value>(CartesianPath::new(points)?)
            .map_err(of_json)?;
        let inner = options.solve(arm, [], &points)?;
        pointer::give(path, KinoptJointPath { inner }, "path")
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

/// Number of points that are not reached; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_joint_path_missed_count(path: *const KinoptJointPath) -> usize {
    let path = unsafe { pointer::object(path, "path") };
    path.map_or(0, |path| path.inner.report.missed.len())
}

/// Writes a point that is not reached.
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

fn entry<'a, T>(all: &'a [T], index: usize, kind: &str) -> Result<&'a T, Failure> {
    let count = all.len();
    all.get(index)
        .ok_or_else(|| Failure::invalid(format!("`index` is {index}, the path has {count} {kind}")))
}
