//! NumPy files: reader of .npy, writer of .npz.
//!
//! A .npy file has a magic string, a version, a header (a Python dictionary in ASCII) and the numbers ("NumPy
//! Enhancement Proposal 1"). A .npz file is a ZIP archive of .npy files, here uncompressed.

use std::io::{Cursor, Write};
use std::path::Path;

use zip::CompressionMethod;
use zip::write::{SimpleFileOptions, ZipWriter};

use crate::failure::Outcome;
use crate::file_access;

const MAGIC: &[u8] = b"\x93NUMPY";
/// Alignment of the numbers, in bytes.
const HEADER_ALIGNMENT: usize = 64;

/// Numbers with the lengths of their axes, in C order.
#[derive(Debug, PartialEq)]
pub(crate) struct Array {
    pub(crate) shape: Vec<usize>,
    pub(crate) numbers: Vec<f64>,
}

/// Reads an array of single or double precision.
pub(crate) fn read(path: &Path) -> Outcome<Array> {
    let bytes = file_access::allowed().read(path)?;
    parse(&bytes).map_err(|problem| failure!("{}: {problem}", path.display()))
}

fn parse(bytes: &[u8]) -> Result<Array, String> {
    let damaged = || "not a NumPy array, or damaged".to_owned();
    let rest = bytes.strip_prefix(MAGIC).ok_or_else(damaged)?;
    let (header, data) = match rest {
        [1, _, a, b, rest @ ..] => rest.split_at_checked(usize::from(u16::from_le_bytes([*a, *b]))),
        [2 | 3, _, a, b, c, d, rest @ ..] => {
            let length = u32::from_le_bytes([*a, *b, *c, *d]);
            rest.split_at_checked(usize::try_from(length).unwrap_or(usize::MAX))
        }
        _ => None,
    }
    .ok_or_else(damaged)?;
    let header = std::str::from_utf8(header).map_err(|_| damaged())?;
    let after = |key: &str| {
        header
            .split_once(key)
            .map(|(_, rest)| rest.trim_start_matches([':', ' ']))
    };
    let kind = after("'descr'").and_then(|rest| rest.split('\'').nth(1));
    let fortran = after("'fortran_order'").is_some_and(|rest| rest.starts_with("True"));
    let shape = after("'shape'").and_then(|rest| rest.strip_prefix('(')?.split_once(')'));
    let (shape, _) = shape.ok_or_else(damaged)?;
    let axes = shape
        .split(',')
        .map(str::trim)
        .filter(|axis| !axis.is_empty());
    let shape: Vec<usize> = axes
        .map(|axis| axis.parse().map_err(|_| damaged()))
        .collect::<Result<_, _>>()?;
    if fortran && shape.len() > 1 {
        return Err(
            "the array is in Fortran order; save it after numpy.ascontiguousarray".to_owned(),
        );
    }
    let numbers: Vec<f64> = match kind {
        Some("<f4") => numbers_of(data, |four| f64::from(f32::from_le_bytes(four))),
        Some("<f8") => numbers_of(data, f64::from_le_bytes),
        other => {
            let other = other.unwrap_or("none");
            return Err(format!("unsupported type {other}; expected <f4 or <f8"));
        }
    };
    let product = shape
        .iter()
        .try_fold(1_usize, |product, axis| product.checked_mul(*axis));
    match product == Some(numbers.len()) {
        true => Ok(Array { shape, numbers }),
        false => Err(damaged()),
    }
}

/// Numbers of N bytes each; an incomplete last one is ignored.
fn numbers_of<const N: usize>(data: &[u8], number: impl Fn([u8; N]) -> f64) -> Vec<f64> {
    let numbers = data.chunks_exact(N).filter_map(|bytes| bytes.first_chunk());
    numbers.map(|bytes| number(*bytes)).collect()
}

/// Array of a .npz file.
pub(crate) enum Column<'a> {
    Numbers(&'a [f64]),
    Flags(&'a [bool]),
    Words(&'a [String]),
}

/// Bytes of a .npz file with arrays by name, each with the lengths of its axes.
pub(crate) fn npz(arrays: &[(&str, &[usize], Column<'_>)]) -> Outcome<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let stored = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .large_file(true);
    for (name, shape, column) in arrays {
        archive.start_file(format!("{name}.npy"), stored)?;
        archive.write_all(&npy(shape, column))?;
    }
    Ok(archive.finish()?.into_inner())
}

fn npy(shape: &[usize], column: &Column<'_>) -> Vec<u8> {
    let mut data = Vec::new();
    let kind = match column {
        Column::Numbers(numbers) => {
            data.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
            "<f8".to_owned()
        }
        Column::Flags(flags) => {
            data.extend(flags.iter().map(|flag| u8::from(*flag)));
            "|b1".to_owned()
        }
        Column::Words(words) => {
            let longest = words
                .iter()
                .map(|word| word.chars().count())
                .max()
                .unwrap_or(0)
                .max(1);
            for word in *words {
                let letters = word.chars().chain(std::iter::repeat('\0')).take(longest);
                data.extend(letters.flat_map(|letter| u32::from(letter).to_le_bytes()));
            }
            format!("<U{longest}")
        }
    };
    let axes: String = shape.iter().map(|axis| format!("{axis}, ")).collect();
    let axes = match shape.len() {
        0 | 1 => axes.trim_end().to_owned(),
        _ => axes.trim_end_matches(", ").to_owned(),
    };
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({axes}), }}");
    let unpadded = MAGIC.len() + 4 + header.len() + 1;
    header.extend(std::iter::repeat_n(
        ' ',
        unpadded.next_multiple_of(HEADER_ALIGNMENT) - unpadded,
    ));
    header.push('\n');
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    // A header of names and three lengths fits 16 bits.
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(data);
    bytes
}

#[cfg(test)]
mod tests {
    use super::{Array, Column, npy, parse};

    #[test]
    fn npy_written_file_reads_back() {
        let numbers = [1.0, -2.5, f64::MAX, 0.1, 0.0, 7.0];
        let bytes = npy(&[2, 3], &Column::Numbers(&numbers));
        let shape = vec![2, 3];
        let numbers = numbers.to_vec();
        assert_eq!(parse(&bytes), Ok(Array { shape, numbers }));
        assert_eq!((bytes.len() - 48) % 64, 0);
    }

    #[test]
    fn npy_damaged_is_rejected() {
        let bytes = npy(&[2], &Column::Numbers(&[1.0, 2.0]));
        for length in 0..bytes.len() {
            assert!(parse(&bytes[..length]).is_err(), "{length} bytes");
        }
        assert!(parse(&npy(&[1], &Column::Flags(&[true]))).is_err());
    }
}
