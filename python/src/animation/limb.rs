//! Analytic two-bone limbs, on top of an animated pose.

use std::sync::Arc;

use kinopt::animation::{Armature as Bones, EndRotation, Limb as TwoBones, LimbGoal as Goal};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::bones_and_poses::{Armature, Pose};
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::transforms::{finite_quaternion, finite_vector, quaternion_argument, shaped, vector};

/// Two-bone limb with an end that reaches a target: thigh and shin, or upper arm and forearm. Bones between the two
/// rotate with the upper one.
///
/// The limb ends at the head of the bone `end`, a hand or a foot, or at a point in the lower bone's coordinates, shape
/// (3,).
///
/// `hinge`, shape (3,), is the bend axis of the elbow or knee, in the lower bone's coordinates: positive rotations are
/// allowed. `softening` slows the end down beyond that fraction of the limb's length, so that the elbow does not snap.
/// Use 0.95 to 0.98, or 1 for none.
///
/// Raises `UnknownNameError` for a bone, `InvalidValueError` for bones that are not descendants of each other, an axis
/// of zero length, a fraction that is not within [0, 1].
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Limb {
    pub(crate) inner: TwoBones,
    pub(crate) armature: Arc<Bones>,
    /// Arguments of the constructor.
    arguments: LimbArguments,
}

#[derive(Clone)]
struct LimbArguments {
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
        let arguments = LimbArguments {
            upper,
            lower,
            end,
            hinge: hinge.map(|axis| axis.to_array()),
            softening,
        };
        Ok(Self {
            inner,
            armature,
            arguments,
        })
    }

    /// Rotates the two bones of a pose so that the end moves by the weight's fraction towards the target, or as near as
    /// the limb reaches. Then it rotates the end bone.
    ///
    /// Raises `InvalidValueError` for a pose of another armature.
    fn reach(&self, pose: &Bound<'_, Pose>, goal: &Bound<'_, LimbGoal>) -> PyResult<()> {
        let goal = goal.get().inner;
        let reach = |locals: &mut _| self.inner.reach(&self.armature, locals, &goal);
        pose.get().with(reach).or_raise()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let LimbArguments {
            upper,
            lower,
            end,
            hinge,
            softening,
        } = self.arguments.clone();
        let end = match end {
            End::Bone(bone) => bone.into_pyobject(py)?.into_any(),
            End::Point(point) => point.into_pyobject(py)?.into_any(),
        };
        let armature = Armature::from(Arc::clone(&self.armature));
        let parts = (armature, upper, lower, end, hinge, softening);
        pickling::by_arguments::<Self>(py, parts, &["hinge", "softening"])
    }

    fn __repr__(&self) -> String {
        format!(
            "Limb({:?}, {:?})",
            self.arguments.upper, self.arguments.lower
        )
    }
}

/// Goal of a limb's end.
///
/// The end goes to `target`, shape (3,), in model coordinates.
///
/// `weight` is the blend weight from 0, the pose itself, to 1, the target. `pole`, shape (3,), is a point towards which
/// the elbow or knee bends (None keeps the bend direction of the pose). `twist` is an additional rotation of the limb
/// about the direction to the target, radians.
///
/// By default the end bone rotates with the limb. `hold` is the blend weight of its rotation before, `rotation_weight`
/// that of the model-space rotation `rotation_xyzw` or `rotation_wxyz`, shape (4,).
///
/// Weights are clamped to [0, 1]. Raises `InvalidValueError` for other shapes, for numbers that are not finite, and if
/// both a hold and a rotation are given.
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
        let rotation = quaternion_argument(rotation_xyzw, rotation_wxyz, "rotations")?;
        let end = match (hold, rotation) {
            (Some(_), Some(_)) => {
                return Err(invalid("hold and a rotation are given: use one of them"));
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

    /// Target of the end, shape (3,), float32.
    #[getter]
    fn target<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        shaped(py, self.inner.target.to_array().to_vec(), &[3])
    }

    /// Blend weight of the goal.
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
        pickling::by_arguments::<Self>(
            py,
            parts,
            &[
                "weight",
                "pole",
                "twist",
                "hold",
                "rotation_xyzw",
                "rotation_weight",
            ],
        )
    }

    fn __repr__(&self) -> String {
        format!(
            "LimbGoal({}, weight={})",
            self.inner.target, self.inner.weight
        )
    }
}
