//! Numerical inverse kinematics over an animated pose, and conversion between skeleton angles and poses.

use std::sync::{Arc, Mutex, PoisonError};

use kinopt::animation::{EulerPoseMap as Angles, ReachLayer as Reach};
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use super::bones_and_poses::{Armature, Pose, Poses, poses_of};
use crate::arrays::{self, Queries};
use crate::coordinates::Coordinates;
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::skeleton::Skeleton;
use crate::solution::Solution;
use crate::solver::Solver;
use crate::transforms::{quaternion, quaternion_argument};

/// Number of poses between two checks for signals.
const POSES_AT_A_TIME: usize = 256;

/// Inverse kinematics over an animated pose: tasks for the tips of bones, each with a weight, on top of the pose of
/// clips. Slower than a `Limb`, but supports any bones, joint limits, and several tips that share a spine. The search
/// starts at the animated pose, so motion that does not help a tip is preserved.
///
/// It holds running state, so it cannot be pickled; calls from several threads are serialised.
///
/// A layer for the tips of these bones of a skeleton, all with weight 0 at first. Bones that are `held` keep their
/// animated model-space rotation, or the rotation of `set_rotation`. `solver` is a `kinopt.Solver` of a method that
/// minimises, default `kinopt.Solver()`.
///
/// Raises `UnknownNameError` for a bone, `InvalidValueError` without bones, and for a geometric method.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct ReachLayer {
    inner: Mutex<Reach>,
    skeleton: Arc<kinopt::Skeleton>,
    coordinates: PyOnceLock<Py<Coordinates>>,
}

