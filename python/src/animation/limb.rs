//! Limbs that reach, in closed form, over the pose that clips gave.

use std::sync::Arc;

use kinopt::animation::{Armature as Bones, EndRotation, Limb as TwoBones, LimbGoal as Goal};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::bones_and_poses::{Armature, Pose};
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::transforms::{finite_quaternion, finite_vector, given, shaped, vector};

/// A thigh and a shin, an upper arm and a forearm: two bones of an armature and the point that should go
/// somewhere. Bones between the two turn with the upper one.
///
/// The limb of two bones that ends where the bone `end` starts, a hand or a foot, or in a point in the
/// lower bone's coordinates, shape (3,).
///
/// `hinge`, shape (3,), is the axis about which the elbow or knee bends, in the lower bone's coordinates:
/// a positive turn bends it the way it may. `softening` slows the end down beyond that share of the
/// limb's length, so that the elbow does not snap: 0.95 to 0.98, or 1 for none.
///
/// Raises `UnknownNameError` for a bone, `InvalidValueError` for bones that do not hang on each other, an
/// axis without length, a share that is not within [0, 1].
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Limb {
    pub(crate) inner: TwoBones,
    pub(crate) armature: Arc<Bones>,
    /// What it was made of.
    made: Made,
}

#[derive(Clone)]
struct Made {
    upper: String,
    lower: String,
    end: End,
    hinge: Option<[f32; 3]>,
    softening: f32,
}

#[derive(Clone)]
enum End {
    Bone(String),
    Point([f32; 3]),
}

#[pymethods]
impl Limb {
    #[new]
    #[pyo3(signature = (armature, upper, lower, end, *, hinge = None, softening = 1.0))]
    fn new(
        armature: &Bound<'_, Armature>,
        upper: String,
        lower: String,
        end: &Bound<'_, PyAny>,
        hinge: Option<&Bound<'_, PyAny>>,
        softening: f32,
    ) -> PyResult<Self> {
        let armature = Arc::clone(&armature.get().inner);
        let end = match end.extract::<String>() {
            Ok(bone) => End::Bone(bone),
            Err(_) => End::Point(vector(end, "end")?.to_array()),
        };
        let hinge = hinge.map(|axis| vector(axis, "hinge")).transpose()?;
        let bone = |name: &str| armature.bone(name).or_raise();
        let (up, low) = (bone(&upper)?, bone(&lower)?);
        let limb = match &end {
            End::Bone(end) => TwoBones::to_bone(&armature, up, low, bone(end)?),
            End::Point(end) => TwoBones::new(&armature, up, low, (*end).into()),
        };
        let mut inner = limb.or_raise()?.with_softening(softening).or_raise()?;
        if let Some(axis) = hinge {
            inner = inner.with_hinge(axis).or_raise()?;
        }
        let made = Made {
            upper,
            lower,
            end,
            hinge: hinge.map(|axis| axis.to_array()),
            softening,
        };
        Ok(Self {
            inner,
            armature,
            made,
        })
    }

    /// Turns the two bones of a pose so that the end goes its weight's share of the way to the target, or as
    /// near as the bones reach; then the bone at the end.
    ///
    /// Raises `InvalidValueError` for a pose of another armature.
    fn reach(&self, pose: &Bound<'_, Pose>, goal: &Bound<'_, LimbGoal>) -> PyResult<()> {
        let goal = goal.get().inner;
        let reach = |locals: &mut _| self.inner.reach(&self.armature, locals, &goal);
        pose.get().with(reach).or_raise()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Made {
            upper,
            lower,
            end,
            hinge,
            softening,
        } = self.made.clone();
        let end = match end {
            End::Bone(bone) => bone.into_pyobject(py)?.into_any(),
            End::Point(point) => point.into_pyobject(py)?.into_any(),
        };
        let armature = Armature::from(Arc::clone(&self.armature));
        let parts = (armature, upper, lower, end, hinge, softening);
        pickling::by_rebuild::<Self>(py, parts)
    }

    #[staticmethod]
    fn _rebuild(
        armature: &Bound<'_, Armature>,
        upper: String,
        lower: String,
        end: &Bound<'_, PyAny>,
        hinge: Option<&Bound<'_, PyAny>>,
        softening: f32,
    ) -> PyResult<Self> {
        Self::new(armature, upper, lower, end, hinge, softening)
    }

