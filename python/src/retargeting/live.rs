//! Online retargeting.

use std::sync::{Mutex, PoisonError};

use kinopt::motion::retarget::LiveFollower;
use kinopt::spatial::Vector3;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::capture::Capture;
use super::request::{RetargetRequest, raised};
use crate::arrays;
use crate::error::OrRaise;

/// Online retargeter of capture frames.
#[pyclass(frozen, module = "kinopt.retargeting")]
pub(crate) struct Live {
    follower: Mutex<LiveFollower>,
    /// Names of the numbers of a configuration.
    #[pyo3(get)]
    names: Vec<String>,
}

#[pymethods]
impl Live {
    #[new]
    fn new(
        py: Python<'_>,
        capture: &Bound<'_, Capture>,
        target: &Bound<'_, PyAny>,
        map: &str,
        options: &Bound<'_, PyDict>,
    ) -> PyResult<Self> {
        let request = RetargetRequest::read(capture, target, map, options)?;
        let follower = py.detach(|| request.fitted()?.live());
        Ok(Self {
            follower: Mutex::new(follower.map_err(raised)?),
            names: request.names(),
        })
    }

    /// Current configuration, shape (nq,).
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let follower = self.follower.lock().unwrap_or_else(PoisonError::into_inner);
        arrays::list(py, follower.q())
    }

    /// Processes the next capture frame, shape (J, 3), with rotations of shape (J, 4) if they are known.
    #[pyo3(signature = (positions, rotations = None))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
        rotations: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let rows = arrays::rows(positions, "positions", 3)?;
        let points: Vec<Vector3<f64>> = rows
            .chunks_exact(3)
            .map(|at| Vector3::new(at[0], at[1], at[2]))
            .collect();
        let rotations = rotations.map(|rotations| {
            let rows = arrays::rows(rotations, "rotations", 4)?;
            let quaternions = rows.chunks_exact(4).map(|q| [q[0], q[1], q[2], q[3]]);
            PyResult::Ok(quaternions.collect::<Vec<[f64; 4]>>())
        });
        let rotations = rotations.transpose()?;
        let q = py.detach(|| {
            let mut follower = self.follower.lock().unwrap_or_else(PoisonError::into_inner);
            let stepped = match &rotations {
                Some(rotations) => follower.step_with_rotations(&points, rotations),
                None => follower.step(&points),
            };
            stepped.map(<[f64]>::to_vec)
        });
        Ok(arrays::list(py, &q.or_raise()?))
    }
}
