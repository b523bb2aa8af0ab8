//! Reader of NumPy's .npy files.
//!
//! A .npy file has a magic string, a version, a header (a Python dictionary in ASCII) and the numbers ("NumPy
//! Enhancement Proposal 1").

use std::path::Path;

use super::super::{MAX_FILE_BYTES, ReadError, read_with};

const MAGIC: &[u8] = b"\x93NUMPY";

/// Numbers or texts with the lengths of their axes, in C order.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct NumpyArray {
    /// Lengths of the axes; empty for a single value.
    pub shape: Vec<usize>,
    /// Numbers, in C order; empty for an array of texts.
    pub numbers: Vec<f64>,
    /// Texts, in C order; empty for an array of numbers.
    pub texts: Vec<String>,
}

impl NumpyArray {
    /// Reads a .npy file of at most 1 GiB.
    ///
    /// # Errors
    /// As [`from_bytes`](Self::from_bytes), or the file cannot be opened.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        read_with(path.as_ref(), MAX_FILE_BYTES, Self::from_bytes)
    }

    /// Reads an array of floating-point numbers, integers, booleans or texts from the bytes of a .npy file. `name` is
    /// used for messages.
    ///
    /// # Errors
    /// Returns an error for a damaged file, and for Python objects.
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Self, ReadError> {
        parse(bytes).map_err(|problem| ReadError::of_file(name, problem))
    }
}

fn parse(bytes: &[u8]) -> Result<NumpyArray, String> {
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
    let is_fortran = after("'fortran_order'").is_some_and(|rest| rest.starts_with("True"));
    let shape = after("'shape'").and_then(|rest| rest.strip_prefix('(')?.split_once(')'));
    let (shape, _) = shape.ok_or_else(damaged)?;
    let axes = shape
        .split(',')
        .map(str::trim)
        .filter(|axis| !axis.is_empty());
    let shape: Vec<usize> = axes
        .map(|axis| axis.parse().map_err(|_| damaged()))
        .collect::<Result<_, _>>()?;
    let mut array = elements(kind.unwrap_or("none"), data)?;
    let count = array.numbers.len().max(array.texts.len());
    let product = shape
        .iter()
        .try_fold(1_usize, |product, axis| product.checked_mul(*axis));
    if product != Some(count) {
        return Err(damaged());
    }
    if is_fortran && shape.len() > 1 {
        let order = c_order(&shape);
        array.numbers = reordered(&array.numbers, &order);
        array.texts = reordered(&array.texts, &order);
    }
    Ok(NumpyArray { shape, ..array })
}

/// Elements of an array of a type, in the order of the file.
fn elements(kind: &str, data: &[u8]) -> Result<NumpyArray, String> {
    let numbers = match kind {
        "<f4" => numbers_of(data, |bytes| f64::from(f32::from_le_bytes(bytes))),
        "<f8" => numbers_of(data, f64::from_le_bytes),
        ">f4" => numbers_of(data, |bytes| f64::from(f32::from_be_bytes(bytes))),
        ">f8" => numbers_of(data, f64::from_be_bytes),
        "|b1" | "|u1" => numbers_of(data, |[byte]| f64::from(byte)),
        "|i1" => numbers_of(data, |bytes| f64::from(i8::from_le_bytes(bytes))),
        "<i2" => numbers_of(data, |bytes| f64::from(i16::from_le_bytes(bytes))),
        "<u2" => numbers_of(data, |bytes| f64::from(u16::from_le_bytes(bytes))),
        "<i4" => numbers_of(data, |bytes| f64::from(i32::from_le_bytes(bytes))),
        "<u4" => numbers_of(data, |bytes| f64::from(u32::from_le_bytes(bytes))),
        "<i8" => numbers_of(data, |bytes| i64::from_le_bytes(bytes) as f64),
        "<u8" => numbers_of(data, |bytes| u64::from_le_bytes(bytes) as f64),
        _ => return texts_of(kind, data),
    };
    Ok(NumpyArray {
        shape: Vec::new(),
        numbers,
        texts: Vec::new(),
    })
}

