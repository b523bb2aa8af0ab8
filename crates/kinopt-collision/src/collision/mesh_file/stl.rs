//! STL reader, binary and text. Vertices at the same position are merged; normals are ignored.

use super::{MeshFile, Points, text};
use kinopt_kinematics::file::{FileLocation, ReadError};

const HEADER_LENGTH: usize = 84;
const TRIANGLE_LENGTH: usize = 50;

pub(super) fn parse(bytes: &[u8], file: &str) -> Result<MeshFile, ReadError> {
    // The length decides first, since many binary files begin with `solid` too.
    let announced = bytes.get(80..HEADER_LENGTH).map(|count| {
        let count = count
            .iter()
            .rev()
            .fold(0_u64, |n, b| n << 8 | u64::from(*b));
        (count, HEADER_LENGTH as u64 + count * TRIANGLE_LENGTH as u64)
    });
    match announced {
        Some((_, length)) if length == bytes.len() as u64 => binary(bytes, file),
        _ if is_text(bytes) => ascii(bytes, file),
        Some((_, length)) if length < bytes.len() as u64 => binary(bytes, file),
        Some((count, length)) => Err(ReadError::truncated(
            file,
            FileLocation::File,
            format!("{count} triangles"),
            u128::from(length - HEADER_LENGTH as u64),
            bytes.len() - HEADER_LENGTH,
        )),
        None => Err(ReadError::of_file(
            file,
            "is not an STL file: it must begin with `solid` or a header of 84 bytes",
        )),
    }
}

fn is_text(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(b"solid") && !bytes.contains(&0)
}

fn binary(bytes: &[u8], file: &str) -> Result<MeshFile, ReadError> {
    let count = bytes[80..HEADER_LENGTH].iter().rev();
    let count = count.fold(0_usize, |n, b| n << 8 | usize::from(*b));
    let mut points = Points::default();
    let mut triangles = Vec::with_capacity(count);
    for (index, record) in bytes[HEADER_LENGTH..]
        .chunks_exact(TRIANGLE_LENGTH)
        .take(count)
        .enumerate()
    {
        let number = |offset: usize| {
            let four = [
                record[offset],
                record[offset + 1],
                record[offset + 2],
                record[offset + 3],
            ];
            f64::from(f32::from_le_bytes(four))
        };
        let corner = |k: usize| [0, 4, 8].map(|part| number(12 * k + part));
        let corners = [1, 2, 3].map(corner);
        if corners.iter().flatten().any(|x| !x.is_finite()) {
            let location = FileLocation::Element("triangle", index);
            return Err(ReadError::malformed(
                file,
                location,
                "has a corner that is not finite",
            ));
        }
        triangles.push(corners.map(|corner| points.index_of(corner)));
    }
    Ok(MeshFile {
        points: points.points,
        triangles,
    })
}

fn ascii(bytes: &[u8], file: &str) -> Result<MeshFile, ReadError> {
    let mut points = Points::default();
    let mut triangles = Vec::new();
    let mut corners: Vec<u32> = Vec::new();
    for (number, line) in text::of(bytes, file)?.lines().enumerate() {
        let fail =
            |problem: &str| ReadError::malformed(file, FileLocation::Line(number + 1), problem);
        let mut words = line.split_whitespace();
        match words.next() {
            Some("vertex") => {
                let point = text::three(&mut words)
                    .ok_or_else(|| fail("a corner needs three finite numbers"))?;
                corners.push(points.index_of(point));
            }
            Some("endloop") => match *corners.as_slice() {
                [a, b, c] => {
                    triangles.push([a, b, c]);
                    corners.clear();
                }
                _ => return Err(fail("a loop of other than three corners")),
            },
            _ => {}
        }
    }
    if !corners.is_empty() {
        return Err(ReadError::of_file(file, "ends within a triangle"));
    }
    Ok(MeshFile {
        points: points.points,
        triangles,
    })
}
