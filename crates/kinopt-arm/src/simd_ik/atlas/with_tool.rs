//! Seed atlas of a chain with a tool.
//!
//! The atlas describes the chain without a tool: its tip is the last joint's frame. A tool changes the links' unit of
//! length and moves their first and last origin along their axes. Three numbers undo that, so arms with different tools
//! share one atlas.

use std::sync::Arc;

use super::table::{Atlas, KeyResolution};
use crate::simd_ik::chain::Chain;
use crate::simd_ik::links::Links;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// A shared atlas and the conversion to it from the links of a chain with a tool.
#[derive(Clone, Debug)]
pub(crate) struct TooledAtlas {
    pub(crate) atlas: Arc<Atlas>,
    /// Lengths of the atlas per length of the links.
    atlas_per_links_length: f64,
    /// Lengths of the links per length of the atlas.
    pub(super) links_per_atlas_length: f64,
    /// Offset of the links' first origin from the atlas's, along the first axis, in lengths of the links.
    first_shift: f64,
    /// Offset of the atlas's last origin from the links', along the last axis, in lengths of the links.
    last_shift: f64,
}

impl TooledAtlas {
    /// Atlas of a chain with these links: the shared one, which must be of the same joints, or a new one.
    ///
    /// Returns `None` if the chain has too few or too many joints for an atlas.
    pub(crate) fn new(
        chain: &Chain,
        links: &Links,
        seed: u64,
        shared: Option<&Arc<Atlas>>,
    ) -> Option<Self> {
        let bare = Links::new(&chain.without_tool());
        let atlas = match shared {
            Some(shared) => Arc::clone(shared),
            None => Arc::new(Atlas::new(&bare, KeyResolution::default(), seed)?),
        };
        let shift = |ends: fn(&Links) -> f64| (ends(links) - ends(&bare)) * links.lengths_per_metre;
        Some(Self {
            atlas,
            atlas_per_links_length: links.metres_per_length * bare.lengths_per_metre,
            links_per_atlas_length: bare.metres_per_length * links.lengths_per_metre,
            first_shift: shift(|links| links.origin_shifts.0),
            last_shift: -shift(|links| links.origin_shifts.1),
        })
    }

    /// Converts the pose of the last joint's frame after its rotation from the links' terms to the atlas's.
    ///
    /// The input is relative to the first joint, the result to the leading axis.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn to_atlas(&self, mut pose: Placement<f64>) -> Placement<f64> {
        let along_first = Vector3::new(0.0, 0.0, self.first_shift);
        let origin = pose.translation + along_first + pose.rotation.z * self.last_shift;
        pose.translation = origin * self.atlas_per_links_length - self.atlas.lead_point;
        pose
    }
}
