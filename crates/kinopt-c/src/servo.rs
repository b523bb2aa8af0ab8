//! Servos: one joint command in each control cycle, within motion limits.

use std::ffi::c_char;
use std::sync::Arc;

use kinopt::Arm;
use kinopt::arm::{Servo, ServoStatus, ServoStep};
use kinopt_bindings::names::held_by;
use kinopt_bindings::option::names;
use kinopt_bindings::option::servo::{ServoOptions, options};
use self_cell::self_cell;
use serde_json::Value;

use crate::arm::KinoptArm;
use crate::error::{Failure, KinoptStatus, guard, of_json};
use crate::pointer;
use crate::settings::settings;
use crate::solution::write_collision;

self_cell!(
    /// A servo and its arm.
    struct Cell {
        owner: Arc<Arm>,
        #[covariant]
        dependent: Servo,
    }
);

/// Servo of an arm. One thread uses it at a time. A cycle allocates nothing.
pub struct KinoptServo {
    cell: Cell,
}

/// State of a servo after a cycle.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KinoptServoStatus {
    /// The tool is within the tolerances of its target.
    OnTarget = 0,
    /// Moving to the target as fast as a velocity, acceleration or jerk limit allows.
    SpeedLimited = 1,
    /// Moving to the target with no joint at a limit.
    Settling = 2,
    /// At rest at the closest pose of the current branch.
    Nearest = 3,
    /// Braking or at rest before a collision.
    Blocked = 4,
    /// A pair that was in contact at the start still is.
    Touching = 5,
    /// Braking after `kinopt_servo_stop`.
    Stopping = 6,
    /// At rest after `kinopt_servo_stop`.
    Stopped = 7,
}

impl From<ServoStatus> for KinoptServoStatus {
    fn from(status: ServoStatus) -> Self {
        match status {
            ServoStatus::OnTarget => Self::OnTarget,
            ServoStatus::SpeedLimited => Self::SpeedLimited,
            ServoStatus::Nearest => Self::Nearest,
            ServoStatus::Blocked => Self::Blocked,
            ServoStatus::Touching => Self::Touching,
            ServoStatus::Stopping => Self::Stopping,
            ServoStatus::Stopped => Self::Stopped,
            _ => Self::Settling,
        }
    }
}

/// Errors of a control cycle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct KinoptServoStep {
    /// State of the servo.
    pub status: KinoptServoStatus,
    /// Distance of the tool from its target, metres.
    pub position_error: f64,
    /// Angle between the tool and its target, radians.
    pub orientation_error: f64,
}

impl KinoptServoStep {
    fn of(step: &ServoStep<'_>) -> Self {
        Self {
            status: step.status.into(),
            position_error: step.position_error,
            orientation_error: step.orientation_error,
        }
    }
}

/// Creates a servo at rest at the configuration `start`, with `time_step` seconds between two cycles, at most 1.
///
/// `settings`: `velocity_limits`, `acceleration_limits`, `jerk_limits` (lists with one number for each joint; default: those
/// of the robot's files), `velocity` and `acceleration` at the start, `straight_line`, `damping`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_servo_new(
    arm: *const KinoptArm,
    start: *const f64,
    start_length: usize,
    time_step: f64,
    settings: *const c_char,
    servo: *mut *mut KinoptServo,
) -> KinoptStatus {
    guard(|| unsafe {
        let arm = Arc::clone(&pointer::object(arm, "arm")?.inner);
        let start = pointer::array(start, start_length, "start")?;
        let settings = self::settings(settings, "option of a servo", &names(&options()), &[])?;
        let options = ServoOptions::of(&settings, &arm).map_err(of_json)?;
        let cell = Cell::try_new(arm, |arm| {
            let servo = arm.servo(start, time_step)?;
            options.apply::<Value>(servo).map_err(of_json)
        });
        pointer::give(servo, KinoptServo { cell: cell? }, "servo")
    })
}

/// Frees a servo.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_servo_free(servo: *mut KinoptServo) {
    unsafe { pointer::free(servo) }
}

/// One control cycle towards a target placement: writes the commanded joint positions to `q`, and its errors to `step`,
/// unless that is null. After an error the servo has not moved.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_servo_step(
    servo: *mut KinoptServo,
    base_from_tool: *const f64,
    q: *mut f64,
    q_length: usize,
    step: *mut KinoptServoStep,
) -> KinoptStatus {
    guard(|| unsafe {
        let target = pointer::placement(base_from_tool, "base_from_tool")?;
        cycle(servo, (q, q_length), step, |servo| Ok(servo.step(target)?))
    })
}

