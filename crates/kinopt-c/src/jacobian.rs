//! Jacobians of arms.

use kinopt::kinematics::Jacobian;

use crate::arm::KinoptArm;
use crate::error::{KinoptStatus, guard};
use crate::pointer;

/// Jacobian of an arm's tool, compiled once. One thread uses it at a time.
pub struct KinoptJacobian {
    inner: Jacobian,
}

/// Compiles the Jacobian of an arm's tool.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_jacobian_new(
    arm: *const KinoptArm,
    jacobian: *mut *mut KinoptJacobian,
) -> KinoptStatus {
    guard(|| unsafe {
        let inner = pointer::object(arm, "arm")?.inner.jacobian()?;
        pointer::give(jacobian, KinoptJacobian { inner }, "jacobian")
    })
}

/// Frees a Jacobian.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_jacobian_free(jacobian: *mut KinoptJacobian) {
    unsafe { pointer::free(jacobian) }
}

/// Writes the Jacobian at a configuration: six rows by columns, one column for each joint.
///
/// The rows are the velocity of the tool's origin, m/s, and its angular velocity, rad/s, in the base's axes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_jacobian_at(
    jacobian: *mut KinoptJacobian,
    q: *const f64,
    q_length: usize,
    matrix: *mut f64,
    matrix_length: usize,
) -> KinoptStatus {
    guard(|| unsafe {
        let jacobian = &mut pointer::object_mut(jacobian, "jacobian")?.inner;
        let at = jacobian.at(pointer::array(q, q_length, "q")?)?;
        pointer::copy(at.as_slice(), matrix, matrix_length, "matrix")
    })
}
