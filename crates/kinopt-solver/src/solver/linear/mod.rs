//! Small dense linear algebra in reused memory: nalgebra's factorisations take ownership and allocate on every call.

mod bounded_projection;
mod branched_matrix;
mod cholesky;
mod complete_orthogonal;
mod curved_normal;
mod damped_normal;
mod dense;
mod elimination_tree;
mod held_step;
mod householder;
mod inner_products;
mod row_space;
mod row_span;
mod semiseparable;
mod tangent_newton;

#[doc(hidden)]
pub use branched_matrix::BranchedMatrix;
pub(super) use complete_orthogonal::CompleteOrthogonal;
pub(super) use curved_normal::{
    CurvedModel, CurvedNormal, SecondOrder, multiply_symmetric, quadratic,
};
pub(super) use damped_normal::DampedNormal;
pub(super) use dense::add_scaled;
#[doc(hidden)]
pub use dense::{dot, largest};
#[doc(hidden)]
pub use held_step::{HeldStep, StepBounds};
#[doc(hidden)]
pub use inner_products::InnerProducts;
#[doc(hidden)]
pub use row_space::RowSpace;
#[doc(hidden)]
pub use row_span::RowSpan;
pub(super) use semiseparable::{Semiseparable, SemiseparableNormal};
#[doc(hidden)]
pub use tangent_newton::{Inequalities, TangentNewton};
