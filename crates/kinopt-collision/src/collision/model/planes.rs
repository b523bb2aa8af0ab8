//! Planes of an MJCF file's world. They are unbounded, so they are obstacles rather than shapes of links.

use std::sync::Arc;

use super::CollisionModel;
use super::bodies::carrier;
use crate::collision::{Obstacle, Shape};
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::{FrameId, Model};
use kinopt_kinematics::spatial::Placement;

/// A half-space on a link that no joint moves.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct LinkHalfSpace {
    /// The obstacle in the world, named after its link.
    #[doc(hidden)]
    pub obstacle: Arc<Obstacle>,
    pub(crate) link: FrameId,
    /// Moving links that may penetrate it.
    pub(crate) passed: Vec<FrameId>,
}

impl LinkHalfSpace {
    pub(super) fn new(
        model: &Model,
        link: FrameId,
        world_from_plane: Placement<f64>,
        passed: Vec<FrameId>,
    ) -> Self {
        let mut passed = passed;
        passed.retain(|link| carrier(model, *link).is_some());
        let name = model.frames()[link.index()].name.as_str();
        let shape = Shape::half_space();
        Self {
            obstacle: Arc::new(Obstacle::new(name, shape, world_from_plane, None)),
            link,
            passed,
        }
    }

    /// True if shapes on a link must stay above the plane. Never true for a fixed link.
    pub(crate) fn blocks(&self, model: &Model, link: FrameId) -> bool {
        carrier(model, link).is_some() && !self.passed.contains(&link)
    }
}

/// World placement of a link that no joint moves; `None` for a moving link.
pub(super) fn fixed_placement(model: &Model, link: FrameId) -> Option<Placement<f64>> {
    if carrier(model, link).is_some() {
        return None;
    }
    let mut kinematics = ForwardKinematics::of_configurations(model, &[link]);
    let placed = kinematics.place(&model.neutral());
    Some(placed.ok()?[0])
}

impl CollisionModel {
    /// Planes of the robot's own world.
    #[doc(hidden)]
    pub fn planes(&self) -> &[LinkHalfSpace] {
        &self.planes
    }

    /// Allows or forbids that one of two links penetrates the planes of the other.
    pub(super) fn allow_planes(&mut self, [a, b]: [FrameId; 2], may: bool) {
        for plane in &mut self.planes {
            for (on, link) in [(a, b), (b, a)] {
                if plane.link == on {
                    plane.passed.retain(|passed| *passed != link);
                    plane.passed.extend(may.then_some(link));
                }
            }
        }
    }

    /// True if one of two links must stay above a plane of the other.
    pub(super) fn is_plane_checked(&self, [a, b]: [FrameId; 2]) -> bool {
        self.planes.iter().any(|plane| {
            [(a, b), (b, a)]
                .iter()
                .any(|(on, link)| plane.link == *on && plane.blocks(&self.model, *link))
        })
    }
}
