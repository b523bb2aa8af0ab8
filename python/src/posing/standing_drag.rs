//! Drags of a character on its feet.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use kinopt::animation::{Armature as Bones, BallPoseMap};
use kinopt::model::PointMass;
use kinopt::motion::posing::StandingDrag as Inner;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::hinges::{hinges_of, named};
use crate::animation::Pose;
use crate::arrays;
use crate::coordinates::Coordinates;
use crate::error::{OrRaise, invalid};
use crate::masses::DENSITY;
use crate::model::Model;
use crate::rig::Rig;
use crate::scene::{Scene, SceneFile};
use crate::skeleton::{Skeleton, cones_of};
use crate::solution::Solution;

/// A drag of some bones of a character on a free base: a rig, a scene or a skeleton.
///
/// Feet keep their pose at rest, unless a bone of their leg is dragged. The center of mass stays above the support
/// polygon of the pinned feet, and elbows, hands, knees and hips above the ground. Knees and elbows rotate about hinges,
/// all other bones between the ends of limbs and the root on ball joints. Fingers, faces and tails move with their
/// parents.
///
/// Feet come first, then balance and ground, then the `dragged` bones. In their null space the body stays upright and
/// near its rest pose.
///
/// `hinges` are a dict as `Skeleton.hinges`; by default those of a skeleton, or guessed ones. `cones` are those of
/// `BallSkeleton`; hips and ankles without a cone get one, so that knees stay above their feet. Masses come from the mesh
/// of a rig or a scene; without a closed mesh they are those of the segments of a human body. `up` is the vertical in the
/// model, by default the axis nearest to the legs.
///
/// Raises `UnknownNameError` for unknown bones, `InvalidValueError` for a character without legs, or hinges, cones and
/// numbers that do not match.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct StandingDrag {
    inner: Mutex<Inner>,
    model: Arc<kinopt::Model>,
    armature: Arc<Bones>,
    map: BallPoseMap,
    coordinates: Py<Coordinates>,
}

/// A character: bones that rotate, armature of its poses, and masses of its mesh.
struct Character {
    skeleton: kinopt::Skeleton,
    armature: Arc<Bones>,
    masses: Vec<PointMass>,
}

impl Character {
    fn of(value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = value.py();
        if let Ok(rig) = value.cast::<Rig>() {
            let rig = Arc::clone(&rig.get().inner);
            let masses = py.detach(|| rig.masses(DENSITY)).ok();
            return Ok(Self {
                armature: Arc::new(Bones::of_skeleton(&rig.skeleton)),
                masses: masses.map_or_else(Vec::new, |masses| masses.points().to_vec()),
                skeleton: rig.skeleton.clone(),
            });
        }
        if let Ok(file) = value.cast::<SceneFile>() {
            return Self::of(&file.getattr("scene")?);
        }
        if let Ok(scene) = value.cast::<Scene>() {
            let scene = Arc::clone(&scene.get().inner);
            let armature = Arc::new(scene.armature.clone());
            let skeleton = armature.turning_skeleton("scene", &scene.turning_bones());
            let skeleton = skeleton.or_raise()?;
            let masses = py.detach(|| scene.masses(&skeleton, DENSITY)).ok();
            return Ok(Self {
                masses: masses.map_or_else(Vec::new, |masses| masses.points().to_vec()),
                skeleton,
                armature,
            });
        }
        if let Ok(skeleton) = value.cast::<Skeleton>() {
            let skeleton = kinopt::Skeleton::clone(&skeleton.get().inner);
            return Ok(Self {
                armature: Arc::new(Bones::of_skeleton(&skeleton)),
                masses: Vec::new(),
                skeleton,
            });
        }
        Err(invalid(format!(
            "a {} is no character: a Rig, Scene, SceneFile or Skeleton",
            value.get_type().name()?
        )))
    }
}

impl StandingDrag {
    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Moves the given targets and runs `on`.
    fn go(
        &self,
        py: Python<'_>,
        targets: Option<&Bound<'_, PyDict>>,
        on: impl FnOnce(&mut Inner) + Send,
    ) -> PyResult<Solution> {
        let mut moves = Vec::new();
        for (bone, target) in targets.into_iter().flatten() {
            let bone = arrays::name(&bone, "a bone of targets")?;
            let target: [f64; 3] = arrays::array(&target, &format!("the target of {bone}"))?;
            moves.push((bone, target));
        }
        let solution = py.detach(|| {
            let mut drag = self.lock();
            for (bone, target) in moves {
                drag.set_target(&bone, target).or_raise()?;
            }
            on(&mut drag);
            Ok::<_, PyErr>(drag.drag().solution().clone())
        })?;
        Ok(Solution::new(solution, self.coordinates.clone_ref(py)))
    }
}