/// One control cycle of a stop, within the motion limits: as `kinopt_servo_step`. Call it until the status is
/// `KINOPT_SERVO_STATUS_STOPPED`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_servo_stop(
    servo: *mut KinoptServo,
    q: *mut f64,
    q_length: usize,
    step: *mut KinoptServoStep,
) -> KinoptStatus {
    guard(|| unsafe { cycle(servo, (q, q_length), step, |servo| Ok(servo.stop())) })
}

unsafe fn cycle(
    servo: *mut KinoptServo,
    (q, q_length): (*mut f64, usize),
    report: *mut KinoptServoStep,
    advance: impl for<'s> FnOnce(&'s mut Servo<'_>) -> Result<ServoStep<'s>, Failure>,
) -> Result<(), Failure> {
    // SAFETY: by the contract of the caller.
    unsafe {
        let cell = &mut pointer::object_mut(servo, "servo")?.cell;
        // Before the servo moves.
        let count = cell.borrow_owner().joint_count();
        if q_length != count {
            let message = format!("`q` has {q_length} numbers, expected {count}");
            return Err(Failure::invalid(message));
        }
        let place = pointer::array_mut(q, q_length, "q")?;
        cell.with_dependent_mut(|_, servo| {
            let step = advance(servo)?;
            place.copy_from_slice(step.q);
            match report.is_null() {
                true => Ok(()),
                false => pointer::write(report, KinoptServoStep::of(&step), "step"),
            }
        })
    }
}

/// Writes the limit that determined a joint's motion in the last cycle, such as "upper limit", "speed down" or
/// "acceleration up"; an empty text for none.
///
/// `joint` counts from base to tip. A text that is longer than the buffer is shortened. Its whole length without the final
/// zero byte is written to `length`, unless that is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_servo_held_by(
    servo: *const KinoptServo,
    joint: usize,
    buffer: *mut c_char,
    size: usize,
    length: *mut usize,
) -> KinoptStatus {
    guard(|| unsafe {
        let held = pointer::object(servo, "servo")?
            .cell
            .borrow_dependent()
            .held();
        let count = held.len();
        let held = held.get(joint).ok_or_else(|| {
            Failure::invalid(format!("`joint` is {joint}, the servo has {count} joints"))
        })?;
        pointer::write_text(held.map_or("", held_by), buffer, size, length)
    })
}

/// Number of pairs that blocked the motion of the last cycle, or that are in contact; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_servo_collision_count(servo: *const KinoptServo) -> usize {
    let servo = unsafe { pointer::object(servo, "servo") };
    servo.map_or(0, |servo| servo.cell.borrow_dependent().collisions().len())
}

/// Writes a pair that blocked the motion of the last cycle, or that is in contact, the deepest first: as
/// `kinopt_solution_collision`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_servo_collision(
    servo: *const KinoptServo,
    index: usize,
    first: *mut c_char,
    second: *mut c_char,
    size: usize,
    distance: *mut f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let servo = pointer::object(servo, "servo")?.cell.borrow_dependent();
        write_collision(servo.collisions(), index, first, second, size, distance)
    })
}

/// Writes the commanded velocities and accelerations of the last cycle; null for those that are not needed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_servo_motion(
    servo: *const KinoptServo,
    velocity: *mut f64,
    acceleration: *mut f64,
    length: usize,
) -> KinoptStatus {
    guard(|| unsafe {
        let servo = pointer::object(servo, "servo")?.cell.borrow_dependent();
        if !velocity.is_null() {
            pointer::copy(servo.velocity(), velocity, length, "velocity")?;
        }
        if !acceleration.is_null() {
            pointer::copy(servo.acceleration(), acceleration, length, "acceleration")?;
        }
        Ok(())
    })
}

/// Writes the limits of velocities, accelerations and jerks; infinite for none. Null for those that are not needed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_servo_limits(
    servo: *const KinoptServo,
    velocities: *mut f64,
    accelerations: *mut f64,
    jerks: *mut f64,
    length: usize,
) -> KinoptStatus {
    guard(|| unsafe {
        let servo = pointer::object(servo, "servo")?.cell.borrow_dependent();
        let places = [
            (servo.velocity_limits(), velocities, "velocities"),
            (servo.acceleration_limits(), accelerations, "accelerations"),
            (servo.jerk_limits(), jerks, "jerks"),
        ];
        for (limits, place, name) in places {
            if !place.is_null() {
                pointer::copy(limits, place, length, name)?;
            }
        }
        Ok(())
    })
}
