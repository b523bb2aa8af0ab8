//! Skeletons on ball joints.

use std::path::PathBuf;
use std::sync::Arc;

use kinopt::animation::{Armature as Bones, BallPoseMap};
use kinopt::io::{self, bvh, gltf};
use kinopt::model::{Limits, UnknownName};
use kinopt::skeleton::{
    BallSkeleton as Balls, BoneCone, BonePlacements, Cones, Posing, SkeletonRoot,
};
use kinopt_bindings::cones::cones;
use numpy::{PyArray1, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

use super::{POSES_AT_A_TIME, Skeleton, write_all};
use crate::animation::{Armature, Pose};
use crate::arrays::{self, Queries};
use crate::error::{OrRaise, invalid};
use crate::model::Model;
use crate::object::Object;
use crate::pickling;
use crate::pool::Pool;

/// Skeleton on ball joints with cone limits: a unit quaternion w, x, y, z for each bone.
///
/// A configuration `q` has w, x, y, z for each moving bone, in their order: its rotation from rest in its own axes.
/// With `root="free"`, x, y, z come before the root's quaternion. They are its displacement from rest along the model's
/// axes, within `bounds`, a dict of (lower, upper) by axis. Its rotation is in those axes too. The model's frames are
/// those of the skeleton; its joints have the names of the bones.
///
/// `cones` is the path of a side file (angles in degrees), or a dict by bone of dicts in radians. "swing" is the
/// largest tilt of the bone's axis, a number or two. "twist" is the range (lower, upper) about its axis. "angle" is the
/// largest rotation about any axis, at most pi. The optional "axis", shape (3,), is the twist axis in its own axes, by
/// default along the bone. The optional "about" is the axis of the first of two swings. Bones without a cone are
/// unlimited. `armature`, with the bones of the skeleton, is the armature of poses.
///
/// Raises `UnknownNameError` for an unknown bone, `InvalidValueError` for an empty cone and for a cone of a bone that
/// does not rotate. Raises `InvalidFileError` and `FileError` for a side file.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct BallSkeleton {
    inner: Balls,
    model: Arc<kinopt::Model>,
    armature: Arc<Bones>,
    bridge: BallPoseMap,
    posings: Pool<Posing>,
    /// Arguments of the constructor.
    cones: Cones,
    root: Root,
}

/// Motion of the root.
#[derive(Clone)]
struct Root {
    kind: String,
    bounds: Vec<(String, (f64, f64))>,
}

impl Root {
    const KINDS: [&'static str; 2] = ["fixed", "free"];

    /// Reads the arguments; the default root is fixed.
    fn new(kind: Option<&Bound<'_, PyAny>>, bounds: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let kind = match kind {
            Some(kind) => arrays::word(kind, "root", &Self::KINDS)?,
            None => Self::KINDS[0].to_owned(),
        };
        let mut ranges = Vec::new();
        for (axis, range) in bounds.into_iter().flatten() {
            let axis = arrays::name(&axis, "an axis of bounds")?;
            let range = range.extract();
            let range =
                range.map_err(|_| invalid("bounds must be a dict of (lower, upper) by axis"))?;
            ranges.push((axis, range));
        }
        Ok(Self {
            kind,
            bounds: ranges,
        })
    }

    fn read(&self) -> PyResult<SkeletonRoot> {
        const AXES: [&str; 3] = ["x", "y", "z"];
        let unknown = |what, name: &str, valid: &[&'static str]| {
            UnknownName::new(what, name, valid.iter().copied())
        };
        let kind = self.kind.as_str();
        let is_free = match kind {
            "fixed" => false,
            "free" => true,
            _ => return Err(unknown("root of ball joints", kind, &Self::KINDS)).or_raise(),
        };
        let mut bounds = [Limits::UNBOUNDED; 3];
        for (axis, (lower, upper)) in &self.bounds {
            let known = AXES.iter().position(|known| known == axis);
            let known = known.filter(|_| is_free);
            let valid = if is_free { &AXES[..] } else { &[] };
            let index = known.ok_or_else(|| unknown("axis of this root", axis, valid));
            bounds[index.or_raise()?] = Limits::new(*lower, *upper);
        }
        Ok(match is_free {
            true => SkeletonRoot::Free { bounds },
            false => SkeletonRoot::Fixed,
        })
    }
}

