//! Options of a robot that is read from a file.

use kinopt::model::Limits;
use kinopt::robot::{BaseJoint, Robot, UrdfReader};

use super::{OptionSpec, Setter};
use crate::names::{MIMIC_LIMITS, named};
use crate::value::{Arguments, ErrorOf, OrRaise, Ranges, Value};

/// Joint between world and root: its name, and bounds by axis.
#[derive(Clone, Debug, Default)]
pub struct BaseSettings {
    /// Name of the kind; `None` for a fixed base.
    pub joint: Option<String>,
    /// Lower and upper bound by axis, metres; of a yaw radians.
    pub bounds: Ranges,
}

/// Options of a robot, as given.
#[derive(Clone, Debug, Default)]
pub struct RobotOptions {
    /// True to repair defects that have a unique repair.
    pub lenient: bool,
    /// True to open referenced files only below the folder of the robot's file.
    pub confine: bool,
    /// True for limits of safety controllers.
    pub soft_limits: bool,
    /// True if mimic joints restrict their source joints.
    pub mimic_limits: bool,
    /// Base joint.
    pub base: BaseSettings,
}

/// Options of a robot, by name.
#[must_use]
pub fn options() -> [OptionSpec<RobotOptions>; 6] {
    [
        OptionSpec {
            name: "base_joint",
            set: Setter::Named(|mut options, kind| {
                options.base.joint = Some(kind.to_owned());
                Ok(options)
            }),
            doc: "joint between the world and the root: \"fixed\", \"free\", \"planar\" (x, y and a rotation about z), \
                  or \"slide-x\", \"slide-y\" or \"slide-z\" (translation along an axis).",
            default: "\"fixed\"",
        },
        OptionSpec {
            name: "base_bounds",
            set: Setter::Ranges(|mut options, bounds| {
                options.base.bounds = bounds;
                options
            }),
            doc: "lower and upper bound of the base by \"x\", \"y\" and \"z\" in metres and, for a planar base, \"yaw\" \
                  in radians.",
            default: "none",
        },
        OptionSpec {
            name: "lenient",
            set: Setter::Switch(|options, lenient| RobotOptions { lenient, ..options }),
            doc: "repairs defects that have a unique repair.",
            default: "False",
        },
        OptionSpec {
            name: "mimic_limits",
            set: Setter::Named(|options, name| {
                let mimic_limits = named("mimic_limits", name, &MIMIC_LIMITS)?;
                Ok(RobotOptions {
                    mimic_limits,
                    ..options
                })
            }),
            doc: "the limits that restrict the source joint of mimic joints: \"source\", its own, or \"both\", also \
                  those of its mimic joints.",
            default: "\"source\"",
        },
        OptionSpec {
            name: "soft_limits",
            set: Setter::Switch(|options, soft_limits| RobotOptions {
                soft_limits,
                ..options
            }),
            doc: "every joint also stays within its safety controller's limits.",
            default: "False",
        },
        OptionSpec {
            name: "confine",
            set: Setter::Switch(|options, confine| RobotOptions { confine, ..options }),
            doc: "opens referenced files only below the folder of the robot's file.",
            default: "False",
        },
    ]
}

impl RobotOptions {
    /// Reads the options.
    ///
    /// # Errors
    /// If an option has another type, or names an unknown value.
    pub fn of<A: Arguments>(arguments: &A) -> Result<Self, ErrorOf<A>> {
        super::apply(arguments, &options(), Self::default())
    }

    /// Reads a robot from the text of its file, without its base joint; `file` is its name in messages.
    ///
    /// # Errors
    /// If the file is malformed.
    pub fn parse<V: Value>(&self, text: &str, file: &str) -> Result<Robot, V::Error> {
        self.reader().parse(text, file).or_raise::<V>()
    }

    /// Reader of a robot's file.
    #[must_use]
    pub fn reader(&self) -> UrdfReader {
        let mut reader = Robot::reader();
        if self.lenient {
            reader = reader.lenient();
        }
        if self.confine {
            reader = reader.confined();
        }
        reader
    }

    /// The robot with the limits of the options.
    ///
    /// # Errors
    /// If a joint has no value within all its limits.
    pub fn limited<V: Value>(&self, mut robot: Robot) -> Result<Robot, V::Error> {
        if self.soft_limits {
            robot = robot.with_soft_limits().or_raise::<V>()?;
        }
        if self.mimic_limits {
            robot = robot.with_mimic_limits().or_raise::<V>()?;
        }
        Ok(robot)
    }
}

impl BaseSettings {
    /// The robot on this base.
    ///
    /// # Errors
    /// If the kind or an axis is unknown, or bounds are empty.
    pub fn of<V: Value>(&self, robot: Robot) -> Result<Robot, V::Error> {
        let kind = self.joint.as_deref().unwrap_or("fixed");
        let ranges = self.bounds.iter();
        let ranges = ranges.map(|(axis, (lower, upper))| (axis, Limits::new(*lower, *upper)));
        let joint = BaseJoint::named(kind, ranges).or_raise::<V>()?;
        robot.with_base_joint(joint).or_raise::<V>()
    }
}
