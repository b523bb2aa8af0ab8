//! Skeletons: bones, their compiled model, and poses.

mod balls;
mod bone;

use std::sync::Arc;

use kinopt::model::UnknownName;
use kinopt::skeleton::{BonePlacements, Posing};
use kinopt::spatial::Placement;
use kinopt_bindings::placement::to_rows;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

pub(crate) use self::balls::{BallSkeleton, cones_of};
pub(crate) use self::bone::{Bone, SkeletonBuilder};
use crate::arrays::{self, Queries};
use crate::error::OrRaise;
use crate::model::Model;
use crate::pickling;
use crate::placement;
use crate::pool::Pool;
use crate::posing;

/// Number of poses between two checks for signals.
const POSES_AT_A_TIME: usize = 256;

/// A validated tree of bones, parents before children, and its compiled model.
///
/// A configuration `q` stacks three angles for each bone, shape (3 * bones,), radians: first twist, bend and second
/// twist of the first bone, of the second, ... The model's frames are a bone's name (its own frame, origin at its tail)
/// and `NAME/tip`; its joints `NAME/twist2`, `NAME/bend` and `NAME/twist1`.
///
/// A skeleton of bones, parents before children.
///
/// Raises `InvalidValueError` with the first invalid bone, `UnknownNameError` for a parent that does not precede its
/// child.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Skeleton {
    pub(crate) inner: Arc<kinopt::Skeleton>,
    model: Arc<kinopt::Model>,
    posings: Pool<Posing>,
}

impl From<Arc<kinopt::Skeleton>> for Skeleton {
    fn from(inner: Arc<kinopt::Skeleton>) -> Self {
        Self {
            model: Arc::new(inner.model().clone()),
            posings: Pool::new(Posing::new(&inner)),
            inner,
        }
    }
}

impl From<kinopt::Skeleton> for Skeleton {
    fn from(skeleton: kinopt::Skeleton) -> Self {
        Arc::new(skeleton).into()
    }
}

impl Skeleton {
    fn frame_name(&self, frame: kinopt::model::FrameId) -> String {
        self.model.frames()[frame.index()].name.clone()
    }

    /// Bones without children.
    fn last(&self) -> impl Iterator<Item = kinopt::skeleton::BoneId> + '_ {
        let bones = self.inner.bones();
        let has_child = |id: &kinopt::skeleton::BoneId| bones.iter().any(|b| b.parent == Some(*id));
        self.inner.bone_ids().filter(move |id| !has_child(id))
    }

    fn holds_of(&self, dragged: &[String]) -> PyResult<kinopt::skeleton::Holds> {
        let ids = dragged.iter().map(|name| self.inner.bone(name).or_raise());
        Ok(self.inner.holds(&ids.collect::<PyResult<Vec<_>>>()?))
    }

    /// Calls `write` with each pose and its part of the output, without the GIL.
    fn each_pose<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        write: impl Fn(&BonePlacements, &mut [f64]) + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let q = Queries::rows(q, "q", self.inner.angles())?;
        let shape = [self.inner.bones().len(), 4, 4];
        self.posings.with(|posing| {
            q.compute((py, out), &shape, POSES_AT_A_TIME, |q, buffer| {
                write(posing.pose(q).or_raise()?, buffer);
                Ok(())
            })
        })
    }
}

#[pymethods]
impl Skeleton {
    #[new]
    fn new(name: &str, bones: Vec<Bound<'_, Bone>>) -> PyResult<Self> {
        let bones: Vec<Bone> = bones.iter().map(|bone| bone.get().clone()).collect();
        bone::skeleton(name, &bones)
    }

    /// Returns the builder of a skeleton.
    #[classmethod]
    fn builder(_class: &Bound<'_, PyType>, name: String) -> SkeletonBuilder {
        SkeletonBuilder::new(name)
    }

    /// Compiled model of the bones; problems use it.
    #[getter]
    pub(crate) fn model(&self) -> Model {
        let inner = Arc::clone(&self.model);
        Model { inner }
    }

    /// Name of the skeleton.
    #[getter]
    fn name(&self) -> &str {
        self.model.name()
    }

    /// The bones, parents before children.
    #[getter]
    fn bones(&self) -> Vec<Bone> {
        let bones = self.inner.bones();
        bones.iter().map(|bone| Bone::of(bones, bone)).collect()
    }

    /// Names of the bones, in their order.
    #[getter]
    fn bone_names(&self) -> Vec<&str> {
        let bones = self.inner.bones().iter();
        bones.map(|bone| bone.name.as_str()).collect()
    }

