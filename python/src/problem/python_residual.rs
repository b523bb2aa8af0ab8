//! Residuals defined by Python functions.

use std::cell::RefCell;
use std::sync::Arc;

use kinopt::Model;
use kinopt::model::{FrameId, JointId};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Inputs, LocalJacobian, NumericResidual, RowBlock};
use kinopt_bindings::names::quantity;
use kinopt_bindings::task::{Goal, NumericTarget};
use pyo3::prelude::*;
use pyo3::types::PyMapping;

use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::object::Object;
use crate::placement;

thread_local! {
    /// Exception of a Python function called by the library on this thread.
    static RAISED: RefCell<Option<PyErr>> = const { RefCell::new(None) };
}

/// Stores an exception until the library returns; `raised` then returns it.
pub(crate) fn raise_later(error: PyErr) {
    RAISED.with_borrow_mut(|raised| {
        raised.get_or_insert(error);
    });
}

/// True if an exception is stored: computation should stop.
pub(crate) fn is_raised() -> bool {
    RAISED.with_borrow(Option::is_some)
}

/// Takes the stored exception and returns it as an error.
pub(crate) fn raised() -> PyResult<()> {
    match RAISED.take() {
        Some(error) => Err(error),
        None => Ok(()),
    }
}

/// A function of numpy arrays: from frame placements and joint values to a residual.
#[derive(Clone)]
pub(crate) struct PythonResidual {
    functions: Arc<Functions>,
    frames: Arc<[FrameId]>,
    joints: Arc<[JointId]>,
    rows: Arc<[RowBlock]>,
}

struct Functions {
    residual: Py<PyAny>,
    jacobian: Option<Py<PyAny>>,
}

impl PythonResidual {
    pub(super) fn of(task: &Bound<'_, PyAny>, model: &Model) -> PyResult<Self> {
        let frames: Vec<String> = task.getattr("frames")?.extract()?;
        let frames = frames.iter().map(|name| model.frame(name));
        let joints = task.getattr("joints")?;
        let joints = match joints.extract::<String>() {
            // "all": the class accepts no other text.
            Ok(_) => model.moving_joints().to_vec(),
            Err(_) => {
                let joints: Vec<String> = joints.extract()?;
                let joints = joints.iter().map(|name| model.joint(name));
                joints.collect::<Result<_, _>>().or_raise()?
            }
        };
        let mut rows = Vec::new();
        for item in task.getattr("rows")?.cast::<PyMapping>()?.items()?.iter() {
            let (name, count): (String, usize) = item.extract()?;
            rows.push(match name.as_str() {
                "chords" => RowBlock::chords(count),
                _ => RowBlock::new(quantity(&name).or_raise()?, count),
            });
        }
        let jacobian = task.getattr("jacobian")?;
        Ok(Self {
            functions: Arc::new(Functions {
                residual: task.getattr("function")?.unbind(),
                jacobian: (!jacobian.is_none()).then(|| jacobian.unbind()),
            }),
            frames: frames.collect::<Result<_, _>>().or_raise()?,
            joints: joints.into(),
            rows: rows.into(),
        })
    }

    /// Residual with another function; its derivatives are finite differences.
    fn with_function(&self, function: &Py<PyAny>) -> Self {
        let residual = Python::attach(|py| function.clone_ref(py));
        let jacobian = None;
        Self {
            functions: Arc::new(Functions { residual, jacobian }),
            ..self.clone()
        }
    }

