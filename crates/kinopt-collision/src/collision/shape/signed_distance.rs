//! Signed distances from points to shapes.

use super::nearest_on_solid::{Nearest, nearest_on_cuboid, nearest_on_cylinder};
use super::{ConvexHull, HeightField, PointCloud, Shape, ShapeKind, TriMesh, TriangleFeature};
use crate::collision::aabb_tree::AabbTree;
use crate::collision::bounding_box::BoundingBox;
use crate::collision::distance::{Core, Pair, convex_gap};
use crate::collision::wide_aabb_tree::Predicate;
use kinopt_kinematics::spatial::{Placement, Vector3};

impl Shape {
    /// The signed distance, metres, from a point in the shape's frame to its surface; negative inside.
    ///
    /// Exact up to rounding. Inside a point cloud it is the depth in the sphere that the point is deepest in. An open
    /// mesh has no inside.
    #[must_use]
    pub fn signed_distance(&self, point: Vector3<f64>) -> f64 {
        self.nearest(point).0
    }

    /// True if [`signed_distance`](Self::signed_distance) is below `reach`; stops at the first part of a shape that is.
    #[cfg_attr(not(debug_assertions), inline(always))]
    #[doc(hidden)]
    pub fn is_within(&self, p: Vector3<f64>, reach: f64) -> bool {
        match self.kind() {
            ShapeKind::Mesh(mesh) => {
                mesh.tree().any(p, reach, &MeshQuery(mesh, p, reach))
                    || mesh.is_closed() && self.signed_distance(p) < reach
            }
            ShapeKind::HeightField(field) => {
                field.tree().any(p, reach, &FieldQuery(field, p, reach))
                    || field.contains(p) && (reach > 0.0 || self.signed_distance(p) < reach)
            }
            ShapeKind::Points(cloud) => {
                let centre_reach = reach + cloud.radius();
                cloud
                    .tree()
                    .any(p, centre_reach, &CloudQuery(cloud, p, reach))
            }
            _ => self.signed_distance(p) < reach,
        }
    }

    /// The [signed distance](Self::signed_distance) and the closest point on the surface.
    pub(crate) fn nearest(&self, p: Vector3<f64>) -> Nearest {
        match self.kind() {
            ShapeKind::Sphere { radius } => from_core(p, Vector3::zero(), *radius),
            ShapeKind::Capsule { radius, length } => {
                let along = p.z.clamp(-0.5 * length, 0.5 * length);
                from_core(p, Vector3::new(0.0, 0.0, along), *radius)
            }
            ShapeKind::Cylinder { radius, length } => nearest_on_cylinder(p, *radius, 0.5 * length),
            ShapeKind::Cuboid { size } => nearest_on_cuboid(p, Vector3::from(*size) * 0.5),
            ShapeKind::HalfSpace => (p.z, Vector3::new(p.x, p.y, 0.0)),
            ShapeKind::Convex(hull) => nearest_on_convex(p, hull),
            ShapeKind::Mesh(mesh) => nearest_on_mesh(p, mesh),
            ShapeKind::HeightField(field) => nearest_on_field(p, field),
            ShapeKind::Points(cloud) => nearest_on_cloud(p, cloud),
        }
    }
}

/// Predicates of [`AabbTree::any`]: an element is nearer to a point than a given distance. The element is a triangle of
/// a mesh or height field, or a sphere of a cloud.
struct MeshQuery<'a>(&'a TriMesh, Vector3<f64>, f64);
struct FieldQuery<'a>(&'a HeightField, Vector3<f64>, f64);
struct CloudQuery<'a>(&'a PointCloud, Vector3<f64>, f64);

impl Predicate<u32> for MeshQuery<'_> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_met(&self, index: u32) -> bool {
        distance_to_triangle(self.1, self.0.triangle(index as usize)) < self.2
    }
}

impl Predicate<u32> for FieldQuery<'_> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_met(&self, index: u32) -> bool {
        distance_to_triangle(self.1, self.0.triangle(index as usize)) < self.2
    }
}

impl Predicate<u32> for CloudQuery<'_> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_met(&self, index: u32) -> bool {
        let distance = (self.1 - self.0.positions()[index as usize]).norm();
        distance - self.0.radius() < self.2
    }
}

