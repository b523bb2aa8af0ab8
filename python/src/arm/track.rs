//! Solutions along paths of targets.

use pyo3::prelude::*;
use pyo3::types::PyType;
use serde::{Deserialize, Serialize};

use crate::error::OrRaise;
use crate::pickling;
use crate::solver::Solutions;

/// A step in which a joint moves farther than 0.2 rad.
#[pyclass(frozen, get_all, module = "kinopt")]
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct Jump {
    /// Index of the step's target in the path; the motion starts at the previous target.
    step: usize,
    /// Name of the joint that moves farthest.
    joint: String,
    /// Distance that it moves, radians; for a prismatic joint metres, converted by its weight.
    distance: f64,
    /// True if small steps along the straight segment lead there: a fast motion or a coarse path. Otherwise the branch
    /// ended and the arm jumped to another.
    continuous: bool,
}

impl Jump {
    pub(super) fn new(arm: &kinopt::Arm, jump: &kinopt::arm::Jump) -> Self {
        Self {
            step: jump.step,
            joint: arm.joints().nth(jump.joint).unwrap_or_default().to_owned(),
            distance: jump.distance,
            continuous: jump.continuous,
        }
    }
}

#[pymethods]
impl Jump {
    fn __repr__(&self) -> String {
        format!(
            "Jump(step {}, {:?}, {:.3} rad, {})",
            self.step,
            self.joint,
            self.distance,
            if self.continuous {
                "continuous"
            } else {
                "flip"
            }
        )
    }
}

/// Solutions along a path: the `Solutions` of its steps, and its `jumps`.
#[pyclass(frozen, extends = Solutions, module = "kinopt")]
pub(crate) struct Track {
    /// Steps in which a joint moves farther than 0.2 rad, in order.
    #[pyo3(get)]
    jumps: Vec<Jump>,
}

impl Track {
    pub(super) fn new<'py>(
        py: Python<'py>,
        arm: &kinopt::Arm,
        track: kinopt::arm::Track,
    ) -> PyResult<Bound<'py, Self>> {
        let jumps = track.jumps.iter().map(|jump| Jump::new(arm, jump));
        let jumps = jumps.collect();
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
