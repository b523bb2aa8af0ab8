//! Motions in .json files, as `TrajectoryTable` writes them.

use std::path::Path;

use kinopt::robot::Robot;
use serde::Deserialize;

use super::{MotionFileError, RobotMotion, columns_of, rate_of_times, selected, text};

#[derive(Deserialize)]
struct MotionDocument {
    #[serde(default)]
    fps: Option<f64>,
    #[serde(default)]
    times: Option<Vec<f64>>,
    #[serde(default)]
    names: Option<Vec<String>>,
    q: Vec<Vec<f64>>,
}

pub(super) fn read(robot: &Robot, path: &Path) -> Result<RobotMotion, MotionFileError> {
    let text = text(path)?;
    let error = |problem: String| MotionFileError::new(path, problem);
    let document: MotionDocument =
        serde_json::from_str(&text).map_err(|problem| error(problem.to_string()))?;
    let expected = robot.model().configuration_len();
    let width = document.names.as_ref().map_or(expected, Vec::len);
    if let Some((frame, row)) = document
        .q
        .iter()
        .enumerate()
        .find(|(_, row)| row.len() != width)
    {
        let given = row.len();
        return Err(error(format!(
            "q[{frame}]: {given} numbers, expected {width}"
        )));
    }
    let q = document.q.concat();
    let q = match &document.names {
        Some(names) => selected(&q, width, &columns_of(robot, names).map_err(error)?),
        None => q,
    };
    let times = document.times.as_deref().and_then(rate_of_times);
    Ok(RobotMotion {
        q,
        frame_rate: document.fps.or(times),
    })
}