/// Nearest point on a sphere about `core`, the closest point of the shape's core.
fn from_core(p: Vector3<f64>, core: Vector3<f64>, radius: f64) -> Nearest {
    let offset = p - core;
    let distance = offset.norm();
    // In the core all directions are equally short. For a capsule, x is perpendicular to the axis.
    let direction = match distance > 0.0 {
        true => offset * distance.recip(),
        false => Vector3::UNITS[0],
    };
    (distance - radius, core + direction * radius)
}

fn nearest_on_convex(p: Vector3<f64>, hull: &ConvexHull) -> Nearest {
    let (distance, normal) = hull.farthest_face(p);
    if distance <= 0.0 {
        return (distance, p - normal * distance);
    }
    let pair = Pair {
        a: Core::Hull(hull),
        b: Core::Point(p),
        a_from_b: Placement::identity(),
    };
    let gap = convex_gap(&pair, 0.0, 0.0, f64::INFINITY);
    gap.map_or((f64::INFINITY, p), |gap| (gap.distance, gap.on_a))
}

/// AABB tree over the triangles of a hull, for [`nearest_on_hull`].
pub(crate) fn hull_tree(hull: &ConvexHull) -> AabbTree {
    let corners = |i: usize| hull_triangle(hull, i);
    AabbTree::new(hull.triangles().len(), |i| BoundingBox::around(corners(i)))
}

fn hull_triangle(hull: &ConvexHull, index: usize) -> [Vector3<f64>; 3] {
    hull.triangles()[index].map(|corner| hull.vertices()[corner as usize])
}

/// As [`Shape::nearest`] up to rounding. Faster for hulls with many triangles.
pub(crate) fn nearest_on_hull(p: Vector3<f64>, hull: &ConvexHull, tree: &AabbTree) -> Nearest {
    let (_, distance, nearest, _) = nearest_triangle(p, tree, |i| hull_triangle(hull, i));
    // A convex body lies on one side of the plane through the closest point, perpendicular to the offset. The point is
    // outside if it is on the other side.
    match (hull.middle() - nearest).dot(p - nearest) > 0.0 {
        true => (-distance, nearest),
        false => (distance, nearest),
    }
}

/// The nearest of many triangles: its index, its distance, the closest point and the feature that holds that point.
fn nearest_triangle(
    p: Vector3<f64>,
    tree: &AabbTree,
    triangle: impl Fn(usize) -> [Vector3<f64>; 3],
) -> (usize, f64, Vector3<f64>, TriangleFeature) {
    let mut best = (0, f64::INFINITY, p, TriangleFeature::Face);
    tree.nearest(
        f64::INFINITY,
        |bounds| bounds.squared_distance(p).sqrt(),
        |index, min_distance| {
            let (nearest, feature) = nearest_on_triangle(p, triangle(index as usize));
            let distance = (p - nearest).norm();
            if distance < min_distance {
                best = (index as usize, distance, nearest, feature);
            }
            distance.min(min_distance)
        },
    );
    best
}

fn nearest_on_mesh(p: Vector3<f64>, mesh: &TriMesh) -> Nearest {
    let (triangle, distance, nearest, feature) =
        nearest_triangle(p, mesh.tree(), |i| mesh.triangle(i));
    let outward = mesh.outward(triangle, feature);
    match outward.is_some_and(|out| out.dot(p - nearest) < 0.0) {
        true => (-distance, nearest),
        false => (distance, nearest),
    }
}

fn nearest_on_field(p: Vector3<f64>, field: &HeightField) -> Nearest {
    let (_, distance, nearest, _) = nearest_triangle(p, field.tree(), |i| field.triangle(i));
    match field.contains(p) {
        true => (-distance, nearest),
        false => (distance, nearest),
    }
}

fn nearest_on_cloud(p: Vector3<f64>, cloud: &PointCloud) -> Nearest {
    let mut nearest = None;
    cloud.tree().nearest(
        f64::INFINITY,
        |bounds| bounds.squared_distance(p),
        |index, min_squared_distance| {
            let point = cloud.positions()[index as usize];
            let squared_distance = (p - point).norm_squared();
            if squared_distance < min_squared_distance {
                nearest = Some(point);
            }
            squared_distance.min(min_squared_distance)
        },
    );
    match nearest {
        Some(point) => from_core(p, point, cloud.radius()),
        None => (f64::INFINITY, p),
    }
}

