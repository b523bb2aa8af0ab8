//! Motions in .csv files.

use std::path::Path;

use kinopt::motion::path::QuaternionOrder;
use kinopt::robot::Robot;

use super::{
    MotionFileError, MotionReading, RobotMotion, columns_of, put_w_first, rate_of_times, selected,
    text,
};

/// Names of the column of sample times, seconds.
const TIMES: [&str; 2] = ["time", "times"];

pub(super) fn read(
    robot: &Robot,
    path: &Path,
    reading: &MotionReading<'_>,
) -> Result<RobotMotion, MotionFileError> {
    let text = text(path)?;
    let error = |problem: String| MotionFileError::new(path, problem);
    let mut lines = text
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty());
    let first = lines.clone().next().map_or("", |(_, line)| line);
    let header = cells(first).any(|cell| cell.parse::<f64>().is_err());
    let header: Option<Vec<String>> = header.then(|| cells(first).map(str::to_owned).collect());
    if header.is_some() {
        lines.next();
    }
    let width = header
        .as_ref()
        .map_or_else(|| cells(first).count(), Vec::len);
    let mut numbers = Vec::new();
    for (index, line) in lines {
        let count = numbers.len();
        for cell in cells(line) {
            let number = cell.parse::<f64>();
            let line = index + 1;
            numbers
                .push(number.map_err(|_| error(format!("line {line}: `{cell}` is not a number")))?);
        }
        let given = numbers.len() - count;
        if given != width {
            let line = index + 1;
            return Err(error(format!(
                "line {line}: {given} numbers, expected {width}"
            )));
        }
    }
    if let Some(header) = header {
        let columns = columns_of(robot, &header).map_err(error)?;
        let time = header
            .iter()
            .position(|name| TIMES.contains(&name.as_str()));
        let times = time.map(|column| selected(&numbers, width, &[column]));
        return Ok(RobotMotion {
            q: selected(&numbers, width, &columns),
            frame_rate: times.and_then(|times| rate_of_times(&times)),
        });
    }
    let expected = robot.model().configuration_len();
    if width != expected {
        return Err(error(format!(
            "rows of {width} numbers, expected {expected}, the length of a configuration of `{}`",
            robot.name()
        )));
    }
    if reading.quaternion != Some(QuaternionOrder::WFirst) {
        put_w_first(robot, &mut numbers);
    }
    Ok(RobotMotion {
        q: numbers,
        frame_rate: None,
    })
}

/// Cells of a row, separated by commas, semicolons or white space.
fn cells(line: &str) -> impl Iterator<Item = &str> + Clone {
    // Names may contain spaces, so these separate only lines without other separators.
    let has_separator = line.contains([',', ';', '\t']);
    let cells = line.split(move |letter: char| match has_separator {
        true => matches!(letter, ',' | ';' | '\t'),
        false => letter.is_whitespace(),
    });
    cells
        .map(|cell| cell.trim().trim_matches('"'))
        .filter(move |cell| has_separator || !cell.is_empty())
}
