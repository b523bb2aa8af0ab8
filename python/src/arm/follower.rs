//! Followers of paths whose targets come one at a time.

use std::sync::{Arc, Mutex, PoisonError};

use kinopt::task::PoseBounds;
use numpy::PyArray1;
use pyo3::prelude::*;
use self_cell::self_cell;

use crate::arrays;
use crate::coordinates::Coordinates;
use crate::error::OrRaise;
use crate::joint_jump::JointJump;
use crate::placement;
use crate::solution::Solution;

use kinopt::arm::Follower as Following;

self_cell!(
    /// A follower and its arm.
    struct Cell {
        owner: Arc<kinopt::Arm>,
        #[covariant]
        dependent: Following,
    }
);

/// Follows a path whose targets come one at a time, step by step on one branch; made by `Arm.follower`.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Follower {
    goal: PoseBounds,
    cell: Mutex<Cell>,
    coordinates: Py<Coordinates>,
}

impl Follower {
    pub(super) fn new(
        arm: Arc<kinopt::Arm>,
        coordinates: Py<Coordinates>,
        start: &[f64],
    ) -> PyResult<Self> {
        let goal = arm.goal();
        let cell = Cell::try_new(arm, |arm| arm.follower(start)).or_raise()?;
        Ok(Self {
            goal,
            cell: Mutex::new(cell),
            coordinates,
        })
    }
}

#[pymethods]
impl Follower {
    /// Configuration at the end of the last step, shape (dof,), radians or metres.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let cell = self.cell.lock().unwrap_or_else(PoisonError::into_inner);
        arrays::list(py, cell.borrow_dependent().q())
    }

    /// Moves to the next target, a placement: the `Solution`, and its `JointJump` or None.
    ///
    /// Raises `InvalidValueError` for a target that is not rigid, or that has no orientation.
    fn advance(
        &self,
        py: Python<'_>,
        target: &Bound<'_, PyAny>,
    ) -> PyResult<(Solution, Option<JointJump>)> {
        let target = placement::target(target, "target", &self.goal)?;
        let (solution, jump) = py.detach(|| {
            let mut cell = self.cell.lock().unwrap_or_else(PoisonError::into_inner);
            cell.with_dependent_mut(|arm, follower| {
                let mut solution = kinopt::Solution::default();
                let jump = follower.advance(target, &mut solution).or_raise()?;
                let jumps = JointJump::of_arm(arm, jump.as_slice());
                PyResult::Ok((solution, jumps.into_iter().next()))
            })
        })?;
        let coordinates = self.coordinates.clone_ref(py);
        Ok((Solution::new(solution, coordinates), jump))
    }

    fn __repr__(&self) -> String {
        let cell = self.cell.lock().unwrap_or_else(PoisonError::into_inner);
        format!("Follower(at {})", arrays::few(cell.borrow_dependent().q()))
    }
}
