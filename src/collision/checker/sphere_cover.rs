//! Spheres around a part, by which most pairs of parts are told apart before their shapes are looked at.

use crate::collision::{Ball, SphereGroup};
use crate::spatial::Placement;

/// What of a reach is rounding.
const ROUNDING: f64 = 1e-9;

/// Spheres around the shapes of a part, and a ball around them all.
#[derive(Clone, Debug)]
pub(super) struct Cover {
    bound: Ball,
    spheres: Vec<Ball>,
}

/// Where one stands.
#[derive(Clone, Debug, Default)]
pub(super) struct PlacedCover {
    bound: Ball,
    spheres: Vec<Ball>,
    /// Whether the bound is there, and whether the spheres are: most parts' are never asked for.
    has_bound: bool,
    has_spheres: bool,
}

impl Cover {
    pub(super) fn of(group: &SphereGroup) -> Self {
        Self {
            bound: group.bound,
            spheres: group.spheres.clone(),
        }
    }
}

impl PlacedCover {
    /// Stands nowhere.
    pub(super) fn forget(&mut self) {
        (self.has_bound, self.has_spheres) = (false, false);
    }

    /// Stands where the part does.
    pub(super) fn place(&mut self, own: &Cover, at: &Placement<f64>) {
        if !std::mem::replace(&mut self.has_bound, true) {
            self.bound = placed(&own.bound, at);
        }
    }

    /// Whether the ball around all meets another's.
    pub(super) fn meets(&self, other: &Self, within: f64) -> bool {
        meet(&self.bound, &other.bound, within)
    }

    /// Places the spheres, once.
    pub(super) fn place_spheres(&mut self, own: &Cover, at: &Placement<f64>) {
        if !std::mem::replace(&mut self.has_spheres, true) {
            self.spheres.clear();
            (self.spheres).extend(own.spheres.iter().map(|ball| placed(ball, at)));
        }
    }

    /// Whether what two of them are around is surely further apart, by their spheres.
    pub(super) fn is_apart(&self, other: &Self, within: f64) -> bool {
        let near = |own: &&Ball| meet(own, &other.bound, within);
        let touches = |own: &Ball| {
            let mut others = other.spheres.iter();
            others.any(|sphere| meet(own, sphere, within))
        };
        !self.spheres.iter().filter(near).any(touches)
    }
}

fn placed(own: &Ball, at: &Placement<f64>) -> Ball {
    Ball {
        centre: at.apply(own.centre),
        radius: own.radius,
    }
}

fn meet(a: &Ball, b: &Ball, within: f64) -> bool {
    // Spheres that are the shapes themselves are not to be lost by rounding.
    let reach = (a.radius + b.radius + within) * (1.0 + ROUNDING);
    (a.centre - b.centre).norm_squared() <= reach * reach
}
