//! Writer of NumPy's .npy and .npz files.
//!
//! A .npy file has a magic string, a version, a header (a Python dictionary in ASCII) and the numbers ("NumPy
//! Enhancement Proposal 1"). A .npz file is a ZIP archive of .npy files, here uncompressed.

use std::io::{Cursor, Write};

use zip::CompressionMethod;
use zip::write::{SimpleFileOptions, ZipWriter};

const MAGIC: &[u8] = b"\x93NUMPY";
/// Alignment of the numbers, in bytes.
const HEADER_ALIGNMENT: usize = 64;

/// Array of a .npz file.
#[derive(Clone, Copy, Debug)]
pub enum Column<'a> {
    /// Double precision.
    Numbers(&'a [f64]),
    /// Booleans.
    Flags(&'a [bool]),
    /// Texts.
    Words(&'a [String]),
}

/// Bytes of a .npz file with arrays by name, each with the lengths of its axes.
///
/// # Errors
/// The errors of the ZIP archive, which exceed no limit for arrays in memory.
pub fn npz(arrays: &[(&str, &[usize], Column<'_>)]) -> std::io::Result<Vec<u8>> {
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

/// Bytes of a .npy file with the lengths of its axes.
pub fn npy(shape: &[usize], column: &Column<'_>) -> Vec<u8> {
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