    /// Calls a function with the inputs of the residual: frames, joints, or both.
    fn call<'py>(
        &self,
        py: Python<'py>,
        function: &Py<PyAny>,
        frames: &[Placement<f64>],
        joints: &[f64],
    ) -> PyResult<Bound<'py, PyAny>> {
        let function = function.bind(py);
        match (self.frames.is_empty(), self.joints.is_empty()) {
            (true, _) => function.call1((arrays::list(py, joints),)),
            (false, true) => function.call1((placement::to_arrays(py, frames)?,)),
            (false, false) => {
                function.call1((placement::to_arrays(py, frames)?, arrays::list(py, joints)))
            }
        }
    }

    fn try_evaluate(
        &self,
        py: Python<'_>,
        frames: &[Placement<f64>],
        joints: &[f64],
        residual: &mut [f64],
    ) -> PyResult<()> {
        let result = self.call(py, &self.functions.residual, frames, joints)?;
        if let ([row], Ok(value)) = (&mut *residual, result.extract::<f64>()) {
            *row = value;
            return Ok(());
        }
        let what = "what the residual's function returned (`rows` is its length)";
        residual.copy_from_slice(&arrays::vector_of(&result, what, residual.len())?);
        Ok(())
    }

    fn try_differentiate(
        &self,
        py: Python<'_>,
        function: &Py<PyAny>,
        (frames, joints): (&[Placement<f64>], &[f64]),
        jacobian: &mut LocalJacobian,
    ) -> PyResult<()> {
        let (rows, columns) = (jacobian.rows(), 6 * frames.len() + joints.len());
        let result = self.call(py, function, frames, joints)?;
        let what = "what the residual's jacobian returned";
        let entries = arrays::rows(&result, what, columns)?;
        if entries.shape()[0] != rows {
            return Err(invalid(format!(
                "{what} has shape ({}, {columns}), expected ({rows}, {columns})",
                entries.shape()[0]
            )));
        }
        for (row, entries) in entries.chunks_exact(columns.max(1)).enumerate() {
            let (twists, by_joints) = entries.split_at(6 * frames.len());
            for (k, twist) in twists.chunks_exact(6).enumerate() {
                let &[vx, vy, vz, wx, wy, wz] = twist else {
                    continue;
                };
                jacobian.linear_mut(k)[row] = Vector3::new(vx, vy, vz);
                jacobian.angular_mut(k)[row] = Vector3::new(wx, wy, wz);
            }
            for (k, &entry) in by_joints.iter().enumerate() {
                jacobian.joint_mut(k)[row] = entry;
            }
        }
        Ok(())
    }
}

impl NumericResidual for PythonResidual {
    fn inputs(&self) -> Inputs {
        Inputs::frames(self.frames.iter().copied()).with_joints(self.joints.iter().copied())
    }

    fn rows(&self) -> Vec<RowBlock> {
        self.rows.to_vec()
    }

    fn evaluate(&self, frames: &[Placement<f64>], joints: &[f64], residual: &mut [f64]) {
        if !is_raised() {
            let done = Python::attach(|py| self.try_evaluate(py, frames, joints, residual));
            match done {
                Ok(()) => return,
                Err(error) => raise_later(error),
            }
        }
        residual.fill(f64::NAN);
    }

    fn differentiate(
        &self,
        frames: &[Placement<f64>],
        joints: &[f64],
        jacobian: &mut LocalJacobian,
    ) -> bool {
        // After an exception the values do not matter.
        if is_raised() {
            return true;
        }
        let Some(function) = &self.functions.jacobian else {
            return false;
        };
        let reads = (frames, joints);
        let done = Python::attach(|py| self.try_differentiate(py, function, reads, jacobian));
        if let Err(error) = done {
            raise_later(error);
        }
        true
    }
}

/// Function that replaces that of a residual: its target.
pub(crate) struct Function(Py<PyAny>);

impl Goal<Object> for Function {
    fn read(value: &Object, what: &str) -> PyResult<Self> {
        value.with(|value| match value.is_callable() {
            true => Ok(Self(value.clone().unbind())),
            false => Err(invalid(format!(
                "{what} must be a function, which replaces that of the residual"
            ))),
        })
    }
}

impl NumericTarget for PythonResidual {
    type Goal = Function;

    fn aim(&mut self, function: &Function) {
        *self = self.with_function(&function.0);
    }
}
