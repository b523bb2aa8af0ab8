//! DMAT matrices, the format of libigl, used for skin weights.
//!
//! The first line is `columns rows`. The values follow column by column, as text. If the first line is `0 0`, a second
//! line `columns rows` follows, and then the values as little-endian `f64`, column by column.

use std::fmt::Write;
use std::path::Path;

use nalgebra::DMatrix;

use kinopt_kinematics::file::{FileLocation, MAX_FILE_BYTES, ReadError, WriteError, read_with};
use kinopt_kinematics::file_replacement::write_file;

/// Encoding of the values of a DMAT file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum DmatEncoding {
    /// Decimal numbers, with as many digits as an exact round trip needs.
    Text,
    /// Little-endian `f64`.
    Binary,
}

/// Reads a matrix of finite numbers from the bytes of a DMAT file. `name` is the file name for messages.
///
/// # Errors
/// A [`ReadError`] with the line or the byte offset: a malformed header, a wrong number of values, or a value that is
/// not finite.
pub fn from_bytes(bytes: &[u8], name: &str) -> Result<DMatrix<f64>, ReadError> {
    let (size, body) = header_line(bytes, 0, 1, name)?;
    if size != (0, 0) {
        return text_values(bytes, body, size, name);
    }
    let (size, body) = header_line(bytes, body, 2, name)?;
    binary_values(bytes, body, size, name)
}

/// Reads a DMAT file of at most 2 GiB.
///
/// # Errors
/// As [`from_bytes`], and a file that cannot be opened.
pub fn read(path: impl AsRef<Path>) -> Result<DMatrix<f64>, ReadError> {
    read_with(path.as_ref(), MAX_FILE_BYTES, from_bytes)
}

/// The bytes of a DMAT file.
///
/// A matrix without columns and rows is always written as binary, because the header `0 0` means binary. A matrix with
/// either columns or rows cannot be read back.
#[must_use]
pub fn to_bytes(matrix: &DMatrix<f64>, encoding: DmatEncoding) -> Vec<u8> {
    let sizes = format!("{} {}\n", matrix.ncols(), matrix.nrows());
    let empty = matrix.ncols() == 0 && matrix.nrows() == 0;
    if encoding == DmatEncoding::Text && !empty {
        let mut text = sizes;
        for value in matrix.as_slice() {
            // Writing to a String cannot fail. The exponent form keeps tiny values short.
            let _ = if value.abs() < 1e-4 {
                writeln!(text, "{value:e}")
            } else {
                writeln!(text, "{value}")
            };
        }
        return text.into_bytes();
    }
    let mut bytes = format!("0 0\n{sizes}").into_bytes();
    for value in matrix.as_slice() {
        bytes.extend_from_slice(&value.to_le_bytes());
    }
    bytes
}

/// Writes [`to_bytes`] to a file.
///
/// # Errors
/// A [`WriteError`] that names the file.
pub fn write(
    matrix: &DMatrix<f64>,
    encoding: DmatEncoding,
    path: impl AsRef<Path>,
) -> Result<(), WriteError> {
    write_file(path.as_ref(), &to_bytes(matrix, encoding))
}

/// The two numbers of the line at `start`, and the offset of the next line.
fn header_line(
    bytes: &[u8],
    start: usize,
    line: usize,
    name: &str,
) -> Result<((usize, usize), usize), ReadError> {
    let rest = bytes.get(start..).unwrap_or(&[]);
    let length = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
    let text = rest.get(..length).unwrap_or(&[]);
    let sizes = std::str::from_utf8(text).ok().and_then(|text| {
        let mut numbers = text.split_ascii_whitespace().map(str::parse::<usize>);
        match (numbers.next(), numbers.next(), numbers.next()) {
            (Some(Ok(columns)), Some(Ok(rows)), None) => Some((columns, rows)),
            _ => None,
        }
    });
    let size = sizes.ok_or_else(|| {
        let problem = "expected the number of columns and of rows, two whole numbers";
        ReadError::malformed(name, FileLocation::Line(line), problem)
    })?;
    Ok((size, (start + length + 1).min(bytes.len())))
}

/// The number of values columns × rows, if the rest of the file can hold them at `width` bytes or more each.
fn checked_count(
    (columns, rows): (usize, usize),
    width: u128,
    available: usize,
    name: &str,
) -> Result<usize, ReadError> {
    let location = || FileLocation::Line(if width == TEXT_WIDTH { 1 } else { 2 });
    let what = format!("{columns} columns of {rows} values");
    // Otherwise a size such as 0 × 10¹² would need no bytes and pass.
    if (columns == 0) != (rows == 0) {
        let problem = format!("{what} are not a table");
        return Err(ReadError::malformed(name, location(), problem));
    }
    let count = columns as u128 * rows as u128;
    // Both factors are below 2^64, but the width may push the product over u128.
    let needed = count.saturating_mul(width);
    // The last text value needs no separator, hence one byte of tolerance.
    let fits = needed <= available as u128 + u128::from(width == TEXT_WIDTH);
    match usize::try_from(count) {
        Ok(count) if fits => Ok(count),
        _ => Err(ReadError::truncated(
            name,
            location(),
            what,
            needed,
            available,
        )),
    }
}

/// Smallest size of a text value in bytes: a digit and a separator.
const TEXT_WIDTH: u128 = 2;

fn text_values(
    bytes: &[u8],
    body: usize,
    (columns, rows): (usize, usize),
    name: &str,
) -> Result<DMatrix<f64>, ReadError> {
    let rest = bytes.get(body..).unwrap_or(&[]);
    let count = checked_count((columns, rows), TEXT_WIDTH, rest.len(), name)?;
    let mut values = Vec::with_capacity(count);
    for (index, line) in rest.split(|&b| b == b'\n').enumerate() {
        let location = || FileLocation::Line(index + 2);
        let line = std::str::from_utf8(line)
            .map_err(|_| ReadError::malformed(name, location(), "is not text"))?;
        for word in line.split_ascii_whitespace() {
            let value = word.parse().ok().filter(|value: &f64| value.is_finite());
            let value = value.ok_or_else(|| {
                let word: String = word.chars().take(40).collect();
                ReadError::malformed(name, location(), format!("`{word}` is not a finite number"))
            })?;
            if values.len() == count {
                let problem = format!("there are more values than the {count} announced");
                return Err(ReadError::malformed(name, location(), problem));
            }
            values.push(value);
        }
    }
    if values.len() != count {
        let problem = format!("holds {} of the {count} values announced", values.len());
        return Err(ReadError::of_file(name, problem));
    }
    Ok(DMatrix::from_vec(rows, columns, values))
}

fn binary_values(
    bytes: &[u8],
    body: usize,
    (columns, rows): (usize, usize),
    name: &str,
) -> Result<DMatrix<f64>, ReadError> {
    let rest = bytes.get(body..).unwrap_or(&[]);
    let count = checked_count((columns, rows), 8, rest.len(), name)?;
    let fail = |value: usize, problem| {
        let location = FileLocation::Byte(body + 8 * value);
        Err(ReadError::malformed(name, location, problem))
    };
    let mut values = Vec::with_capacity(count);
    for (index, chunk) in rest.chunks_exact(8).take(count).enumerate() {
        let value = f64::from_le_bytes(chunk.try_into().unwrap_or_default());
        if !value.is_finite() {
            return fail(index, format!("{value} is not a finite number"));
        }
        values.push(value);
    }
    let remaining = rest.len() - 8 * count;
    if remaining > 0 {
        return fail(
            count,
            format!("{remaining} bytes are left after the last value"),
        );
    }
    Ok(DMatrix::from_vec(rows, columns, values))
}