    /// Index of each bone's parent in `bones`, shape (bones,), int64; -1 for roots.
    #[getter]
    fn parents<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let parent = |bone: &kinopt::skeleton::Bone| bone.parent.map_or(-1, |p| p.index() as i64);
        PyArray1::from_iter(py, self.inner.bones().iter().map(parent))
    }

    /// Names of the model's frames at the tips of bones without children: hands, feet, a head.
    ///
    /// These are frames, for tasks and kinematics ("hand/tip" at the end of the bone "hand", whose own frame, "hand",
    /// is at its tail). `ends` are these bones by their own names.
    #[getter]
    fn tips(&self) -> Vec<String> {
        let tips = self.last().map(|id| self.frame_name(self.inner.tip(id)));
        tips.collect()
    }

    /// Names of the bones without children, in the order of `tips`.
    #[getter]
    fn ends(&self) -> Vec<&str> {
        let bones = self.inner.bones();
        let ends = self.last().map(|id| bones[id.index()].name.as_str());
        ends.collect()
    }

    /// Length of a configuration: three angles for each bone.
    #[getter]
    fn angles(&self) -> usize {
        self.inner.angles()
    }

    /// Lowest and highest angles, shape (bones, 3, 2), radians: first twist, bend, second twist; infinite
    /// for none.
    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let bones = self.inner.bones();
        let limits = bones.iter().flat_map(|bone| bone.limits);
        let ends: Vec<f64> = limits.flat_map(|l| [l.lower, l.upper]).collect();
        let array = arrays::list(py, &ends).reshape([bones.len(), 3, 2])?;
        Ok(array.to_dyn().clone())
    }

    /// Diagonal of the bounding box of all tails and tips at rest, in the rig's unit. Tolerances scale with it.
    #[getter]
    fn size(&self) -> f64 {
        self.inner.size()
    }

    /// Returns a bone by its name.
    ///
    /// Raises `UnknownNameError`, which lists the bones.
    fn bone(&self, name: &str) -> PyResult<Bone> {
        let id = self.inner.bone(name).or_raise()?;
        let bones = self.inner.bones();
        Ok(Bone::of(bones, &bones[id.index()]))
    }

    /// Name of the model's frame at a bone's tail, with the bone's axes.
    ///
    /// Raises `UnknownNameError` for an unknown bone.
    fn tail(&self, bone: &str) -> PyResult<String> {
        let id = self.inner.bone(bone).or_raise()?;
        Ok(self.frame_name(self.inner.tail(id)))
    }

    /// Name of the model's frame at a bone's tip, with the bone's axes.
    ///
    /// Raises `UnknownNameError` for an unknown bone.
    fn tip(&self, bone: &str) -> PyResult<String> {
        let id = self.inner.bone(bone).or_raise()?;
        Ok(self.frame_name(self.inner.tip(id)))
    }

    /// Names of a bone's joints in the order of its angles: first twist, bend, second twist.
    ///
    /// Raises `UnknownNameError` for an unknown bone.
    fn joints(&self, bone: &str) -> PyResult<Vec<String>> {
        let id = self.inner.bone(bone).or_raise()?;
        let joints = self.inner.joints(id).into_iter();
        Ok(joints
            .map(|joint| self.model.joints()[joint.index()].name.clone())
            .collect())
    }

    /// The bone of a model's frame, and true if the frame is its tip.
    ///
    /// Raises `UnknownNameError` for an unknown frame.
    fn bone_of_frame(&self, frame: &str) -> PyResult<(&str, bool)> {
        let id = self.model.frame(frame).or_raise()?;
        let (bone, is_tip) = self
            .inner
            .bone_of_frame(id)
            .ok_or_else(|| {
                let names = self.inner.bones().iter().map(|bone| bone.name.as_str());
                UnknownName::new("bone's frame", frame, names)
            })
            .or_raise()?;
        Ok((&self.inner.bones()[bone.index()].name, is_tip))
    }

    /// The skeleton with its root at a 4 x 4 placement in a larger scene, in the rig's unit. Angles and limits keep
    /// their meaning.
    ///
    /// Raises `InvalidValueError` for another shape, for numbers that are not finite and for a placement that is not
    /// rigid.
    fn placed(&self, scene_from_model: &Bound<'_, PyAny>) -> PyResult<Self> {
        let placement = placement::placement(scene_from_model, "scene_from_model")?;
        self.inner.placed(placement).or_raise().map(Self::from)
    }

    /// The same skeleton with its joints and tips at their positions in a pose of its armature, by the pose's own
    /// translations and scales. The meaning of the angles is unchanged.
    ///
    /// Raises `InvalidValueError` for a pose of fewer bones.
    fn standing_in(&self, pose: &Bound<'_, crate::animation::Pose>) -> PyResult<Self> {
        let pose = pose.get().now();
        pose.posed_skeleton(&self.inner).or_raise().map(Self::from)
    }

    /// Bone transforms in the model: `model_from_bone`, shape (bones, 4, 4) for `q` of shape (3 * bones,), and (N,
    /// bones, 4, 4) for (N, 3 * bones). Angles are radians, lengths in the rig's own unit. `out` receives the result.
    ///
    /// Raises `InvalidValueError` for another shape, for numbers that are not finite and for an `out` of another shape
    /// or type.
    #[pyo3(signature = (q, *, out = None))]
    fn pose<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.each_pose(py, q, out, |pose, buffer| {
            write_all(pose.model_from_bone.iter().copied(), buffer);
        })
    }

    /// Skinning transforms, rest -> posed, shape (bones, 4, 4) or (N, bones, 4, 4), for `q` as in `pose`.
    ///
    /// Raises `InvalidValueError` for another shape, for numbers that are not finite and for an `out` of another shape
    /// or type.
    #[pyo3(signature = (q, *, out = None))]
    fn skinning_transforms<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.each_pose(py, q, out, |pose, buffer| {
            write_all(pose.skinning_transforms(&self.inner), buffer);
        })
    }

    /// Bones to hold during a drag of the tips of the `dragged` bones: {"trunk": bones locked in rotation, "back":
    /// bones that hardly bend, "ends": bones whose tips stay}.
    ///
    /// Raises `UnknownNameError` for an unknown bone.
    fn holds(&self, dragged: Vec<String>) -> PyResult<std::collections::BTreeMap<&str, Vec<&str>>> {
        let holds = self.holds_of(&dragged)?;
        let names = |ids: &[kinopt::skeleton::BoneId]| {
            let bones = self.inner.bones();
            ids.iter()
                .map(|id| bones[id.index()].name.as_str())
                .collect()
        };
        Ok([
            ("trunk", names(&holds.trunk)),
            ("back", names(&holds.back)),
            ("ends", names(&holds.ends)),
        ]
        .into())
    }

    /// Parameter map for a drag of the tips of the `dragged` bones from the angles `q`: the trunk is locked and the spine
    /// bends by at most 0.7 rad in all. Problems use it: `Problem(skeleton, tasks, parameters=...)`.
    ///
    /// Raises `UnknownNameError` for an unknown bone, `InvalidValueError` for another shape of `q`.
    fn hold_parameters<'py>(
        slf: &Bound<'py, Self>,
        dragged: Vec<String>,
        q: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let this = slf.get();
        let q = arrays::vector_of(q, "q", this.inner.angles())?;
        let holds = this.holds_of(&dragged)?;
        posing::hold_parameters(slf.py(), slf.as_any(), &holds, &this.inner, &q)
    }

    /// Posture tasks for a drag of the tips of the `dragged` bones: all bones stay near the angles `q`, and the spine
    /// with five times the weight of the limbs.
    ///
    /// Raises `UnknownNameError` for an unknown bone, `InvalidValueError` for another shape of `q`.
    fn hold_postures<'py>(
        &self,
        dragged: Vec<String>,
        q: &Bound<'py, PyAny>,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let py = q.py();
        let q = arrays::vector_of(q, "q", self.inner.angles())?;
        posing::hold_postures(py, &self.holds_of(&dragged)?, &self.inner, &q)
    }

    /// Hinges by bone: {bone: {"axis": (x, y, z), "range": (lower, upper)}}. The axis is in the axes of the bone, the range
    /// in radians from rest.
    #[getter]
    fn hinges<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        posing::named(py, &self.inner.hinges())
    }

    /// Guessed hinges of knees and elbows, as `hinges`. Each also has "rest_bend", the angle between the two segments of
    /// the limb in radians, and "source", the reason for its axis.
    ///
    /// A limb with a rest bend of 10 degrees or more keeps its plane. In limbs that are almost straight, knees bend
    /// backward and elbows forward. Feet show where the body faces, else the sides of names do. Both sides get mirrored
    /// axes.
    fn guess_hinges<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        posing::guessed(py, &self.inner)
    }

    /// The skeleton with other hinges: a dict as `hinges`, by default the guessed ones, `{}` for none. The bend of a
    /// hinged bone is the angle about its axis, and both twists are locked.
    ///
    /// Raises `UnknownNameError` for an unknown bone, `InvalidValueError` for a locked bone, an axis of length 0 or an
    /// empty range.
    #[pyo3(signature = (hinges = None))]
    fn with_hinges(&self, hinges: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let hinges = posing::hinges_of(&self.inner, hinges)?;
        self.inner.with_hinges(&hinges).or_raise().map(Self::from)
    }

    /// The skeleton as JSON, which `Skeleton.from_json` reads.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&*self.inner).or_raise()
    }

    /// Creates a skeleton from the JSON of `to_json`, and validates it.
    ///
    /// Raises `InvalidValueError` for a text that is not a skeleton.
    #[classmethod]
    fn from_json(_class: &Bound<'_, PyType>, text: &str) -> PyResult<Self> {
        let skeleton = serde_json::from_str::<kinopt::Skeleton>(text);
        skeleton.or_raise().map(Self::from)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let class = py.get_type::<Self>();
        pickling::by_method(class.as_any(), "from_json", (self.to_json()?,))
    }

    fn __repr__(&self) -> String {
        format!(
            "Skeleton({:?}, {} bones)",
            self.model.name(),
            self.inner.bones().len()
        )
    }
}

/// Writes placements as sixteen numbers each.
fn write_all(placements: impl Iterator<Item = Placement<f64>>, buffer: &mut [f64]) {
    for (placement, buffer) in placements.zip(buffer.chunks_exact_mut(16)) {
        buffer.copy_from_slice(&to_rows(&placement));
    }
}
