//! Whatever file a model comes from, as one thing.

use std::path::Path;

use kinopt::Model;
use kinopt::io::rig::Rig;
use kinopt::model::{JointKind, ParameterMap};

use crate::failure::{Failure, Outcome};

/// What kinds of files [`LoadedModel::read`] takes. A new kind is a line here and an arm there.
const SUPPORTED: &str = ".json (a rig)";

/// Rigs count as reached within this share of their size; an angle within as many radians.
const RIG_TOLERANCE: f64 = 1e-9;
/// Robots count as reached within so many metres and radians.
const ROBOT_TOLERANCE: f64 = 1e-6;

/// A model and what else its file holds.
#[derive(Debug)]
pub(crate) struct LoadedModel {
    /// The file, as typed.
    pub(crate) file: String,
    /// What problems are stated on.
    pub(crate) model: Model,
    /// The rest of a rig; `None` for a robot.
    pub(crate) rig: Option<Box<Rig>>,
}

impl LoadedModel {
    /// Reads any supported file, told apart by its extension.
    pub(crate) fn read(path: &Path) -> Outcome<Self> {
        let file = path.display().to_string();
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        match extension.to_ascii_lowercase().as_str() {
            "json" => {
                let rig = Rig::read(path)?;
                Ok(Self {
                    file,
                    model: rig.skeleton.model().clone(),
                    rig: Some(Box::new(rig)),
                })
            }
            "" => Err(Failure::new(format!(
                "{file}: a model file needs an extension; supported: {SUPPORTED}"
            ))),
            other => Err(Failure::new(format!(
                "{file}: models in .{other} files are not supported; supported: {SUPPORTED}"
            ))),
        }
    }

    /// "rig" or "robot".
    pub(crate) fn kind(&self) -> &'static str {
        match self.rig {
            Some(_) => "rig",
            None => "robot",
        }
    }

    /// A length of the model's own scale: a rig's mesh (or, without one, its bones) in the rig's
    /// unit, a robot's reach in metres.
    pub(crate) fn size(&self) -> f64 {
        match &self.rig {
            Some(rig) => match rig.mesh.as_ref().map(|mesh| mesh.size()) {
                Some(size) if size > 0.0 => size,
                _ => rig.skeleton.size(),
            },
            None => self.model.reach(),
        }
    }

    /// How far off counts as reached: a length in metres (rigs: their own unit), and radians.
    pub(crate) fn default_tolerances(&self) -> (f64, f64) {
        match self.rig {
            Some(_) => (RIG_TOLERANCE * self.size(), RIG_TOLERANCE),
            None => (ROBOT_TOLERANCE, ROBOT_TOLERANCE),
        }
    }

    /// The name of the unit of length.
    pub(crate) fn length_unit(&self) -> &'static str {
        match self.rig {
            Some(_) => "rig units",
            None => "m",
        }
    }

    /// Which coordinates of a configuration a solver may change.
    pub(crate) fn free_coordinates(&self) -> Vec<bool> {
        let mut free = vec![false; self.model.degrees_of_freedom()];
        for &leader in ParameterMap::free(&self.model).leaders() {
            if let Some(flag) = free.get_mut(leader) {
                *flag = true;
            }
        }
        free
    }

    /// Which coordinates of a configuration are angles; the others are lengths.
    pub(crate) fn is_angle(&self) -> impl Iterator<Item = bool> + '_ {
        let joints = self.model.joints();
        let moving = self.model.moving_joints().iter();
        moving.map(|id| {
            let joint = joints.get(id.index());
            joint.is_none_or(|joint| joint.kind != JointKind::Prismatic)
        })
    }
}
