//! A checker of a robot as it comes.

use super::Checker;
use crate::collision::{CollisionModel, CollisionModelError, Fineness, SphereModel};
use crate::robot::Robot;

/// Configurations that are drawn to find pairs that cannot touch or always do.
const SAMPLES: u64 = 1000;
const SEED: u64 = 0;
/// How far spheres may stick out, as a share of the largest shape.
const OVERHANG: f64 = 0.1;

impl Checker {
    /// A robot by itself, with the shapes of its file ([`CollisionModel::of`]), without the pairs that cannot touch, or always do in a thousand random
    /// configurations ([`CollisionModel::with_pairs_sampled`]), and with spheres that cover the shapes.
    ///
    /// # Errors
    /// As [`CollisionModel::of`].
    pub fn of(robot: &Robot) -> Result<Self, CollisionModelError> {
        Ok(Self::sampled(CollisionModel::of(robot)?))
    }

    /// As [`covered`](Self::covered), without the pairs that cannot touch, or always do in a thousand random configurations.
    #[must_use]
    pub fn sampled(model: CollisionModel) -> Self {
        Self::covered(usual_pairs(model))
    }

    /// As [`sampled`](Self::sampled), but with spheres that cover the shapes already, which takes far less time.
    #[must_use]
    pub fn sampled_with_spheres(model: CollisionModel, spheres: SphereModel) -> Self {
        Self::new(usual_pairs(model)).with_spheres(spheres)
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
        let overhang = OVERHANG * largest.fold(0.0, f64::max);
        match SphereModel::of(&checker.model, Fineness::Overhang(overhang)) {
            Ok(spheres) => checker.with_spheres(spheres),
            // Without spheres all is checked by its shapes.
            Err(_) => checker,
        }
    }
}

fn usual_pairs(model: CollisionModel) -> CollisionModel {
    let sampled = model.clone().with_pairs_sampled(SAMPLES, SEED);
    // Nothing is drawn where a joint cannot be; all pairs are kept then.
    sampled.unwrap_or(model)
}
