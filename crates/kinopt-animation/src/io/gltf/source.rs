//! A document with its buffers, and the limit of its decoded size.

use std::borrow::Cow;
use std::cell::Cell;

use gltf_json::Root;

use super::compression::Undecoded;
use crate::io::{FileLocation, ReadError};

/// Largest decoded size per byte of the file. Accessors may share bytes or have none, so a short file could otherwise
/// need any amount of memory.
const MAX_BYTES_PER_FILE_BYTE: usize = 256;
/// Smallest limit of the decoded size, bytes.
const MIN_MEMORY_LIMIT: usize = 1 << 18;

/// A document with its buffers.
pub(super) struct GltfSource<'a> {
    pub(super) name: &'a str,
    pub(super) root: &'a Root,
    pub(super) buffers: Vec<Cow<'a, [u8]>>,
    /// Primitives that are left out because they cannot be decoded.
    pub(super) undecoded: Undecoded,
    memory_left: Cell<usize>,
}

/// Largest decoded size of a file, bytes.
pub(super) fn memory_limit(json_length: usize, buffers: &[Cow<'_, [u8]>]) -> usize {
    let bytes = buffers.iter().map(|buffer| buffer.len()).sum::<usize>();
    bytes
        .saturating_add(json_length)
        .saturating_mul(MAX_BYTES_PER_FILE_BYTE)
        .saturating_add(MIN_MEMORY_LIMIT)
}

impl<'a> GltfSource<'a> {
    pub(super) fn new(
        name: &'a str,
        root: &'a Root,
        buffers: Vec<Cow<'a, [u8]>>,
        undecoded: Undecoded,
        memory_limit: usize,
    ) -> Self {
        Self {
            name,
            root,
            buffers,
            undecoded,
            memory_left: Cell::new(memory_limit),
        }
    }

    pub(super) fn fail(&self, path: impl Into<String>, problem: impl Into<String>) -> ReadError {
        ReadError::malformed(self.name, FileLocation::Json(path.into()), problem)
    }

    /// An entry of one of the document's lists. `user` names its user in messages.
    pub(super) fn entry<T>(
        &self,
        entries: &'a [T],
        (list, index): (&str, usize),
        user: Option<&str>,
    ) -> Result<&'a T, ReadError> {
        entries.get(index).ok_or_else(|| {
            let user = user.map_or_else(String::new, |user| format!("{user}: "));
            let problem = format!("{user}does not exist; there are {}", entries.len());
            self.fail(format!("{list}[{index}]"), problem)
        })
    }

    /// Subtracts `count` entries of type `T` from the remaining decoded size.
    pub(super) fn charge<T>(&self, count: usize, path: &str) -> Result<(), ReadError> {
        let bytes = count.checked_mul(size_of::<T>());
        let remaining = bytes.and_then(|bytes| self.memory_left.get().checked_sub(bytes));
        remaining
            .map(|remaining| self.memory_left.set(remaining))
            .ok_or_else(|| {
                let problem = "it would take memory out of proportion to the file";
                self.fail(path, problem)
            })
    }
}
