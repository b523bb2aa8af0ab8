//! Answers to whether a target can be reached.

use pyo3::prelude::*;

use crate::solution::Solution;

/// Answer of `Arm.reachability`: a configuration that reaches the target, or a proof that there is none.
#[pyclass(frozen, get_all, module = "kinopt")]
pub(crate) struct Reachability {
    /// True if `solution` reaches the target, False if no configuration within the joint limits does, None if that is
    /// undecided.
    pub(super) reachable: Option<bool>,
    /// The solution, or the closest pose found.
    pub(super) solution: Py<Solution>,
    /// Number of boxes of joint values that were examined; 0 for a reachable target.
    pub(super) boxes: usize,
}

#[pymethods]
impl Reachability {
    /// The explanation of `solution`, which names the proof.
    fn explain(&self, py: Python<'_>) -> PyResult<String> {
        self.solution.bind(py).call_method0("explain")?.extract()
    }

    fn __repr__(&self) -> String {
        let answer = match self.reachable {
            Some(true) => "reachable",
            Some(false) => "unreachable",
            None => "undecided",
        };
        format!("Reachability({answer}, {} boxes)", self.boxes)
    }
}
