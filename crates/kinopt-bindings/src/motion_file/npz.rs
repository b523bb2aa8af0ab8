//! Motions in .npz files.

use std::path::Path;

use kinopt::io::numpy::{NumpyArchive, NumpyArray};
use kinopt::motion::path::QuaternionOrder;
use kinopt::robot::Robot;

use super::{
    MotionFileError, MotionReading, RobotMotion, base_quaternion, columns_of, put_w_first,
    rate_of_times, selected,
};

/// Names of whole configurations: of kinopt, and of MuJoCo.
const CONFIGURATIONS: [&str; 2] = ["q", "qpos"];
/// Names of the frame rate, of sample times and of the sample time.
const FRAME_RATES: [&str; 3] = ["fps", "frame_rate", "frequency"];
const TIMES: [&str; 2] = ["times", "time"];
const TIME_STEPS: [&str; 2] = ["dt", "timestep"];
/// Names of the parts of GMR's motions: base position, base quaternion x, y, z, w, and joint angles.
const PARTS: [&str; 3] = ["root_pos", "root_rot", "dof_pos"];

pub(super) fn read(
    robot: &Robot,
    path: &Path,
    reading: &MotionReading<'_>,
) -> Result<RobotMotion, MotionFileError> {
    let archive = NumpyArchive::read(path)?;
    let error = |problem: String| MotionFileError::new(path, problem);
    let expected = robot.model().configuration_len();
    let mut numbers;
    match archive.first_of(&CONFIGURATIONS)? {
        Some(array) => {
            let width = row_width(array);
            numbers = match archive.get("names")? {
                Some(names) if names.texts.len() == width => {
                    let columns = columns_of(robot, &names.texts).map_err(error)?;
                    selected(&array.numbers, width, &columns)
                }
                _ if width == expected => array.numbers.clone(),
                _ => return Err(error(other_width(robot, width))),
            };
            if reading.quaternion == Some(QuaternionOrder::WLast) {
                put_w_first(robot, &mut numbers);
            }
        }
        None => {
            let parts = PARTS.map(|name| archive.array(name));
            let [Ok(position), Ok(rotation), Ok(joints)] = parts else {
                let names: Vec<&str> = archive.names().collect();
                return Err(error(format!(
                    "no configurations: expected `q`, `qpos`, or `root_pos`, `root_rot` and `dof_pos`; the file has {}",
                    names.join(", ")
                )));
            };
            let width = 7 + row_width(joints);
            if base_quaternion(robot).is_none() || width != expected {
                return Err(error(other_width(robot, width)));
            }
            numbers = Vec::new();
            let rows = position.numbers.chunks_exact(3);
            let rows = rows.zip(rotation.numbers.chunks_exact(4));
            for ((at, turn), angles) in rows.zip(joints.numbers.chunks_exact(width - 7)) {
                numbers.extend(at.iter().chain(turn).chain(angles));
            }
            if reading.quaternion != Some(QuaternionOrder::WFirst) {
                put_w_first(robot, &mut numbers);
            }
        }
    }
    let number = |names: &[&str]| -> Result<Option<f64>, MotionFileError> {
        let array = archive.first_of(names)?;
        Ok(array.and_then(|array| array.numbers.first().copied()))
    };
    let times = archive.first_of(&TIMES)?;
    let times = times.and_then(|array| rate_of_times(&array.numbers));
    let step = number(&TIME_STEPS)?.map(|step| 1.0 / step);
    Ok(RobotMotion {
        q: numbers,
        frame_rate: number(&FRAME_RATES)?.or(times).or(step),
    })
}

/// Numbers of a row: the length of the last of two axes.
fn row_width(array: &NumpyArray) -> usize {
    match *array.shape {
        [_, width] => width,
        _ => array.numbers.len(),
    }
}

fn other_width(robot: &Robot, width: usize) -> String {
    format!(
        "configurations of {width} numbers, expected {}, the length of a configuration of `{}`",
        robot.model().configuration_len(),
        robot.name()
    )
}
