//! Sphere covers of parts, which reject most pairs before exact distances.

use crate::collision::{Ball, SphereGroup};
use kinopt_kinematics::spatial::Placement;

/// Relative margin for rounding.
const ROUNDING: f64 = 1e-9;

/// Spheres that cover the shapes of a part, and their bounding sphere, in the part's frame.
#[derive(Clone, Debug)]
pub(super) struct PartCover {
    bound: Ball,
    spheres: Vec<Ball>,
}

/// A cover in world coordinates.
#[derive(Clone, Debug, Default)]
pub(super) struct PlacedCover {
    bound: Ball,
    spheres: Vec<Ball>,
    /// True once the bound and the spheres are computed. Most parts never need them.
    has_bound: bool,
    has_spheres: bool,
}

impl PartCover {
    pub(super) fn of(group: &SphereGroup) -> Self {
        Self {
            bound: group.bound,
            spheres: group.spheres.clone(),
        }
    }
}

impl PlacedCover {
    /// Marks the bound and the spheres as not computed.
    pub(super) fn reset(&mut self) {
        (self.has_bound, self.has_spheres) = (false, false);
    }

    /// Computes the bounding sphere on first use.
    pub(super) fn place(&mut self, cover: &PartCover, at: &Placement<f64>) {
        if !std::mem::replace(&mut self.has_bound, true) {
            self.bound = placed(&cover.bound, at);
        }
    }

    /// True if the bounding spheres are at most `max_distance` metres apart.
    pub(super) fn meets(&self, other: &Self, max_distance: f64) -> bool {
        meet(&self.bound, &other.bound, max_distance)
    }

    /// Computes the spheres on first use.
    pub(super) fn place_spheres(&mut self, cover: &PartCover, at: &Placement<f64>) {
        if !std::mem::replace(&mut self.has_spheres, true) {
            self.spheres.clear();
            (self.spheres).extend(cover.spheres.iter().map(|ball| placed(ball, at)));
        }
    }

    /// True if the covered shapes are certainly farther apart than `max_distance` metres.
    pub(super) fn is_apart(&self, other: &Self, max_distance: f64) -> bool {
        let near = |ball: &&Ball| meet(ball, &other.bound, max_distance);
        let is_near = |ball: &Ball| {
            let mut others = other.spheres.iter();
            others.any(|sphere| meet(ball, sphere, max_distance))
        };
        !self.spheres.iter().filter(near).any(is_near)
    }
}

fn placed(ball: &Ball, at: &Placement<f64>) -> Ball {
    Ball {
        centre: at.apply(ball.centre),
        radius: ball.radius,
    }
}

fn meet(a: &Ball, b: &Ball, max_distance: f64) -> bool {
    // If the spheres are the shapes themselves, rounding must not lose a pair.
    let reach = (a.radius + b.radius + max_distance) * (1.0 + ROUNDING);
    (a.centre - b.centre).norm_squared() <= reach * reach
}
