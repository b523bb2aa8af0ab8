//! Analytic aim of a bone, on top of an animated pose.

use std::sync::Arc;

use kinopt::animation::{Aim as Aiming, AimGoal as Look, Armature as Bones};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::bones_and_poses::{Armature, Pose};
use crate::arrays;
use crate::error::OrRaise;
use crate::pickling;
use crate::transforms::{finite_vector, shaped, vector};

/// Rotates a bone so that one of its axes points at a target: a looking head, an aiming hand.
///
/// `forward` is the axis that points, in the bone's coordinates. `up` is the axis that goals may keep upright, `offset`
/// an offset point from which it points instead of from its joint. All have shape (3,).
///
/// Raises `UnknownNameError` for a bone, `InvalidValueError` for axes of zero length or parallel axes.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Aim {
    inner: Aiming,
    armature: Arc<Bones>,
    /// Arguments: name of the bone, forward, up and offset.
    arguments: (String, [f32; 3], Option<[f32; 3]>, [f32; 3]),
}

#[pymethods]
impl Aim {
    #[new]
    #[pyo3(signature = (armature, bone, forward, *, up = None, offset = None))]
    fn new(
        armature: &Bound<'_, Armature>,
        bone: String,
        forward: &Bound<'_, PyAny>,
        up: Option<&Bound<'_, PyAny>>,
        offset: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let armature = Arc::clone(&armature.get().inner);
        let id = armature.bone(&bone).or_raise()?;
        let forward = vector(forward, "forward")?;
        let up = up.map(|up| vector(up, "up")).transpose()?;
        let offset = match offset {
            Some(offset) => vector(offset, "offset")?.to_array(),
            None => [0.0; 3],
        };
        let mut inner = Aiming::new(&armature, id, forward).or_raise()?;
        inner = inner.with_offset(offset).or_raise()?;
        if let Some(up) = up {
            inner = inner.with_up(up).or_raise()?;
        }
        Ok(Self {
            inner,
            armature,
            arguments: (bone, forward.to_array(), up.map(|up| up.to_array()), offset),
        })
    }

    /// Rotates the bone of a pose towards the target, by the weight's fraction of the angle. Returns False if no
    /// rotation exists: for a target that is not finite or is at the joint itself.
    ///
    /// Raises `InvalidValueError` for a pose of another armature.
    fn turn(&self, pose: &Bound<'_, Pose>, goal: &Bound<'_, AimGoal>) -> PyResult<bool> {
        let goal = goal.get().inner;
        let turn = |locals: &mut _| self.inner.turn(&self.armature, locals, &goal);
        pose.get().with(turn).or_raise()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (bone, forward, up, offset) = self.arguments.clone();
        let armature = Armature::from(Arc::clone(&self.armature));
        let parts = (armature, bone, forward, up, offset);
        pickling::by_arguments::<Self>(py, parts, &["up", "offset"])
    }

    fn __repr__(&self) -> String {
        format!("Aim({:?})", self.arguments.0)
    }
}

/// Target of an `Aim`.
///
/// It points at `target`, shape (3,), in model coordinates. `up`, shape (3,), is the direction for the bone's up axis,
/// as far as possible (None: the shortest arc). `twist` is an additional rotation about the direction to the target,
/// radians. `weight` is the fraction of the angle, within [0, 1].
///
/// The weight is clamped to [0, 1]. Raises `InvalidValueError` for other shapes and numbers that are not finite.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct AimGoal {
    inner: Look,
}

#[pymethods]
impl AimGoal {
    #[new]
    #[pyo3(signature = (target, *, up = None, twist = 0.0, weight = 1.0))]
    fn new(
        target: &Bound<'_, PyAny>,
        up: Option<&Bound<'_, PyAny>>,
        twist: f32,
        weight: f32,
    ) -> PyResult<Self> {
        let inner = Look {
            target: finite_vector(target, "target")?,
            up: up.map(|up| finite_vector(up, "up")).transpose()?,
            twist: arrays::finite(twist.into(), "twist").map(|_| twist)?,
            weight: arrays::finite(weight.into(), "weight").map(|_| weight)?,
        };
        Ok(Self { inner })
    }

    /// Target point, shape (3,), float32.
    #[getter]
    fn target<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        shaped(py, self.inner.target.to_array().to_vec(), &[3])
    }

    /// Fraction of the angle, within [0, 1].
    #[getter]
    fn weight(&self) -> f32 {
        self.inner.weight
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Look {
            target,
            up,
            twist,
            weight,
        } = self.inner;
        let parts = (target.to_array(), up.map(|up| up.to_array()), twist, weight);
        pickling::by_arguments::<Self>(py, parts, &["up", "twist", "weight"])
    }

    fn __repr__(&self) -> String {
        format!(
            "AimGoal({}, weight={})",
            self.inner.target, self.inner.weight
        )
    }
}
