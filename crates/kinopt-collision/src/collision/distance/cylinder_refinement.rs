//! Refinement of distances of cylinders to full precision.
//!
//! The signed distance of convex bodies is the maximum over directions n of the gap −h_B(−n) − h_A(n), with the support
//! functions h. Simplex searches converge only linearly to the direction of a round body. The refinement solves for it.
//! A rim is a circle, a side is the axis with a radius, and a polyhedron contributes nearby vertices and the lines
//! between them. Each pair of features gives a stationary direction. The direction with the widest gap wins, which
//! cannot increase the error.

use kinopt_kinematics::spatial::{Placement, Vector3};

use super::core_and_radius::{Core, Gap, Pair};
use super::nearest_features::{Candidate, Feature, across, stationary, unit};

/// Depth below the support point up to which vertices are candidates, relative to the scale of the pair.
const CANDIDATE_DEPTH: f64 = 1e-4;
/// Largest offset from the found point at which a candidate's point replaces it, relative to the scale of the pair.
const MAX_POINT_OFFSET: f64 = 1e-3;
/// Difference below which two gaps count as equal, relative to the scale of the pair.
const EQUAL_GAP_TOLERANCE: f64 = 1e-15;
/// Sine of the angle below which a direction counts as perpendicular to a face.
const PERPENDICULAR_TOLERANCE: f64 = 1e-9;

/// The gap, refined to full precision.
pub(super) fn refined(pair: &Pair<'_>, estimate: Gap) -> Gap {
    let scale = pair.scale();
    let a = features(&pair.a, &Placement::identity(), estimate.normal, scale);
    let b = features(&pair.b, &pair.a_from_b, -estimate.normal, scale);
    let flat = a.1.into_iter().chain(b.1).map(|normal| (normal, None));
    let mut candidates: Vec<Candidate> = flat.collect();
    for &on_a in &a.0 {
        for &on_b in &b.0 {
            candidates.extend(stationary(on_a, on_b, &estimate));
        }
    }
    // Last: among equal gaps, a computed direction is more accurate.
    candidates.push((estimate.normal, None));
    let mut best = Gap {
        distance: f64::NEG_INFINITY,
        ..estimate
    };
    for (normal, on_a) in candidates {
        let is_reversed = normal.dot(estimate.normal) < 0.0;
        let normal = if is_reversed { -normal } else { normal };
        let gap = pair.gap_along(normal);
        // Among equal gaps the first remains.
        if gap > best.distance + EQUAL_GAP_TOLERANCE * scale {
            // A distant point is on another part of a face; for the side of a cylinder, the point is on the axis.
            let offset = |p: Vector3<f64>| across(p - estimate.on_a, normal).norm();
            let near = on_a.filter(|&p| offset(p) <= MAX_POINT_OFFSET * scale);
            best = Gap {
                distance: gap,
                on_a: near.unwrap_or(estimate.on_a),
                normal,
                ..estimate
            };
        }
    }
    with_projected_points(pair, best)
}

/// The gap with its points projected onto the parts of both bodies that are farthest along the normal.
fn with_projected_points(pair: &Pair<'_>, gap: Gap) -> Gap {
    let Gap {
        distance,
        on_a,
        normal,
        ..
    } = gap;
    let offset = normal * distance;
    let onto_a = |p| farthest_part(&pair.a, &Placement::identity(), normal, p);
    let onto_b = |p| farthest_part(&pair.b, &pair.a_from_b, -normal, p);
    let (dimension_a, dimension_b) = (onto_a(on_a).0, onto_b(on_a + offset).0);
    // The part of higher dimension comes last: its projection does not move the point off the other part.
    let on_a = match dimension_a <= dimension_b {
        true => onto_b(onto_a(on_a).1 + offset).1 - offset,
        false => onto_a(onto_b(on_a + offset).1 - offset).1,
    };
    Gap {
        on_a,
        on_b: on_a + offset,
        ..gap
    }
}

/// Dimension of a core's farthest part along a direction, and the point of that part next to `near`.
fn farthest_part(
    core: &Core<'_>,
    at: &Placement<f64>,
    along: Vector3<f64>,
    near: Vector3<f64>,
) -> (usize, Vector3<f64>) {
    let Core::Cylinder { radius, half } = core else {
        // Vertex, edge or face: a point across the normal remains as found.
        let top = at
            .apply(core.support(at.rotation.transpose_mul(along)))
            .dot(along);
        return (2, near + along * (top - near.dot(along)));
    };
    let inward = at.rotation.transpose_mul(along);
    let local = at.inverse().apply(near);
    let side = (inward.x * inward.x + inward.y * inward.y).sqrt();
    if side < PERPENDICULAR_TOLERANCE {
        let axis_distance = (local.x * local.x + local.y * local.y).sqrt();
        let scale = if axis_distance > *radius {
            radius / axis_distance
        } else {
            1.0
        };
        let on_end = Vector3::new(local.x * scale, local.y * scale, half.copysign(inward.z));
        return (2, at.apply(on_end));
    }
    let scale = radius / side;
    let z = match inward.z.abs() < PERPENDICULAR_TOLERANCE {
        true => local.z.clamp(-half, *half),
        false => half.copysign(inward.z),
    };
    let dimension = usize::from(inward.z.abs() < PERPENDICULAR_TOLERANCE);
    (
        dimension,
        at.apply(Vector3::new(inward.x * scale, inward.y * scale, z)),
    )
}

/// The features of a core that may touch along a direction, and the normals of its flat faces there.
fn features(
    core: &Core<'_>,
    at: &Placement<f64>,
    along: Vector3<f64>,
    scale: f64,
) -> (Vec<Feature>, Vec<Vector3<f64>>) {
    let corners: Vec<Vector3<f64>> = match core {
        Core::Cylinder { radius, half } => {
            let axis = at.rotation.z;
            let end = at.translation + axis * half.copysign(along.dot(axis));
            let rim = Feature::Circle(end, [at.rotation.x, at.rotation.y], *radius);
            return (vec![rim, Feature::Line(at.translation, axis)], vec![axis]);
        }
        Core::Point(p) => vec![*p],
        Core::Segment(half) => [-half, *half].map(|z| Vector3::new(0.0, 0.0, z)).to_vec(),
        Core::Triangle(corners) => corners.to_vec(),
        Core::Box(half) => (0..8_u8)
            .map(|i| {
                let side = |bit: u8, half: f64| if i & bit == 0 { half } else { -half };
                Vector3::new(side(1, half.x), side(2, half.y), side(4, half.z))
            })
            .collect(),
        Core::Hull(hull) => hull.vertices().to_vec(),
    };
    let mut corners: Vec<_> = corners.into_iter().map(|p| at.apply(p)).collect();
    corners.sort_by(|p, q| q.dot(along).total_cmp(&p.dot(along)));
    let min_projection = corners[0].dot(along) - CANDIDATE_DEPTH * scale;
    // More vertices do not belong to one face but to a finely faceted round surface.
    corners.truncate(
        corners
            .iter()
            .take_while(|p| p.dot(along) >= min_projection)
            .count()
            .min(6),
    );
    let mut features: Vec<_> = corners.iter().map(|&p| Feature::Point(p)).collect();
    let mut normals = Vec::new();
    for (i, &p) in corners.iter().enumerate() {
        for (j, &q) in corners.iter().enumerate().skip(i + 1) {
            let Some(direction) = unit(q - p) else {
                continue;
            };
            features.push(Feature::Line(p, direction));
            let third = corners.iter().skip(j + 1);
            normals.extend(third.filter_map(|&r| unit(direction.cross(r - p))));
        }
    }
    (features, normals)
}
