//! One shape, as differences from the rest.

use glam::Vec3;

use super::MorphError;
use crate::mesh::TriangleMesh;

/// The differences of one shape from the rest, at the vertices where there are any.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphTarget {
    pub(super) name: String,
    pub(super) vertices: Vec<u32>,
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) tangents: Vec<Vec3>,
}

impl MorphTarget {
    /// A target of sparse deltas: `vertices` in rising order, and for each its position's delta in
    /// the model's unit. Normals' and tangents' deltas may be left empty.
    ///
    /// # Errors
    /// The lists differ in length, vertices do not rise, or a number is not finite.
    pub fn new(
        name: impl Into<String>,
        vertices: Vec<u32>,
        positions: Vec<Vec3>,
        normals: Vec<Vec3>,
        tangents: Vec<Vec3>,
    ) -> Result<Self, MorphError> {
        let target: String = name.into();
        let lists = [
            ("position delta", &positions, false),
            ("normal delta", &normals, true),
            ("tangent delta", &tangents, true),
        ];
        for (what, list, optional) in lists {
            if list.len() != vertices.len() && !(optional && list.is_empty()) {
                return Err(MorphError::DeltaCount {
                    target,
                    what,
                    given: list.len(),
                    vertices: vertices.len(),
                });
            }
            let broken = list.iter().zip(&vertices).find(|(d, _)| !d.is_finite());
            if let Some((_, &vertex)) = broken {
                return Err(MorphError::NonFinite {
                    target,
                    what,
                    vertex,
                });
            }
        }
        let fall = vertices.windows(2).find(|pair| pair[0] >= pair[1]);
        if let Some(&[_, vertex]) = fall {
            return Err(MorphError::Order { target, vertex });
        }
        Ok(Self {
            name: target,
            vertices,
            positions,
            normals,
            tangents,
        })
    }

    /// The target whose full weight turns `rest` into `shape`: deltas of positions, and of normals
    /// where both have them. Vertices that move by no more than `threshold` (in the model's unit) and
    /// whose normal keeps to it as well are left out; 0 leaves out what is equal.
    ///
    /// # Errors
    /// The shape has another number of vertices.
    pub fn between(
        name: impl Into<String>,
        rest: &TriangleMesh,
        shape: &TriangleMesh,
        threshold: f32,
    ) -> Result<Self, MorphError> {
        let mut own = Self {
            name: name.into(),
            ..Self::default()
        };
        if shape.positions().len() != rest.positions().len() {
            return Err(MorphError::ShapeCount {
                target: own.name,
                given: shape.positions().len(),
                vertices: rest.positions().len(),
            });
        }
        let with_normals = !rest.normals().is_empty() && !shape.normals().is_empty();
        let pairs = rest.positions().iter().zip(shape.positions());
        for (vertex, (from, to)) in pairs.enumerate() {
            let moved = *to - *from;
            let normals = (rest.normals().get(vertex), shape.normals().get(vertex));
            let turned = match normals {
                (Some(from), Some(to)) => *to - *from,
                _ => Vec3::ZERO,
            };
            if moved.length() > threshold || turned.length() > threshold {
                own.vertices.push(vertex as u32);
                own.positions.push(moved);
                if with_normals {
                    own.normals.push(turned);
                }
            }
        }
        Ok(own)
    }

    getters! {
        /// The name that clips and files know it by.
        pub fn name(&self) -> &str = &self.name;
        /// The vertices it moves, rising.
        pub fn vertices(&self) -> &[u32] = &self.vertices;
        /// How far it moves each of those vertices, in the model's unit.
        pub fn position_deltas(&self) -> &[Vec3] = &self.positions;
        /// What it adds to the normal of each of those vertices; empty where it leaves normals alone.
        pub fn normal_deltas(&self) -> &[Vec3] = &self.normals;
        /// What it adds to the tangent of each of those vertices; empty where it leaves tangents alone.
        pub fn tangent_deltas(&self) -> &[Vec3] = &self.tangents;
    }
}
