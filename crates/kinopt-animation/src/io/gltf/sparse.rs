//! Sparse accessors: entries that differ from zero or from a buffer view.

use gltf_json::accessor::sparse::Sparse;
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index};

use super::accessor_view::AccessorView;
use super::source::GltfSource;
use crate::io::ReadError;

/// Indices and values of a sparse accessor.
pub(super) struct SparseViews<'a> {
    count: usize,
    indices: AccessorView<'a>,
    pub(super) values: AccessorView<'a>,
}

impl GltfSource<'_> {
    /// The non-zero entries of an accessor, with their indices. A sparse accessor without a buffer view gives all
    /// entries that it lists, including zeros.
    pub(super) fn deltas<T: Clone>(
        &self,
        index: Index<Accessor>,
        count: usize,
        user: &str,
        convert: impl Fn([f64; 3]) -> T,
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
                let indices = self
                    .sparse_indices(&sparse, count, &path, user)?
                    .into_iter();
                let entries = indices
                    .zip(0..)
                    .map(|(vertex, entry)| (vertex, convert(sparse.values.entry(entry))));
                Ok(entries.collect())
            }
            (None, None) => Ok(Vec::new()),
            (Some(_), _) => {
                let dense = self.read(index, user, |entry: [f64; 3]| entry)?;
                let changed = (0..).zip(dense).filter(|(_, entry)| *entry != [0.0; 3]);
                Ok(changed
                    .map(|(vertex, entry)| (vertex, convert(entry)))
                    .collect())
            }
        }
    }

    pub(super) fn sparse<const N: usize>(
        &self,
        index: Index<Accessor>,
        user: &str,
    ) -> Result<Option<SparseViews<'_>>, ReadError> {
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
        let key_path = |key: &str| format!("accessors[{}].sparse.{key}", index.value());
        let count = usize::try_from(count.0).ok().filter(|&count| count > 0);
        let count = count.ok_or_else(|| {
            self.fail(
                key_path("count"),
                format!("{user}: must be a number above 0"),
            )
        })?;
        let Checked::Valid(kind) = indices.component_type else {
            let problem = format!("{user}: must be one of 5121, 5123, 5125");
            return Err(self.fail(key_path("indices.componentType"), problem));
        };
        let (view, offset) = (indices.buffer_view, indices.byte_offset.0);
        let path = key_path("indices.bufferView");
        let indices = self.accessor_view::<1>(view, offset, count, kind.0, &path, user)?;
        let component = self.component(accessor, index, user)?;
        let (view, offset) = (values.buffer_view, values.byte_offset.0);
        let path = key_path("values.bufferView");
        let mut values = self.accessor_view::<N>(view, offset, count, component, &path, user)?;
        values.normalized = accessor.normalized;
        Ok(Some(SparseViews {
            count,
            indices,
            values,
        }))
    }

    /// Indices of the entries that a sparse accessor lists: ascending, below `count`.
    pub(super) fn sparse_indices(
        &self,
        sparse: &SparseViews<'_>,
        count: usize,
        path: &str,
        user: &str,
    ) -> Result<Vec<u32>, ReadError> {
        self.charge::<u32>(sparse.count, path)?;
        let indices = (0..sparse.count).map(|entry| sparse.indices.entry::<1>(entry)[0] as u32);
        let indices: Vec<u32> = indices.collect();
        let is_increasing = indices.windows(2).all(|pair| pair[0] < pair[1]);
        if !is_increasing || indices.last().is_some_and(|&last| last as usize >= count) {
            let problem = format!("{user}: must increase and be below the {count} entries");
            return Err(self.fail(format!("{path}.sparse.indices"), problem));
        }
        Ok(indices)
    }
}
