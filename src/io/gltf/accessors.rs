//! Numbers out of buffers: accessors and their sparse parts, each offset checked.

use std::borrow::Cow;
use std::cell::Cell;

use ::gltf::json::accessor::{ComponentType, Type, sparse::Sparse};
use ::gltf::json::buffer::View;
use ::gltf::json::validation::Checked;
use ::gltf::json::{Accessor, Index, Root};

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
    buffers: Vec<Cow<'a, [u8]>>,
    room: Cell<usize>,
}

/// One run of numbers in a buffer.
struct Run<'a> {
    bytes: &'a [u8],
    stride: usize,
    component: ComponentType,
    normalized: bool,
}

/// The entries that differ from zero or from the accessor's buffer view.
struct SparseRuns<'a> {
    count: usize,
    indices: Run<'a>,
    values: Run<'a>,
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

    /// The entries of an accessor that are not zero, by place. Those that a sparse accessor without
    /// a buffer view lists are given even where they are zero.
    pub(super) fn deltas<T: Clone>(
        &self,
        index: Index<Accessor>,
        count: usize,
        user: &str,
        of: impl Fn([f64; 3]) -> T,
    ) -> Result<Vec<(u32, T)>, ReadError> {
        let path = format!("accessors[{}]", index.value());
        let given = self.count(index, user)?;
        if given != count {
            let problem = format!("{user}: {given} entries for {count} vertices");
            return Err(self.fail(path, problem));
        }
        match (
            self.base::<3>(index, count, user)?,
            self.sparse::<3>(index, user)?,
        ) {
            (None, Some(sparse)) => {
                self.charge::<(u32, T)>(sparse.count, &path)?;
                let places = self.places(&sparse, count, &path, user)?.into_iter();
                let entries = places
                    .zip(0..)
                    .map(|(place, entry)| (place, of(sparse.values.entry(entry))));
                Ok(entries.collect())
            }
            (None, None) => Ok(Vec::new()),
            (Some(_), _) => {
                let all = self.read(index, user, |entry: [f64; 3]| entry)?;
                let moved = (0..).zip(all).filter(|(_, entry)| *entry != [0.0; 3]);
                Ok(moved.map(|(place, entry)| (place, of(entry))).collect())
            }
        }
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

    fn accessor(&self, index: Index<Accessor>, user: &str) -> Result<&'a Accessor, ReadError> {
        let accessors = &self.root.accessors;
        accessors.get(index.value()).ok_or_else(|| {
            let path = format!("accessors[{}]", index.value());
            let problem = format!("{user}: does not exist; there are {}", accessors.len());
            self.fail(path, problem)
        })
    }

    /// The numbers that an accessor's buffer view holds; `None` where it has none.
    fn base<const N: usize>(
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

    fn component(
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

    fn sparse<const N: usize>(
        &self,
        index: Index<Accessor>,
        user: &str,
    ) -> Result<Option<SparseRuns<'_>>, ReadError> {
        let accessor = self.accessor(index, user)?;
        let Some(Sparse {
            count,
            indices,
            values,
            ..
        }) = &accessor.sparse
        else {
            return Ok(None);
        };
        let at = |key: &str| format!("accessors[{}].sparse.{key}", index.value());
        let count = usize::try_from(count.0).ok().filter(|&count| count > 0);
        let count = count.ok_or_else(|| self.fail(at("count"), format!("{user}: is no count")))?;
        let Checked::Valid(kind) = indices.component_type else {
            let problem = format!("{user}: is none of 5121, 5123 and 5125");
            return Err(self.fail(at("indices.componentType"), problem));
        };
        let (view, offset) = (indices.buffer_view, indices.byte_offset.0);
        let path = at("indices.bufferView");
        let indices = self.run::<1>(view, offset, count, kind.0, &path, user)?;
        let component = self.component(accessor, index, user)?;
        let (view, offset) = (values.buffer_view, values.byte_offset.0);
        let path = at("values.bufferView");
        let mut values = self.run::<N>(view, offset, count, component, &path, user)?;
        values.normalized = accessor.normalized;
        Ok(Some(SparseRuns {
            count,
            indices,
            values,
        }))
    }

    /// Which entries a sparse accessor lists: rising, below `count`.
    fn places(
        &self,
        sparse: &SparseRuns<'_>,
        count: usize,
        path: &str,
        user: &str,
    ) -> Result<Vec<u32>, ReadError> {
        self.charge::<u32>(sparse.count, path)?;
        let places = (0..sparse.count).map(|entry| sparse.indices.entry::<1>(entry)[0] as u32);
        let places: Vec<u32> = places.collect();
        let rise = places.windows(2).all(|pair| pair[0] < pair[1]);
        if !rise || places.last().is_some_and(|&last| last as usize >= count) {
            let problem = format!("{user}: do not rise, or are beyond the {count} entries");
            return Err(self.fail(format!("{path}.sparse.indices"), problem));
        }
        Ok(places)
    }

    /// The bytes of `count` entries, wherever the view puts them.
    fn run<const N: usize>(
        &self,
        view: Index<View>,
        offset: u64,
        count: usize,
        component: ComponentType,
        path: &str,
        user: &str,
    ) -> Result<Run<'_>, ReadError> {
        let views = &self.root.buffer_views;
        let own = views.get(view.value()).ok_or_else(|| {
            let problem = format!(
                "{user}: view {} of {} does not exist",
                view.value(),
                views.len()
            );
            self.fail(path, problem)
        })?;
        let at = |key: &str| format!("bufferViews[{}].{key}", view.value());
        let buffer = self.buffers.get(own.buffer.value()).ok_or_else(|| {
            let buffers = self.buffers.len();
            let problem = format!(
                "{user}: buffer {} of {buffers} does not exist",
                own.buffer.value()
            );
            self.fail(at("buffer"), problem)
        })?;
        let start = own.byte_offset.map_or(0, |offset| offset.0);
        let viewed = slice(buffer, start, u128::from(own.byte_length.0)).ok_or_else(|| {
            let needed = u128::from(start) + u128::from(own.byte_length.0);
            let what = format!("{user}: the view's bytes");
            let place = Place::Json(at("byteLength"));
            ReadError::truncated(self.name, place, what, needed, buffer.len())
        })?;
        let size = N * component.size();
        let stride = own.byte_stride.map_or(size, |stride| stride.0);
        if stride < size {
            let problem = format!("{user}: {stride} is less than the {size} bytes of an entry");
            return Err(self.fail(at("byteStride"), problem));
        }
        let needed = (count as u128 - 1) * stride as u128 + size as u128;
        let bytes = slice(viewed, offset, needed).ok_or_else(|| {
            let what = format!("{user}: {count} entries from byte {offset} of the view");
            ReadError::truncated(
                self.name,
                Place::Json(path.into()),
                what,
                needed,
                viewed.len(),
            )
        })?;
        Ok(Run {
            bytes,
            stride,
            component,
            normalized: false,
        })
    }
}

