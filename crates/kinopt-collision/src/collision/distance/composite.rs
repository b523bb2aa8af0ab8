//! Signed distance of shapes with many parts: meshes, height fields and point clouds, by AABB trees.

use crate::collision::aabb_tree::{AabbTree, Contents};
use crate::collision::bounding_box::BoundingBox;
use crate::collision::shape::{HeightField, PointCloud, Shape, ShapeKind, TriMesh};
use kinopt_kinematics::clock::deadline::is_over;
use kinopt_kinematics::spatial::{Placement, Vector3};

use super::convex;
use super::core_and_radius::{Core, Gap, Pair};

/// A shape as a set of convex parts.
pub(super) enum ConvexParts<'a> {
    One(Core<'a>, f64),
    Mesh(&'a TriMesh, &'a Shape),
    Field(&'a HeightField, &'a Shape),
    Cloud(&'a PointCloud),
}

impl<'a> ConvexParts<'a> {
    /// Parts of any shape. A half-space has no parts and becomes a point.
    pub(super) fn of(shape: &'a Shape) -> Self {
        match shape.kind() {
            ShapeKind::Mesh(mesh) => Self::Mesh(mesh, shape),
            ShapeKind::HeightField(field) => Self::Field(field, shape),
            ShapeKind::Points(cloud) => Self::Cloud(cloud),
            kind => {
                let origin = (Core::Point(Vector3::zero()), 0.0);
                let (core, radius) = Core::of(kind).unwrap_or(origin);
                Self::One(core, radius)
            }
        }
    }

    fn tree(&self) -> Option<&'a AabbTree> {
        match self {
            Self::One(..) => None,
            Self::Mesh(mesh, _) => Some(mesh.tree()),
            Self::Field(field, _) => Some(field.tree()),
            Self::Cloud(cloud) => Some(cloud.tree()),
        }
    }

    fn part(&self, index: usize) -> Core<'a> {
        match self {
            Self::One(core, ..) => *core,
            Self::Mesh(mesh, _) => Core::Triangle(mesh.triangle(index)),
            Self::Field(field, _) => Core::Triangle(field.triangle(index)),
            Self::Cloud(cloud) => Core::Point(cloud.positions()[index]),
        }
    }

    /// Radius of the sphere around each part, metres.
    fn radius(&self) -> f64 {
        match self {
            Self::One(_, radius) => *radius,
            Self::Cloud(cloud) => cloud.radius(),
            _ => 0.0,
        }
    }

    /// The shape, if it has an inside that its parts do not fill.
    fn enclosing_shape(&self) -> Option<&'a Shape> {
        match self {
            Self::Mesh(mesh, shape) => mesh.is_closed().then_some(*shape),
            Self::Field(_, shape) => Some(*shape),
            _ => None,
        }
    }

    /// Box of a tree node, without the radius.
    fn node_bounds(&self, node: u32) -> BoundingBox {
        match (self, self.tree()) {
            (_, Some(tree)) => tree.node_bounds(node),
            (Self::One(core, ..), _) => core.bounds(),
            _ => BoundingBox::EMPTY,
        }
    }
}

/// The signed distance; `None` if it is more than `max_distance`.
pub(super) fn gap(
    a: &ConvexParts<'_>,
    b: &ConvexParts<'_>,
    a_from_b: &Placement<f64>,
    max_distance: f64,
) -> Option<Gap> {
    let mut best = surface_gap(a, b, a_from_b, max_distance);
    let b_from_a = a_from_b.inverse();
    let deepest = [
        enclosed(a, b, a_from_b),
        enclosed(b, a, &b_from_a).map(|gap| gap.flipped(a_from_b)),
    ];
    for gap in deepest.into_iter().flatten() {
        if best.is_none_or(|best| gap.distance < best.distance) {
            best = Some(gap);
        }
    }
    best
}

