//! Vertices and faces as the PLY parser fills them.

use glam::Vec3;
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

use crate::mesh::single_precision;
use crate::spatial::Vector3;

/// A vertex: x, y, z, nx, ny, nz.
pub(super) struct Vertex([f64; 6]);

impl Vertex {
    pub(super) fn position(&self) -> Vec3 {
        let [x, y, z, ..] = self.0;
        single_precision(Vector3::new(x, y, z))
    }

    pub(super) fn normal(&self) -> Vec3 {
        let [.., x, y, z] = self.0;
        single_precision(Vector3::new(x, y, z))
    }

    fn set(&mut self, name: &str, value: Option<f64>) -> PropertyAccessResult {
        let [x, y, z, nx, ny, nz] = &mut self.0;
        let component = match name {
            "x" => x,
            "y" => y,
            "z" => z,
            "nx" => nx,
            "ny" => ny,
            "nz" => nz,
            _ => return PropertyAccessResult::Ignored,
        };
        match value {
            Some(value) => {
                *component = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::UnsupportedType,
        }
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self([0.0; 6])
    }

    fn set_property(&mut self, name: &str, _: Property) -> PropertyAccessResult {
        self.set(name, None)
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        self.set(name, Some(f64::from(value)))
    }

    fn set_double(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        self.set(name, Some(value))
    }
}

/// Vertex indices of a polygon, unchecked.
pub(super) struct Face(Vec<i64>);

impl Face {
    /// Adds the triangles of the polygon as a fan around its first corner.
    pub(super) fn cut_into_fan(
        &self,
        vertex_count: usize,
        triangles: &mut Vec<[u32; 3]>,
    ) -> Result<(), String> {
        let corner = |index: &i64| match u32::try_from(*index) {
            Ok(index) if (index as usize) < vertex_count => Ok(index),
            _ => Err(format!(
                "vertex index {index} is out of range; there are {vertex_count} vertices"
            )),
        };
        let [first, rest @ ..] = self.0.as_slice() else {
            return Err("has no corners".into());
        };
        if rest.len() < 2 {
            return Err(format!(
                "has {} corners; a face has at least 3",
                self.0.len()
            ));
        }
        let first = corner(first)?;
        for pair in rest.windows(2) {
            if let [b, c] = pair {
                triangles.push([first, corner(b)?, corner(c)?]);
            }
        }
        Ok(())
    }
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        fn widen<T: Into<i64>>(values: Vec<T>) -> Vec<i64> {
            values.into_iter().map(Into::into).collect()
        }
        if name != "vertex_indices" && name != "vertex_index" {
            return PropertyAccessResult::Ignored;
        }
        self.0 = match property {
            Property::ListChar(values) => widen(values),
            Property::ListUChar(values) => widen(values),
            Property::ListShort(values) => widen(values),
            Property::ListUShort(values) => widen(values),
            Property::ListInt(values) => widen(values),
            Property::ListUInt(values) => widen(values),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// An entry of an ignored element.
pub(super) struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}
