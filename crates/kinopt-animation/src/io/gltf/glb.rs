//! GLB, the binary container of a document and its buffer (glTF 2.0 specification, section 4.4).

use crate::io::{FileLocation, ReadError};

/// First bytes of a GLB file.
const MAGIC: &[u8; 4] = b"glTF";

/// Size of the file header in bytes.
const HEADER_SIZE: usize = 12;
/// Size of a chunk header in bytes.
const CHUNK_HEADER_SIZE: usize = 8;

/// The chunks of a file.
pub(super) struct Chunks<'a> {
    pub(super) json: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
    /// Chunks of other types, which readers must ignore.
    pub(super) others: Vec<([u8; 4], &'a [u8])>,
}

/// Reports whether a file is GLB.
pub(super) fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Splits a GLB file into chunks; other files are JSON text.
pub(super) fn split<'a>(bytes: &'a [u8], name: &str) -> Result<Chunks<'a>, ReadError> {
    if !is_glb(bytes) {
        return Ok(Chunks {
            json: bytes,
            binary: None,
            others: Vec::new(),
        });
    }
    let fail = |offset: usize, problem: String| {
        ReadError::malformed(name, FileLocation::Byte(offset), problem)
    };
    let word = |offset: usize| -> Result<u32, ReadError> {
        let word = bytes
            .get(offset..offset + 4)
            .and_then(|w| <[u8; 4]>::try_from(w).ok());
        word.map(u32::from_le_bytes)
            .ok_or_else(|| fail(offset, "the header is cut off".into()))
    };
    let truncated = |offset: usize, what: &str, needed: usize, available: usize| {
        ReadError::truncated(
            name,
            FileLocation::Byte(offset),
            what.into(),
            needed as u128,
            available,
        )
    };
    let version = word(4)?;
    if version != 2 {
        let problem = format!("is GLB of version {version}; version 2 is read");
        return Err(fail(4, problem));
    }
    let announced = word(8)? as usize;
    let Some(file) = bytes.get(..announced) else {
        let what = "the contents of the GLB file";
        return Err(truncated(8, what, announced, bytes.len()));
    };
    let (mut json, mut binary, mut others, mut offset) = (None, None, Vec::new(), HEADER_SIZE);
    // A tail shorter than a chunk header is padding that some writers add.
    while offset + CHUNK_HEADER_SIZE <= file.len() {
        let (length, kind) = (word(offset)? as usize, word(offset + 4)?);
        let (start, available) = (
            offset + CHUNK_HEADER_SIZE,
            file.len() - offset - CHUNK_HEADER_SIZE,
        );
        let Some(chunk) = file.get(start..start.saturating_add(length)) else {
            return Err(truncated(offset, "a chunk", length, available));
        };
        match &kind.to_le_bytes() {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            kind => others.push((*kind, chunk)),
        }
        offset = start + length;
    }
    let json = json.ok_or_else(|| fail(HEADER_SIZE, "there is no JSON chunk".into()))?;
    Ok(Chunks {
        json,
        binary,
        others,
    })
}

/// A GLB file of a document, a buffer and other chunks; `None` if its length exceeds 32 bits.
pub(super) fn join(json: &[u8], binary: &[u8], others: &[([u8; 4], Vec<u8>)]) -> Option<Vec<u8>> {
    // Chunks end at multiples of four bytes: JSON is padded with spaces, the buffer with zeros.
    let main_chunks = [(*b"JSON", json, b' '), (*b"BIN\0", binary, 0)];
    let main_chunks = main_chunks
        .into_iter()
        .filter(|(_, bytes, _)| !bytes.is_empty());
    let others = others
        .iter()
        .map(|(kind, bytes)| (*kind, bytes.as_slice(), 0));
    let chunks = main_chunks.chain(others);
    let lengths = chunks
        .clone()
        .map(|(_, bytes, _)| CHUNK_HEADER_SIZE + bytes.len().next_multiple_of(4));
    let length = u32::try_from(HEADER_SIZE + lengths.sum::<usize>()).ok()?;
    let mut file = Vec::with_capacity(length as usize);
    file.extend(MAGIC);
    file.extend(2u32.to_le_bytes());
    file.extend(length.to_le_bytes());
    for (kind, bytes, padding) in chunks {
        let padded = bytes.len().next_multiple_of(4);
        // Fits because it is at most the total length.
        file.extend((padded as u32).to_le_bytes());
        file.extend(kind);
        file.extend(bytes);
        file.resize(file.len() + padded - bytes.len(), padding);
    }
    Some(file)
}
