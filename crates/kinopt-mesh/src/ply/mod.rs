//! PLY meshes: ASCII and binary, in both byte orders.
//!
//! The crate `ply-rs-bw` parses. Counts that the file cannot hold, entries without properties and repeated declarations
//! pass its header check and are rejected here before the payload is read.
//!
//! A mesh needs two elements. `vertex` has properties `x y z` of type `float` or `double`, and optionally `nx ny nz`.
//! `face` has a list `vertex_indices` or `vertex_index`. Polygons are split into fans. Other elements and properties
//! are skipped.

mod elements;
mod header;

use std::path::Path;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyAccess};

use self::elements::{Face, Skipped, Vertex};
use crate::mesh::TriangleMesh;
use kinopt_kinematics::file::{FileLocation, MAX_FILE_BYTES, ReadError, WriteError, read_with};
use kinopt_kinematics::file_replacement::write_file;

/// Encoding of the numbers of a PLY file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlyEncoding {
    /// Decimal numbers, with as many digits as an exact round trip needs.
    Ascii,
    /// Binary, least significant byte first.
    BinaryLittleEndian,
    /// Binary, most significant byte first.
    BinaryBigEndian,
}

/// Reads a mesh from the bytes of a PLY file. `name` is the file name for messages.
///
/// # Errors
/// A [`ReadError`] with the line, byte offset or face. Causes are a malformed header, a wrong amount of data, a number
/// that is not finite in single precision, or an index out of range.
pub fn from_bytes(bytes: &[u8], name: &str) -> Result<TriangleMesh, ReadError> {
    let mut source = PlySource {
        reader: Reader::new(bytes),
        length: bytes.len(),
        binary: false,
        name,
    };
    let header = Parser::<Skipped>::new().read_header(&mut source.reader);
    let header = header.map_err(|error| source.fail(&error))?;
    let body = source.offset();
    header::check(&header, bytes.get(..body).unwrap_or(bytes), name)?;
    source.binary = header.encoding != Encoding::Ascii;

    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for element in header.elements.values() {
        header::check_count(&header, element, bytes.len() - source.offset(), name)?;
        match element.name.as_str() {
            "vertex" => vertices = source.entries::<Vertex>(&header, element)?,
            "face" => faces = source.entries::<Face>(&header, element)?,
            _ => drop(source.entries::<Skipped>(&header, element)?),
        }
    }
    source.expect_end()?;
    let with_normals = header::has_normals(&header);
    assemble(&vertices, &faces, with_normals, name)
}

/// Reads a PLY file of at most 2 GiB.
///
/// # Errors
/// As [`from_bytes`], and a file that cannot be opened.
pub fn read(path: impl AsRef<Path>) -> Result<TriangleMesh, ReadError> {
    read_with(path.as_ref(), MAX_FILE_BYTES, from_bytes)
}

/// The mesh as a PLY file: `float` coordinates, normals if there are any, `uint` indices.
#[must_use]
pub fn to_bytes(mesh: &TriangleMesh, encoding: PlyEncoding) -> Vec<u8> {
    let format = match encoding {
        PlyEncoding::Ascii => "ascii",
        PlyEncoding::BinaryLittleEndian => "binary_little_endian",
        PlyEncoding::BinaryBigEndian => "binary_big_endian",
    };
    let mut bytes = format!(
        "ply\nformat {format} 1.0\nelement vertex {}\n",
        mesh.positions().len()
    )
    .into_bytes();
    let normals: &[&str] = &["nx", "ny", "nz"];
    let normals = if mesh.normals().is_empty() {
        &[]
    } else {
        normals
    };
    for property in ["x", "y", "z"].iter().chain(normals) {
        bytes.extend_from_slice(format!("property float {property}\n").as_bytes());
    }
    let faces = mesh.triangles().len();
    bytes.extend_from_slice(
        format!("element face {faces}\nproperty list uchar uint vertex_indices\nend_header\n")
            .as_bytes(),
    );
    for (vertex, p) in mesh.positions().iter().enumerate() {
        let normal = mesh.normals().get(vertex).map(|n| n.to_array());
        let values = p.to_array().into_iter().chain(normal.into_iter().flatten());
        put_entry(
            &mut bytes,
            values,
            encoding,
            f32::to_le_bytes,
            f32::to_be_bytes,
        );
    }
    for &triangle in mesh.triangles() {
        match encoding {
            PlyEncoding::Ascii => bytes.extend_from_slice(b"3 "),
            _ => bytes.push(3),
        }
        put_entry(
            &mut bytes,
            triangle.into_iter(),
            encoding,
            u32::to_le_bytes,
            u32::to_be_bytes,
        );
    }
    bytes
}

