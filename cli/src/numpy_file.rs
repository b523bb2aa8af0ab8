//! Reader of NumPy's .npy files.
//!
//! A .npy file has a magic string, a version, a header (a Python dictionary in ASCII) and the numbers ("NumPy
//! Enhancement Proposal 1").

use std::path::Path;

use crate::failure::Outcome;
use crate::file_access;

const MAGIC: &[u8] = b"\x93NUMPY";

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

#[cfg(test)]
mod tests {
    use kinopt_bindings::trajectory_file::{Column, npy};

    use super::{Array, parse};

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
