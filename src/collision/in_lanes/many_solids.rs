//! Solids that are too many to be looked at one after another.

use super::distance_field::{DistanceField, Known};
use crate::collision::box_tree::BoxTree;
use crate::collision::{Ball, BoundingBox, Shape};
use crate::spatial::{Placement, Vector3};

/// Shapes in their places, a tree over their boxes, and how far from them the points of a grid are.
#[derive(Clone, Debug)]
pub(super) struct ManySolids {
    /// Each with what takes a point of the chain's base into its own coordinates.
    solids: Vec<(Shape, Placement<f64>)>,
    tree: BoxTree,
    field: Option<DistanceField>,
}

impl ManySolids {
    /// Shapes that are bounded, each by where it stands in the base; balls that the bodies never leave, and the farthest that is asked about,
    /// metres.
    pub(super) fn new(
        solids: Vec<(&Shape, Placement<f64>)>,
        rooms: &[Ball],
        farthest: f64,
    ) -> Self {
        let boxes: Vec<BoundingBox> = (solids.iter())
            .map(|(shape, base_from_solid)| shape.bounding_box().placed(base_from_solid))
            .collect();
        let tree = BoxTree::new(boxes.len(), |index| boxes[index]);
        let room = rooms
            .iter()
            .map(|ball| BoundingBox::around([ball.centre]).grown(ball.radius));
        let room = room.fold(BoundingBox::EMPTY, BoundingBox::union);
        // What is farther from all solids the tree tells at once.
        let room = room.intersection(tree.bounds().grown(farthest));
        Self {
            solids: (solids.into_iter())
                .map(|(shape, base_from_solid)| (shape.clone(), base_from_solid.inverse()))
                .collect(),
            field: DistanceField::new(room, farthest),
            tree,
        }
    }

    /// Whether a point, in the base, is surely nowhere nearer than so far.
    pub(super) fn surely_apart(&self, point: Vector3<f64>, reach: f64) -> bool {
        self.about(point).least >= reach
    }

    /// Whether a point is nearer than so far to any, or in it.
    pub(super) fn near(&self, point: Vector3<f64>, reach: f64) -> bool {
        match self.about(point) {
            known if known.least >= reach => false,
            known if known.most < reach => true,
            _ => {
                let found = self.nearest(point, reach, |distance, least| match distance < reach {
                    // No other is asked.
                    true => f64::NEG_INFINITY,
                    false => least,
                });
                found < reach
            }
        }
    }

    fn about(&self, point: Vector3<f64>) -> Known {
        let measure = |point, limit| self.nearest(point, limit, f64::min);
        let known = (self.field.as_ref()).and_then(|field| field.about(point, measure));
        // Beside the grid most of what is asked about is beside the box around all.
        known.unwrap_or_else(|| Known {
            least: self.tree.bounds().squared_distance(point).sqrt(),
            most: f64::INFINITY,
        })
    }

    /// Goes through the solids in the order of nearness, as far as boxes tell, with the least value so far.
    fn nearest(&self, point: Vector3<f64>, limit: f64, keep: impl Fn(f64, f64) -> f64) -> f64 {
        self.tree.nearest(
            limit,
            |bounds| bounds.squared_distance(point).sqrt(),
            |index, least| {
                let (shape, solid_from_base) = &self.solids[index as usize];
                let own = solid_from_base.apply(point);
                keep(shape.signed_distance_within(own, least), least)
            },
        )
    }
}
