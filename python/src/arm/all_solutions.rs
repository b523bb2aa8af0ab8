//! All solutions of a target, and self-motions.

use kinopt::arm::{AllSolutions as Inner, PoseSolution, SelfMotion as Motion};
use kinopt_bindings::names::{argument, elbow, shoulder, wrist};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// All solutions of a target, nearest to the start first. `len()` is their number.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct AllSolutions {
    inner: Inner,
    joints: usize,
}

impl AllSolutions {
    pub(super) fn new(inner: Inner, joints: usize) -> Self {
        Self { inner, joints }
    }

    fn each<T>(&self, value: impl Fn(&PoseSolution) -> T) -> Vec<T> {
        self.inner.solutions.iter().map(value).collect()
    }
}

#[pymethods]
impl AllSolutions {
    /// Configurations, shape (N, dof), radians or metres.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let solutions = &self.inner.solutions;
        let q: Vec<f64> = solutions.iter().flat_map(|s| &s.q).copied().collect();
        PyArray1::from_vec(py, q).reshape([solutions.len(), self.joints])
    }

    /// Position errors, metres, shape (N,).
    #[getter]
    fn position_errors<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.each(|solution| solution.position_error))
    }

    /// Orientation errors, radians, shape (N,).
    #[getter]
    fn orientation_errors<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.each(|solution| solution.orientation_error))
    }

    /// Branches of the shoulder: "left", "right", or None where the arm's structure defines none.
    #[getter]
    fn shoulder(&self) -> Vec<Option<&'static str>> {
        self.each(|solution| solution.branch.shoulder.map(shoulder))
    }

    /// Branches of the elbow: "up", "down", or None where the arm's structure defines none.
    #[getter]
    fn elbow(&self) -> Vec<Option<&'static str>> {
        self.each(|solution| solution.branch.elbow.map(elbow))
    }

    /// Branches of the wrist: "no_flip", "flip", or None where the arm's structure defines none.
    #[getter]
    fn wrist(&self) -> Vec<Option<&'static str>> {
        self.each(|solution| solution.branch.wrist.map(wrist))
    }

    /// True if the set has all isolated solutions, and there are no others.
    #[getter]
    fn complete(&self) -> bool {
        self.inner.complete
    }

    /// True if the target has a continuous family of solutions, of which the set has samples.
    #[getter]
    fn has_family(&self) -> bool {
        self.inner.has_family
    }

    /// Argument for the completeness: "spherical_wrist", "spherical_shoulder", "three_parallel_axes",
    /// "univariate_polynomial", or None.
    #[getter]
    fn argument(&self) -> Option<&'static str> {
        argument(&self.inner.argument)
    }

    fn __len__(&self) -> usize {
        self.inner.solutions.len()
    }

    fn __repr__(&self) -> String {
        let complete = match self.inner.complete {
            true => "complete",
            false => "not complete",
        };
        format!("AllSolutions({}, {complete})", self.inner.solutions.len())
    }
}

/// A curve of configurations that keep the tool at its target. `len()` is the number of samples.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct SelfMotion {
    inner: Motion,
}

impl SelfMotion {
    pub(super) fn new(inner: Motion) -> Self {
        Self { inner }
    }
}

#[pymethods]
impl SelfMotion {
    /// Successive configurations, shape (N, 7), radians. No joint moves by more than 0.05 rad between two.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let samples = self.inner.q.len() / 7;
        PyArray1::from_slice(py, &self.inner.q).reshape([samples, 7])
    }

    /// True if the last configuration is followed by the first, up to whole turns of joints without limits.
    #[getter]
    fn closed(&self) -> bool {
        self.inner.closed
    }

    fn __len__(&self) -> usize {
        self.inner.q.len() / 7
    }

    fn __repr__(&self) -> String {
        let kind = match self.inner.closed {
            true => "closed",
            false => "open",
        };
        format!("SelfMotion({} samples, {kind})", self.inner.q.len() / 7)
    }
}