#[pymethods]
impl StandingDrag {
    #[new]
    #[pyo3(signature = (character, dragged, *, hinges = None, cones = None, up = None))]
    fn new(
        character: &Bound<'_, PyAny>,
        dragged: Vec<String>,
        hinges: Option<&Bound<'_, PyAny>>,
        cones: Option<&Bound<'_, PyAny>>,
        up: Option<[f64; 3]>,
    ) -> PyResult<Self> {
        let py = character.py();
        let Character {
            skeleton,
            armature,
            masses,
        } = Character::of(character)?;
        let mut builder = Inner::builder(&skeleton)
            .dragged(dragged)
            .with_masses(masses)
            .with_cones(cones_of(cones)?);
        if let Some(hinges) = hinges {
            builder = builder.with_hinges(hinges_of(&skeleton, Some(hinges))?);
        }
        if let Some(up) = up {
            builder = builder.with_up(up);
        }
        let inner = builder.build().or_raise()?;
        let model = Arc::new(inner.skeleton().model().clone());
        Ok(Self {
            map: BallPoseMap::new(&armature, inner.skeleton()),
            coordinates: Py::new(py, Coordinates::of_model(&model))?,
            inner: Mutex::new(inner),
            armature,
            model,
        })
    }

    /// Moves the body by one frame towards the targets, {bone: position of its tip}, in the character's unit. Bones
    /// without a target here keep theirs.
    ///
    /// Raises `UnknownNameError` for a bone that is not dragged.
    #[pyo3(signature = (targets = None))]
    fn advance(&self, py: Python<'_>, targets: Option<&Bound<'_, PyDict>>) -> PyResult<Solution> {
        self.go(py, targets, |drag| {
            drag.advance();
        })
    }

    /// As `advance`, until the body is at rest, in at most `frames` frames.
    ///
    /// Raises `UnknownNameError` for a bone that is not dragged.
    #[pyo3(signature = (targets = None, *, frames = 1000))]
    fn settle(
        &self,
        py: Python<'_>,
        targets: Option<&Bound<'_, PyDict>>,
        frames: usize,
    ) -> PyResult<Solution> {
        self.go(py, targets, |drag| {
            drag.settle(frames);
        })
    }

    /// Configuration of `model`, shape (nq,).
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, self.lock().drag().q())
    }

    /// Pose of the character's armature, for meshes and clips.
    #[getter]
    fn pose(&self) -> PyResult<Pose> {
        let mut pose = self.armature.rest().clone();
        self.map
            .pose_of(self.lock().drag().q(), &mut pose)
            .or_raise()?;
        Ok(Pose::of(&self.armature, pose))
    }

    /// Model of the drag: ball joints, hinges and a free root.
    #[getter]
    fn model(&self) -> Model {
        let inner = Arc::clone(&self.model);
        Model { inner }
    }

    /// Hinges by bone, as `Skeleton.hinges`.
    #[getter]
    fn hinges<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let hinges = self.lock().skeleton().skeleton().hinges();
        named(py, &hinges)
    }

    /// Names of the pinned bones.
    #[getter]
    fn feet(&self) -> Vec<String> {
        let drag = self.lock();
        let bones = drag.skeleton().skeleton().bones();
        let feet = drag.feet().into_iter();
        feet.map(|foot| bones[foot.index()].name.clone()).collect()
    }

    /// Positions of all bones by name: the tails in the current configuration, each (x, y, z), in the character's unit.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let drag = self.lock();
        let pose = drag.skeleton().pose(drag.drag().q()).or_raise()?;
        let by_bone = PyDict::new(py);
        let bones = drag.skeleton().skeleton().bones().iter();
        for (bone, placement) in bones.zip(&pose.model_from_bone) {
            by_bone.set_item(
                &bone.name,
                arrays::list(py, &placement.translation.to_array()),
            )?;
        }
        Ok(by_bone)
    }

    /// Corners of the pinned feet, (n, 3). The support polygon is their convex hull, seen along the vertical.
    #[getter]
    fn support_points(&self) -> Vec<[f64; 3]> {
        let points = self.lock().support_points().into_iter();
        points.map(|point| point.to_array()).collect()
    }

    /// Position of the center of mass, (x, y, z).
    #[getter]
    fn center_of_mass<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.lock().centre_of_mass().to_array())
    }

    /// Distance of the center of mass from the edges of the support polygon, in the character's unit; negative outside.
    #[getter]
    fn balance_margin(&self) -> f64 {
        self.lock().balance_margin()
    }

    /// True if the body is at rest.
    #[getter]
    fn is_at_rest(&self) -> bool {
        self.lock().drag().is_at_rest()
    }

    fn __repr__(&self) -> String {
        format!("StandingDrag({:?})", self.model.name())
    }
}
