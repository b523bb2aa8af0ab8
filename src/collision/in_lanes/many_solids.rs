//! Solids that are too many to be looked at one after another.

use std::sync::{Arc, OnceLock};

use super::distance_field::{DistanceField, Grids, Known};
use crate::collision::changing_tree::{Changed, ChangingTree};
use crate::collision::{Ball, BoundingBox, Shape};
use crate::spatial::{Placement, Vector3};

/// A shape, and what takes a point of the chain's base into its own coordinates.
type Placed = (Shape, Placement<f64>);

/// Shapes in their places, a tree over their boxes, and how far the points of a grid are from those that the large tree was made of: what
/// changed since is asked beside it.
#[derive(Clone, Debug)]
pub(super) struct ManySolids {
    solids: ChangingTree<Placed>,
    /// Made when first asked.
    field: Arc<OnceLock<Option<DistanceField>>>,
    /// Around all places where anything is asked about.
    room: BoundingBox,
    farthest: f64,
}

/// A shape of a number by where it stands in the base; nothing where there is no more.
pub(super) type SolidChange<'a> = (u64, Option<(&'a Shape, Placement<f64>)>);

impl ManySolids {
    /// Shapes that are bounded; balls that the bodies never leave, and the farthest that is asked about, metres.
    pub(super) fn new<'a>(
        solids: impl IntoIterator<Item = (u64, &'a Shape, Placement<f64>)>,
        rooms: &[Ball],
        farthest: f64,
    ) -> Self {
        let room = rooms
            .iter()
            .map(|ball| BoundingBox::around([ball.centre]).grown(ball.radius));
        let solids = solids.into_iter().map(|(number, shape, base_from_solid)| {
            let (placed, bounds) = placed(shape, &base_from_solid);
            (number, placed, bounds)
        });
        Self {
            solids: ChangingTree::new(solids),
            field: Arc::default(),
            room: room.fold(BoundingBox::EMPTY, BoundingBox::union),
            farthest,
        }
    }

    /// The same with some of them changed, in the order of their numbers.
    pub(super) fn changed(&self, changes: &[SolidChange<'_>]) -> Self {
        let changes = changes.iter().map(|(number, now)| -> Changed<Placed> {
            (*number, now.map(|(shape, at)| placed(shape, &at)))
        });
        let solids = self.solids.changed(changes.collect());
        Self {
            field: match solids.shares_old(&self.solids) {
                true => Arc::clone(&self.field),
                false => Arc::default(),
            },
            solids,
            ..*self
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.solids.is_empty()
    }

    /// Whether a point, in the base, is surely nowhere nearer than so far.
    pub(super) fn surely_apart(&self, point: Vector3<f64>, reach: f64) -> bool {
        self.about(point, reach, Grids::Coarse).least >= reach
            && !(self.solids.has_new() && self.meets_new(point, reach))
    }

    /// Whether the box of anything that changed is nearer to a point than so far.
    fn meets_new(&self, point: Vector3<f64>, reach: f64) -> bool {
        let apart = |bounds: &BoundingBox| bounds.squared_distance(point);
        let least = reach * reach;
        let found = self.solids.nearest_new(least, apart, |place, least| {
            match apart(self.solids.bounds(place)) < least {
                true => f64::NEG_INFINITY,
                false => least,
            }
        });
        found < least
    }

    /// Whether a point is nearer than so far to any, or in it; `None` where the coarse grids alone do not tell.
    pub(super) fn roughly_near(&self, point: Vector3<f64>, reach: f64) -> Option<bool> {
        let known = self.about(point, reach, Grids::Coarse);
        self.is_near(point, reach, known)
    }

    /// What is known of a point says whether it is nearer than so far to any.
    fn is_near(&self, point: Vector3<f64>, reach: f64, known: Known) -> Option<bool> {
        match known {
            known if known.least >= reach => (!self.solids.has_new()).then_some(false),
            known if known.most < reach && !self.may_be_gone(point, known.most) => Some(true),
            _ => None,
        }
    }

    /// Whether a point is nearer than so far to any, or in it.
    pub(super) fn near(&self, point: Vector3<f64>, reach: f64) -> bool {
        let known = self.about(point, reach, Grids::All);
        if let Some(near) = self.is_near(point, reach, known) {
            return near;
        }
        let visit = |place, least| match self.is_within(place, point, reach) {
            // No other is asked.
            true => f64::NEG_INFINITY,
            false => least,
        };
        let apart = |bounds: &BoundingBox| bounds.squared_distance(point).sqrt();
        let found = match known.least >= reach {
            true => self.solids.nearest_new(reach, apart, visit),
            false => self.solids.nearest(reach, apart, visit),
        };
        found < reach
    }

    /// Whether what is nearer to a point than so far may be no more.
    fn may_be_gone(&self, point: Vector3<f64>, most: f64) -> bool {
        let mut gone = self.solids.gone_bounds();
        gone.any(|bounds| bounds.squared_distance(point) <= most * most)
    }

    /// What is known of those that the large tree was made of, be they still there or not, as far as it takes to tell whether any is nearer
    /// than so far.
    fn about(&self, point: Vector3<f64>, reach: f64, grids: Grids) -> Known {
        let measure = |point: Vector3<f64>, limit| {
            let apart = |bounds: &BoundingBox| bounds.squared_distance(point).sqrt();
            self.solids.nearest_old(limit, apart, |place, least| {
                match apart(self.solids.bounds(place)) < least {
                    true => self.distance(place, point, least).min(least),
                    false => least,
                }
            })
        };
        let known =
            (self.field().as_ref()).and_then(|field| field.about(point, reach, grids, measure));
        // Beside the grid most of what is asked about is beside the box around all.
        known.unwrap_or_else(|| Known {
            least: self.solids.old_bounds().squared_distance(point).sqrt(),
            most: f64::INFINITY,
        })
    }

    fn field(&self) -> &Option<DistanceField> {
        self.field.get_or_init(|| {
            // What is farther from all solids the tree tells at once.
            let around = self.solids.old_bounds().grown(self.farthest);
            DistanceField::new(self.room.intersection(around), self.farthest)
        })
    }

    /// Whether a point is nearer than so far to one, or in it.
    fn is_within(&self, place: u32, point: Vector3<f64>, reach: f64) -> bool {
        let (shape, solid_from_base) = self.solids.thing(place);
        shape.is_within(solid_from_base.apply(point), reach)
    }

    /// How far a point is from one, if that is less than so far.
    fn distance(&self, place: u32, point: Vector3<f64>, limit: f64) -> f64 {
        let (shape, solid_from_base) = self.solids.thing(place);
        shape.signed_distance_within(solid_from_base.apply(point), limit)
    }
}

fn placed(shape: &Shape, base_from_solid: &Placement<f64>) -> (Placed, BoundingBox) {
    let bounds = shape.bounding_box().placed(base_from_solid);
    ((shape.clone(), base_from_solid.inverse()), bounds)
}

#[cfg(test)]
#[allow(clippy::expect_used, reason = "it is a test")]
mod tests {
    use super::*;

    /// Numbers within [-1, 1] that never change.
    struct Numbers(u32);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(self.0 >> 8) / f64::from(1 << 23) - 1.0
        }

        fn point(&mut self, size: f64) -> Vector3<f64> {
            Vector3::new(self.next(), self.next(), self.next()) * size
        }

        fn shape(&mut self) -> Shape {
            let size = 0.06 + 0.04 * self.next();
            let shape = match self.0 >> 29 {
                0 | 1 => Shape::sphere(size),
                2 | 3 => Shape::cylinder(size, 0.05),
                4 | 5 => Shape::cuboid([size, 0.02, 0.1]),
                _ => Shape::points((0..100).map(|_| self.point(0.2)).collect(), 0.004),
            };
            shape.expect("a shape of a size")
        }
    }

