//! Reading of paths from CSV files, with or without a header.

use std::fmt;
use std::path::Path;

use super::{CartesianPath, PathError};
use kinopt_kinematics::file::{FileLocation, ReadError, ReadProblem, read_with};
use kinopt_kinematics::spatial::{Placement, Quaternion, Vector3};

/// Largest file size, bytes.
const LENGTH_LIMIT: u64 = 1 << 30;
/// Largest deviation of a quaternion's norm from 1, due to rounding. Quaternions are then normalised.
const NORM_TOLERANCE: f64 = 1e-3;
/// Largest tool index.
const MAX_TOOL: f64 = 255.0;

/// Order of quaternion elements in files without a header.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum QuaternionOrder {
    /// w, x, y, z. This is the default.
    #[default]
    WFirst,
    /// x, y, z, w.
    WLast,
}

/// Meaning of the columns of a file; indices count from 0. Its `Display` text counts from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct CsvColumns {
    /// Columns of x, y and z, metres.
    pub position: [usize; 3],
    /// Columns of w, x, y and z; `None` if the file has positions only, which need an arm whose goal leaves the
    /// orientation free.
    pub quaternion: Option<[usize; 4]>,
    /// Column of the time, seconds; `None` if the file has no times.
    pub time: Option<usize>,
    /// Column of the tool index of [`CartesianPath::with_tools`]; `None` if all points use tool 0.
    pub tool: Option<usize>,
    /// True if a header names the columns.
    pub by_name: bool,
}

impl fmt::Display for CsvColumns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let one_based = |column: usize| column + 1;
        let [x, y, z] = self.position.map(one_based);
        write!(f, "x, y, z from columns {x}, {y}, {z}")?;
        match self.quaternion {
            Some(columns) => {
                let [w, x, y, z] = columns.map(one_based);
                write!(f, "; quaternion w, x, y, z from columns {w}, {x}, {y}, {z}")?;
            }
            None => write!(f, "; no orientation")?,
        }
        match self.time {
            Some(time) => write!(f, "; times from column {}", one_based(time))?,
            None => write!(f, "; no times")?,
        }
        if let Some(tool) = self.tool {
            write!(f, "; tools from column {}", one_based(tool))?;
        }
        let suffix = match self.by_name {
            true => " (as the header names them)",
            false => " (by their number)",
        };
        f.write_str(suffix)
    }
}

impl CartesianPath {
    /// Reads a table of points from a CSV file: `x, y, z` in metres, and optionally a quaternion and a `time` in
    /// seconds.
    ///
    /// Columns are separated by commas, semicolons, tabs or blanks. A header may name them in any order (`x`, `pos_x`,
    /// `target-POS_X`, `qw`, `rot_w`, `target-ROT_W`, `time`, `t`, …). A column `tool` has the [tool
    /// index](Self::with_tools) of each point. Without known names, the number of columns decides:
    ///
    /// | columns | meaning |
    /// |---|---|
    /// | 3 | x, y, z |
    /// | 4 | time, x, y, z |
    /// | 7 | x, y, z, quaternion in the given `order` |
    /// | 8 | time, x, y, z, quaternion |
    ///
    /// Times that increase by one, or do not increase, are treated as row numbers and ignored.
    ///
    /// # Errors
    /// Returns an error, with the line, if:
    ///
    /// - the file cannot be read;
    /// - the number of columns is not supported;
    /// - a field is not a finite number;
    /// - a quaternion's norm differs from 1 by more than 0.001;
    /// - a tool is not an integer from 0 to 255;
    /// - the points or times are invalid.
    pub fn read(
        path: impl AsRef<Path>,
        order: QuaternionOrder,
    ) -> Result<(Self, CsvColumns), ReadError> {
        read_with(path.as_ref(), LENGTH_LIMIT, |bytes, name| {
            Self::from_csv(bytes, name, order)
        })
    }

