//! The seed atlas: where in joint space to begin for a given goal.
//!
//! Turning the first joint turns the whole arm about its axis, and turning the last one turns the
//! tool about its own: neither needs to be tabulated. What remains of a goal is four numbers, its
//! key: distance from the first axis and height along it, and the direction of the last axis seen
//! in the half plane through the goal. A grid over the keys holds in every cell a few
//! configurations found there by sampling, each with the derivative of the joint values by the
//! key. A seed is then a table look-up, a first-order correction and two angles. The tool on the last
//! joint plays no part, so arms that differ in their tools share an atlas.

mod build;
mod candidates;
mod key;
mod look_up;
mod table;
mod with_tool;

pub(crate) use candidates::Candidates;
pub(crate) use table::Atlas;
pub(crate) use with_tool::TooledAtlas;
