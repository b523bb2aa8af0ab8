//! A mesh as a file has it.

use std::collections::BTreeSet;

use glam::{Vec3, Vec4};

use super::morph_targets::Deltas;

/// One joint's share in a vertex, as the file has it.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointWeight {
    pub(super) vertex: u32,
    pub(super) joint: u32,
    pub(super) weight: f64,
}

/// A mesh before it meets a skin.
#[derive(Clone, Debug, Default)]
pub(super) struct RawMesh {
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) tangents: Vec<Vec4>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) joints: Vec<JointWeight>,
    /// Whether every primitive has joints.
    pub(super) is_skinned: bool,
    pub(super) targets: Vec<Deltas>,
    /// The primitives of points and lines by their numbers, and what they are.
    pub(super) without_triangles: Vec<(usize, String)>,
    /// Attributes that nothing here is for, by name.
    pub(super) left_out: BTreeSet<String>,
}
