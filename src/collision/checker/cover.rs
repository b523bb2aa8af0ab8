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

impl Cover {
    pub(super) fn of(group: &SphereGroup) -> Self {
        Self {
            bound: group.bound,
            spheres: group.spheres.clone(),
        }
    }

    /// Where the part stands.
    pub(super) fn placed(&self, at: &Placement<f64>) -> Self {
        let place = |own: &Ball| Ball {
            centre: at.apply(own.centre),
            radius: own.radius,
        };
        Self {
            bound: place(&self.bound),
            spheres: self.spheres.iter().map(place).collect(),
        }
    }

    /// Whether what two of them are around is surely further apart.
    pub(super) fn is_apart(&self, other: &Self, within: f64) -> bool {
        let meet = |a: &Ball, b: &Ball| {
            // Spheres that are the shapes themselves are not to be lost by rounding.
            let reach = (a.radius + b.radius + within) * (1.0 + ROUNDING);
            (a.centre - b.centre).norm_squared() <= reach * reach
        };
        let mut near = self.spheres.iter().filter(|own| meet(own, &other.bound));
        !(meet(&self.bound, &other.bound)
            && near.any(|own| other.spheres.iter().any(|sphere| meet(own, sphere))))
    }
}