    /// Reads a table from bytes, like [`read`](Self::read). Errors report `name` as the file.
    ///
    /// # Errors
    /// Returns the errors of [`read`](Self::read).
    pub fn from_csv(
        bytes: &[u8],
        name: &str,
        order: QuaternionOrder,
    ) -> Result<(Self, CsvColumns), ReadError> {
        let malformed =
            |place: FileLocation, problem: String| ReadError::malformed(name, place, problem);
        let text = std::str::from_utf8(bytes).map_err(|error| {
            malformed(
                FileLocation::Byte(error.valid_up_to()),
                "is not UTF-8".into(),
            )
        })?;
        let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
        let mut lines = lines
            .map(|(number, line)| (number + 1, line.trim()))
            .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
            .peekable();
        let Some(&(first, head)) = lines.peek() else {
            return Err(malformed(FileLocation::File, "has no points".into()));
        };
        let fields: Vec<&str> = split(head).collect();
        let is_header = fields.iter().any(|field| field.parse::<f64>().is_err());
        let columns = match is_header {
            true => CsvColumns::named(&fields),
            false => None,
        };
        let columns = match columns {
            Some(columns) => columns,
            None => CsvColumns::counted(fields.len(), order)
                .map_err(|problem| malformed(FileLocation::Line(first), problem))?,
        };
        if is_header {
            lines.next();
        }
        let mut table = Table::default();
        let mut row = Vec::with_capacity(fields.len());
        for (number, line) in lines {
            row.clear();
            for field in split(line) {
                let value = field.parse::<f64>().ok().filter(|value| value.is_finite());
                row.push(value.ok_or_else(|| {
                    malformed(
                        FileLocation::Line(number),
                        format!("`{field}` is not a finite number"),
                    )
                })?);
            }
            if row.len() != fields.len() {
                let problem = format!(
                    "has {} columns, the first line has {}",
                    row.len(),
                    fields.len()
                );
                return Err(malformed(FileLocation::Line(number), problem));
            }
            table
                .push_row(&row, &columns)
                .map_err(|problem| malformed(FileLocation::Line(number), problem))?;
        }
        if table.points.is_empty() {
            return Err(malformed(FileLocation::File, "has no points".into()));
        }
        let finished = table.finish(columns);
        finished
            .map_err(|error| ReadError::new(name, FileLocation::File, ReadProblem::invalid(error)))
    }
}

/// Points read so far.
#[derive(Default)]
struct Table {
    points: Vec<Placement<f64>>,
    times: Vec<f64>,
    tools: Vec<usize>,
}

impl Table {
    fn push_row(&mut self, row: &[f64], columns: &CsvColumns) -> Result<(), String> {
        let [x, y, z] = columns.position.map(|column| row[column]);
        let translation = Vector3::new(x, y, z);
        let point = match columns.quaternion {
            None => Placement::translation(translation),
            Some(columns) => {
                let [w, x, y, z] = columns.map(|column| row[column]);
                let v = Vector3::new(x, y, z);
                let length = (w * w + v.norm_squared()).sqrt();
                if (length - 1.0).abs() > NORM_TOLERANCE {
                    return Err(format!("its quaternion has length {length}: 1 is needed"));
                }
                let unit = Quaternion {
                    w: w / length,
                    v: v * length.recip(),
                };
                Placement::new(unit.to_matrix(), translation)
            }
        };
        self.points.push(point);
        self.times.extend(columns.time.map(|column| row[column]));
        if let Some(column) = columns.tool {
            let number = row[column];
            if number.fract() != 0.0 || !(0.0..=MAX_TOOL).contains(&number) {
                return Err(format!(
                    "its tool is {number}: a whole number from 0 to {MAX_TOOL} is needed"
                ));
            }
            self.tools.push(number as usize);
        }
        Ok(())
    }

