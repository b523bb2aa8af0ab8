//! Path followers, with targets one at a time.

use std::rc::Rc;

use self_cell::self_cell;
use wasm_bindgen::prelude::*;

use crate::error::{Exception, raise};
use crate::placement::read;
use crate::solution::Solution;

use kinopt::arm::Follower as Following;

self_cell!(
    struct Cell {
        owner: Rc<kinopt::Arm>,
        #[covariant]
        dependent: Following,
    }
);

/// Path follower of an arm. A step in which a joint moves farther than 0.2 rad is reported as a jump.
#[wasm_bindgen]
pub struct Follower {
    cell: Cell,
    jumped: bool,
}

impl Follower {
    pub(super) fn new(arm: Rc<kinopt::Arm>, start: &[f64]) -> Result<Self, Exception> {
        let cell = Cell::try_new(arm, |arm| arm.follower(start)).map_err(raise)?;
        let jumped = false;
        Ok(Self { cell, jumped })
    }
}

#[wasm_bindgen]
impl Follower {
    /// Current configuration.
    #[wasm_bindgen(getter)]
    pub fn q(&self) -> Vec<f64> {
        self.cell.borrow_dependent().q().to_vec()
    }

    /// True if the last step moved a joint farther than 0.2 rad.
    #[wasm_bindgen(getter)]
    pub fn jumped(&self) -> bool {
        self.jumped
    }

    /// Moves to the next target.
    pub fn advance(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Placement")] target: &[f64],
    ) -> Result<Solution, Exception> {
        let target = read(target, "target")?;
        let mut solution = kinopt::Solution::default();
        let advanced = self.cell.with_dependent_mut(|_, follower| {
            let jump = follower.advance(target, &mut solution);
            jump.map(|jump| jump.is_some())
        });
        self.jumped = advanced.map_err(raise)?;
        Ok(solution.into())
    }
}
