//! The shapes of a link as one solid, for signed distance queries.

use crate::collision::aabb_tree::BoxTree;
use crate::collision::shape::{Nearest, hull_tree, nearest_on_hull};
use crate::collision::{BoundingBox, CollisionObject, ShapeKind};
use crate::spatial::{Placement, Vector3};

/// Shapes in the frame of their link.
pub(super) struct Solid<'a> {
    shapes: Vec<Placed<'a>>,
}

/// A shape with its inverse placement and its bounding box in its own frame.
struct Placed<'a> {
    object: &'a CollisionObject,
    shape_from_link: Placement<f64>,
    bounds: BoundingBox,
    /// AABB tree over the triangles of a hull: a linear search is too slow for the number of queries.
    tree: Option<BoxTree>,
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

impl<'a> Placed<'a> {
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
            shapes: objects.into_iter().map(Placed::new).collect(),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// Distance to the nearest shape, or minus the depth in the deepest, metres. Never exceeds the true depth.
    pub(super) fn signed_distance(&self, point: Vector3<f64>) -> f64 {
        let each = self.shapes.iter();
        each.fold(f64::INFINITY, |least, shape| {
            let local = shape.shape_from_link.apply(point);
            // Skips shapes whose bounding box is already too far.
            match least > 0.0 && shape.bounds.squared_distance(local) >= least * least {
                true => least,
                false => least.min(shape.nearest(local).0),
            }
        })
    }

    /// The closest point on the surface of the nearest shape.
    pub(super) fn nearest(&self, point: Vector3<f64>) -> Vector3<f64> {
        let probe = self.probe(point, f64::INFINITY);
        probe.map_or(point, |probe| probe.nearest)
    }

    /// Data of a point; `None` if it is at least `within` metres outside.
    pub(super) fn probe(&self, point: Vector3<f64>, within: f64) -> Option<Probe> {
        let mut found: Option<(Nearest, &Placed<'_>)> = None;
        let mut near = 0;
        for shape in &self.shapes {
            let local = shape.shape_from_link.apply(point);
            if shape.bounds.squared_distance(local) > within * within {
                continue;
            }
            let nearest = shape.nearest(local);
            near += usize::from(nearest.0 <= within);
            if found.is_none_or(|((least, _), _)| nearest.0 < least) {
                found = Some((nearest, shape));
            }
        }
        let ((distance, place), shape) = found.filter(|((least, _), _)| *least < within)?;
        Some(Probe {
            distance,
            nearest: shape.object.link_from_shape.apply(place),
            is_convex: near == 1 && !shape.is_hollow(),
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
