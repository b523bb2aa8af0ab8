//! Solutions along paths of targets.

use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::pickling;
use crate::solver::Solutions;

/// A step in which a joint moves farther than 0.2 rad.
#[pyclass(frozen, get_all, module = "kinopt")]
#[derive(Clone)]
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
        jumps: Vec<(usize, String, f64, bool)>,
    ) -> PyResult<Bound<'py, Self>> {
        let jump = |(step, joint, distance, continuous)| Jump {
            step,
            joint,
            distance,
            continuous,
        };
        let jumps = jumps.into_iter().map(jump).collect();
        Bound::new(
            class.py(),
            (Self { jumps }, Solutions::read(solutions, dof)?),
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let jumps = slf.get().jumps.iter();
        let jumps = jumps.map(|j| (j.step, j.joint.as_str(), j.distance, j.continuous));
        let (solutions, dof) = slf.as_super().get().written()?;
        let arguments = (solutions, dof, jumps.collect::<Vec<_>>());
        pickling::by_method(py.get_type::<Self>().as_any(), "_rebuild_path", arguments)
    }

    fn __repr__(slf: &Bound<'_, Self>) -> String {
        let jumps = slf.get().jumps.len();
        let reached = slf.as_super().get().reached_text();
        format!("Track({reached}, {jumps} jumps)")
    }
}
