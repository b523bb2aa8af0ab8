//! Root motion: the motion of a bone over the ground, separated from a clip.

use kinopt::animation::RootMotion as Motion;
use kinopt_bindings::names::{PLAYBACKS, named};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::curve::{KeyedCurve, Values};
use crate::arrays;
use crate::error::OrRaise;
use crate::transforms::one_to_array;

/// Horizontal motion and heading of a character, relative to the start of the clip: from `Clip.without_root_motion`.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct RootMotion {
    pub(crate) inner: Motion,
}

#[pymethods]
impl RootMotion {
    /// Horizontal displacement by the time of the clip in seconds: a curve of vectors.
    #[getter]
    fn way(&self) -> KeyedCurve {
        let inner = Values::Vectors(self.inner.way().clone());
        KeyedCurve { inner }
    }

    /// Heading about the upward axis in radians, not wrapped: a curve of numbers.
    #[getter]
    fn heading(&self) -> KeyedCurve {
        let inner = Values::Numbers(self.inner.heading().clone());
        KeyedCurve { inner }
    }

    /// Transform of the character at a time of the clip in seconds, shape (4, 4), relative to its start.
    ///
    /// Raises `InvalidValueError` for a time that is not finite.
    fn at<'py>(&self, py: Python<'py>, time: f64) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let time = arrays::finite(time, "time")?;
        one_to_array(py, &self.inner.at(time as f32))
    }

    /// Transform of the character after `elapsed` seconds of playback, shape (4, 4); each loop continues from the end
    /// of the last one.
    ///
    /// Raises `UnknownNameError` for another `playback`, `InvalidValueError` for a time that is not finite.
    #[pyo3(signature = (elapsed, playback = "loop"))]
    fn after<'py>(
        &self,
        py: Python<'py>,
        elapsed: f64,
        playback: &str,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let elapsed = arrays::finite(elapsed, "elapsed")?;
        one_to_array(
            py,
            &self
                .inner
                .after(elapsed, named("playback", playback, &PLAYBACKS).or_raise()?),
        )
    }
}