    type Known = (u64, Shape, Placement<f64>);

    fn is_near(solids: &[Known], point: Vector3<f64>, reach: f64) -> bool {
        let near = |(_, shape, at): &Known| {
            let point = at.inverse().apply(point);
            shape.signed_distance(point) < reach
        };
        solids.iter().any(near)
    }

    /// Asks about points, some of them again and again, each told as one solid after another tells.
    fn ask(many: &ManySolids, solids: &[Known], numbers: &mut Numbers, told: &mut [usize; 3]) {
        let places: Vec<_> = (0..40).map(|_| numbers.point(1.3)).collect();
        for step in 0..4_000 {
            let about = match step % 2 {
                0 => numbers.point(1.3),
                _ => places[step / 2 % places.len()] + numbers.point(0.01),
            };
            let reach = 0.1 + 0.1 * numbers.next();
            let near = is_near(solids, about, reach);
            let roughly = many.roughly_near(about, reach);
            assert!(roughly.is_none_or(|said| said == near));
            assert!(!(near && many.surely_apart(about, reach)));
            // Whichever is asked first.
            assert_eq!(many.near(about, reach), near, "{about:?} {reach}");
            assert!(many.roughly_near(about, reach) == roughly);
            told[roughly.map_or(2, usize::from)] += 1;
        }
    }

    #[test]
    fn whatever_was_asked_before_each_point_is_as_near_as_to_one_solid_after_another() {
        let numbers = &mut Numbers(1);
        let mut placed = |number| {
            let shape = numbers.shape();
            (number, shape, Placement::translation(numbers.point(1.0)))
        };
        let mut solids: Vec<Known> = (0..400).map(&mut placed).collect();
        let all = solids
            .iter()
            .map(|(number, shape, at)| (*number, shape, *at));
        let room = Ball {
            centre: Vector3::zero(),
            radius: 1.2,
        };
        let mut many = ManySolids::new(all, &[room], 0.3);
        let mut told = [0; 3];
        let first = many.clone();
        let before = solids.clone();
        for change in 0..6 {
            ask(&many, &solids, &mut Numbers(10 + change), &mut told);
            let number = 7 * u64::from(change);
            let now = placed(number);
            many = many.changed(&[(number, Some((&now.1, now.2))), (number + 1, None)]);
            solids.retain(|(known, ..)| *known != number && *known != number + 1);
            solids.push(now);
        }
        assert!(many.solids.has_new() && many.solids.shares_old(&first.solids));
        ask(&first, &before, &mut Numbers(99), &mut told);
        assert!(told.iter().all(|&count| count > 1_000), "{told:?}");
    }
}
