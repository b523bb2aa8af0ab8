//! Derivatives of an arm's solutions with respect to their targets.

use kinopt::arm::ArmDerivative as Derivative;
use numpy::ndarray::IxDyn;
use numpy::{PyArray, PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{self, axes};
use crate::error::{OrRaise, invalid};
use crate::placement;

/// The derivative of an arm's solution with respect to its target, or of N solutions.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct ArmDerivative {
    /// Shape (dof, 6), or (N, dof, 6): radians and metres, for translation of the target along its own axes (metres)
    /// and rotation about them (radians).
    #[pyo3(get)]
    by_target: Py<PyArray<f64, IxDyn>>,
    differentiability: Vec<&'static str>,
    is_one: bool,
}

#[pymethods]
impl ArmDerivative {
    /// Differentiability: "unique"; "shortest_of_many", if the arm is redundant for the goal and the derivative is the
    /// shortest change; or the reason why no derivative exists: "on_limit", "at_kink", "singular", "not_stationary",
    /// "not_finite". A list for N solutions.
    #[getter]
    fn differentiability<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(match self.differentiability.as_slice() {
            [one] if self.is_one => one.into_pyobject(py)?.into_any(),
            all => all.into_pyobject(py)?.into_any(),
        })
    }

    /// True if the solution is a smooth function of its target here: a bool, or an array of N.
    #[getter]
    fn is_unique<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut all = self.differentiability.iter().map(|name| *name == "unique");
        Ok(match self.is_one {
            true => all.all(|one| one).into_pyobject(py)?.to_owned().into_any(),
            false => PyArray1::from_iter(py, all).into_any(),
        })
    }

    fn __repr__(&self) -> String {
        match (self.is_one, self.differentiability.as_slice()) {
            (true, [one]) => format!("ArmDerivative({one})"),
            (_, all) => {
                let unique = all.iter().filter(|name| **name == "unique").count();
                format!("ArmDerivative({unique} of {} unique)", all.len())
            }
        }
    }
}

/// Computes the derivative of one solution and target, or of several.
pub(super) fn derivative(
    arm: &kinopt::Arm,
    target: &Bound<'_, PyAny>,
    q: &Bound<'_, PyAny>,
) -> PyResult<ArmDerivative> {
    let (py, dof) = (q.py(), arm.joint_count());
    let is_one = axes(q)? < 2;
    let (targets, q) = match is_one {
        true => (
            vec![placement::target(target, "target", &arm.goal())?],
            arrays::vector_of(q, "q", dof)?.to_vec(),
        ),
        false => (
            placement::targets(target, "target", &arm.goal())?.to_vec("target")?,
            arrays::rows(q, "q", dof)?.to_vec(),
        ),
    };
    let count = q.len().checked_div(dof).unwrap_or(0);
    if targets.len() != count {
        return Err(invalid(format!(
            "there are {} targets, but {count} rows of q",
            targets.len()
        )));
    }
    let all: Result<Vec<Derivative>, _> = py.detach(|| {
        let queries = targets.iter().zip(q.chunks_exact(dof.max(1)));
        queries
            .map(|(target, q)| arm.derivative(*target, q))
            .collect()
    });
    let all = all.or_raise()?;
    let mut numbers = Vec::with_capacity(all.len() * dof * 6);
    for derivative in &all {
        numbers.extend_from_slice(derivative.by_target.transpose().as_slice());
    }
    let shape = if is_one {
        vec![dof, 6]
    } else {
        vec![count, dof, 6]
    };
    Ok(ArmDerivative {
        by_target: arrays::list(py, &numbers).reshape(shape)?.unbind(),
        differentiability: all
            .iter()
            .map(|derivative| derivative.differentiability.name())
            .collect(),
        is_one,
    })
}
