//! Files of robot motions, from any program: .csv, .npz, .json, .glb and .gltf.
//!
//! | file | configurations | frame rate |
//! |---|---|---|
//! | .csv without a header row | one row a frame; a free base has its quaternion as x, y, z, w, as in Unitree's LAFAN1 | – |
//! | .csv with a header row | columns by name; quaternion w, x, y, z | column `time` |
//! | .npz | `q` or `qpos`, quaternion w, x, y, z; or `root_pos`, `root_rot` (x, y, z, w) and `dof_pos` | `fps`, `times`, `dt` |
//! | .json | `q` | `fps`, `times` |
//! | .glb, .gltf | nodes with the names of the robot's links | given |

mod csv;
mod error;
mod json;
mod link_nodes;
mod npz;
mod robot_scene;

use std::path::Path;

use kinopt::io::FileAccess;
use kinopt::motion::path::QuaternionOrder;
use kinopt::robot::Robot;

pub use error::MotionFileError;
pub use robot_scene::write_robot_glb;

use crate::coordinates;

/// Motion of a robot: one configuration after another.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotMotion {
    /// Configurations, radians and metres; quaternions w, x, y, z.
    pub q: Vec<f64>,
    /// Samples per second, if the file or the options have it.
    pub frame_rate: Option<f64>,
}

/// Options of reading a motion.
#[derive(Clone, Copy, Debug, Default)]
pub struct MotionReading<'a> {
    /// Order of the base's quaternion in rows without names. `None` is x, y, z, w for .csv files, and w, x, y, z for all
    /// other files.
    pub quaternion: Option<QuaternionOrder>,
    /// Samples per second; `None` for those of the file.
    pub frame_rate: Option<f64>,
    /// Clip of a scene; `None` for the first.
    pub clip: Option<&'a str>,
}

/// Samples per second of a scene, whose keys may have any times.
const SCENE_RATE: f64 = 30.0;

impl RobotMotion {
    /// Reads the motion of a robot. The format is that of the file's extension.
    ///
    /// # Errors
    /// Returns an error with the file's name: for a file that cannot be read, another number of columns, missing links,
    /// and numbers that are not finite.
    pub fn read(
        robot: &Robot,
        path: &Path,
        reading: &MotionReading<'_>,
    ) -> Result<Self, MotionFileError> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        let extension = extension.unwrap_or_default().to_ascii_lowercase();
        let mut motion = match extension.as_str() {
            "csv" | "txt" => csv::read(robot, path, reading),
            "npz" => npz::read(robot, path, reading),
            "json" => json::read(robot, path),
            "glb" | "gltf" | "vrm" => link_nodes::read(robot, path, reading),
            _ => Err(MotionFileError::extension(path)),
        }?;
        motion.frame_rate = reading.frame_rate.or(motion.frame_rate);
        let width = robot.model().configuration_len();
        if motion.q.is_empty() {
            return Err(MotionFileError::new(path, "the motion has no frames"));
        }
        if let Some(index) = motion.q.iter().position(|number| !number.is_finite()) {
            let name = coordinates::names(robot.model()).swap_remove(index % width);
            let frame = index / width;
            let problem = format!("frame {frame}: `{name}` is not finite");
            return Err(MotionFileError::new(path, problem));
        }
        Ok(motion)
    }
}

/// Text of a file of at most 1 GiB.
fn text(path: &Path) -> Result<String, MotionFileError> {
    let bytes = FileAccess::new().read(path)?;
    String::from_utf8(bytes).map_err(|_| MotionFileError::new(path, "not a text in UTF-8"))
}

/// Index of the first number of the base's quaternion in a configuration, if it begins with a free base.
fn base_quaternion(robot: &Robot) -> Option<usize> {
    let joint = robot.free_root()?;
    (robot.model().coordinate(joint) == Some(0)).then_some(3)
}

/// Changes the base's quaternions from x, y, z, w to w, x, y, z.
fn put_w_first(robot: &Robot, q: &mut [f64]) {
    let Some(first) = base_quaternion(robot) else {
        return;
    };
    for row in q.chunks_exact_mut(robot.model().configuration_len()) {
        row[first..first + 4].rotate_right(1);
    }
}

/// Frame rate of equidistant sample times.
fn rate_of_times(times: &[f64]) -> Option<f64> {
    let (first, last) = (times.first()?, times.last()?);
    let rate = (times.len() - 1) as f64 / (last - first);
    (rate.is_finite() && rate > 0.0).then_some(rate)
}

/// Index of each coordinate of a robot among names.
///
/// # Errors
/// Returns a message with the missing names.
fn columns_of(robot: &Robot, names: &[String]) -> Result<Vec<usize>, String> {
    let coordinates = coordinates::names(robot.model());
    let position = |name: &String| names.iter().position(|known| known == name);
    let missing: Vec<&str> = (coordinates.iter())
        .filter(|name| position(name).is_none())
        .map(String::as_str)
        .collect();
    match missing.is_empty() {
        true => Ok(coordinates.iter().filter_map(position).collect()),
        false => Err(format!("columns are missing: {}", missing.join(", "))),
    }
}

/// Selects and orders the columns of rows.
fn selected(numbers: &[f64], width: usize, columns: &[usize]) -> Vec<f64> {
    let rows = numbers.chunks_exact(width.max(1));
    rows.flat_map(|row| columns.iter().map(|column| row[*column]))
        .collect()
}
