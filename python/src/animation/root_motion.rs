//! Where a bone takes a character, apart from the clip.

use kinopt::animation::RootMotion as Motion;
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::curve::{KeyedCurve, Values};
use super::playback;
use crate::arrays;
use crate::transforms::one_to_array;

/// A character's way over the ground and its turning, from where it stood at the clip's start: of `Clip.without_root_motion`.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct RootMotion {
    pub(crate) inner: Motion,
}

#[pymethods]
impl RootMotion {
    /// The way over the ground by the clip's time in seconds: a curve of vectors.
    #[getter]
    fn way(&self) -> KeyedCurve {
        let inner = Values::Vectors(self.inner.way().clone());
        KeyedCurve { inner }
    }

    /// The turn about the axis up in radians, beyond whole turns: a curve of numbers.
    #[getter]
    fn heading(&self) -> KeyedCurve {
        let inner = Values::Numbers(self.inner.heading().clone());
        KeyedCurve { inner }
    }

    /// The character's place at a time of the clip in seconds, shape (4, 4): from where it starts to where it is.
    ///
    /// Raises `InvalidValueError` for a time that is not finite.
    fn at<'py>(&self, py: Python<'py>, time: f64) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let time = arrays::finite(time, "time")?;
        one_to_array(py, &self.inner.at(time as f32))
    }

    /// The character's place after `elapsed` seconds of playback, shape (4, 4): over the end of a loop it goes on from where the loop ended.
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
        one_to_array(py, &self.inner.after(elapsed, playback::of(playback)?))
    }
}
