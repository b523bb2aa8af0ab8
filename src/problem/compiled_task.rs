//! A task with its names resolved to slots and its rows placed.

use std::ops::Range;

use crate::kinematics::FrameSlot;
use crate::task::{ErasedResidual, Quantity, Role};

/// Rows of one quantity, their weight and tolerance.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub(crate) quantity: Quantity,
    /// Rows of the whole problem.
    pub(crate) rows: Range<usize>,
    pub(crate) weight: f64,
    pub(crate) tolerance: f64,
}

pub(crate) struct CompiledTask {
    pub(crate) name: String,
    pub(crate) residual: Box<dyn ErasedResidual>,
    pub(crate) role: Role,
    pub(crate) blocks: Vec<Block>,
    /// All rows, of the whole problem.
    pub(crate) rows: Range<usize>,
    /// The weight of each row.
    pub(crate) weights: Vec<f64>,
    pub(crate) frames: Vec<FrameSlot>,
    /// Coordinates of the configuration.
    pub(crate) coordinates: Vec<usize>,
}

impl CompiledTask {
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.blocks.iter()
    }
}