fn slice(bytes: &[u8], start: u64, length: u128) -> Option<&[u8]> {
    let end = usize::try_from(u128::from(start).checked_add(length)?).ok()?;
    bytes.get(usize::try_from(start).ok()?..end)
}

impl Run<'_> {
    fn entry<const N: usize>(&self, index: usize) -> [f64; N] {
        let size = self.component.size();
        std::array::from_fn(|place| {
            let start = index * self.stride + place * size;
            let bytes = self.bytes.get(start..start + size).unwrap_or(&[0; 4]);
            self.number(bytes)
        })
    }

    fn number(&self, bytes: &[u8]) -> f64 {
        let [a, b, c, d] = std::array::from_fn(|at| bytes.get(at).copied().unwrap_or(0));
        let (short, word) = ([a, b], [a, b, c, d]);
        let (number, most) = match self.component {
            ComponentType::I8 => (f64::from(a as i8), 127.0),
            ComponentType::U8 => (f64::from(a), 255.0),
            ComponentType::I16 => (f64::from(i16::from_le_bytes(short)), 32767.0),
            ComponentType::U16 => (f64::from(u16::from_le_bytes(short)), 65535.0),
            ComponentType::U32 => (f64::from(u32::from_le_bytes(word)), f64::from(u32::MAX)),
            ComponentType::F32 => return f64::from(f32::from_le_bytes(word)),
        };
        match self.normalized {
            // Section 3.6.2.2: the lowest signed integer stands for −1 as well.
            true => (number / most).max(-1.0),
            false => number,
        }
    }
}
