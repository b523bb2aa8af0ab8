//! Forward kinematics and Jacobians, for one configuration or several.

use kinopt::kinematics::{
    ForwardKinematics as Kinematics, Jacobian as Derivative, KinematicsError,
};
use kinopt::model::FrameId;
use numpy::PyArrayMethods;
use numpy::ndarray::IxDyn;
use pyo3::prelude::*;

use crate::arrays::{self, axes};
use crate::error::{OrRaise, invalid};
use crate::has_model::{configuration_of_model, model_of};
use crate::pickling;
use crate::pool::Pool;
use kinopt_bindings::placement::to_rows;

/// Configurations between two checks for signals.
const ROWS_AT_A_TIME: usize = 4096;

/// Forward kinematics of frames of a model: compiled once, usable from any number of threads.
///
/// `model` is a model, a robot, a skeleton or a rig; `frames` are names of frames, None for all of them. Raises
/// `UnknownNameError` for an unknown frame.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct ForwardKinematics {
    frames: Frames,
    pool: Pool<Kinematics>,
}

/// Jacobians of frames of a model: compiled once, usable from any number of threads.
///
/// Six rows for each frame: the velocity of its origin (m/s), then its angular velocity (rad/s), in world axes
/// (Pinocchio's `LOCAL_WORLD_ALIGNED`). One column for each degree of freedom, for velocities as in `Model.integrate`.
/// `model` is a model, a robot, a skeleton or a rig; `frames` are names of frames, None for all of them. Raises
/// `UnknownNameError` for an unknown frame.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Jacobian {
    frames: Frames,
    pool: Pool<Derivative>,
}

/// Frames by name.
struct Frames {
    names: Vec<String>,
    /// Model of the frames and the names as given; None for all.
    model: Py<PyAny>,
    requested_names: Option<Vec<String>>,
}

impl Frames {
    /// Resolves the frames and compiles their kinematics.
    fn compile(
        model: &Bound<'_, PyAny>,
        requested_names: Option<Vec<String>>,
    ) -> PyResult<(Self, Kinematics)> {
        let inner_model = model_of(model)?;
        let (names, kinematics) = match &requested_names {
            None => {
                let names = inner_model.frames().iter().map(|frame| frame.name.clone());
                (names.collect(), Kinematics::new(&inner_model))
            }
            Some(names) => {
                let ids: Result<Vec<FrameId>, _> =
                    names.iter().map(|name| inner_model.frame(name)).collect();
                let kinematics =
                    Kinematics::of_frames(&inner_model, &ids.or_raise()?).or_raise()?;
                (names.clone(), kinematics)
            }
        };
        let model = model.clone().unbind();
        let frames = Self {
            names,
            model,
            requested_names,
        };
        Ok((frames, kinematics))
    }

    /// Pickles a class from its arguments.
    fn pickled<'py, T: pyo3::PyTypeInfo>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_class::<T>(py, (self.model.bind(py), self.requested_names.clone()))
    }
}

/// Computes numbers for each configuration: an array of shape `shape` for one of shape (nq,), of shape (N, ...) for N
/// of them.
fn for_each_configuration<'py, T: Clone + Send + Sync>(
    q: &Bound<'py, PyAny>,
    shape: &[usize],
    pool: &Pool<T>,
    compute: impl Fn(&mut T, &[f64], &mut [f64]) -> Result<(), KinematicsError> + Sync,
    dof: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let py = q.py();
    let length = shape.iter().product::<usize>();
    if axes(q)? < 2 {
        let q = arrays::vector_of(q, "q", dof)?;
        let mut numbers = vec![0.0; length];
        pool.with(|workspace| compute(workspace, &q, &mut numbers))
            .or_raise()?;
        return Ok(arrays::list(py, &numbers).reshape(shape)?.into_any());
    }
    let q = arrays::rows(q, "q", dof)?;
    let mut full_shape = vec![q.shape()[0]];
    full_shape.extend_from_slice(shape);
    let array = crate::arrays::zeros::<f64, _>(py, IxDyn(&full_shape))?;
    let mut writable = array
        .try_readwrite()
        .map_err(|error| invalid(error.to_string()))?;
    let numbers = writable
        .as_slice_mut()
        .map_err(|error| invalid(error.to_string()))?;
    if dof > 0 && length > 0 {
        let pieces = q
            .chunks(ROWS_AT_A_TIME * dof)
            .zip(numbers.chunks_mut(ROWS_AT_A_TIME * length));
        for (piece, (q, numbers)) in pieces.enumerate() {
            py.check_signals()?;
            let each = || {
                pool.with(|workspace| {
                    let rows = q.chunks_exact(dof).zip(numbers.chunks_exact_mut(length));
                    for (i, (q, numbers)) in rows.enumerate() {
                        compute(workspace, q, numbers)
                            .map_err(|error| (piece * ROWS_AT_A_TIME + i, error))?;
                    }
                    Ok(())
                })
            };
            let done: Result<(), (usize, KinematicsError)> = py.detach(each);
            done.map_err(|(row, error)| invalid(format!("row {row} of q: {error}")))?;
        }
    }
    drop(writable);
    Ok(array.into_any())
}

