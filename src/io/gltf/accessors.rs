//! Numbers out of buffers: accessors and their sparse parts, each offset checked.

use std::borrow::Cow;
use std::cell::Cell;

use ::gltf::json::accessor::{ComponentType, Type};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Accessor, Index, Root};

use super::run::Run;
use crate::io::{Place, ReadError};

/// What a byte of the file may decode to. Accessors may share bytes, or have none where they are
/// all zeros; without a limit a short file could ask for any amount of memory.
const GROWTH: usize = 256;
/// What a file may decode to however short it is.
const LEAST_ROOM: usize = 1 << 18;

/// A document with its buffers.
pub(super) struct Source<'a> {
    pub(super) name: &'a str,
    pub(super) root: &'a Root,
    pub(super) buffers: Vec<Cow<'a, [u8]>>,
    room: Cell<usize>,
}

impl<'a> Source<'a> {
    pub(super) fn new(
        name: &'a str,
        root: &'a Root,
        json_length: usize,
        buffers: Vec<Cow<'a, [u8]>>,
    ) -> Self {
        let bytes = buffers.iter().map(|buffer| buffer.len()).sum::<usize>();
        let room = bytes.saturating_add(json_length).saturating_mul(GROWTH);
        Self {
            name,
            root,
            buffers,
            room: Cell::new(room.saturating_add(LEAST_ROOM)),
        }
    }

    pub(super) fn fail(&self, path: impl Into<String>, problem: impl Into<String>) -> ReadError {
        ReadError::malformed(self.name, Place::Json(path.into()), problem)
    }

    /// Takes so many entries of type `T` out of what the file may decode to.
    pub(super) fn charge<T>(&self, count: usize, path: &str) -> Result<(), ReadError> {
        let bytes = count.checked_mul(size_of::<T>());
        let left = bytes.and_then(|bytes| self.room.get().checked_sub(bytes));
        left.map(|left| self.room.set(left)).ok_or_else(|| {
            let problem = "it would take memory out of proportion to the file";
            self.fail(path, problem)
        })
    }

    /// How many entries an accessor has. `user` says who asks, for messages.
    pub(super) fn count(&self, index: Index<Accessor>, user: &str) -> Result<usize, ReadError> {
        let accessor = self.accessor(index, user)?;
        match usize::try_from(accessor.count.0) {
            Ok(count) if count > 0 => Ok(count),
            _ => {
                let path = format!("accessors[{}].count", index.value());
                let problem = format!("{user}: {} is no count of entries", accessor.count.0);
                Err(self.fail(path, problem))
            }
        }
    }

    /// All entries of an accessor with N numbers in each: its integers as they are, or as fractions
    /// where it is normalised.
    pub(super) fn read<const N: usize, T: Clone>(
        &self,
        index: Index<Accessor>,
        user: &str,
        of: impl Fn([f64; N]) -> T,
    ) -> Result<Vec<T>, ReadError> {
        let count = self.count(index, user)?;
        let path = format!("accessors[{}]", index.value());
        self.charge::<T>(count, &path)?;
        let mut values = match self.base::<N>(index, count, user)? {
            Some(run) => (0..count).map(|entry| of(run.entry(entry))).collect(),
            None => vec![of([0.0; N]); count],
        };
        if let Some(sparse) = self.sparse::<N>(index, user)? {
            for (place, entry) in self
                .places(&sparse, count, &path, user)?
                .into_iter()
                .zip(0..)
            {
                if let Some(value) = values.get_mut(place as usize) {
                    *value = of(sparse.values.entry(entry));
                }
            }
        }
        Ok(values)
    }

    /// All entries of an accessor of whole numbers.
    pub(super) fn read_indices<const N: usize>(
        &self,
        index: Index<Accessor>,
        user: &str,
    ) -> Result<Vec<[u32; N]>, ReadError> {
        let accessor = self.accessor(index, user)?;
        let whole = matches!(
            accessor.component_type,
            Checked::Valid(kind)
                if matches!(kind.0, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
        );
        if !whole || accessor.normalized {
            let path = format!("accessors[{}].componentType", index.value());
            return Err(self.fail(path, format!("{user}: these are no whole numbers from 0")));
        }
        self.read(index, user, |entry: [f64; N]| {
            entry.map(|number| number as u32)
        })
    }

    pub(super) fn accessor(
        &self,
        index: Index<Accessor>,
        user: &str,
    ) -> Result<&'a Accessor, ReadError> {
        let accessors = &self.root.accessors;
        accessors.get(index.value()).ok_or_else(|| {
            let path = format!("accessors[{}]", index.value());
            let problem = format!("{user}: does not exist; there are {}", accessors.len());
            self.fail(path, problem)
        })
    }

    /// The numbers that an accessor's buffer view holds; `None` where it has none.
    pub(super) fn base<const N: usize>(
        &self,
        index: Index<Accessor>,
        count: usize,
        user: &str,
    ) -> Result<Option<Run<'_>>, ReadError> {
        let accessor = self.accessor(index, user)?;
        let at = |key: &str| format!("accessors[{}].{key}", index.value());
        let fits = match accessor.type_ {
            Checked::Valid(Type::Scalar) => N == 1,
            Checked::Valid(Type::Vec2) => N == 2,
            Checked::Valid(Type::Vec3) => N == 3,
            Checked::Valid(Type::Vec4) => N == 4,
            Checked::Valid(Type::Mat4) => N == 16,
            _ => false,
        };
        if !fits {
            let problem = format!("{user}: needs {N} numbers in each entry");
            return Err(self.fail(at("type"), problem));
        }
        let component = self.component(accessor, index, user)?;
        let Some(view) = accessor.buffer_view else {
            return Ok(None);
        };
        let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
        let mut run = self.run::<N>(view, offset, count, component, &at("bufferView"), user)?;
        run.normalized = accessor.normalized;
        Ok(Some(run))
    }

    pub(super) fn component(
        &self,
        accessor: &Accessor,
        index: Index<Accessor>,
        user: &str,
    ) -> Result<ComponentType, ReadError> {
        match accessor.component_type {
            Checked::Valid(kind) => Ok(kind.0),
            Checked::Invalid => {
                let path = format!("accessors[{}].componentType", index.value());
                Err(self.fail(
                    path,
                    format!("{user}: is none of 5120 to 5123, 5125 and 5126"),
                ))
            }
        }
    }
}
