//! MoveIt's `joint_limits.yaml`: joint limits in addition to those of a robot description.

use std::path::Path;

use super::Robot;
use super::drive::DriveLimits;
use crate::yaml::{self, Node, Value};
use kinopt_kinematics::file::{FileLocation, ReadError, ReadProblem, read_with};
use kinopt_kinematics::model::{JointId, JointRef, Limits, UnknownName};

/// Largest file size that is read, bytes.
const LENGTH_LIMIT: u64 = 16 << 20;

/// Keys of a joint, in MoveIt's files and ros2_control's.
const KEYS: [&str; 19] = [
    "has_position_limits",
    "min_position",
    "max_position",
    "has_velocity_limits",
    "max_velocity",
    "has_acceleration_limits",
    "max_acceleration",
    "has_deceleration_limits",
    "max_deceleration",
    "has_jerk_limits",
    "max_jerk",
    "has_effort_limits",
    "max_effort",
    "has_soft_limits",
    "soft_lower_limit",
    "soft_upper_limit",
    "k_position",
    "k_velocity",
    "angle_wraparound",
];

impl Robot {
    /// Adds the limits of a `joint_limits.yaml`, as in a MoveIt configuration.
    ///
    /// The map `joint_limits` holds `max_velocity`, `max_acceleration` and `max_jerk` of each joint.
    /// `has_velocity_limits: false` and the like remove a limit. `min_position` and `max_position` narrow the limits of
    /// the robot's file. Units are radians, metres and seconds. Limits of deceleration and effort and soft limits are
    /// not read.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
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
    /// A file that cannot be read or has another format, an unknown joint or key, or a rate limit that is not above 0.
    /// Also a position that is not finite, or positions that leave a joint no value.
    pub fn with_joint_limits(self, path: impl AsRef<Path>) -> Result<Self, ReadError> {
        read_with(path.as_ref(), LENGTH_LIMIT, |bytes, file| {
            self.with_joint_limits_of(bytes, file)
        })
    }

    /// Adds the limits of a `joint_limits.yaml` from bytes. `file` is the file name for error messages.
    ///
    /// # Errors
    /// As for [`with_joint_limits`](Self::with_joint_limits).
    pub fn with_joint_limits_of(mut self, bytes: &[u8], file: &str) -> Result<Self, ReadError> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            ReadError::malformed(
                file,
                FileLocation::Byte(error.valid_up_to()),
                "is not UTF-8",
            )
        })?;
        let root = yaml::parse(text, file)?;
        let limits_node = root.get("joint_limits").ok_or_else(|| {
            fail(
                file,
                &root,
                "is not a joint_limits.yaml: it has no `joint_limits`",
            )
        })?;
        let joints = match &limits_node.value {
            Value::Map(joints) => joints.as_slice(),
            // A file whose joints are all commented out.
            _ if limits_node.list().is_some_and(<[_]>::is_empty) => &[],
            _ => {
                return Err(fail(
                    file,
                    limits_node,
                    "`joint_limits` must be a map of joints",
                ));
            }
        };
        let mut narrowed = Vec::new();
        for (k, (name, limits)) in joints.iter().enumerate() {
            let joint = JointEntry { file, name, limits };
            if joints[..k]
                .iter()
                .any(|(other, _)| other.text() == name.text())
            {
                let name_text = name.text().unwrap_or_default();
                let problem = format!("joint `{name_text}` is listed twice");
                return Err(fail(file, name, &problem));
            }
            let id = joint.id(&self)?;
            joint.check_keys()?;
            if self.drives.len() <= id.index() {
                self.drives.resize(id.index() + 1, DriveLimits::default());
            }
            let drive = &mut self.drives[id.index()];
            joint.rate("velocity", &mut drive.velocity)?;
            joint.rate("acceleration", &mut drive.acceleration)?;
            joint.rate("jerk", &mut drive.jerk)?;
            narrowed.extend(joint.positions()?.map(|limits| (id, limits)));
        }
        let invalid = |error| ReadError::new(file, FileLocation::File, ReadProblem::invalid(error));
        self.narrowed(&narrowed).map_err(invalid)
    }
}

fn fail(file: &str, node: &Node<'_>, problem: &str) -> ReadError {
    ReadError::malformed(file, FileLocation::Line(node.line), problem)
}

/// One joint's entry.
struct JointEntry<'a, 't> {
    file: &'a str,
    name: &'a Node<'t>,
    limits: &'a Node<'t>,
}

impl JointEntry<'_, '_> {
    fn id(&self, robot: &Robot) -> Result<JointId, ReadError> {
        let name = self.name.text().unwrap_or_default();
        JointRef::from(name)
            .resolve(robot.model())
            .map_err(|unknown| fail(self.file, self.name, &unknown.to_string()))
    }

    /// Rejects keys that MoveIt and ros2_control do not know: a mistyped key would leave a joint without its limit.
    fn check_keys(&self) -> Result<(), ReadError> {
        let Value::Map(entries) = &self.limits.value else {
            return Ok(());
        };
        for (key, _) in entries {
            let name = key.text().unwrap_or_default();
            if !KEYS.contains(&name) {
                let unknown = UnknownName::new("joint limit", name, KEYS);
                return Err(fail(self.file, key, &unknown.to_string()));
            }
        }
        Ok(())
    }

    /// Value of `has_…_limits`, if the file has it.
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
        let problem = || fail(self.file, node, &format!("`{key}` must be a finite number"));
        number.map(Some).ok_or_else(problem)
    }

    /// Replaces or removes a velocity, acceleration or jerk limit.
    fn rate(&self, what: &str, limit: &mut Option<f64>) -> Result<(), ReadError> {
        let key = format!("max_{what}");
        match (self.has(what)?, self.number(&key)?) {
            (Some(false), _) => *limit = None,
            (_, Some(max)) if max > 0.0 => *limit = Some(max),
            (_, Some(_)) => {
                let problem = format!(
                    "`{key}` must be above 0; `has_{what}_limits: false` removes the limit"
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