fn distance_to_triangle(p: Vector3<f64>, corners: [Vector3<f64>; 3]) -> f64 {
    (p - nearest_on_triangle(p, corners).0).norm()
}

/// The closest point of a triangle to a point (Ericson, "Real-Time Collision Detection", 5.1.5), and its feature.
///
/// A triangle without area counts as its sides.
fn nearest_on_triangle(
    p: Vector3<f64>,
    corners: [Vector3<f64>; 3],
) -> (Vector3<f64>, TriangleFeature) {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let sides = [b - a, c - b, a - c];
    // The projection is inside the triangle if it is on the inner side of all three edges.
    let inner = (0..3).all(|i| sides[i].cross(p - corners[i]).dot(normal) > 0.0);
    if inner {
        let height = normal.dot(p - a) / normal.norm_squared();
        return (p - normal * height, TriangleFeature::Face);
    }
    let mut best = (f64::INFINITY, a, TriangleFeature::Corner(0));
    for i in 0..3 {
        let (from, side) = (corners[i], sides[i]);
        let share = side.dot(p - from) / side.norm_squared();
        let (nearest, feature) = match share {
            share if share > 0.0 && share < 1.0 => (from + side * share, TriangleFeature::Side(i)),
            share if share >= 1.0 => (corners[(i + 1) % 3], TriangleFeature::Corner((i + 1) % 3)),
            _ => (from, TriangleFeature::Corner(i)),
        };
        let squared_distance = (p - nearest).norm_squared();
        if squared_distance < best.0 {
            best = (squared_distance, nearest, feature);
        }
    }
    (best.1, best.2)
}

#[cfg(test)]
#[allow(clippy::expect_used, clippy::panic, reason = "it is a test")]
mod tests {
    use super::*;

    /// The faces of the octahedron |x| + |y| + |z| = 1 are 1 / √3 from its centre. Each is the nearest in its octant.
    #[test]
    fn hull_tree_contains_every_triangle() {
        let corners = Vector3::UNITS.map(|unit| [unit, -unit]);
        let shape = Shape::convex(corners.as_flattened()).expect("points that span a volume");
        let ShapeKind::Convex(hull) = shape.kind() else {
            panic!("a hull");
        };
        let tree = hull_tree(hull);
        for octant in 0..8 {
            let sign = |axis: u32| if octant >> axis & 1 == 0 { 1.0 } else { -1.0 };
            let out = Vector3::new(sign(0), sign(1), sign(2));
            for reach in [0.2, 0.4, 2.0] {
                let (distance, nearest) = nearest_on_hull(out * reach, hull, &tree);
                let expected = (3.0 * reach - 1.0) / 3.0_f64.sqrt();
                assert!(
                    (distance - expected).abs() < 1e-12,
                    "{out:?}: {distance} {expected}"
                );
                assert!((nearest - out * (1.0 / 3.0)).norm() < 1e-12, "{nearest:?}");
            }
        }
    }

    #[test]
    fn hull_tree_distance_equals_plane_distance() {
        let number =
            |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24) - 0.5;
        let point =
            |k: u32| Vector3::new(number(3 * k), number(3 * k + 1), 0.3 * number(3 * k + 2));
        let corners: Vec<_> = (0..200).map(point).collect();
        let shape = Shape::convex(&corners).expect("points that span a volume");
        let ShapeKind::Convex(hull) = shape.kind() else {
            panic!("a hull");
        };
        let tree = hull_tree(hull);
        for k in 1000..3000 {
            let p = point(k) * 1.6;
            let (expected, nearest) = shape.nearest(p);
            let (distance, tree_nearest) = nearest_on_hull(p, hull, &tree);
            assert!((distance - expected).abs() < 1e-12, "{distance} {expected}");
            // Inside, two faces may be equally near.
            assert!(distance < 0.0 || (tree_nearest - nearest).norm() < 1e-6);
        }
    }
}
