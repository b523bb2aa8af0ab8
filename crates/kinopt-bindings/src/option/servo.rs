//! Options of a servo.

use kinopt::Arm;
use kinopt::arm::Servo;

use super::{Joints, OptionSpec, Setter};
use crate::value::{Arguments, ErrorOf, OrRaise, Value};

/// Options of a servo, as given; `None` is the default.
#[derive(Clone, Debug, Default)]
pub struct ServoOptions {
    /// Velocity limits, rad/s or m/s.
    pub velocity_limits: Option<Vec<f64>>,
    /// Acceleration limits, rad/s² or m/s².
    pub acceleration_limits: Option<Vec<f64>>,
    /// Jerk limits, rad/s³ or m/s³.
    pub jerk_limits: Option<Vec<f64>>,
    /// Velocity at the start, rad/s or m/s.
    pub velocity: Option<Vec<f64>>,
    /// Acceleration at the start, rad/s² or m/s².
    pub acceleration: Option<Vec<f64>>,
    /// True to keep the tool on the straight line to its target.
    pub straight_line: bool,
    /// Damping near singular configurations, radians.
    pub damping: Option<f64>,
}

/// Options of a servo, by name. Lists have one number for each free joint.
#[must_use]
pub fn options() -> [OptionSpec<ServoOptions>; 7] {
    [
        OptionSpec {
            name: "velocity_limits",
            set: Setter::PerJoint(
                |options, limits| ServoOptions {
                    velocity_limits: Some(limits),
                    ..options
                },
                None,
            ),
            doc: "a number or shape (dof,), rad/s or m/s, inf for none. They hold in every cycle for the differences of the \
                  commanded positions.",
            default: "those of the robot's files",
        },
        OptionSpec {
            name: "acceleration_limits",
            set: Setter::PerJoint(
                |options, limits| ServoOptions {
                    acceleration_limits: Some(limits),
                    ..options
                },
                None,
            ),
            doc: "a number or shape (dof,), rad/s² or m/s², inf for none.",
            default: "those of the robot's files",
        },
        OptionSpec {
            name: "jerk_limits",
            set: Setter::PerJoint(
                |options, limits| ServoOptions {
                    jerk_limits: Some(limits),
                    ..options
                },
                None,
            ),
            doc: "a number or shape (dof,), rad/s³ or m/s³, inf for none.",
            default: "those of the robot's files",
        },
        OptionSpec {
            name: "velocity",
            set: Setter::PerJoint(
                |options, velocity| ServoOptions {
                    velocity: Some(velocity),
                    ..options
                },
                Some(0.0),
            ),
            doc: "shape (dof,), velocity at the start, rad/s or m/s.",
            default: "at rest",
        },
        OptionSpec {
            name: "acceleration",
            set: Setter::PerJoint(
                |options, acceleration| ServoOptions {
                    acceleration: Some(acceleration),
                    ..options
                },
                Some(0.0),
            ),
            doc: "shape (dof,), acceleration at the start, rad/s² or m/s².",
            default: "0",
        },
        OptionSpec {
            name: "straight_line",
            set: Setter::Switch(|options, straight_line| ServoOptions {
                straight_line,
                ..options
            }),
            doc: "keeps the tool on the straight line to its target, at reduced speed if necessary. The tool leaves \
                  the line near singular configurations and position limits, and while it brakes for a collision.",
            default: "False",
        },
        OptionSpec {
            name: "damping",
            set: Setter::Number(|options, radians| ServoOptions {
                damping: Some(radians),
                ..options
            }),
            doc: "the tool motion, in radians for each radian of joint motion, that runs at half of its speed. More \
                  damping makes joints slower near singular configurations.",
            default: "0.01",
        },
    ]
}

impl ServoOptions {
    /// Reads the options of a servo of an arm.
    ///
    /// # Errors
    /// If an option has another type, or names an unknown joint.
    pub fn of<A: Arguments>(arguments: &A, arm: &Arm) -> Result<Self, ErrorOf<A>> {
        let read = super::apply(arguments, &options(), Self::default())?;
        Joints::of_arm(arm, |joints| joints.apply(arguments, &options(), read))
    }

    /// Applies the options to a servo.
    ///
    /// # Errors
    /// If an option is out of range.
    pub fn apply<'a, V: Value>(&self, servo: Servo<'a>) -> Result<Servo<'a>, V::Error> {
        let mut servo = servo;
        if let Some(limits) = &self.velocity_limits {
            servo = servo.with_velocity_limits(limits).or_raise::<V>()?;
        }
        if let Some(limits) = &self.acceleration_limits {
            servo = servo.with_acceleration_limits(limits).or_raise::<V>()?;
        }
        if let Some(limits) = &self.jerk_limits {
            servo = servo.with_jerk_limits(limits).or_raise::<V>()?;
        }
        servo = servo.with_straight_line(self.straight_line);
        if let Some(radians) = self.damping {
            servo = servo.with_damping(radians).or_raise::<V>()?;
        }
        if self.velocity.is_some() || self.acceleration.is_some() {
            let zeros = vec![0.0; servo.q().len()];
            let velocity = self.velocity.as_ref().unwrap_or(&zeros);
            let acceleration = self.acceleration.as_ref().unwrap_or(&zeros);
            servo = servo.with_motion(velocity, acceleration).or_raise::<V>()?;
        }
        Ok(servo)
    }
}
