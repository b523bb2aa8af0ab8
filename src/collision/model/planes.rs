//! Planes that a robot's file has in its world: no shapes of links, as they have no end, but obstacles of its own.

use std::sync::Arc;

use super::CollisionModel;
use super::bodies::carrier;
use crate::collision::{Obstacle, Shape};
use crate::kinematics::ForwardKinematics;
use crate::model::{FrameId, Model};
use crate::spatial::Placement;

/// A half-space on a link that no joint moves.
#[derive(Clone, Debug)]
pub(crate) struct Plane {
    /// As an obstacle in the world, under its link's name.
    pub(crate) obstacle: Arc<Obstacle>,
    pub(crate) link: FrameId,
    /// Links that may be through it; none that stands as it does.
    pub(crate) passed: Vec<FrameId>,
}

impl Plane {
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

    /// Whether what is on a link is kept over it: not what stands as it does.
    pub(crate) fn holds(&self, model: &Model, link: FrameId) -> bool {
        carrier(model, link).is_some() && !self.passed.contains(&link)
    }
}

/// Where a link stands, if no joint moves it.
pub(super) fn standing(model: &Model, link: FrameId) -> Option<Placement<f64>> {
    if carrier(model, link).is_some() {
        return None;
    }
    let mut kinematics = ForwardKinematics::of_configurations(model, &[link]);
    let placed = kinematics.place(&model.neutral());
    Some(placed.ok()?[0])
}

impl CollisionModel {
    /// Planes that stand in the robot's own world.
    pub(crate) fn planes(&self) -> &[Plane] {
        &self.planes
    }

    /// Lets a link be through the planes of another, or keeps it over them again.
    pub(super) fn pass_planes(&mut self, [a, b]: [FrameId; 2], may: bool) {
        for plane in &mut self.planes {
            for (on, link) in [(a, b), (b, a)] {
                if plane.link == on {
                    plane.passed.retain(|passed| *passed != link);
                    plane.passed.extend(may.then_some(link));
                }
            }
        }
    }

    /// Whether one of two links is kept over a plane of the other.
    pub(super) fn is_over_plane(&self, [a, b]: [FrameId; 2]) -> bool {
        self.planes.iter().any(|plane| {
            [(a, b), (b, a)]
                .iter()
                .any(|(on, link)| plane.link == *on && plane.holds(&self.model, *link))
        })
    }
}
