//! Playback time of a clip.

use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;

use crate::arrays;

/// Playback time of a clip, with a speed that may be negative.
///
/// It is `elapsed` seconds after the start of playback; `speed` is seconds of the clip for each second.
///
/// Raises `InvalidValueError` for numbers that are not finite.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Playhead {
    inner: Mutex<kinopt::animation::Playhead>,
}

impl Playhead {
    fn with<T>(&self, run: impl FnOnce(&mut kinopt::animation::Playhead) -> T) -> T {
        run(&mut self.inner.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl Playhead {
    #[new]
    #[pyo3(signature = (elapsed = 0.0, speed = 1.0))]
    fn new(elapsed: f64, speed: f64) -> PyResult<Self> {
        let elapsed = arrays::finite(elapsed, "elapsed")?;
        let mut playhead = kinopt::animation::Playhead::starting_at(elapsed);
        playhead.speed = arrays::finite(speed, "speed")?;
        let inner = Mutex::new(playhead);
        Ok(Self { inner })
    }

    /// Seconds since playback started.
    #[getter]
    fn elapsed(&self) -> f64 {
        self.with(|playhead| playhead.elapsed())
    }

    /// Playback speed: seconds of the clip for each second; may be assigned, negative plays backwards.
    #[getter]
    fn speed(&self) -> f64 {
        self.with(|playhead| playhead.speed)
    }

    #[setter]
    fn set_speed(&self, speed: f64) -> PyResult<()> {
        let speed = arrays::finite(speed, "speed")?;
        self.with(|playhead| playhead.speed = speed);
        Ok(())
    }

    /// Advances playback by `seconds`. Pass the result to `Clip.fired` for its events.
    ///
    /// Raises `InvalidValueError` for a number that is not finite.
    fn advance(&self, seconds: f64) -> PyResult<Passage> {
        let seconds = arrays::finite(seconds, "seconds")?;
        let inner = self.with(|playhead| playhead.advance(seconds));
        Ok(Passage { inner })
    }

    fn __repr__(&self) -> String {
        let (elapsed, speed) = self.with(|playhead| (playhead.elapsed(), playhead.speed));
        format!("Playhead(elapsed={elapsed}, speed={speed})")
    }
}

/// Interval of playback time.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Passage {
    pub(crate) inner: kinopt::animation::Passage,
}

#[pymethods]
impl Passage {
    /// Start, in seconds since playback started.
    #[getter]
    fn start(&self) -> f64 {
        self.inner.from
    }

    /// End, in seconds since playback started; before `start` when playing backwards.
    #[getter]
    fn end(&self) -> f64 {
        self.inner.to
    }

    /// True if playback started at `start`.
    #[getter]
    fn starts(&self) -> bool {
        self.inner.starts
    }

    fn __repr__(&self) -> String {
        format!("Passage({} s to {} s)", self.inner.from, self.inner.to)
    }
}
