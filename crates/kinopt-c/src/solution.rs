//! Solutions of one query.

use std::ffi::c_char;

use kinopt::Solution;
use kinopt::ik::Collision;

use crate::error::{Failure, KinoptStatus, guard};
use crate::pointer;

/// Result of a query, reached or not. It can be used for any number of queries, one after another.
#[derive(Default)]
pub struct KinoptSolution {
    pub(crate) inner: Solution,
}

/// Errors and effort of a query.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct KinoptOutcome {
    /// True if every required task is within its tolerance, and the configuration is collision-free.
    pub reached: bool,
    /// Largest position error, metres; NaN without a task that has a position.
    pub position_error: f64,
    /// Largest orientation error, radians; NaN without a task that has an orientation.
    pub orientation_error: f64,
    /// Iterations of all attempts.
    pub iterations: u32,
    /// Number of attempts.
    pub attempts: u32,
}

impl KinoptOutcome {
    fn of(solution: &Solution) -> Self {
        let count = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
        Self {
            reached: solution.reached,
            position_error: solution.position_error().unwrap_or(f64::NAN),
            orientation_error: solution.orientation_error().unwrap_or(f64::NAN),
            iterations: count(solution.iterations),
            attempts: count(solution.attempts),
        }
    }
}

/// Creates a solution without content.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_solution_new(solution: *mut *mut KinoptSolution) -> KinoptStatus {
    guard(|| unsafe { pointer::give(solution, KinoptSolution::default(), "solution") })
}

/// Frees a solution.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_solution_free(solution: *mut KinoptSolution) {
    unsafe { pointer::free(solution) }
}

/// True if every required task is within its tolerance, and the configuration is collision-free; false for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_solution_reached(solution: *const KinoptSolution) -> bool {
    let solution = unsafe { pointer::object(solution, "solution") };
    solution.is_ok_and(|solution| solution.inner.reached)
}

/// Configuration, valid until the next query with this solution; its length is written to `length`, unless that is null.
/// Null for a solution without content.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_solution_q(
    solution: *const KinoptSolution,
    length: *mut usize,
) -> *const f64 {
    let solution = unsafe { pointer::object(solution, "solution") };
    let q = solution.map_or(&[][..], |solution| &solution.inner.q);
    unsafe { pointer::kept_numbers(q, length) }
}

/// Writes the errors and the effort of the query.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_solution_outcome(
    solution: *const KinoptSolution,
    outcome: *mut KinoptOutcome,
) -> KinoptStatus {
    guard(|| unsafe {
        let solution = &pointer::object(solution, "solution")?.inner;
        pointer::write(outcome, KinoptOutcome::of(solution), "outcome")
    })
}

/// Writes an explanation: reached or not, the errors, and the limits or collisions that prevent a better result.
///
/// A text that is longer than the buffer is shortened. Its whole length without the final zero byte is written to `length`,
/// unless that is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_solution_explain(
    solution: *const KinoptSolution,
    buffer: *mut c_char,
    size: usize,
    length: *mut usize,
) -> KinoptStatus {
    guard(|| unsafe {
        let text = pointer::object(solution, "solution")?.inner.explain();
        pointer::write_text(&text, buffer, size, length)
    })
}

/// Number of pairs in collision, or nearer than the margin; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_solution_collision_count(solution: *const KinoptSolution) -> usize {
    let solution = unsafe { pointer::object(solution, "solution") };
    solution.map_or(0, |solution| solution.inner.collisions().len())
}

/// Writes the distance of a pair in metres, negative for penetration, and the names of its parts: each to a buffer of `size`
/// bytes, shortened if the buffer is too small. Links and obstacles have the names of the robot and the world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_solution_collision(
    solution: *const KinoptSolution,
    index: usize,
    first: *mut c_char,
    second: *mut c_char,
    size: usize,
    distance: *mut f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let collisions = pointer::object(solution, "solution")?.inner.collisions();
        write_collision(collisions, index, first, second, size, distance)
    })
}

/// Writes names and distance of a pair.
pub(crate) unsafe fn write_collision(
    collisions: &[Collision],
    index: usize,
    first: *mut c_char,
    second: *mut c_char,
    size: usize,
    distance: *mut f64,
) -> Result<(), Failure> {
    let count = collisions.len();
    let collision = collisions.get(index).ok_or_else(|| {
        Failure::invalid(format!("`index` is {index}, there are {count} collisions"))
    })?;
    // SAFETY: by the contract of the caller.
    unsafe {
        pointer::write_text(&collision.first, first, size, std::ptr::null_mut())?;
        pointer::write_text(&collision.second, second, size, std::ptr::null_mut())?;
        pointer::write(distance, collision.distance, "distance")
    }
}
