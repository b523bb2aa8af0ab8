//! The buffer of decoded bytes.

use gltf_json::Index;
use gltf_json::buffer::{Buffer, View};
use gltf_json::validation::USize64;

use crate::io::{FileLocation, ReadError};

/// Decoded bytes of a file, in one buffer after those of the file.
pub(super) struct DecodedBuffer<'a> {
    name: &'a str,
    index: usize,
    bytes: Vec<u8>,
    limit: usize,
}

impl<'a> DecodedBuffer<'a> {
    /// An empty buffer of `index` that grows up to `limit` bytes.
    pub(super) fn new(name: &'a str, index: usize, limit: usize) -> Self {
        Self {
            name,
            index,
            bytes: Vec::new(),
            limit,
        }
    }

    pub(super) fn fail(&self, path: &str, problem: impl Into<String>) -> ReadError {
        ReadError::malformed(self.name, FileLocation::Json(path.into()), problem)
    }

    /// Number of bytes that may still be decoded.
    pub(super) fn remaining(&self) -> usize {
        self.limit - self.bytes.len()
    }

    /// Appends `length` zero bytes and returns their offset.
    pub(super) fn reserve(&mut self, length: usize, path: &str) -> Result<usize, ReadError> {
        if length > self.remaining() {
            let problem = "it would take memory out of proportion to the file";
            return Err(self.fail(path, problem));
        }
        let offset = self.bytes.len();
        self.bytes.resize(offset + length, 0);
        Ok(offset)
    }

    /// The bytes from `offset`.
    pub(super) fn bytes_from(&mut self, offset: usize) -> &mut [u8] {
        self.bytes.get_mut(offset..).unwrap_or_default()
    }

    /// Makes `view` refer to all bytes from `offset`.
    pub(super) fn place(&self, view: &mut View, offset: usize) {
        view.buffer = Index::<Buffer>::new(self.index as u32);
        view.byte_offset = Some(USize64(offset as u64));
        view.byte_length = USize64((self.bytes.len() - offset) as u64);
    }

    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

/// A byte range of a buffer; an error if it exceeds the buffer.
pub(super) fn slice(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    let end = start.checked_add(usize::try_from(length).ok()?)?;
    bytes.get(start..end)
}
