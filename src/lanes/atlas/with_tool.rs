//! An atlas as a chain with a tool sees it.
//!
//! The atlas is of the chain alone: its tip is the last joint's frame. A tool moves what a chain's
//! links count from: their unit of length, and how far origins slid along the first and the last
//! axis. These three numbers lead back, so that arms that differ in their tools share one atlas.

use std::sync::Arc;

use super::table::{Atlas, Resolution};
use crate::lanes::chain::Chain;
use crate::lanes::links::Links;
use crate::spatial::{Placement, Vector3};

/// A shared atlas and the way to it from the links of a chain with a tool.
#[derive(Clone, Debug)]
pub(crate) struct TooledAtlas {
    pub(crate) atlas: Arc<Atlas>,
    /// Lengths of the atlas in a length of the links.
    lengths: f64,
    /// Lengths of the links in a length of the atlas.
    pub(super) own_lengths: f64,
    /// How far the links' first origin lies beyond the atlas's, along the first axis, in lengths of
    /// the links.
    first: f64,
    /// How far the links' last origin lies before the atlas's, along the last axis, likewise.
    last: f64,
}

impl TooledAtlas {
    /// The atlas of a chain whose links these are: one that is there already, of the same joints with
    /// whatever tool, or a new one. None for chains too short or too long.
    pub(crate) fn new(
        chain: &Chain,
        links: &Links,
        seed: u64,
        shared: Option<&Arc<Atlas>>,
    ) -> Option<Self> {
        let bare = Links::new(&chain.without_tool());
        let atlas = match shared {
            Some(shared) => Arc::clone(shared),
            None => Arc::new(Atlas::new(&bare, Resolution::default(), seed)?),
        };
        let slid = |ends: fn(&Links) -> f64| (ends(links) - ends(&bare)) * links.lengths_per_metre;
        Some(Self {
            atlas,
            lengths: links.metres_per_length * bare.lengths_per_metre,
            own_lengths: bare.metres_per_length * links.lengths_per_metre,
            first: slid(|links| links.slid.0),
            last: -slid(|links| links.slid.1),
        })
    }

    /// From a placement of the frame after the last turn in the first joint's, both as the links have
    /// them, to the same as the atlas has them, from where the leading axis is.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn place(&self, mut place: Placement<f64>) -> Placement<f64> {
        let along_first = Vector3::new(0.0, 0.0, self.first);
        let origin = place.translation + along_first + place.rotation.z * self.last;
        place.translation = origin * self.lengths - self.atlas.lead_at;
        place
    }
}