    fn __repr__(&self) -> String {
        format!("Limb({:?}, {:?})", self.made.upper, self.made.lower)
    }
}

/// What the end of a limb should do this frame.
///
/// The end at `target`, shape (3,), in model coordinates.
///
/// `weight` is how far it goes, from 0, the pose as it is, to 1; `pole`, shape (3,), the point towards
/// which the elbow or knee goes (None keeps the side that the pose has); `twist` how far the limb turns
/// about the way to the target besides, radians.
///
/// The bone at the end goes along, is held as it was by the share `hold`, or turned in the model as
/// `rotation_xyzw` or `rotation_wxyz` says, shape (4,), by the share `rotation_weight`.
///
/// Weights are taken into [0, 1]. Raises `InvalidValueError` for other shapes, for numbers that are not finite, and for an end
/// that is both held and turned.
#[pyclass(frozen, module = "kinopt.animation")]
#[derive(Clone)]
pub(crate) struct LimbGoal {
    pub(crate) inner: Goal,
}

#[pymethods]
impl LimbGoal {
    #[new]
    #[pyo3(signature = (
        target, *, weight = 1.0, pole = None, twist = 0.0, hold = None, rotation_xyzw = None,
        rotation_wxyz = None, rotation_weight = 1.0
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        target: &Bound<'_, PyAny>,
        weight: f32,
        pole: Option<&Bound<'_, PyAny>>,
        twist: f32,
        hold: Option<f32>,
        rotation_xyzw: Option<&Bound<'_, PyAny>>,
        rotation_wxyz: Option<&Bound<'_, PyAny>>,
        rotation_weight: f32,
    ) -> PyResult<Self> {
        for (value, what) in [
            (weight, "weight"),
            (twist, "twist"),
            (hold.unwrap_or(0.0), "hold"),
            (rotation_weight, "rotation_weight"),
        ] {
            arrays::finite(value.into(), what)?;
        }
        let rotation = given(rotation_xyzw, rotation_wxyz, "rotations")?;
        let end = match (hold, rotation) {
            (Some(_), Some(_)) => {
                return Err(invalid("the bone at the end is held or turned, not both"));
            }
            (Some(weight), None) => EndRotation::Hold { weight },
            (None, Some((q, order))) => EndRotation::Goal {
                rotation: finite_quaternion(q, order)?,
                weight: rotation_weight,
            },
            (None, None) => EndRotation::Follow,
        };
        let mut inner = Goal::at(finite_vector(target, "target")?);
        inner.weight = weight;
        inner.pole = pole.map(|pole| finite_vector(pole, "pole")).transpose()?;
        inner.twist = twist;
        inner.end = end;
        Ok(Self { inner })
    }

    /// Where the end should be, shape (3,), float32.
    #[getter]
    fn target<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        shaped(py, self.inner.target.to_array().to_vec(), &[3])
    }

    /// How far it goes.
    #[getter]
    fn weight(&self) -> f32 {
        self.inner.weight
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let goal = &self.inner;
        let (hold, rotation, weight) = match goal.end {
            EndRotation::Hold { weight } => (Some(weight), None, 1.0),
            EndRotation::Goal { rotation, weight } => (None, Some(rotation.to_array()), weight),
            _ => (None, None, 1.0),
        };
        let parts = (
            goal.target.to_array(),
            goal.weight,
            goal.pole.map(|pole| pole.to_array()),
            goal.twist,
            hold,
            rotation,
            weight,
        );
        pickling::by_rebuild::<Self>(py, parts)
    }

    #[staticmethod]
    fn _rebuild(
        target: &Bound<'_, PyAny>,
        weight: f32,
        pole: Option<&Bound<'_, PyAny>>,
        twist: f32,
        hold: Option<f32>,
        rotation: Option<&Bound<'_, PyAny>>,
        rotation_weight: f32,
    ) -> PyResult<Self> {
        Self::new(
            target,
            weight,
            pole,
            twist,
            hold,
            rotation,
            None,
            rotation_weight,
        )
    }

    fn __repr__(&self) -> String {
        format!(
            "LimbGoal({}, weight={})",
            self.inner.target, self.inner.weight
        )
    }
}