/// Writes [`to_bytes`] to a file.
///
/// # Errors
/// A [`WriteError`] that names the file.
pub fn write(
    mesh: &TriangleMesh,
    encoding: PlyEncoding,
    path: impl AsRef<Path>,
) -> Result<(), WriteError> {
    write_file(path.as_ref(), &to_bytes(mesh, encoding))
}

fn put_entry<T: Copy + std::fmt::Display>(
    bytes: &mut Vec<u8>,
    values: impl Iterator<Item = T>,
    encoding: PlyEncoding,
    to_little_endian: impl Fn(T) -> [u8; 4],
    to_big_endian: impl Fn(T) -> [u8; 4],
) {
    match encoding {
        PlyEncoding::BinaryLittleEndian => {
            values.for_each(|v| bytes.extend_from_slice(&to_little_endian(v)))
        }
        PlyEncoding::BinaryBigEndian => {
            values.for_each(|v| bytes.extend_from_slice(&to_big_endian(v)))
        }
        PlyEncoding::Ascii => {
            let words: Vec<String> = values.map(|v| v.to_string()).collect();
            bytes.extend_from_slice(words.join(" ").as_bytes());
            bytes.push(b'\n');
        }
    }
}

fn assemble(
    vertices: &[Vertex],
    faces: &[Face],
    with_normals: bool,
    name: &str,
) -> Result<TriangleMesh, ReadError> {
    let positions = vertices.iter().map(Vertex::position).collect();
    let normals = if with_normals {
        vertices.iter().map(Vertex::normal).collect()
    } else {
        Vec::new()
    };
    let mut triangles = Vec::new();
    for (index, face) in faces.iter().enumerate() {
        face.cut_into_fan(vertices.len(), &mut triangles)
            .map_err(|problem| {
                ReadError::malformed(name, FileLocation::Element("face", index), problem)
            })?;
    }
    TriangleMesh::new(positions, normals, triangles)
        .map_err(|error| ReadError::new(name, FileLocation::File, error))
}

/// The bytes that are parsed, with data for messages.
struct PlySource<'a> {
    reader: Reader<&'a [u8]>,
    length: usize,
    binary: bool,
    name: &'a str,
}

impl PlySource<'_> {
    fn offset(&self) -> usize {
        self.length - self.reader.get_ref().len()
    }

    fn entries<E: PropertyAccess>(
        &mut self,
        header: &Header,
        element: &ElementDef,
    ) -> Result<Vec<E>, ReadError> {
        Parser::<E>::new()
            .read_payload_for_element(&mut self.reader, element, header)
            .map_err(|error| self.fail(&error))
    }

    /// Checks that no data follow the last entry, which would indicate a wrong count.
    fn expect_end(&self) -> Result<(), ReadError> {
        let rest = self.reader.get_ref();
        if rest.is_empty() || (!self.binary && rest.iter().all(u8::is_ascii_whitespace)) {
            return Ok(());
        }
        let problem = format!("{} bytes are left after the last entry", rest.len());
        let location = FileLocation::Byte(self.offset());
        Err(ReadError::malformed(self.name, location, problem))
    }

    fn fail(&self, error: &ParseError) -> ReadError {
        let location = match error.line() {
            // The parser counts binary entries as lines, which is no useful position.
            Some(line) if !self.binary => FileLocation::Line(line),
            _ => FileLocation::Byte(self.offset()),
        };
        // The parser's messages quote lines of the file, and some end with internals of its grammar.
        let text = error.to_string();
        let text = text.split("Error: ParseError").next().unwrap_or(&text);
        let text = text
            .split_once(": ")
            .filter(|_| error.line().is_some())
            .map_or(text, |t| t.1);
        let words: Vec<&str> = text.split_whitespace().collect();
        let short: String = words.join(" ").chars().take(200).collect();
        ReadError::malformed(self.name, location, short)
    }
}
