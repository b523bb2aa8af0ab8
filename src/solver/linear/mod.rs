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

pub(crate) use branched_matrix::BranchedMatrix;
pub(super) use complete_orthogonal::CompleteOrthogonal;
pub(super) use curved_normal::{
    CurvedModel, CurvedNormal, SecondOrder, multiply_symmetric, quadratic,
};
pub(super) use damped_normal::DampedNormal;
pub(super) use dense::add_scaled;
pub(crate) use dense::{dot, largest};
pub(crate) use held_step::{HeldStep, StepBounds};
pub(crate) use inner_products::InnerProducts;
pub(crate) use row_space::RowSpace;
pub(crate) use row_span::RowSpan;
pub(super) use semiseparable::{Semiseparable, SemiseparableNormal};
pub(crate) use tangent_newton::{Inequalities, TangentNewton};