impl ReachLayer {
    fn with<T>(&self, run: impl FnOnce(&mut Reach) -> T) -> T {
        run(&mut self.inner.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl ReachLayer {
    #[new]
    #[pyo3(signature = (skeleton, tips, held = Vec::new(), *, solver = None))]
    fn new(
        skeleton: &Bound<'_, Skeleton>,
        tips: Vec<String>,
        held: Vec<String>,
        solver: Option<&Bound<'_, Solver>>,
    ) -> PyResult<Self> {
        let solver = match solver {
            Some(solver) => solver.get().optimiser("a reach layer")?.clone(),
            None => kinopt::Solver::default(),
        };
        let skeleton = Arc::clone(&skeleton.get().inner);
        let ids = |names: &[String]| {
            let ids = names.iter().map(|name| skeleton.bone(name).or_raise());
            ids.collect::<PyResult<Vec<_>>>()
        };
        let (tips, held) = (ids(&tips)?, ids(&held)?);
        let layer = Reach::holding(&skeleton, &tips, &held, solver);
        Ok(Self {
            inner: Mutex::new(layer.or_raise()?),
            skeleton,
            coordinates: PyOnceLock::new(),
        })
    }

    /// Sets the target of a bone's tip, shape (3,), in model coordinates, and its blend weight: from 0, the animated
    /// position, to 1, the target.
    ///
    /// Raises `UnknownNameError` for a bone outside the layer, and `InvalidValueError` for a target that is not finite.
    #[pyo3(signature = (bone, target, weight = 1.0))]
    fn set_goal(&self, bone: &str, target: &Bound<'_, PyAny>, weight: f64) -> PyResult<()> {
        let bone = self.skeleton.bone(bone).or_raise()?;
        let target: [f64; 3] = arrays::array(target, "target")?;
        self.with(|layer| layer.set_goal(bone, target, weight))
            .or_raise()
    }

    /// Sets the model-space rotation of a held bone, `xyzw` or `wxyz` of shape (4,), and its blend weight, from 0 to 1.
    ///
    /// Raises `UnknownNameError` for a bone that the layer does not hold.
    #[pyo3(signature = (bone, weight = 1.0, *, xyzw = None, wxyz = None))]
    fn set_rotation(
        &self,
        bone: &str,
        weight: f64,
        xyzw: Option<&Bound<'_, PyAny>>,
        wxyz: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let bone = self.skeleton.bone(bone).or_raise()?;
        let (q, order) = quaternion_argument(xyzw, wxyz, "rotations")?
            .ok_or_else(|| invalid("a rotation is given as xyzw or as wxyz"))?;
        let q = quaternion(q, order)?;
        self.with(|layer| layer.set_rotation(bone, q, weight))
            .or_raise()
    }

    /// Rotates the bones of a pose so that the tips move by their weights' fractions towards their targets, within the
    /// joint limits. Returns the `Solution`, with the errors of missed targets; None if all weights are 0.
    ///
    /// Below bones that the pose scales unevenly, it is solved again until the tips of the posed bones are at their
    /// targets. The solution is that of the posed bones.
    ///
    /// Raises `InvalidValueError` for a pose of another armature; the pose stays as it is.
    fn apply(&self, py: Python<'_>, pose: &Bound<'_, Pose>) -> PyResult<Option<Solution>> {
        let pose = pose.get();
        let mut locals = pose.now();
        let solved = py.detach(|| {
            self.with(|layer| layer.apply(&mut locals).map(|solution| solution.cloned()))
        });
        let solution = solved.or_raise()?;
        pose.with(|current| current.copy_from(&locals));
        let coordinates = self.coordinates.get_or_try_init(py, || {
            Py::new(py, Coordinates::of_model(self.skeleton.model()))
        })?;
        Ok(solution.map(|solution| Solution::new(solution, coordinates.clone_ref(py))))
    }

    fn __repr__(&self) -> String {
        format!("ReachLayer({} bones)", self.skeleton.bones().len())
    }
}

/// Conversion between a skeleton's stacked angles and poses of its armature.
///
/// For the skeleton of `armature.skeleton()`, such as that of a scene, give this `armature`: its poses have the scales
/// of the bones, which skinning needs. By default the armature is `Armature.of_skeleton(skeleton)`, whose scales are 1.
///
/// Raises `InvalidValueError` for an armature of another number of bones.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct EulerPoseMap {
    inner: Angles,
    skeleton: Arc<kinopt::Skeleton>,
    armature: Arc<kinopt::animation::Armature>,
}

#[pymethods]
impl EulerPoseMap {
    #[new]
    #[pyo3(signature = (skeleton, armature = None))]
    fn new(
        skeleton: &Bound<'_, Skeleton>,
        armature: Option<&Bound<'_, Armature>>,
    ) -> PyResult<Self> {
        let skeleton = Arc::clone(&skeleton.get().inner);
        let armature = match armature {
            Some(armature) => Arc::clone(&armature.get().inner),
            None => Arc::new(kinopt::animation::Armature::of_skeleton(&skeleton)),
        };
        if armature.bones() != skeleton.bones().len() {
            return Err(invalid(format!(
                "an armature of {} bones for a skeleton of {}",
                armature.bones(),
                skeleton.bones().len()
            )));
        }
        let inner = Angles::new(&skeleton);
        Ok(Self {
            inner,
            skeleton,
            armature,
        })
    }

    /// Stacked angles of a pose, radians: shape (3 * bones,) for a `Pose`, (N, 3 * bones) for `Poses`. `out` receives
    /// the result.
    ///
    /// Raises `InvalidValueError` for poses of other bones and for an `out` of another shape or type.
    #[pyo3(signature = (pose, *, out = None))]
    fn angles_of<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (poses, count) = poses_of(pose)?;
        let angles = self.skeleton.angles();
        if let Some(odd) = poses.iter().find(|pose| pose.bones() * 3 != angles) {
            return Err(invalid(format!(
                "a pose of {} bones for a skeleton of {}",
                odd.bones(),
                self.skeleton.bones().len()
            )));
        }
        let shape: Vec<usize> = count.into_iter().chain([angles]).collect();
        let array = arrays::output_array::<f64>(py, out, &shape)?;
        arrays::fill(&array, |buffer| {
            py.detach(|| {
                let mut each = poses.iter().zip(buffer.chunks_mut(angles.max(1)));
                each.try_for_each(|(pose, buffer)| self.inner.angles_of(pose, buffer))
            })
            .or_raise()
        })?;
        Ok(array)
    }

    /// Pose of stacked angles, radians: a `Pose` for shape (3 * bones,), `Poses` for (N, 3 * bones);
    /// translations and scales are those of the armature's rest pose.
    ///
    /// Raises `InvalidValueError` for another shape and for angles that are not finite.
    fn pose_of<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let one = arrays::axes(q)? == 1;
        let q = Queries::rows(q, "q", self.skeleton.angles())?;
        let mut poses = vec![self.armature.rest().clone(); q.count()];
        q.each(py, &mut poses, POSES_AT_A_TIME, |q, pose| {
            self.inner.pose_of(q, &mut pose[0]).or_raise()
        })?;
        match (one, poses.pop()) {
            (true, Some(pose)) => Ok(Bound::new(py, Pose::of(&self.armature, pose))?.into_any()),
            (_, last) => {
                poses.extend(last);
                Ok(Bound::new(py, Poses::of(&self.armature, poses))?.into_any())
            }
        }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let skeleton = Skeleton::from(Arc::clone(&self.skeleton));
        let parts = (skeleton, Armature::from(Arc::clone(&self.armature)));
        pickling::by_class::<Self>(py, parts)
    }

    fn __repr__(&self) -> String {
        format!("EulerPoseMap({} bones)", self.skeleton.bones().len())
    }
}
