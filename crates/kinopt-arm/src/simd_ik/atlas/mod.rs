//! Seed atlas: a table from goals to start configurations.
//!
//! Rotating the first joint rotates the whole arm, and rotating the last one rotates the tool about its axis. The table
//! factors out both. A goal then has a key of four numbers: radius, height, and the direction of the last axis in the
//! half plane through the goal. Each cell of a grid over the keys holds a few sampled configurations, with their
//! derivative by the key. A look-up corrects them to first order and adds two angles. The tool plays no part, so arms
//! with different tools share an atlas.

mod build;
mod candidates;
mod key;
mod look_up;
mod table;
mod with_tool;

pub(crate) use candidates::Candidates;
pub(crate) use table::Atlas;
pub(crate) use with_tool::TooledAtlas;
