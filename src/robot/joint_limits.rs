//! MoveIt's `joint_limits.yaml`: what a robot's joints may do, beside what its description says.

use std::path::Path;

use super::Robot;
use super::drive::Drive;
use crate::file::{Place, ReadError, ReadProblem, read_with};
use crate::model::{JointId, JointRef, Limits};
use crate::yaml::{self, Node, Value};

/// Bytes that are read of a file.
const LONGEST: u64 = 16 << 20;

impl Robot {
    /// The same robot with the limits of a `joint_limits.yaml`, as MoveIt's configurations have it: under `joint_limits` each
    /// joint's `max_velocity`, `max_acceleration` and `max_jerk` (`has_velocity_limits: false` removes one), `min_position` and
    /// `max_position`, which narrow what the robot's file says. Radians and metres, seconds. Other keys are ignored.
    ///
    /// ```
    /// use kinopt::robot::Robot;
    ///
    /// let limits = "joint_limits:\n  joint1: {has_acceleration_limits: true, max_acceleration: 3.75}";
    /// let robot = Robot::read("models/franka_panda.urdf")?.with_joint_limits_of(limits.as_bytes(), "limits")?;
    /// let joint = robot.model().joint("joint1")?;
    /// assert_eq!(robot.acceleration_limit(joint), Some(3.75));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A file that cannot be read or is no such file, a joint that the robot does not have, a limit that is not above 0 (a
    /// position that is not finite), or positions that leave a joint no value.
    pub fn with_joint_limits(self, path: impl AsRef<Path>) -> Result<Self, ReadError> {
        read_with(path.as_ref(), LONGEST, |bytes, file| {
            self.with_joint_limits_of(bytes, file)
        })
    }

    /// The same from bytes; `file` is its name in messages.
    ///
    /// # Errors
    /// As for [`with_joint_limits`](Self::with_joint_limits).
    pub fn with_joint_limits_of(mut self, bytes: &[u8], file: &str) -> Result<Self, ReadError> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            ReadError::malformed(file, Place::Byte(error.valid_up_to()), "is not UTF-8")
        })?;
        let root = yaml::parse(text, file)?;
        let told = root.get("joint_limits").ok_or_else(|| {
            fail(
                file,
                &root,
                "has no `joint_limits`, so it is no joint_limits.yaml",
            )
        })?;
        let joints = match &told.value {
            Value::Map(joints) => joints.as_slice(),
            // All joints commented out.
            _ if told.list().is_some_and(<[_]>::is_empty) => &[],
            _ => return Err(fail(file, told, "`joint_limits` is no map of joints")),
        };
        let mut narrowed = Vec::new();
        for (name, limits) in joints {
            let joint = Joint { file, name, limits };
            let id = joint.id(&self)?;
            if self.drives.len() <= id.index() {
                self.drives.resize(id.index() + 1, Drive::default());
            }
            let drive = &mut self.drives[id.index()];
            joint.rate("velocity", &mut drive.velocity)?;
            joint.rate("acceleration", &mut drive.acceleration)?;
            joint.rate("jerk", &mut drive.jerk)?;
            narrowed.extend(joint.positions()?.map(|limits| (id, limits)));
        }
        let invalid = |error| ReadError::new(file, Place::File, ReadProblem::invalid(error));
        self.narrowed(&narrowed).map_err(invalid)
    }
}

fn fail(file: &str, at: &Node<'_>, problem: &str) -> ReadError {
    ReadError::malformed(file, Place::Line(at.line), problem)
}

/// One joint's entry.
struct Joint<'a, 't> {
    file: &'a str,
    name: &'a Node<'t>,
    limits: &'a Node<'t>,
}

impl Joint<'_, '_> {
    fn id(&self, robot: &Robot) -> Result<JointId, ReadError> {
        let name = self.name.text().unwrap_or_default();
        JointRef::from(name)
            .resolve(robot.model())
            .map_err(|unknown| fail(self.file, self.name, &unknown.to_string()))
    }

    /// What `has_…_limits` says; what is not said is taken by whether there is a number.
    fn has(&self, what: &str) -> Result<Option<bool>, ReadError> {
        let key = format!("has_{what}_limits");
        let Some(node) = self.limits.get(&key) else {
            return Ok(None);
        };
        match node.text() {
            Some("true" | "True" | "1") => Ok(Some(true)),
            Some("false" | "False" | "0") => Ok(Some(false)),
            _ => Err(fail(
                self.file,
                node,
                &format!("`{key}` is neither true nor false"),
            )),
        }
    }

    fn number(&self, key: &str) -> Result<Option<f64>, ReadError> {
        let Some(node) = self.limits.get(key) else {
            return Ok(None);
        };
        let number = node.number().filter(|number| number.is_finite());
        let problem = || fail(self.file, node, &format!("`{key}` is no finite number"));
        number.map(Some).ok_or_else(problem)
    }

    /// Replaces a limit of a rate, or takes it away.
    fn rate(&self, what: &str, known: &mut Option<f64>) -> Result<(), ReadError> {
        let key = format!("max_{what}");
        match (self.has(what)?, self.number(&key)?) {
            (Some(false), _) => *known = None,
            (_, Some(most)) if most > 0.0 => *known = Some(most),
            (_, Some(_)) => {
                let problem = format!(
                    "`{key}` is not above 0; without a limit it is `has_{what}_limits: false`"
                );
                return Err(fail(self.file, self.limits, &problem));
            }
            (Some(true), None) => {
                return Err(fail(self.file, self.limits, &format!("has no `{key}`")));
            }
            (None, None) => {}
        }
        Ok(())
    }

    fn positions(&self) -> Result<Option<Limits>, ReadError> {
        if self.has("position")? == Some(false) {
            return Ok(None);
        }
        Ok(
            match (self.number("min_position")?, self.number("max_position")?) {
                (None, None) => None,
                (lower, upper) => Some(Limits {
                    lower: lower.unwrap_or(f64::NEG_INFINITY),
                    upper: upper.unwrap_or(f64::INFINITY),
                }),
            },
        )
    }
}
