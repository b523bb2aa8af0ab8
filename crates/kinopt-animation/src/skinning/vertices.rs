//! Vertex buffers of rest meshes and posed meshes.

use glam::{Vec3, Vec4};

use kinopt_kinematics::SizeMismatch;
use kinopt_mesh::mesh::TriangleMesh;

/// Vertices at rest. Empty buffers are skipped.
#[derive(Clone, Copy, Debug, Default)]
pub struct RestVertices<'a> {
    /// Positions in the model's unit.
    pub positions: &'a [Vec3],
    /// Normals of any length above 1e-18.
    pub normals: &'a [Vec3],
    /// Tangents x, y, z with the sign of the bitangent (+1 or −1) as w, as in glTF. The bitangent is w n × t.
    pub tangents: &'a [Vec4],
}

/// Output buffers for posed vertices. Each has the length of its rest buffer.
#[derive(Debug, Default)]
pub struct PosedVertices<'a> {
    /// Positions in the model's unit.
    pub positions: &'a mut [Vec3],
    /// Normals of unit length.
    pub normals: &'a mut [Vec3],
    /// Tangents of unit length, and the sign of the bitangent.
    pub tangents: &'a mut [Vec4],
}

impl PosedVertices<'_> {
    /// The rest buffers of a mesh that correspond to non-empty posed buffers.
    pub(crate) fn rest_of<'r>(&self, mesh: &'r TriangleMesh) -> RestVertices<'r> {
        let mut rest = RestVertices::default();
        if !self.positions.is_empty() {
            rest.positions = mesh.positions();
        }
        if !self.normals.is_empty() {
            rest.normals = mesh.normals();
        }
        rest
    }
}

/// Checks that each buffer is empty both at rest and posed, or has one entry per vertex in both.
pub(super) fn check(
    rest: RestVertices<'_>,
    posed: &PosedVertices<'_>,
    vertices: usize,
) -> Result<(), SizeMismatch> {
    let check = |names: [&'static str; 2], at_rest: usize, in_pose: usize| {
        if at_rest != 0 || in_pose != 0 {
            SizeMismatch::check(names[0], at_rest, vertices)?;
        }
        SizeMismatch::check(names[1], in_pose, at_rest)
    };
    let positions = ["rest positions", "posed positions"];
    check(positions, rest.positions.len(), posed.positions.len())?;
    let normals = ["rest normals", "posed normals"];
    check(normals, rest.normals.len(), posed.normals.len())?;
    let tangents = ["rest tangents", "posed tangents"];
    check(tangents, rest.tangents.len(), posed.tangents.len())
}

/// Splits off the first `count` items; an empty buffer stays empty.
#[cfg(feature = "rayon")]
fn parts<'a, T>(buffer: &mut &'a [T], count: usize) -> &'a [T] {
    let (first, others) = buffer.split_at(count.min(buffer.len()));
    *buffer = others;
    first
}

/// As `parts`, for mutable buffers.
#[cfg(feature = "rayon")]
fn parts_mut<'a, T>(buffer: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let contents = std::mem::take(buffer);
    let (first, others) = contents.split_at_mut(count.min(contents.len()));
    *buffer = others;
    first
}

impl RestVertices<'_> {
    /// Number of vertices in the non-empty buffers.
    pub(super) fn len(&self) -> usize {
        let directions = self.normals.len().max(self.tangents.len());
        self.positions.len().max(directions)
    }

    /// The first `count` vertices and the remaining ones.
    #[cfg(feature = "rayon")]
    pub(super) fn split(self, count: usize) -> (Self, Self) {
        let mut after = self;
        let first = Self {
            positions: parts(&mut after.positions, count),
            normals: parts(&mut after.normals, count),
            tangents: parts(&mut after.tangents, count),
        };
        (first, after)
    }
}

#[cfg(feature = "rayon")]
impl PosedVertices<'_> {
    /// The first `count` vertices and the remaining ones.
    pub(super) fn split(mut self, count: usize) -> (Self, Self) {
        let first = Self {
            positions: parts_mut(&mut self.positions, count),
            normals: parts_mut(&mut self.normals, count),
            tangents: parts_mut(&mut self.tangents, count),
        };
        (first, self)
    }
}