impl BallSkeleton {
    fn make(
        skeleton: kinopt::Skeleton,
        armature: Arc<Bones>,
        cones: Cones,
        root: Root,
    ) -> PyResult<Self> {
        let inner = Balls::new(skeleton, &cones, root.read()?).or_raise()?;
        Ok(Self {
            model: Arc::new(inner.model().clone()),
            bridge: BallPoseMap::new(&armature, &inner),
            posings: Pool::new(inner.posing()),
            inner,
            armature,
            cones,
            root,
        })
    }

    fn each_pose<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        write: impl Fn(&BonePlacements, &mut [f64]) + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let q = Queries::rows(q, "q", self.model.configuration_len())?;
        let shape = [self.armature.bones(), 4, 4];
        self.posings.with(|posing| {
            q.compute((py, out), &shape, POSES_AT_A_TIME, |q, buffer| {
                write(posing.pose(q).or_raise()?, buffer);
                Ok(())
            })
        })
    }
}

#[pymethods]
impl BallSkeleton {
    #[new]
    #[pyo3(signature = (skeleton, *, cones = None, root = None, bounds = None, armature = None))]
    fn new(
        skeleton: &Bound<'_, Skeleton>,
        cones: Option<&Bound<'_, PyAny>>,
        root: Option<&Bound<'_, PyAny>>,
        bounds: Option<&Bound<'_, PyDict>>,
        armature: Option<&Bound<'_, Armature>>,
    ) -> PyResult<Self> {
        let skeleton = &skeleton.get().inner;
        let armature = match armature {
            Some(armature) => Arc::clone(&armature.get().inner),
            None => Arc::new(Bones::of_skeleton(skeleton)),
        };
        let names = skeleton.bones().iter().map(|bone| bone.name.as_str());
        if !names.eq(armature.names().iter().map(String::as_str)) {
            return Err(invalid(
                "the armature and the skeleton have different bones",
            ));
        }
        let skeleton = kinopt::Skeleton::clone(skeleton);
        Self::make(
            skeleton,
            armature,
            cones_of(cones)?,
            Root::new(root, bounds)?,
        )
    }