    fn finish(self, mut columns: CsvColumns) -> Result<(CartesianPath, CsvColumns), PathError> {
        let mut path = CartesianPath::new(self.points)?;
        path.oriented = columns.quaternion.is_some();
        if columns.tool.is_some() {
            path = path.with_tools(self.tools)?;
        }
        let is_increasing = self.times.windows(2).all(|pair| pair[0] < pair[1]);
        let counts_rows = self.times.windows(2).all(|pair| pair[1] - pair[0] == 1.0);
        if columns.time.is_none() || !columns.by_name && (counts_rows || !is_increasing) {
            columns.time = None;
            return Ok((path, columns));
        }
        Ok((path.with_times(self.times)?, columns))
    }
}

fn split(line: &str) -> impl Iterator<Item = &str> {
    let is_separator = |c: char| matches!(c, ',' | ';' | '\t');
    let has_separators = line.contains(is_separator);
    let parts = line.split(move |c: char| match has_separators {
        true => is_separator(c),
        false => c.is_whitespace(),
    });
    parts
        .map(|field| field.trim().trim_matches('"'))
        .filter(move |field| has_separators || !field.is_empty())
}

impl CsvColumns {
    /// Finds the columns by the names of a header. Returns `None` if it does not name a position.
    fn named(header: &[&str]) -> Option<Self> {
        let names: Vec<String> = header.iter().map(|name| normalised(name)).collect();
        let find = |known: &[&str]| names.iter().position(|name| known.contains(&name.as_str()));
        let position = |axis: &str| {
            find(&[
                axis,
                &format!("p{axis}"),
                &format!("pos{axis}"),
                &format!("position{axis}"),
            ])
        };
        let quaternion = |axis: &str| {
            let forms = ["q", "rot", "quat", "quaternion", "orientation", "o", "r"];
            let forms = forms.map(|form| format!("{form}{axis}"));
            let mut known: Vec<&str> = forms.iter().map(String::as_str).collect();
            known.extend((axis == "w").then_some("w"));
            find(&known)
        };
        let [Some(x), Some(y), Some(z)] = ["x", "y", "z"].map(position) else {
            return None;
        };
        let quaternion = match ["w", "x", "y", "z"].map(quaternion) {
            [Some(w), Some(x), Some(y), Some(z)] => Some([w, x, y, z]),
            [None, None, None, None] => None,
            _ => return None,
        };
        Some(Self {
            position: [x, y, z],
            quaternion,
            time: find(&["time", "t", "times", "timestamp", "seconds", "s"]),
            tool: find(&["tool", "toolindex", "toolnumber"]),
            by_name: true,
        })
    }

    /// Assigns the columns by their count.
    fn counted(count: usize, order: QuaternionOrder) -> Result<Self, String> {
        let (first, has_quaternion) = match count {
            3 => (0, false),
            4 => (1, false),
            7 => (0, true),
            8 => (1, true),
            _ => {
                return Err(format!(
                    "has {count} columns without names that are known: 7 (x, y, z and a quaternion), 8 (a time before them), \
                     3 (x, y, z) or 4 are understood, or a header with x, y, z, qw, qx, qy, qz and perhaps time"
                ));
            }
        };
        let element_columns = match order {
            QuaternionOrder::WFirst => [3, 4, 5, 6],
            QuaternionOrder::WLast => [6, 3, 4, 5],
        };
        Ok(Self {
            position: [first, first + 1, first + 2],
            quaternion: has_quaternion.then_some(element_columns.map(|column| first + column)),
            time: (first == 1).then_some(0),
            tool: None,
            by_name: false,
        })
    }
}

/// Reduces a column name to lower-case letters and digits of its last part: `target-POS_X` is `posx`.
fn normalised(name: &str) -> String {
    let last = name.rsplit(['-', '/', ':']).next().unwrap_or(name);
    let letters = last.chars().filter(char::is_ascii_alphanumeric);
    letters.map(|c| c.to_ascii_lowercase()).collect()
}
