//! Whole paths.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::arrays;
use crate::error::OrRaise;
use crate::items::Items;
use crate::solution::Solution;

/// A step in which a joint moves further than 0.2 rad.
#[pyclass(frozen, get_all, module = "kinopt")]
#[derive(Clone)]
pub(crate) struct Jump {
    /// Which step: the place of its target in the path; the motion is from the one before.
    step: usize,
    /// Name of the joint that moves furthest.
    joint: String,
    /// How far it moves, radians; a slide by the metres that weigh as much.
    distance: f64,
    /// Whether small steps lead there along the straight way: a fast motion or a coarse path. If not, the
    /// branch ended and this is a flip to another.
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

/// A path of solutions, and where it is broken.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Track {
    solutions: Vec<kinopt::Solution>,
    dof: usize,
    /// The steps in which a joint moves further than 0.2 rad, in order.
    #[pyo3(get)]
    jumps: Vec<Jump>,
}

impl Track {
    pub(super) fn new(arm: &kinopt::Arm, track: kinopt::arm::Track) -> Self {
        let jumps = track.jumps.iter().map(|jump| Jump::new(arm, jump));
        Self {
            jumps: jumps.collect(),
            dof: arm.joint_count(),
            solutions: track.solutions,
        }
    }

    fn errors<'py>(
        &self,
        py: Python<'py>,
        error: impl Fn(&kinopt::Solution) -> Option<f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        let errors = self.solutions.iter().map(|s| error(s).unwrap_or(f64::NAN));
        PyArray1::from_iter(py, errors)
    }
}

#[pymethods]
impl Track {
    /// Shape (N, dof), radians or metres, each within its limits.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let numbers: Vec<f64> = self
            .solutions
            .iter()
            .flat_map(|s| s.q.iter().copied())
            .collect();
        arrays::list(py, &numbers).reshape([self.solutions.len(), self.dof])
    }

    /// Shape (N,), bool: whether each target is reached within the tolerances.
    #[getter]
    fn reached<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_iter(py, self.solutions.iter().map(|s| s.reached))
    }

    /// Shape (N,), metres.
    #[getter]
    fn position_error<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.errors(py, |s| s.tasks().next()?.position_error())
    }

    /// Shape (N,), radians.
    #[getter]
    fn orientation_error<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.errors(py, |s| s.tasks().next()?.orientation_error())
    }

    /// What `Solution.explain` says of each step, a list.
    fn explain(&self) -> Vec<String> {
        self.solutions
            .iter()
            .map(kinopt::Solution::explain)
            .collect()
    }

    fn __iter__(slf: &Bound<'_, Self>) -> PyResult<Items> {
        Items::of(slf)
    }

    fn __len__(&self) -> usize {
        self.solutions.len()
    }

    fn __getitem__(&self, i: isize) -> PyResult<Solution> {
        let i = arrays::place(i, self.solutions.len())?;
        Ok(Solution::from(self.solutions[i].clone()))
    }

    #[classmethod]
    fn _rebuild(
        _class: &Bound<'_, PyType>,
        solutions: &str,
        dof: usize,
        jumps: Vec<(usize, String, f64, bool)>,
    ) -> PyResult<Self> {
        let jump = |(step, joint, distance, continuous)| Jump {
            step,
            joint,
            distance,
            continuous,
        };
        Ok(Self {
            solutions: serde_json::from_str(solutions).or_raise()?,
            dof,
            jumps: jumps.into_iter().map(jump).collect(),
        })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let jumps = self.jumps.iter();
        let jumps = jumps.map(|j| (j.step, j.joint.as_str(), j.distance, j.continuous));
        let solutions = serde_json::to_string(&self.solutions).or_raise()?;
        let arguments = (solutions, self.dof, jumps.collect::<Vec<_>>());
        let rebuild = py.get_type::<Self>().getattr("_rebuild")?;
        Ok((rebuild, arguments).into_pyobject(py)?.into_any())
    }

    fn __repr__(&self) -> String {
        let reached = self.solutions.iter().filter(|s| s.reached).count();
        format!(
            "Track({reached} of {} reached, {} jumps)",
            self.solutions.len(),
            self.jumps.len()
        )
    }
}