/// Numbers of N bytes each; an incomplete last one is ignored.
fn numbers_of<const N: usize>(data: &[u8], number: impl Fn([u8; N]) -> f64) -> Vec<f64> {
    let numbers = data.chunks_exact(N).filter_map(|bytes| bytes.first_chunk());
    numbers.map(|bytes| number(*bytes)).collect()
}

/// Texts of a fixed length, without the zeros at their ends.
fn texts_of(kind: &str, data: &[u8]) -> Result<NumpyArray, String> {
    let unsupported = || {
        format!("unsupported type {kind}; expected numbers (<f4, <f8, integers), booleans or texts")
    };
    let length = |prefix| -> Option<usize> { kind.strip_prefix(prefix)?.parse().ok() };
    let texts: Vec<String> = match (length("<U"), length("|S")) {
        (Some(length @ 1..), _) => {
            let letters = |text: &[u8]| {
                let codes = text.chunks_exact(4).filter_map(|code| code.first_chunk());
                let codes = codes.map(|code| u32::from_le_bytes(*code));
                codes
                    .take_while(|code| *code != 0)
                    .filter_map(char::from_u32)
                    .collect()
            };
            let width = length.checked_mul(4).ok_or_else(unsupported)?;
            data.chunks_exact(width).map(letters).collect()
        }
        (_, Some(length @ 1..)) => {
            let letters = |text: &[u8]| {
                let text = text.iter().take_while(|byte| **byte != 0).copied();
                String::from_utf8_lossy(&text.collect::<Vec<u8>>()).into_owned()
            };
            data.chunks_exact(length).map(letters).collect()
        }
        _ => return Err(unsupported()),
    };
    Ok(NumpyArray {
        shape: Vec::new(),
        numbers: Vec::new(),
        texts,
    })
}

/// Index in Fortran order of each element in C order.
fn c_order(shape: &[usize]) -> Vec<usize> {
    let count = shape.iter().product();
    let fortran_index = |mut index: usize| {
        // From the last axis, which varies fastest in C order.
        let mut indices = vec![0; shape.len()];
        for (axis, length) in shape.iter().enumerate().rev() {
            indices[axis] = index % length;
            index /= length;
        }
        let axes = indices.iter().zip(shape).rev();
        axes.fold(0, |sum, (index, length)| sum * length + index)
    };
    (0..count).map(fortran_index).collect()
}

fn reordered<T: Clone>(elements: &[T], order: &[usize]) -> Vec<T> {
    let elements = order.iter().filter_map(|index| elements.get(*index));
    elements.cloned().collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::parse;

    fn npy(kind: &str, is_fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let header =
            format!("{{'descr': '{kind}', 'fortran_order': {is_fortran}, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn fortran_order_is_read_as_c_order() {
        let data: Vec<u8> = (0..6_i32).flat_map(i32::to_le_bytes).collect();
        let array = parse(&npy("<i4", "True", "(2, 3)", &data)).unwrap();
        assert_eq!(array.shape, [2, 3]);
        assert_eq!(array.numbers, [0.0, 2.0, 4.0, 1.0, 3.0, 5.0]);
    }

    #[test]
    fn texts_end_at_zeros() {
        let array = parse(&npy("|S4", "False", "(2,)", b"male\x61\0\0\0")).unwrap();
        assert_eq!(array.texts, ["male", "a"]);
        let wide: Vec<u8> = "ñb"
            .chars()
            .chain(['\0'])
            .flat_map(|c| u32::from(c).to_le_bytes())
            .collect();
        assert_eq!(
            parse(&npy("<U3", "False", "()", &wide)).unwrap().texts,
            ["ñb"]
        );
    }

    #[test]
    fn damaged_array_is_rejected() {
        let bytes = npy("<f8", "False", "(2,)", &[0; 16]);
        for length in 0..bytes.len() {
            assert!(parse(&bytes[..length]).is_err(), "{length} bytes");
        }
        let object = parse(&npy("|O", "False", "()", b"pickle")).unwrap_err();
        assert!(object.contains("unsupported type |O"), "{object}");
    }
}