/// The gap of a part of B inside A, with the depth of the part's middle.
fn enclosed(a: &ConvexParts<'_>, b: &ConvexParts<'_>, a_from_b: &Placement<f64>) -> Option<Gap> {
    let enclosing_shape = a.enclosing_shape()?;
    let at = |b: Vector3<f64>| {
        let point = a_from_b.apply(b);
        (point, enclosing_shape.signed_distance(point))
    };
    let (point, distance) = match b {
        ConvexParts::Cloud(cloud) => {
            let mut deepest = (Vector3::zero(), 0.0);
            cloud.tree().nearest(
                0.0,
                |bounds| at(bounds.centre()).1 - bounds.half_diagonal(),
                |point, _| {
                    let point_and_distance = at(cloud.positions()[point as usize]);
                    if point_and_distance.1 < deepest.1 {
                        deepest = point_and_distance;
                    }
                    deepest.1
                },
            );
            deepest
        }
        _ => at(b.part(0).middle()),
    };
    if distance >= 0.0 {
        return None;
    }
    let nearest = enclosing_shape.nearest(point).1;
    let normal = (nearest - point) * distance.recip().abs();
    let distance = distance - b.radius();
    Some(Gap {
        distance,
        on_a: nearest,
        on_b: nearest + normal * distance,
        normal,
    })
}

/// The smallest distance of a part of A and a part of B.
fn surface_gap(
    a: &ConvexParts<'_>,
    b: &ConvexParts<'_>,
    a_from_b: &Placement<f64>,
    max_distance: f64,
) -> Option<Gap> {
    let radii = (a.radius(), b.radius());
    let lower_bound = |node_a: u32, node_b: u32| {
        let bounds = (a.node_bounds(node_a), b.node_bounds(node_b));
        box_distance(&bounds.0, &bounds.1, a_from_b) - radii.0 - radii.1
    };
    let mut best: Option<Gap> = None;
    let mut limit = max_distance;
    let mut stack = vec![(0, 0, lower_bound(0, 0))];
    while let Some((node_a, node_b, bound)) = stack.pop() {
        if bound > limit || (best.is_some() && bound >= limit) {
            continue;
        }
        let contents = (
            a.tree().map(|tree| tree.contents(node_a)),
            b.tree().map(|tree| tree.contents(node_b)),
        );
        let a_is_larger = || {
            let size = |bounds: BoundingBox| bounds.half_diagonal();
            size(a.node_bounds(node_a)) >= size(b.node_bounds(node_b))
        };
        let pairs = match contents {
            (Some(Contents::Nodes(children)), Some(Contents::Nodes(_))) if a_is_larger() => {
                children.map(|child| (child, node_b))
            }
            (_, Some(Contents::Nodes(children))) => children.map(|child| (node_a, child)),
            (Some(Contents::Nodes(children)), _) => children.map(|child| (child, node_b)),
            (on_a, on_b) => {
                if is_over() {
                    return best;
                }
                for (&i, &j) in items(&on_a)
                    .iter()
                    .flat_map(|i| items(&on_b).iter().map(move |j| (i, j)))
                {
                    let pair = Pair {
                        a: a.part(i as usize),
                        b: b.part(j as usize),
                        a_from_b: *a_from_b,
                    };
                    let part_gap = convex::gap(&pair, radii.0, radii.1, limit);
                    if let Some(gap) = part_gap.filter(|gap| gap.distance <= limit) {
                        limit = gap.distance;
                        best = Some(gap);
                    }
                }
                continue;
            }
        };
        let [nearer, farther] = pairs.map(|(i, j)| (i, j, lower_bound(i, j)));
        // The nearer pair is on top of the stack.
        stack.extend(if nearer.2 <= farther.2 {
            [farther, nearer]
        } else {
            [nearer, farther]
        });
    }
    best
}

fn items<'t>(contents: &'t Option<Contents<'t>>) -> &'t [u32] {
    match contents {
        Some(Contents::Items(items)) => items,
        _ => &[0],
    }
}

/// Lower bound of the distance of two boxes, by separating axes; negative if they may overlap.
///
/// The penetration depth of any two parts in the boxes is at most its absolute value.
fn box_distance(a: &BoundingBox, b: &BoundingBox, a_from_b: &Placement<f64>) -> f64 {
    let (half_a, half_b) = ((a.max - a.min) * 0.5, (b.max - b.min) * 0.5);
    let offset = a_from_b.apply(b.centre()) - a.centre();
    let rotation = &a_from_b.rotation;
    let distance_along = |axis: Vector3<f64>| {
        let in_b = rotation.transpose_mul(axis);
        let reach = |v: Vector3<f64>, half: Vector3<f64>| {
            v.x.abs() * half.x + v.y.abs() * half.y + v.z.abs() * half.z
        };
        offset.dot(axis).abs() - reach(axis, half_a) - reach(in_b, half_b)
    };
    let axes = Vector3::UNITS.into_iter();
    let axes = axes.chain([rotation.x, rotation.y, rotation.z]);
    axes.map(distance_along).fold(f64::NEG_INFINITY, f64::max)
}
