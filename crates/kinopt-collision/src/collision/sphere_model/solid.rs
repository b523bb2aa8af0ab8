//! The shapes of a link as one solid, for signed distance queries.

use crate::collision::aabb_tree::AabbTree;
use crate::collision::shape::{Nearest, hull_tree, nearest_on_hull};
use crate::collision::{BoundingBox, CollisionObject, ShapeKind};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Shapes in the frame of their link.
pub(super) struct Solid<'a> {
    shapes: Vec<PlacedObject<'a>>,
}

/// A shape with its inverse placement and its bounding box in its own frame.
struct PlacedObject<'a> {
    object: &'a CollisionObject,
    shape_from_link: Placement<f64>,
    bounds: BoundingBox,
    /// AABB tree over the triangles of a hull: a linear search is too slow for the number of queries.
    tree: Option<AabbTree>,
}

/// Data of a point that is inside or near the solid.
pub(super) struct Probe {
    /// Distance to the nearest shape, or minus the depth in the deepest, metres.
    pub(super) distance: f64,
    /// The closest point on that shape's surface.
    pub(super) nearest: Vector3<f64>,
    /// True if that shape is the only one in range and is convex.
    ///
    /// For a point outside, all of the shape within the query range is then nearer to [`nearest`](Self::nearest) than
    /// that range.
    pub(super) is_convex: bool,
}

impl<'a> PlacedObject<'a> {
    fn new(object: &'a CollisionObject) -> Self {
        let tree = match object.shape.kind() {
            ShapeKind::Convex(hull) => Some(hull_tree(hull)),
            _ => None,
        };
        Self {
            shape_from_link: object.link_from_shape.inverse(),
            bounds: object.shape.bounding_box(),
            object,
            tree,
        }
    }

    /// The signed distance and the closest point in the shape's frame.
    fn nearest(&self, local: Vector3<f64>) -> Nearest {
        match (self.object.shape.kind(), &self.tree) {
            (ShapeKind::Convex(hull), Some(tree)) => nearest_on_hull(local, hull, tree),
            _ => self.object.shape.nearest(local),
        }
    }

    fn is_hollow(&self) -> bool {
        matches!(
            self.object.shape.kind(),
            ShapeKind::Mesh(_) | ShapeKind::Points(_)
        )
    }
}

impl<'a> Solid<'a> {
    pub(super) fn new(objects: impl IntoIterator<Item = &'a CollisionObject>) -> Self {
        Self {
            shapes: objects.into_iter().map(PlacedObject::new).collect(),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// Distance to the nearest shape, or minus the depth in the deepest, metres. Never exceeds the true depth.
    pub(super) fn signed_distance(&self, point: Vector3<f64>) -> f64 {
        let shapes = self.shapes.iter();
        shapes.fold(f64::INFINITY, |min_distance, shape| {
            let local = shape.shape_from_link.apply(point);
            // Skips shapes whose bounding box is already too far.
            match min_distance > 0.0
                && shape.bounds.squared_distance(local) >= min_distance * min_distance
            {
                true => min_distance,
                false => min_distance.min(shape.nearest(local).0),
            }
        })
    }

    /// The closest point on the surface of the nearest shape.
    pub(super) fn nearest(&self, point: Vector3<f64>) -> Vector3<f64> {
        let probe = self.probe(point, f64::INFINITY);
        probe.map_or(point, |probe| probe.nearest)
    }

    /// Data of a point; `None` if it is at least `max_distance` metres outside.
    pub(super) fn probe(&self, point: Vector3<f64>, max_distance: f64) -> Option<Probe> {
        let mut best: Option<(Nearest, &PlacedObject<'_>)> = None;
        let mut in_range = 0;
        for shape in &self.shapes {
            let local = shape.shape_from_link.apply(point);
            if shape.bounds.squared_distance(local) > max_distance * max_distance {
                continue;
            }
            let nearest = shape.nearest(local);
            in_range += usize::from(nearest.0 <= max_distance);
            if best.is_none_or(|((min_distance, _), _)| nearest.0 < min_distance) {
                best = Some((nearest, shape));
            }
        }
        let ((distance, nearest), shape) =
            best.filter(|((min_distance, _), _)| *min_distance < max_distance)?;
        Some(Probe {
            distance,
            nearest: shape.object.link_from_shape.apply(nearest),
            is_convex: in_range == 1 && !shape.is_hollow(),
        })
    }

    pub(super) fn bounds(&self) -> BoundingBox {
        let boxes = self
            .shapes
            .iter()
            .map(|shape| shape.bounds.placed(&shape.object.link_from_shape));
        boxes.fold(BoundingBox::EMPTY, BoundingBox::union)
    }
}
