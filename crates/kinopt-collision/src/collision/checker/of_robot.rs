//! Checkers of a robot with default options.

use super::Checker;
use crate::collision::{CollisionModel, CollisionModelError, Resolution, SphereModel};
use kinopt_robot::robot::Robot;

/// Number of random configurations for the pairs that never or always collide.
const SAMPLES: u64 = 1000;
const SEED: u64 = 0;
/// Maximum protrusion of the spheres, relative to the largest bounding radius of a shape.
const MAX_RELATIVE_PROTRUSION: f64 = 0.1;

impl Checker {
    /// A checker of a robot without a world, with default options.
    ///
    /// It has the shapes of the robot's file ([`CollisionModel::of`]) and spheres that cover them. Pairs that never or
    /// almost always collide in a thousand random configurations are disabled ([`CollisionModel::with_pairs_sampled`]).
    ///
    /// # Errors
    /// As [`CollisionModel::of`].
    pub fn of(robot: &Robot) -> Result<Self, CollisionModelError> {
        Ok(Self::sampled(CollisionModel::of(robot)?))
    }

    /// As [`covered`](Self::covered), without the pairs that never or almost always collide in a thousand random
    /// configurations.
    #[must_use]
    pub fn sampled(model: CollisionModel) -> Self {
        Self::covered(without_constant_pairs(model))
    }

    /// As [`sampled`](Self::sampled), with given spheres, which takes far less time.
    #[must_use]
    pub fn sampled_with_spheres(model: CollisionModel, spheres: SphereModel) -> Self {
        Self::new(without_constant_pairs(model)).with_spheres(spheres)
    }

    /// As [`new`](Self::new), with spheres that cover the shapes.
    #[must_use]
    pub fn covered(model: CollisionModel) -> Self {
        let checker = Self::new(model);
        if checker.spheres.is_some() {
            return checker;
        }
        let sizes = checker.model.objects().iter();
        let largest = sizes.map(|object| object.shape.bounding_sphere().radius);
        let max_protrusion = MAX_RELATIVE_PROTRUSION * largest.fold(0.0, f64::max);
        match SphereModel::of(&checker.model, Resolution::MaxProtrusion(max_protrusion)) {
            Ok(spheres) => checker.with_spheres(spheres),
            // Without spheres, all pairs are checked by exact distances.
            Err(_) => checker,
        }
    }
}

fn without_constant_pairs(model: CollisionModel) -> CollisionModel {
    let sampled = model.clone().with_pairs_sampled(SAMPLES, SEED);
    // If sampling fails, all pairs stay enabled.
    sampled.unwrap_or(model)
}
