//! Forward kinematics of models with loops.

use std::sync::Arc;

use kinopt::model::JointId;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::{self, Queries};
use crate::error::OrRaise;
use crate::has_model::model_of;
use crate::model::first_seed;
use crate::pickling;
use crate::problem::parameters_of;
use crate::robot::Robot;

/// Rows between two checks for signals.
const ROWS_AT_A_TIME: usize = 16;

/// Forward kinematics of a model with loops: the dependent joints follow from the given ones.
///
/// `model` is a model or a robot; `dependent` names the joints that close its loops. Default: those of a robot's
/// `passive_joints` that move a loop.
///
/// Raises `UnknownNameError` for an unknown joint, `InvalidValueError` if no joint is passive or a joint does not move.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct LoopClosure {
    python_model: Py<PyAny>,
    model: Arc<kinopt::Model>,
    dependent: Vec<JointId>,
}

impl LoopClosure {
    /// Calls `compute` with the loop closure of the library, which borrows the model.
    fn with_closure<T>(
        &self,
        py: Python<'_>,
        compute: impl FnOnce(&kinopt::ik::LoopClosure<'_>) -> PyResult<T>,
    ) -> PyResult<T> {
        let python_model = self.python_model.bind(py);
        let parameters = parameters_of(python_model, &self.model);
        compute(&kinopt::ik::LoopClosure::new(parameters, &self.dependent).or_raise()?)
    }
}

#[pymethods]
impl LoopClosure {
    #[new]
    #[pyo3(signature = (model, dependent = None))]
    fn new(model: &Bound<'_, PyAny>, dependent: Option<Vec<String>>) -> PyResult<Self> {
        let inner_model = model_of(model)?;
        let dependent = match (&dependent, model.cast::<Robot>()) {
            (Some(names), _) => {
                let joints = names.iter().map(|name| inner_model.joint(name));
                joints.collect::<Result<_, _>>().or_raise()?
            }
            (None, Ok(robot)) => {
                let passive = robot.get().inner.passive_joints().iter().copied();
                passive.filter(|id| inner_model.moves_a_loop(*id)).collect()
            }
            (None, Err(_)) => Vec::new(),
        };
        let closure = Self {
            python_model: model.clone().unbind(),
            model: inner_model,
            dependent,
        };
        closure.with_closure(model.py(), |_| Ok(()))?;
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

    /// The configuration with its dependent joints such that all loops are closed to 1e-9 m and rad; mimic joints
    /// follow. The other joints keep their values. Shape (nq,), or (N, nq). If a loop closes at several values, the
    /// values of the dependent joints in `q` select one.
    ///
    /// Raises `InvalidValueError`, which names the loop and its closure error, if a loop does not close. Raises it also
    /// for other shapes, numbers that are not finite, and given joints outside their limits.
    fn close<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = q.py();
        let width = self.model.configuration_len();
        let rows = Queries::rows(q, "q", width)?;
        let array = self.with_closure(py, |closure| {
            rows.compute((py, None), &[width], ROWS_AT_A_TIME, |row, row_buffer| {
                row_buffer.copy_from_slice(row);
                closure.close(row_buffer).or_raise()
            })
        })?;
        Ok(array.into_any())
    }

    /// Closure error of each loop at a configuration: tuples of its name, the distance in metres, and the angle in
    /// radians, 0 for a "connect".
    ///
    /// Raises `InvalidValueError` for another shape and for numbers that are not finite.
    fn gaps(&self, q: &Bound<'_, PyAny>) -> PyResult<Vec<(String, f64, f64)>> {
        let numbers = arrays::vector_of(q, "q", self.model.configuration_len())?;
        let gaps = self.with_closure(q.py(), |closure| closure.gaps(&numbers).or_raise())?;
        let rows = gaps.into_iter().map(|gap| (gap.name, gap.gap, gap.angle));
        Ok(rows.collect())
    }

    /// A configuration within all limits whose loops are closed, shape (nq,). Starts from a random configuration and
    /// moves all joints of the loops. The distribution is not uniform. `seed` is a whole number or a
    /// `numpy.random.Generator`.
    ///
    /// Raises `InvalidValueError` for another seed, and if none of 32 random configurations leads to closed loops.
    #[pyo3(signature = (seed = None))]
    fn random_configuration<'py>(
        &self,
        py: Python<'py>,
        seed: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let seed = seed.map_or(Ok(0), first_seed)?;
        let drawn =
            self.with_closure(py, |closure| closure.random_configuration(seed).or_raise())?;
        Ok(arrays::list(py, &drawn))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_class::<Self>(py, (self.python_model.bind(py), self.dependent()))
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
