//! The shapes of a link as one solid, of which points are asked how deep they are.

use crate::collision::{BoundingBox, CollisionObject, ShapeKind};
use crate::spatial::{Placement, Vector3};

/// Shapes in the frame of their link.
pub(super) struct Solid<'a> {
    shapes: Vec<(&'a CollisionObject, Placement<f64>)>,
}

impl<'a> Solid<'a> {
    pub(super) fn new(objects: impl IntoIterator<Item = &'a CollisionObject>) -> Self {
        let placed = |object: &'a CollisionObject| (object, object.link_from_shape.inverse());
        Self {
            shapes: objects.into_iter().map(placed).collect(),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// How far outside the nearest shape, or minus how deep in the deepest: never deeper than it truly is.
    pub(super) fn signed_distance(&self, point: Vector3<f64>) -> f64 {
        let each = self.shapes.iter();
        let distance = |(object, inverse): &(&CollisionObject, Placement<f64>)| {
            object.shape.signed_distance(inverse.apply(point))
        };
        each.map(distance).fold(f64::INFINITY, f64::min)
    }

    /// The point of the surface of the shape that is nearest.
    pub(super) fn nearest(&self, point: Vector3<f64>) -> Vector3<f64> {
        let each = self.shapes.iter().map(|(object, inverse)| {
            let local = inverse.apply(point);
            (object.shape.signed_distance(local), object, local)
        });
        let nearest = each.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map_or(point, |(_, object, local)| {
            object.link_from_shape.apply(object.shape.nearest(local).1)
        })
    }

    /// Whether all of it that lies in a ball about a point outside is nearer to [`nearest`](Self::nearest) than
    /// that ball's radius: so it is where one convex shape alone is that near.
    pub(super) fn is_convex_near(&self, point: Vector3<f64>, radius: f64) -> bool {
        let mut near = self.shapes.iter().filter(|(object, inverse)| {
            object.shape.signed_distance(inverse.apply(point)) <= radius
        });
        let hollow = |kind: &ShapeKind| matches!(kind, ShapeKind::Mesh(_) | ShapeKind::Points(_));
        match (near.next(), near.next()) {
            (Some((only, _)), None) => !hollow(only.shape.kind()),
            _ => false,
        }
    }

    pub(super) fn bounds(&self) -> BoundingBox {
        let boxes = self
            .shapes
            .iter()
            .map(|(object, _)| object.shape.bounding_box().placed(&object.link_from_shape));
        boxes.fold(BoundingBox::EMPTY, BoundingBox::union)
    }
}
