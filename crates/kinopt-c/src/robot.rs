//! Robots from URDF and MJCF.

use std::ffi::{CString, c_char};
use std::sync::Arc;

use kinopt::robot::Robot;
use kinopt_bindings::option::names;
use kinopt_bindings::option::robot::{RobotOptions, options};
use serde_json::Value;

use crate::error::{Failure, KinoptStatus, guard, of_json};
use crate::pointer;
use crate::settings::settings;

/// A robot: joints, links, limits. It is immutable.
pub struct KinoptRobot {
    pub(crate) inner: Arc<Robot>,
    frames: Vec<CString>,
}

impl KinoptRobot {
    fn new(robot: Robot) -> Self {
        let frames = robot.model().frames().iter();
        Self {
            frames: frames
                .map(|frame| pointer::kept_text(&frame.name))
                .collect(),
            inner: Arc::new(robot),
        }
    }
}

unsafe fn options_of(text: *const c_char) -> Result<RobotOptions, Failure> {
    let known = names(&options());
    // SAFETY: by the contract of the caller.
    let settings = unsafe { settings(text, "option of a robot", &known, &[]) }?;
    RobotOptions::of(&settings).map_err(of_json)
}

fn finished(robot: Robot, options: &RobotOptions) -> Result<KinoptRobot, Failure> {
    let robot = options.limited::<Value>(robot).map_err(of_json)?;
    let robot = options.base.of::<Value>(robot).map_err(of_json)?;
    Ok(KinoptRobot::new(robot))
}

/// Reads a robot from a URDF or MJCF file.
///
/// `settings`: `base_joint` ("free", "planar", …), `base_bounds`, `lenient`, `mimic_limits`, `soft_limits`, `confine`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_robot_read(
    path: *const c_char,
    settings: *const c_char,
    robot: *mut *mut KinoptRobot,
) -> KinoptStatus {
    guard(|| unsafe {
        let options = options_of(settings)?;
        let read = options.reader().read(pointer::text(path, "path")?)?;
        pointer::give(robot, finished(read, &options)?, "robot")
    })
}

/// Reads a robot from the text of a URDF or MJCF file; `name` is the file's name in messages. Settings are those of
/// `kinopt_robot_read`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_robot_parse(
    text: *const c_char,
    name: *const c_char,
    settings: *const c_char,
    robot: *mut *mut KinoptRobot,
) -> KinoptStatus {
    guard(|| unsafe {
        let options = options_of(settings)?;
        let (text, name) = (pointer::text(text, "text")?, pointer::text(name, "name")?);
        let parsed = options.parse::<Value>(text, name).map_err(of_json)?;
        pointer::give(robot, finished(parsed, &options)?, "robot")
    })
}

/// Creates the robot with the joint limits of a MoveIt `joint_limits.yaml`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_robot_with_joint_limits(
    robot: *const KinoptRobot,
    yaml: *const c_char,
    file: *const c_char,
    limited: *mut *mut KinoptRobot,
) -> KinoptStatus {
    guard(|| unsafe {
        let robot = Robot::clone(&pointer::object(robot, "robot")?.inner);
        let (yaml, file) = (pointer::text(yaml, "yaml")?, pointer::text(file, "file")?);
        let robot = robot.with_joint_limits_of(yaml.as_bytes(), file)?;
        pointer::give(limited, KinoptRobot::new(robot), "limited")
    })
}

/// Frees a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_robot_free(robot: *mut KinoptRobot) {
    unsafe { pointer::free(robot) }
}

/// Length of a configuration of the robot; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_robot_configuration_len(robot: *const KinoptRobot) -> usize {
    let robot = unsafe { pointer::object(robot, "robot") };
    robot.map_or(0, |robot| robot.inner.model().configuration_len())
}

/// Writes the neutral configuration: 0, or the nearest limit; quaternions are w, x, y, z.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_robot_neutral(
    robot: *const KinoptRobot,
    q: *mut f64,
    q_length: usize,
) -> KinoptStatus {
    guard(|| unsafe {
        let robot = &pointer::object(robot, "robot")?.inner;
        pointer::copy(&robot.model().neutral(), q, q_length, "q")
    })
}

/// Number of frames: links, and the ends of their joints; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_robot_frame_count(robot: *const KinoptRobot) -> usize {
    let robot = unsafe { pointer::object(robot, "robot") };
    robot.map_or(0, |robot| robot.frames.len())
}

/// Name of a frame, valid as long as the robot; null for an index out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_robot_frame_name(
    robot: *const KinoptRobot,
    index: usize,
) -> *const c_char {
    let robot = unsafe { pointer::object(robot, "robot") };
    pointer::text_at(robot.map_or(&[], |robot| &robot.frames), index)
}
