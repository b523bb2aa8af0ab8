//! Solids that are too many to be looked at one after another.

use std::sync::{Arc, OnceLock};

use super::distance_field::{DistanceField, Known};
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
        self.about(point).least >= reach && !(self.solids.has_new() && self.meets_new(point, reach))
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

    /// Whether a point is nearer than so far to any, or in it.
    pub(super) fn near(&self, point: Vector3<f64>, reach: f64) -> bool {
        let visit = |place, least| match self.distance(place, point, least) < reach {
            // No other is asked.
            true => f64::NEG_INFINITY,
            false => least,
        };
        let apart = |bounds: &BoundingBox| bounds.squared_distance(point).sqrt();
        let found = match self.about(point) {
            known if known.least >= reach => match self.solids.has_new() {
                true => self.solids.nearest_new(reach, apart, visit),
                false => return false,
            },
            known if known.most < reach && !self.may_be_gone(point, known.most) => return true,
            _ => self.solids.nearest(reach, apart, visit),
        };
        found < reach
    }

    /// Whether what is nearer to a point than so far may be no more.
    fn may_be_gone(&self, point: Vector3<f64>, most: f64) -> bool {
        let mut gone = self.solids.gone_bounds();
        gone.any(|bounds| bounds.squared_distance(point) <= most * most)
    }

    /// What is known of those that the large tree was made of, be they still there or not.
    fn about(&self, point: Vector3<f64>) -> Known {
        let measure = |point: Vector3<f64>, limit| {
            let apart = |bounds: &BoundingBox| bounds.squared_distance(point).sqrt();
            self.solids.nearest_old(limit, apart, |place, least| {
                self.distance(place, point, least).min(least)
            })
        };
        let known = (self.field().as_ref()).and_then(|field| field.about(point, measure));
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
