//! A mesh as the file describes it.

use std::borrow::Cow;
use std::collections::BTreeSet;

use glam::{Vec3, Vec4};

use super::morph_targets::Deltas;

/// Weight of one joint on a vertex, as the file states it.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointWeight {
    pub(super) vertex: u32,
    pub(super) joint: u32,
    pub(super) weight: f64,
}

/// A mesh before its skin is applied.
#[derive(Clone, Debug, Default)]
pub(super) struct RawMesh {
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) tangents: Vec<Vec4>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) joints: Vec<JointWeight>,
    /// Every primitive has joints.
    pub(super) is_skinned: bool,
    pub(super) targets: Vec<Deltas>,
    /// Index of each primitive that is left out, and the reason: points, lines or compression.
    pub(super) unread: Vec<(usize, Cow<'static, str>)>,
    /// Names of ignored attributes.
    pub(super) left_out: BTreeSet<String>,
}
