//! Closed loops, and forward kinematics of models that have them.

use std::sync::Arc;

use kinopt::model::{FrameId, JointId, Loop, LoopKind};
use kinopt::spatial::Placement;
use numpy::ndarray::IxDyn;
use numpy::{PyArray1, PyArray3};
use pyo3::prelude::*;

use crate::arrays::{self, Questions, fill};
use crate::error::OrRaise;
use crate::has_model::model_of;
use crate::model::first_seed;
use crate::pickling;
use crate::placement;
use crate::problem::parameters_of;
use crate::robot::Robot;

/// Rows between two looks at signals.
const PIECE: usize = 16;

/// A loop as it is told: its name, "connect" or "weld", the frames' names, and where on them.
pub(crate) type LoopParts<'py> = (String, &'static str, [String; 2], Bound<'py, PyArray3<f64>>);

/// The loops of a model.
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

/// A loop whose frames have names.
#[derive(Clone)]
pub(crate) struct NamedLoop {
    pub(crate) name: String,
    pub(crate) frames: [String; 2],
    kind: LoopKind,
    places: [Placement<f64>; 2],
}

impl NamedLoop {
    /// As it is given; places that are not, are the frames themselves.
    pub(crate) fn new(
        name: String,
        frames: [String; 2],
        kind: &str,
        places: Option<[Bound<'_, PyAny>; 2]>,
    ) -> PyResult<Self> {
        let kinds = [LoopKind::Connect, LoopKind::Weld];
        let known = kinds.into_iter().find(|known| known.name() == kind);
        let names = kinds.map(LoopKind::name);
        let kind = known.ok_or_else(|| kinopt::model::UnknownName::new("loop kind", kind, names));
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

    /// With the frames that are meant.
    pub(crate) fn of(&self, frames: [FrameId; 2]) -> Loop {
        let own = match self.kind {
            LoopKind::Weld => Loop::weld(&self.name, frames),
            _ => Loop::connect(&self.name, frames),
        };
        own.at(self.places)
    }

    /// What `new` takes.
    pub(crate) fn pickled<'py>(&self, py: Python<'py>) -> PyResult<LoopParts<'py>> {
        let places = placement::to_arrays(py, &self.places)?;
        let frames = self.frames.clone();
        Ok((self.name.clone(), self.kind.name(), frames, places))
    }
}

/// Forward kinematics of a model with loops: the joints that nothing drives follow from those that are given.
///
/// `model` is a model or a robot; `dependent` names the joints that close its loops. Without it they are those of a
/// robot's `passive_joints` that move a loop.
///
/// Raises `UnknownNameError` for a joint that there is not, `InvalidValueError` where no joint is passive or one
/// does not move.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct LoopClosure {
    of: Py<PyAny>,
    model: Arc<kinopt::Model>,
    dependent: Vec<JointId>,
}

impl LoopClosure {
    /// Asks the library's, which borrows its model.
    fn ask<T>(
        &self,
        py: Python<'_>,
        question: impl FnOnce(&kinopt::ik::LoopClosure<'_>) -> PyResult<T>,
    ) -> PyResult<T> {
        let of = self.of.bind(py);
        let parameters = parameters_of(of, &self.model);
        question(&kinopt::ik::LoopClosure::new(parameters, &self.dependent).or_raise()?)
    }
}

#[pymethods]
impl LoopClosure {
    #[new]
    #[pyo3(signature = (model, dependent = None))]
    fn new(model: &Bound<'_, PyAny>, dependent: Option<Vec<String>>) -> PyResult<Self> {
        let own = model_of(model)?;
        let dependent = match (&dependent, model.cast::<Robot>()) {
            (Some(names), _) => {
                let joints = names.iter().map(|name| own.joint(name));
                joints.collect::<Result<_, _>>().or_raise()?
            }
            (None, Ok(robot)) => {
                let passive = robot.get().inner.passive_joints().iter().copied();
                passive.filter(|id| own.moves_a_loop(*id)).collect()
            }
            (None, Err(_)) => Vec::new(),
        };
        let closure = Self {
            of: model.clone().unbind(),
            model: own,
            dependent,
        };
        closure.ask(model.py(), |_| Ok(()))?;
        Ok(closure)
    }

    /// Names of the joints that close the loops.
    #[getter]
    fn dependent(&self) -> Vec<&str> {
        let joints = self.dependent.iter();
        joints
            .map(|id| self.model.joints()[id.index()].name.as_str())
            .collect()
    }

    /// The configuration with its dependent joints where all loops are closed, to 1e-9 m and rad, and those that
    /// follow others with them; the rest keep their values. Shape (nq,), or (N, nq). Of several ways to close a loop
    /// it is the one that the dependent joints' own values lead to.
    ///
    /// Raises `InvalidValueError`, which names the loop and its gap, where one does not close; for other shapes,
    /// numbers that are not finite, and joints outside their limits that should keep their values.
    fn close<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = q.py();
        let width = self.model.configuration_len();
        let rows = Questions::rows(q, "q", width)?;
        let array = crate::arrays::zeros::<f64, _>(py, IxDyn(&rows.shape(&[width])))?;
        self.ask(py, |closure| {
            fill(&array, |room| {
                rows.each(py, room, PIECE, |row, to| {
                    to.copy_from_slice(row);
                    closure.close(to).or_raise()
                })
            })
        })?;
        Ok(array.into_any())
    }

    /// How far each loop is open at a configuration: tuples of its name, the gap in metres, and the angle in radians,
    /// 0 for a "connect".
    ///
    /// Raises `InvalidValueError` for another shape and for numbers that are not finite.
    fn gaps(&self, q: &Bound<'_, PyAny>) -> PyResult<Vec<(String, f64, f64)>> {
        let numbers = arrays::vector_of(q, "q", self.model.configuration_len())?;
        let gaps = self.ask(q.py(), |closure| closure.gaps(&numbers).or_raise())?;
        let told = gaps.into_iter().map(|gap| (gap.name, gap.gap, gap.angle));
        Ok(told.collect())
    }

    /// A configuration within all limits whose loops are closed, shape (nq,): from a random one all joints that move
    /// a loop go where they close it. Not all such configurations are as likely. `seed` is a whole number or a
    /// `numpy.random.Generator`.
    ///
    /// Raises `InvalidValueError` for another seed, and for loops that none of 32 random configurations closes.
    #[pyo3(signature = (seed = None))]
    fn random_configuration<'py>(
        &self,
        py: Python<'py>,
        seed: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let seed = seed.map_or(Ok(0), first_seed)?;
        let drawn = self.ask(py, |closure| closure.random_configuration(seed).or_raise())?;
        Ok(arrays::list(py, &drawn))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_class::<Self>(py, (self.of.bind(py), self.dependent()))
    }

    fn __repr__(&self) -> String {
        format!(
            "LoopClosure({:?}, {} loops, dependent: {})",
            self.model.name(),
            self.model.loops().len(),
            self.dependent().join(", ")
        )
    }
}
