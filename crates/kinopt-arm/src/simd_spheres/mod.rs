//! SIMD collision check of a chain's bodies, as spheres, against solids and each other: eight configurations at once.
//!
//! The check has two phases, as in VAMP (Thomason, Kingston & Kavraki 2024, "Motions in microseconds via vectorized
//! sampling-based planning"). The bounding sphere of each body comes first, its spheres follow if the bound is near.

mod bodies;
mod instruction_set;
mod near;
mod passed;
mod solid_tree;
mod solids;

pub(crate) use bodies::{BodyChain, ChainBody};
pub(crate) use instruction_set::{CHECKED, SphereWorkspaces, near};
pub(crate) use passed::Passed;
pub(crate) use solids::{SolidMoved, Solids};