    /// Reads the bones of a .glb, .gltf or .bvh file. The joints of a scene's skins rotate, and the bones of a capture
    /// with rotation channels; without any, all bones rotate. Arguments are as for the class.
    ///
    /// Raises as the class does, `FileError` if the file cannot be opened and `InvalidFileError` if its content or
    /// format is invalid.
    #[classmethod]
    #[pyo3(signature = (path, *, cones = None, root = None, bounds = None))]
    fn read(
        class: &Bound<'_, PyType>,
        path: PathBuf,
        cones: Option<&Bound<'_, PyAny>>,
        root: Option<&Bound<'_, PyAny>>,
        bounds: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let (cones, root) = (cones_of(cones)?, Root::new(root, bounds)?);
        let is_capture = path
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("bvh"));
        let py = class.py();
        let (armature, turning) = match is_capture {
            true => {
                let capture = py.detach(|| bvh::read(&path)).or_raise()?;
                let turning = capture.turning_bones();
                (capture.armature, turning)
            }
            false => {
                let scene = py.detach(|| gltf::read(&path)).or_raise()?;
                let turning = scene.turning_bones();
                (scene.armature, turning)
            }
        };
        let name = path.display().to_string();
        let skeleton = armature.turning_skeleton(name, &turning).or_raise()?;
        Self::make(skeleton, Arc::new(armature), cones, root)
    }

    /// The model with one ball for each bone; problems use it.
    #[getter]
    fn model(&self) -> Model {
        let inner = Arc::clone(&self.model);
        Model { inner }
    }

    /// The bones at rest; the model of this skeleton has revolute joints.
    #[getter]
    fn skeleton(&self) -> Skeleton {
        self.inner.skeleton().clone().into()
    }

    /// Armature of the poses.
    #[getter]
    fn armature(&self) -> Armature {
        Arc::clone(&self.armature).into()
    }

    /// Names of the bones, in their order.
    #[getter]
    fn bone_names(&self) -> Vec<&str> {
        self.armature.names().iter().map(String::as_str).collect()
    }

    /// Names of the joints of a bone, prismatic joints of a free root before its ball; empty for a fixed bone.
    ///
    /// Raises `UnknownNameError` for an unknown bone.
    fn joints(&self, bone: &str) -> PyResult<Vec<&str>> {
        let joints = self.inner.joints(self.inner.bone(bone).or_raise()?);
        let joints = joints.into_iter();
        Ok(joints
            .map(|joint| self.model.joints()[joint.index()].name.as_str())
            .collect())
    }

    /// Name of the model's frame at a bone's tail, with the bone's axes.
    ///
    /// Raises `UnknownNameError` for an unknown bone.
    fn tail(&self, bone: &str) -> PyResult<&str> {
        let frame = self.inner.tail(self.inner.bone(bone).or_raise()?);
        Ok(&self.model.frames()[frame.index()].name)
    }

    /// Name of the model's frame at a bone's tip, with the bone's axes.
    ///
    /// Raises `UnknownNameError` for an unknown bone.
    fn tip(&self, bone: &str) -> PyResult<&str> {
        let frame = self.inner.tip(self.inner.bone(bone).or_raise()?);
        Ok(&self.model.frames()[frame.index()].name)
    }

    /// Poses of the bones: `model_from_bone`, shape (bones, 4, 4) for `q` of shape (n,), and (N, bones, 4, 4) for (N,
    /// n), in the file's unit. `out` receives the result.
    ///
    /// Raises `InvalidValueError` for another shape, for numbers that are not finite, for a quaternion of length zero
    /// and for an `out` of another shape or type.
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
    /// Raises as `pose` does.
    #[pyo3(signature = (q, *, out = None))]
    fn skinning_transforms<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.each_pose(py, q, out, |pose, buffer| {
            write_all(pose.skinning_transforms(self.inner.skeleton()), buffer);
        })
    }

    /// Configuration of a pose of the armature, shape (n,), without regard to the cones. Translations and scales of
    /// bones are ignored, except for the position of a free root.
    ///
    /// Raises `InvalidValueError` for a pose of other bones.
    fn configuration<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, Pose>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let pose = pose.get().now();
        if pose.bones() != self.armature.bones() {
            return Err(invalid(format!(
                "the pose has {} bones, the skeleton {}",
                pose.bones(),
                self.armature.bones()
            )));
        }
        let mut q = Vec::new();
        self.bridge.configuration_of(&pose, &mut q).or_raise()?;
        Ok(arrays::list(py, &q))
    }

    /// Pose of the armature for a configuration of shape (n,); bones that do not move are at rest.
    ///
    /// Raises `InvalidValueError` for another shape.
    fn to_pose(&self, q: &Bound<'_, PyAny>) -> PyResult<Pose> {
        let q = arrays::vector_of(q, "q", self.model.configuration_len())?;
        let mut pose = self.armature.rest().clone();
        self.bridge.pose_of(&q, &mut pose).or_raise()?;
        Ok(Pose::of(&self.armature, pose))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let bounds = PyDict::new(py);
        for (axis, range) in &self.root.bounds {
            bounds.set_item(axis, *range)?;
        }
        let cones = PyDict::new(py);
        for (bone, cone) in &self.cones {
            let entry = PyDict::new(py);
            let BoneCone { axis, limits } = cone;
            entry.set_item("twist", (limits.twist.lower, limits.twist.upper))?;
            match limits.about {
                Some(about) => {
                    entry.set_item("swing", limits.swing)?;
                    entry.set_item("about", about.to_array())?;
                }
                None => entry.set_item("swing", limits.swing[0])?,
            }
            if let Some(angle) = limits.angle {
                entry.set_item("angle", angle)?;
            }
            if let Some(axis) = axis {
                entry.set_item("axis", axis.to_array())?;
            }
            cones.set_item(bone, entry)?;
        }
        let kind = &self.root.kind;
        let parts = (self.skeleton(), cones, kind, bounds, self.armature());
        pickling::by_arguments::<Self>(py, parts, &["cones", "root", "bounds", "armature"])
    }

    fn __repr__(&self) -> String {
        format!(
            "BallSkeleton({:?}, {} bones, {} root, {} cones)",
            self.model.name(),
            self.armature.bones(),
            self.root.kind,
            self.cones.len()
        )
    }
}

/// Reads cones of a side file, or of a dict in radians.
pub(crate) fn cones_of(source: Option<&Bound<'_, PyAny>>) -> PyResult<Cones> {
    let Some(source) = source else {
        return Ok(Cones::new());
    };
    let Ok(dict) = source.cast::<PyDict>() else {
        let path = source.extract::<PathBuf>();
        let path = path.map_err(|_| invalid("cones must be a path, or a dict by bone"))?;
        return io::cones::read(path).or_raise();
    };
    let entry = |(bone, cone): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        Ok((arrays::name(&bone, "a bone of cones")?, Object::of(&cone)))
    };
    cones(dict.iter().map(entry).collect::<PyResult<_>>()?)
}
