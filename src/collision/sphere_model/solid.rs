//! The shapes of a link as one solid, of which points are asked how deep they are.

use crate::collision::box_tree::BoxTree;
use crate::collision::shape::{Nearest, hull_tree, nearest_on_hull};
use crate::collision::{BoundingBox, CollisionObject, ShapeKind};
use crate::spatial::{Placement, Vector3};

/// Shapes in the frame of their link.
pub(super) struct Solid<'a> {
    shapes: Vec<Placed<'a>>,
}

/// A shape, what takes a point of the link into its own coordinates, and the box around it there.
struct Placed<'a> {
    object: &'a CollisionObject,
    shape_from_link: Placement<f64>,
    bounds: BoundingBox,
    /// Of a hull over its triangles: it is asked too often to look at each of them.
    tree: Option<BoxTree>,
}

/// What is known of a point that is within or near.
pub(super) struct Probe {
    /// How far outside the nearest shape, or minus how deep in the deepest.
    pub(super) distance: f64,
    /// The point of that shape's surface that is nearest.
    pub(super) nearest: Vector3<f64>,
    /// Whether that shape alone is near, and convex: then all of it that is as near as was asked is nearer to
    /// [`nearest`](Self::nearest) than that, if the point is outside.
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

    /// In its own coordinates.
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

    /// How far outside the nearest shape, or minus how deep in the deepest: never deeper than it truly is.
    pub(super) fn signed_distance(&self, point: Vector3<f64>) -> f64 {
        let each = self.shapes.iter();
        each.fold(f64::INFINITY, |least, shape| {
            let local = shape.shape_from_link.apply(point);
            // What the box around it tells needs no closer look.
            match least > 0.0 && shape.bounds.squared_distance(local) >= least * least {
                true => least,
                false => least.min(shape.nearest(local).0),
            }
        })
    }

    /// The point of the surface of the shape that is nearest.
    pub(super) fn nearest(&self, point: Vector3<f64>) -> Vector3<f64> {
        let probe = self.probe(point, f64::INFINITY);
        probe.map_or(point, |probe| probe.nearest)
    }

    /// What is known of a point; `None` where it is at least so far outside.
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
