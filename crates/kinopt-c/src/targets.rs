//! Targets of a problem that change between queries.

use std::ffi::c_char;

use kinopt::problem::Targets;
use kinopt_bindings::placement::to_rows;
use kinopt_bindings::task::Aimed;
use serde_json::Value as Json;

use crate::error::{Failure, KinoptStatus, guard, of_json};
use crate::pointer;
use crate::problem::KinoptProblem;

/// Targets of a problem. One thread uses it at a time.
pub struct KinoptTargets {
    pub(crate) inner: Targets,
}

/// Creates targets, with those of the problem's tasks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_targets_new(
    problem: *const KinoptProblem,
    targets: *mut *mut KinoptTargets,
) -> KinoptStatus {
    guard(|| unsafe {
        let inner = pointer::object(problem, "problem")?.inner.inner.targets();
        pointer::give(targets, KinoptTargets { inner }, "targets")
    })
}

/// Frees targets.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_targets_free(targets: *mut KinoptTargets) {
    unsafe { pointer::free(targets) }
}

/// Sets the target of a pose or orientation, or the previous placement of a velocity task.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_targets_set_placement(
    targets: *mut KinoptTargets,
    problem: *const KinoptProblem,
    task: *const c_char,
    placement: *const f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let placement = pointer::placement(placement, "placement")?;
        let rows: Json = to_rows(&placement).chunks(4).collect();
        set(targets, problem, task, &rows)
    })
}

/// Sets the target of a task of one number or of a list: x, y, z of a point, a look-at, a gaze or a centre of mass, two
/// pixels, a distance, the values of a posture's joints.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_targets_set_numbers(
    targets: *mut KinoptTargets,
    problem: *const KinoptProblem,
    task: *const c_char,
    numbers: *const f64,
    length: usize,
) -> KinoptStatus {
    guard(|| unsafe {
        let numbers = pointer::array(numbers, length, "numbers")?;
        if let Some(number) = numbers.iter().find(|number| !number.is_finite()) {
            return Err(Failure::invalid(format!(
                "`numbers` has {number}, expected finite numbers"
            )));
        }
        let value = match numbers {
            [number] => (*number).into(),
            numbers => numbers.iter().copied().collect::<Json>(),
        };
        set(targets, problem, task, &value)
    })
}

unsafe fn set(
    targets: *mut KinoptTargets,
    problem: *const KinoptProblem,
    task: *const c_char,
    value: &Json,
) -> Result<(), Failure> {
    // SAFETY: by the contract of the caller.
    unsafe {
        let targets = &mut pointer::object_mut(targets, "targets")?.inner;
        let problem = &pointer::object(problem, "problem")?.inner;
        let index = problem
            .task_named(pointer::text(task, "task")?)
            .map_err(of_json)?;
        let aim = problem.read(index, value).map_err(of_json)?;
        aim(&mut Aimed::Targets(targets)).map_err(of_json)
    }
}