#[pymethods]
impl ForwardKinematics {
    #[new]
    #[pyo3(signature = (model, frames = None))]
    fn new(model: &Bound<'_, PyAny>, frames: Option<Vec<String>>) -> PyResult<Self> {
        let (frames, kinematics) = Frames::compile(model, frames)?;
        let pool = Pool::new(kinematics);
        Ok(Self { frames, pool })
    }

    /// Names of the frames, in the order of the placements.
    #[getter]
    fn frame_names(&self) -> Vec<String> {
        self.frames.names.clone()
    }

    /// world_from_frame of each frame: shape (frames, 4, 4) for `q` of shape (nq,), (N, frames, 4, 4) for (N, nq);
    /// radians and metres. Limits do not matter.
    ///
    /// Raises `InvalidValueError` for another shape and for numbers that are not finite.
    fn place<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let dof = self.pool.template().variables();
        let write_placements = |kinematics: &mut Kinematics, q: &[f64], numbers: &mut [f64]| {
            let placements = kinematics.place(q)?;
            for (sixteen, placement) in numbers.chunks_exact_mut(16).zip(placements) {
                sixteen.copy_from_slice(&to_rows(placement));
            }
            Ok(())
        };
        let shape = [self.frames.names.len(), 4, 4];
        let q = configuration_of_model(self.frames.model.bind(q.py()), q, "q")?;
        for_each_configuration(&q, &shape, &self.pool, write_placements, dof)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.frames.pickled::<Self>(py)
    }

    fn __repr__(&self) -> String {
        format!("ForwardKinematics({} frames)", self.frames.names.len())
    }
}

#[pymethods]
impl Jacobian {
    #[new]
    #[pyo3(signature = (model, frames = None))]
    fn new(model: &Bound<'_, PyAny>, frames: Option<Vec<String>>) -> PyResult<Self> {
        let (frames, kinematics) = Frames::compile(model, frames)?;
        let pool = Pool::new(Derivative::new(kinematics));
        Ok(Self { frames, pool })
    }

    /// Names of the frames, in the order of the rows.
    #[getter]
    fn frame_names(&self) -> Vec<String> {
        self.frames.names.clone()
    }

    /// Jacobian at a configuration: shape (6 * frames, dof) for `q` of shape (nq,), (N, 6 * frames, dof) for (N, nq).
    ///
    /// Raises `InvalidValueError` for another shape and for numbers that are not finite.
    fn at<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let q = configuration_of_model(self.frames.model.bind(q.py()), q, "q")?;
        jacobians(&q, &self.pool, self.frames.names.len())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.frames.pickled::<Self>(py)
    }

    fn __repr__(&self) -> String {
        format!("Jacobian({} frames)", self.frames.names.len())
    }
}

/// Computes the Jacobians of `frames` frames at one configuration or several.
pub(crate) fn jacobians<'py>(
    q: &Bound<'py, PyAny>,
    pool: &Pool<Derivative>,
    frames: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let (width, columns) = (pool.template().variables(), pool.template().columns());
    let at = |jacobian: &mut Derivative, q: &[f64], numbers: &mut [f64]| {
        let matrix = jacobian.at(q)?;
        for (row, numbers) in numbers.chunks_exact_mut(columns).enumerate() {
            for (number, &entry) in numbers.iter_mut().zip(&matrix.row(row)) {
                *number = entry;
            }
        }
        Ok(())
    };
    for_each_configuration(q, &[6 * frames, columns], pool, at, width)
}

/// Placement of one frame: world_from_frame, shape (4, 4) for `q` of shape (nq,), (N, 4, 4) for (N, nq).
///
/// `ForwardKinematics` compiles once, and takes several frames. Raises `UnknownNameError` for the frame,
/// `InvalidValueError` for a `q` of another shape or one that is not finite.
#[pyfunction]
pub(crate) fn frame_placement<'py>(
    model: &Bound<'py, PyAny>,
    frame: String,
    q: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let kinematics = ForwardKinematics::new(model, Some(vec![frame]))?;
    without_frames(&kinematics.place(q)?, 3)
}

/// Jacobian of one frame: linear rows first, then angular, in world axes at the frame's origin. It has shape (6, dof)
/// for `q` of shape (nq,), (N, 6, dof) for (N, nq).
///
/// `Jacobian` compiles once, and takes several frames. Raises `UnknownNameError` for the frame, `InvalidValueError` for
/// a `q` of another shape or one that is not finite.
#[pyfunction]
pub(crate) fn frame_jacobian<'py>(
    model: &Bound<'py, PyAny>,
    frame: String,
    q: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    Jacobian::new(model, Some(vec![frame]))?.at(q)
}

/// Removes the axis of frames, which has length 1 and index `-from_last`, from an array.
fn without_frames<'py>(array: &Bound<'py, PyAny>, from_last: isize) -> PyResult<Bound<'py, PyAny>> {
    array.call_method1("squeeze", (-from_last,))
}
