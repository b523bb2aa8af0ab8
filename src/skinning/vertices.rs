//! Buffers of vertices on their way from rest to pose.

use glam::{Vec3, Vec4};

use super::SkinningError;

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

/// Refuses buffers that are neither empty at both ends nor one per vertex at both ends.
pub(super) fn check(
    rest: RestVertices<'_>,
    posed: &PosedVertices<'_>,
    vertices: usize,
) -> Result<(), SkinningError> {
    let pairs = [
        (
            rest.positions.len(),
            posed.positions.len(),
            ["rest positions", "posed positions"],
        ),
        (
            rest.normals.len(),
            posed.normals.len(),
            ["rest normals", "posed normals"],
        ),
        (
            rest.tangents.len(),
            posed.tangents.len(),
            ["rest tangents", "posed tangents"],
        ),
    ];
    for (at_rest, in_pose, [rest_name, posed_name]) in pairs {
        if at_rest == in_pose && (at_rest == vertices || at_rest == 0) {
            continue;
        }
        let (what, given) = if at_rest == vertices {
            (posed_name, in_pose)
        } else {
            (rest_name, at_rest)
        };
        return Err(SkinningError::VertexCount {
            what,
            given,
            vertices,
        });
    }
    Ok(())
}

/// The first `count` items and the others; an empty buffer stays empty in both.
#[cfg(feature = "rayon")]
fn parts<T>(buffer: &[T], count: usize) -> (&[T], &[T]) {
    buffer.split_at(count.min(buffer.len()))
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
        let (positions, normals, tangents) = (
            parts(self.positions, count),
            parts(self.normals, count),
            parts(self.tangents, count),
        );
        let side = |positions, normals, tangents| Self {
            positions,
            normals,
            tangents,
        };
        (
            side(positions.0, normals.0, tangents.0),
            side(positions.1, normals.1, tangents.1),
        )
    }
}

#[cfg(feature = "rayon")]
impl PosedVertices<'_> {
    /// The first `count` vertices and the others.
    pub(super) fn split(self, count: usize) -> (Self, Self) {
        let at = |length: usize| count.min(length);
        let (positions, positions_after) = {
            let at = at(self.positions.len());
            self.positions.split_at_mut(at)
        };
        let (normals, normals_after) = {
            let at = at(self.normals.len());
            self.normals.split_at_mut(at)
        };
        let (tangents, tangents_after) = {
            let at = at(self.tangents.len());
            self.tangents.split_at_mut(at)
        };
        (
            Self {
                positions,
                normals,
                tangents,
            },
            Self {
                positions: positions_after,
                normals: normals_after,
                tangents: tangents_after,
            },
        )
    }
}
