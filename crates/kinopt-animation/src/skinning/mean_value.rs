//! Mean-value coordinates for closed triangle meshes.
//!
//! Source: Ju, Schaefer & Warren 2005. The weights of a triangle come from its mean vector (their section 3.2; Floater,
//! Kós & Reimers 2005) instead of angles and square roots. This loses fewer digits near the planes of triangles.

use glam::DVec3;

use kinopt_kinematics::scalar::elementary;

/// Largest distance from a corner at which a point coincides with it, relative to the size of the cage.
const CORNER_TOLERANCE: f64 = 1e-9;
/// Largest triple product of the unit directions to a triangle's corners at which a point is in the triangle's plane.
///
/// Also the largest deviation of half their angle sum from π at which the point is on the triangle, radians. The
/// neglected weights are of the size of the rounding error.
const PLANE_TOLERANCE: f64 = 1e-8;

/// Fills `row` with the coordinates of one point, which sum to 1. Returns false if their sum is zero. `size` is the
/// diagonal of the cage's bounding box; triangle indices are in range.
pub(super) fn mean_value_coordinates(
    corners: &[DVec3],
    triangles: &[[u32; 3]],
    size: f64,
    point: DVec3,
    row: &mut [f64],
) -> bool {
    row.fill(0.0);
    if let Some(corner) = corners
        .iter()
        .position(|c| c.distance(point) <= CORNER_TOLERANCE * size)
    {
        row[corner] = 1.0;
        return true;
    }
    for indices in triangles {
        let indices = indices.map(|index| index as usize);
        match triangle_weights(indices.map(|index| corners[index] - point)) {
            Weights::Away(weights) => {
                for (index, weight) in indices.into_iter().zip(weights) {
                    row[index] += weight;
                }
            }
            Weights::InPlane => {}
            Weights::On(weights) => {
                row.fill(0.0);
                for (index, weight) in indices.into_iter().zip(weights) {
                    row[index] = weight;
                }
                break;
            }
        }
    }
    let sum: f64 = row.iter().sum();
    let size: f64 = row.iter().map(|weight| weight.abs()).sum();
    for weight in row.iter_mut() {
        *weight /= sum;
    }
    sum.abs() > 1e-12 * size
}

/// Contribution of a triangle to the weights of its corners.
enum Weights {
    /// The point lies off the triangle's plane.
    Away([f64; 3]),
    /// The point lies in the plane outside the triangle: no contribution.
    InPlane,
    /// The point lies on the triangle. These are barycentric coordinates up to their sum.
    On([f64; 3]),
}

/// Weights of a triangle; `arms` are the vectors from the point to the corners.
fn triangle_weights(arms: [DVec3; 3]) -> Weights {
    let lengths = arms.map(DVec3::length);
    let units = [0, 1, 2].map(|i| arms[i] / lengths[i]);
    // Angles opposite each corner, seen from the point; accurate near 0 and π.
    let angles = [0, 1, 2].map(|i| {
        let (next, last) = (units[(i + 1) % 3], units[(i + 2) % 3]);
        2.0 * elementary::atan2((next - last).length(), (next + last).length())
    });
    let volume = units[0].dot(units[1].cross(units[2]));
    if volume.abs() <= PLANE_TOLERANCE {
        let half_turn = angles.iter().sum::<f64>() / 2.0;
        if std::f64::consts::PI - half_turn > PLANE_TOLERANCE {
            return Weights::InPlane;
        }
        // In a triangle 2-D mean-value coordinates are barycentric coordinates (their figure 4).
        return Weights::On(
            [0, 1, 2]
                .map(|i| elementary::sin(angles[i]) * lengths[(i + 1) % 3] * lengths[(i + 2) % 3]),
        );
    }
    // Normals of the planes through the point and an edge, on the side of corner i.
    let normals = [0, 1, 2].map(|i| units[(i + 1) % 3].cross(units[(i + 2) % 3]).normalize());
    let mean: DVec3 = (0..3).map(|i| 0.5 * angles[i] * normals[i]).sum();
    // m = Σ_i w_i (c_i − x), projected on each normal, which is orthogonal to the other two arms.
    Weights::Away([0, 1, 2].map(|i| normals[i].dot(mean) / normals[i].dot(arms[i])))
}
