//! Accessors and their sparse parts, with checked offsets.

use gltf_json::accessor::{ComponentType, Type};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index};

use super::accessor_view::AccessorView;
use super::source::GltfSource;
use crate::io::ReadError;

impl<'a> GltfSource<'a> {
    /// Number of entries of an accessor. `user` names its user in messages.
    pub(super) fn count(&self, index: Index<Accessor>, user: &str) -> Result<usize, ReadError> {
        let accessor = self.accessor(index, user)?;
        match usize::try_from(accessor.count.0) {
            Ok(count) if count > 0 => Ok(count),
            _ => {
                let path = format!("accessors[{}].count", index.value());
                let problem = format!(
                    "{user}: the number of entries {} must be above 0",
                    accessor.count.0
                );
                Err(self.fail(path, problem))
            }
        }
    }

    /// All entries of an accessor with `N` numbers each. Normalised integers become fractions; other integers keep
    /// their values.
    pub(super) fn read<const N: usize, T: Clone>(
        &self,
        index: Index<Accessor>,
        user: &str,
        convert: impl Fn([f64; N]) -> T,
    ) -> Result<Vec<T>, ReadError> {
        let count = self.count(index, user)?;
        let path = format!("accessors[{}]", index.value());
        self.charge::<T>(count, &path)?;
        let mut values = match self.base::<N>(index, count, user)? {
            Some(view) => (0..count).map(|entry| convert(view.entry(entry))).collect(),
            None => vec![convert([0.0; N]); count],
        };
        if let Some(sparse) = self.sparse::<N>(index, user)? {
            let indices = self.sparse_indices(&sparse, count, &path, user)?;
            for (entry_index, entry) in indices.into_iter().zip(0..) {
                if let Some(value) = values.get_mut(entry_index as usize) {
                    *value = convert(sparse.values.entry(entry));
                }
            }
        }
        Ok(values)
    }

    /// All entries of an accessor of unsigned integers.
    pub(super) fn read_indices<const N: usize>(
        &self,
        index: Index<Accessor>,
        user: &str,
    ) -> Result<Vec<[u32; N]>, ReadError> {
        let accessor = self.accessor(index, user)?;
        let is_unsigned = matches!(
            accessor.component_type,
            Checked::Valid(kind)
                if matches!(kind.0, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
        );
        if !is_unsigned || accessor.normalized {
            let path = format!("accessors[{}].componentType", index.value());
            return Err(self.fail(path, format!("{user}: these are not unsigned integers")));
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
        self.entry(
            &self.root.accessors,
            ("accessors", index.value()),
            Some(user),
        )
    }

    /// The numbers in an accessor's buffer view; `None` without a view.
    pub(super) fn base<const N: usize>(
        &self,
        index: Index<Accessor>,
        count: usize,
        user: &str,
    ) -> Result<Option<AccessorView<'_>>, ReadError> {
        let accessor = self.accessor(index, user)?;
        let key_path = |key: &str| format!("accessors[{}].{key}", index.value());
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
            return Err(self.fail(key_path("type"), problem));
        }
        let component = self.component(accessor, index, user)?;
        let Some(view) = accessor.buffer_view else {
            return Ok(None);
        };
        let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
        let mut accessor_view = self.accessor_view::<N>(
            view,
            offset,
            count,
            component,
            &key_path("bufferView"),
            user,
        )?;
        accessor_view.normalized = accessor.normalized;
        Ok(Some(accessor_view))
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
                let problem = format!("{user}: must be one of 5120 to 5123, 5125, 5126");
                Err(self.fail(path, problem))
            }
        }
    }
}
