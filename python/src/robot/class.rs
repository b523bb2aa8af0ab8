//! The class of robots, without its methods.

use std::sync::{Arc, OnceLock};

use kinopt::collision::Checker;
use kinopt::model::JointKind;
use kinopt::motion::retarget::FootShapes;
use kinopt_bindings::coordinate_order::CoordinateOrder;
use kinopt_bindings::per_joint::configuration_of;
use numpy::PyArray1;
use pyo3::prelude::*;

use super::source::Source;
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::named_configuration::by_position;

/// A robot: a model with mimic joints, velocity limits, shapes and masses.
///
/// Every link is a frame of the link's name; the root link is fixed in the world. A configuration lists the moving
/// joints in the order of the file.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Robot {
    pub(crate) inner: Arc<kinopt::robot::Robot>,
    pub(crate) model: Arc<kinopt::Model>,
    pub(super) source: Source,
    /// Collision checker of its shapes and their spheres, created at the first use.
    checker: OnceLock<Checker>,
    foot_shapes: OnceLock<FootShapes>,
}

impl Robot {
    pub(super) fn build(source: Source) -> PyResult<Self> {
        let robot = source.read()?;
        Ok(Self {
            model: Arc::new(robot.model().clone()),
            inner: Arc::new(robot),
            source,
            checker: OnceLock::new(),
            foot_shapes: OnceLock::new(),
        })
    }

    /// Returns the text of the robot's URDF after a change, and the robot of that text with the same options.
    pub(crate) fn with_urdf(
        &self,
        change: impl FnOnce(&str, &str) -> PyResult<String>,
    ) -> PyResult<(String, Self)> {
        if self.source.is_mjcf() {
            return Err(invalid(
                "the robot is from MJCF: corrections are written to URDF only",
            ));
        }
        let text = change(&self.source.text, &self.source.file)?;
        let source = Source {
            text: text.as_str().into(),
            ..self.source.clone()
        };
        Ok((text, Self::build(source)?))
    }

    /// Returns the collision checker of its shapes, in a world without obstacles.
    pub(crate) fn checker(&self) -> PyResult<Checker> {
        if let Some(known) = self.checker.get() {
            return Ok(known.clone());
        }
        let checker = Checker::of(&self.inner).or_raise()?;
        Ok(self.checker.get_or_init(|| checker).clone())
    }

    /// Returns the collision shapes of its feet, computed once.
    pub(crate) fn foot_shapes(&self) -> FootShapes {
        let read_shapes = || FootShapes::of_files(&self.inner);
        self.foot_shapes.get_or_init(read_shapes).clone()
    }

    /// Returns a configuration by joint name as an array; other values as they are. Missing joints are at the neutral
    /// configuration, and mimic joints follow.
    pub(crate) fn by_position<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        what: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        by_position(q, |q| {
            let q = configuration_of(q, what, &self.model, self.inner.neutral())?;
            self.inner.apply_mimics(&q).or_raise()
        })
    }

    pub(super) fn pinocchio_order(&self) -> PyResult<CoordinateOrder> {
        if self.source.is_mjcf() {
            return Err(invalid(
                "the order of Pinocchio is known for robots from URDF, not from MJCF: use to_mujoco",
            ));
        }
        // Added limits make a continuous joint a revolute one here, but not in Pinocchio.
        let file_model = self.source.file_model()?;
        let kind = |joint: &str| {
            let id = file_model.joint(joint).ok()?;
            Some(file_model.joints()[id.index()].kind)
        };
        Ok(CoordinateOrder::of_pinocchio(&self.model, |joint| {
            kind(joint) == Some(JointKind::Continuous)
        }))
    }

    pub(super) fn mujoco_order(&self) -> CoordinateOrder {
        match self.source.is_mjcf() {
            true => CoordinateOrder::same(&self.model),
            false => CoordinateOrder::of_mujoco(&self.model),
        }
    }

    pub(super) fn per_joint<'py>(
        &self,
        py: Python<'py>,
        value: impl Fn(kinopt::model::JointId) -> Option<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let joints = self.model.moving_joints().iter();
        arrays::frozen(py, joints.map(|&id| value(id).unwrap_or(f64::INFINITY)))
    }
}
