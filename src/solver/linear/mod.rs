//! Small dense linear algebra in memory that is reused: nalgebra's factorisations take ownership
//! and allocate on every call.

mod complete_orthogonal;
mod damped_normal;
mod householder;

pub(super) use complete_orthogonal::CompleteOrthogonal;
pub(super) use damped_normal::DampedNormal;
