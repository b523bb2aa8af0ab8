//! Reads robots from URDF.
//!
//! urdf-rs parses the numbers. What it would hide is looked for in the XML before: limits that are
//! not there, misspelt elements, joint types it would take as fixed. So there is an error with a
//! file, a line and a name, or a model that says what the file says.

mod attributes;
mod document;
mod error;
mod joint_element;
mod placement;
mod topology;

use std::path::Path;

pub use error::{Fault, UrdfError};

use self::attributes::Place;
use self::joint_element::JointElement;
use super::{Mimic, Robot};
use crate::io::{self, ReadError, read_bytes};
use crate::model::{Joint, JointId, JointKind, Limits, Model};
use crate::spatial::{Placement, Vector3};

/// The longest file that is read; real robots stay below 1 MB.
const LENGTH_LIMIT: u64 = 64 << 20;

impl Robot {
    /// Reads a URDF file.
    ///
    /// Links become frames; every joint keeps its name; a configuration lists the moving joints in
    /// the order of the file. Meshes, masses and extensions are not looked at, so `package://` paths
    /// need no ROS. `mimic` joints follow their master, and their limits restrict it. An axis need
    /// not be of unit length, and is x where none is given. A missing `lower` or `upper` is an error.
    /// Speeds are kept: see [`velocity_limit`](Self::velocity_limit).
    ///
    /// ```
    /// use kinopt::robot::Robot;
    ///
    /// let robot = Robot::read("models/universal_ur5e.urdf")?;
    /// assert_eq!(robot.model().degrees_of_freedom(), 6);
    /// let arm = robot.chain("base", "flange")?;
    /// assert_eq!(arm.len(), 6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// What is wrong with the file, with line and name: see [`UrdfError`] and [`Fault`]. Floating,
    /// planar and spherical joints are refused by name, and xacro files are not expanded.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, UrdfError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let bytes = read_bytes(path, LENGTH_LIMIT)?;
        match std::str::from_utf8(&bytes) {
            Ok(text) => Self::parse(text, &file),
            Err(error) => {
                let at = io::Place::Byte(error.valid_up_to());
                Err(ReadError::malformed(&file, at, "is not UTF-8 text").into())
            }
        }
    }

    /// Reads a URDF document from memory; `file` is the name that errors give it.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(text: &str, file: &str) -> Result<Self, UrdfError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let place = Place { file, text };
        let document = document::read(file, text)?;
        let topology = topology::order(&place, &document)?;
        let values = urdf_rs::read_from_string(&document.kinematic_text)
            .map_err(|error| parser(file, error))?;
        if values.joints.len() != document.joints.len() {
            return Err(parser(file, "it sees other joints than the document has"));
        }

        let mut builder = Model::builder(document.robot.name.as_str());
        let mut carrier: Vec<Option<JointId>> = vec![None; document.links.len()];
        let mut ids: Vec<Option<JointId>> = vec![None; document.joints.len()];
        let mut velocity_limits = Vec::with_capacity(document.joints.len());
        for branch in &topology.branches {
            let element = &document.joints[branch.joint];
            let value = &values.joints[branch.joint];
            let id = builder.joint(joint(element, value, carrier[branch.parent_link]));
            carrier[branch.child_link] = Some(id);
            ids[branch.joint] = Some(id);
            velocity_limits.push(velocity_limit(value));
        }
        for (link, joint) in document.links.iter().zip(&carrier) {
            builder.frame(link.name.as_str(), *joint, Placement::identity());
        }
        let moves = |kind: &urdf_rs::JointType| *kind != urdf_rs::JointType::Fixed;
        let in_file_order = (values.joints.iter().zip(&ids))
            .filter(|(value, _)| moves(&value.joint_type))
            .filter_map(|(_, id)| *id)
            .collect();
        builder.configuration_order(in_file_order);

        let mimics = (values.joints.iter().zip(&ids).zip(&topology.masters))
            .filter_map(|((value, joint), master)| {
                let mimic = value.mimic.as_ref()?;
                Some(Mimic {
                    joint: (*joint)?,
                    master: ids[(*master)?]?,
                    ratio: mimic.multiplier.unwrap_or(1.0),
                    offset: mimic.offset.unwrap_or(0.0),
                })
            })
            .collect();
        builder
            .build()
            .and_then(|model| Self::new(model, mimics))
            .map(|robot| Self {
                velocity_limits,
                ..robot
            })
            .map_err(|source| UrdfError::Model {
                file: file.to_owned(),
                source,
            })
    }
}

/// A checked joint as the model wants it.
fn joint(element: &JointElement, value: &urdf_rs::Joint, parent: Option<JointId>) -> Joint {
    let rotation = match element.quaternion {
        Some(xyzw) => placement::from_quaternion(xyzw),
        None => placement::from_roll_pitch_yaw(*value.origin.rpy),
    };
    let (kind, limits) = match value.joint_type {
        urdf_rs::JointType::Revolute => (JointKind::Revolute, limits(value)),
        urdf_rs::JointType::Prismatic => (JointKind::Prismatic, limits(value)),
        urdf_rs::JointType::Continuous => (JointKind::Continuous, Limits::UNBOUNDED),
        // The document check let no other type through.
        _ => (JointKind::Fixed, Limits::new(0.0, 0.0)),
    };
    let axis = match kind {
        JointKind::Fixed => Vector3::new(1.0, 0.0, 0.0),
        _ => Vector3::from(*value.axis.xyz),
    };
    Joint {
        name: element.named.name.clone(),
        parent,
        parent_from_joint: Placement::new(rotation, Vector3::from(*value.origin.xyz)),
        kind,
        axis,
        limits,
    }
}

/// What a file that knows no speed writes, 0, is no limit.
fn velocity_limit(value: &urdf_rs::Joint) -> Option<f64> {
    let moves = value.joint_type != urdf_rs::JointType::Fixed;
    (moves && value.limit.velocity > 0.0).then_some(value.limit.velocity)
}

fn limits(value: &urdf_rs::Joint) -> Limits {
    Limits::new(value.limit.lower, value.limit.upper)
}

fn parser(file: &str, problem: impl ToString) -> UrdfError {
    UrdfError::Parser {
        file: file.to_owned(),
        problem: problem.to_string(),
    }
}
