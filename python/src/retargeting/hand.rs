//! Retargeting of hands.

use std::sync::{Mutex, PoisonError};

use kinopt::motion::retarget::{HandFollower, HandMap, HandRetargeting};
use kinopt::spatial::Vector3;
use kinopt_bindings::coordinates;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use super::capture::Capture;
use super::request::{raised, target_of};
use crate::arrays;
use crate::error::OrRaise;

/// Configurations, their names, and tip error, pinch distance and scales.
type HandMotionParts<'py> = (Bound<'py, PyArray2<f64>>, Vec<String>, (f64, f64, Vec<f64>));

/// Map of a captured hand to a robot hand (JSON), by names.
#[pyfunction]
pub(super) fn hand_map_guessed(
    capture: &Bound<'_, Capture>,
    target: &Bound<'_, PyAny>,
    side: Option<&str>,
) -> PyResult<String> {
    let robot = target_of(target)?;
    let map = HandMap::guess(&capture.get().inner, robot.model(), side);
    Ok(map.map_err(raised)?.to_json())
}

/// Retargets a captured hand to a robot hand by a map (JSON).
#[pyfunction]
pub(super) fn hand_retargeted<'py>(
    py: Python<'py>,
    capture: &Bound<'py, Capture>,
    target: &Bound<'py, PyAny>,
    map: &str,
) -> PyResult<HandMotionParts<'py>> {
    let robot = target_of(target)?;
    let capture = capture.get().inner.clone();
    let map = HandMap::from_json(map).map_err(raised)?;
    let motion = py.detach(|| HandRetargeting::new(&robot, &map, &capture)?.per_frame());
    let motion = motion.map_err(raised)?;
    let report = motion.report;
    Ok((
        arrays::list(py, &motion.q).reshape([motion.times.len(), motion.nq])?,
        coordinates::names(robot.model()),
        (report.tip_error, report.pinch_distance, report.scales),
    ))
}

/// Online retargeter of a hand.
#[pyclass(frozen, module = "kinopt.retargeting")]
pub(crate) struct LiveHand {
    follower: Mutex<HandFollower>,
    /// Names of the numbers of a configuration.
    #[pyo3(get)]
    names: Vec<String>,
}

#[pymethods]
impl LiveHand {
    #[new]
    fn new(capture: &Bound<'_, Capture>, target: &Bound<'_, PyAny>, map: &str) -> PyResult<Self> {
        let robot = target_of(target)?;
        let map = HandMap::from_json(map).map_err(raised)?;
        let fitted = HandRetargeting::new(&robot, &map, &capture.get().inner);
        let follower = fitted.and_then(|fitted| fitted.live()).map_err(raised)?;
        Ok(Self {
            follower: Mutex::new(follower),
            names: coordinates::names(robot.model()),
        })
    }

    /// Current configuration, shape (nq,).
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let follower = self.follower.lock().unwrap_or_else(PoisonError::into_inner);
        arrays::list(py, follower.q())
    }

    /// Processes the next capture frame, shape (J, 3).
    fn step<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let rows = arrays::rows(positions, "positions", 3)?;
        let points = rows
            .chunks_exact(3)
            .map(|at| Vector3::new(at[0], at[1], at[2]));
        let points: Vec<Vector3<f64>> = points.collect();
        let q = py.detach(|| {
            let mut follower = self.follower.lock().unwrap_or_else(PoisonError::into_inner);
            follower.step(&points).map(<[f64]>::to_vec)
        });
        Ok(arrays::list(py, &q.or_raise()?))
    }
}
