//! Buffers of vertices on their way from rest to pose.

use glam::{Vec3, Vec4};

use crate::SizeMismatch;
use crate::mesh::TriangleMesh;

/// Vertices at rest. A buffer that is empty is not there.
#[derive(Clone, Copy, Debug, Default)]
pub struct RestVertices<'a> {
    /// Positions in the model's own unit.
    pub positions: &'a [Vec3],
    /// Normals, of any length above 1e-18.
    pub normals: &'a [Vec3],
    /// Tangents x, y, z with the bitangent's sign (+1 or −1) as w, as in glTF: the bitangent is
    /// w n × t.
    pub tangents: &'a [Vec4],
}

/// Where posed vertices go. Each buffer is as long as the one at rest.
#[derive(Debug, Default)]
pub struct PosedVertices<'a> {
    /// Positions in the model's own unit.
    pub positions: &'a mut [Vec3],
    /// Normals of unit length.
    pub normals: &'a mut [Vec3],
    /// Tangents of unit length, and the bitangent's sign.
    pub tangents: &'a mut [Vec4],
}

impl PosedVertices<'_> {
    /// What of a mesh at rest goes into the buffers that are there.
    pub(crate) fn wanted_of<'r>(&self, mesh: &'r TriangleMesh) -> RestVertices<'r> {
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

/// Refuses buffers that are neither empty at both ends nor one per vertex at both ends.
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

/// Takes the first `count` items off; an empty buffer stays empty.
#[cfg(feature = "rayon")]
fn parts<'a, T>(buffer: &mut &'a [T], count: usize) -> &'a [T] {
    let (first, others) = buffer.split_at(count.min(buffer.len()));
    *buffer = others;
    first
}

/// [`parts`] of what is written.
#[cfg(feature = "rayon")]
fn parts_mut<'a, T>(buffer: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let whole = std::mem::take(buffer);
    let (first, others) = whole.split_at_mut(count.min(whole.len()));
    *buffer = others;
    first
}

impl RestVertices<'_> {
    /// How many vertices there are in the buffers that are there.
    pub(super) fn len(&self) -> usize {
        let directions = self.normals.len().max(self.tangents.len());
        self.positions.len().max(directions)
    }

    /// The first `count` vertices and the others.
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
    /// The first `count` vertices and the others.
    pub(super) fn split(mut self, count: usize) -> (Self, Self) {
        let first = Self {
            positions: parts_mut(&mut self.positions, count),
            normals: parts_mut(&mut self.normals, count),
            tangents: parts_mut(&mut self.tangents, count),
        };
        (first, self)
    }
}
