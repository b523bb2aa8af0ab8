//! Whether the bodies of a chain, as spheres, come near solids or each other: for eight configurations at once.
//!
//! Broad and fine, as in VAMP (Thomason, Kingston & Kavraki 2024, "Motions in microseconds via vectorized
//! sampling-based planning"): a sphere round each body first, and its own spheres where that one comes near.

mod bodies;
mod instruction_set;
mod many_solids;
mod near;
mod passed;
mod solids;

pub(crate) use bodies::{Body, BodyChain};
pub(crate) use instruction_set::{CHECKED, Rooms, near};
pub(crate) use passed::Passed;
pub(crate) use solids::{SolidMoved, Solids};
