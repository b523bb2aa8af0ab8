//! Solutions along paths of targets.

use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::error::OrRaise;
use crate::joint_jump::JointJump;
use crate::pickling;
use crate::solver::Solutions;

/// Solutions along a path: the `Solutions` of its steps, and its `jumps`.
#[pyclass(frozen, extends = Solutions, module = "kinopt")]
pub(crate) struct Track {
    /// Steps in which a joint moves farther than 0.2 rad, in order.
    #[pyo3(get)]
    jumps: Vec<JointJump>,
}

impl Track {
    pub(super) fn new<'py>(
        py: Python<'py>,
        arm: &kinopt::Arm,
        track: kinopt::arm::Track,
    ) -> PyResult<Bound<'py, Self>> {
        let jumps = JointJump::of_arm(arm, &track.jumps);
        let solutions = Solutions::new(track.solutions, arm.joint_count());
        Bound::new(py, (Self { jumps }, solutions))
    }
}

#[pymethods]
impl Track {
    #[classmethod]
    fn _rebuild_path<'py>(
        class: &Bound<'py, PyType>,
        solutions: &str,
        dof: usize,
        jumps: &str,
    ) -> PyResult<Bound<'py, Self>> {
        let jumps = pickling::of_json(jumps)?;
        let solutions = Solutions::read(solutions, dof)?;
        Bound::new(class.py(), (Self { jumps }, solutions))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let jumps = serde_json::to_string(&slf.get().jumps).or_raise()?;
        let (solutions, dof) = slf.as_super().get().written()?;
        let class = slf.py().get_type::<Self>();
        pickling::by_method(class.as_any(), "_rebuild_path", (solutions, dof, jumps))
    }

    fn __repr__(slf: &Bound<'_, Self>) -> String {
        let jumps = slf.get().jumps.len();
        let reached = slf.as_super().get().reached_text();
        format!("Track({reached}, {jumps} jumps)")
    }
}
