//! Loops of a model, with frames by name.

use kinopt::model::{FrameId, Loop, LoopKind};
use kinopt::spatial::Placement;
use kinopt_bindings::names::{LOOPS, named};
use numpy::PyArray3;
use pyo3::prelude::*;

use crate::error::OrRaise;
use crate::placement;

/// Loop in the form of Python: its name, "connect" or "weld", the names of its frames, and the placements in these
/// frames.
pub(crate) type LoopParts<'py> = (String, &'static str, [String; 2], Bound<'py, PyArray3<f64>>);

/// Returns the loops of a model.
pub(crate) fn loop_parts<'py>(
    py: Python<'py>,
    model: &kinopt::Model,
) -> PyResult<Vec<LoopParts<'py>>> {
    let name = |id: FrameId| model.frames()[id.index()].name.clone();
    let loops = model.loops().iter().map(|closed| {
        let places = placement::to_arrays(py, &closed.frame_from_place)?;
        let frames = closed.frames.map(name);
        Ok((closed.name.clone(), closed.kind.name(), frames, places))
    });
    loops.collect()
}

/// Loop with frames by name.
#[derive(Clone)]
pub(crate) struct NamedLoop {
    pub(crate) name: String,
    pub(crate) frames: [String; 2],
    kind: LoopKind,
    places: [Placement<f64>; 2],
}

impl NamedLoop {
    /// Creates a loop; missing placements are the identity.
    pub(crate) fn new(
        name: String,
        frames: [String; 2],
        kind: &str,
        places: Option<[Bound<'_, PyAny>; 2]>,
    ) -> PyResult<Self> {
        let kind = named("loop kind", kind, &LOOPS);
        let places = match places {
            None => [Placement::identity(); 2],
            Some([first, second]) => [
                placement::placement(&first, "a place of a loop")?,
                placement::placement(&second, "a place of a loop")?,
            ],
        };
        Ok(Self {
            name,
            frames,
            kind: kind.or_raise()?,
            places,
        })
    }

    /// Returns the loop between these frames.
    pub(crate) fn of(&self, frames: [FrameId; 2]) -> Loop {
        let joined = match self.kind {
            LoopKind::Weld => Loop::weld(&self.name, frames),
            _ => Loop::connect(&self.name, frames),
        };
        joined.at(self.places)
    }

    /// Arguments of `new`.
    pub(crate) fn pickled<'py>(&self, py: Python<'py>) -> PyResult<LoopParts<'py>> {
        let places = placement::to_arrays(py, &self.places)?;
        let frames = self.frames.clone();
        Ok((self.name.clone(), self.kind.name(), frames, places))
    }
}
