//! Accessors and their sparse parts, with checked offsets.

use gltf_json::accessor::{ComponentType, Type};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index};

use super::accessor_view::AccessorView;
use super::source::Source;
use crate::io::ReadError;

impl<'a> Source<'a> {
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
            let places = self.places(&sparse, count, &path, user)?;
            for (place, entry) in places.into_iter().zip(0..) {
                if let Some(value) = values.get_mut(place as usize) {
                    *value = of(sparse.values.entry(entry));
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
        let whole = matches!(
            accessor.component_type,
            Checked::Valid(kind)
                if matches!(kind.0, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
        );
        if !whole || accessor.normalized {
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
                let problem = format!("{user}: must be one of 5120 to 5123, 5125, 5126");
                Err(self.fail(path, problem))
            }
        }
    }
}
