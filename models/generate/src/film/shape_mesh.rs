//! Triangles of collision shapes.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DAffine3, DVec3};
use kinopt::collision::{Shape, ShapeKind};

use crate::Failure;
use crate::render::Scene;

/// Number of segments around the axis.
const AXIS_SEGMENTS: usize = 28;
/// Number of segments from pole to equator.
const QUARTER_SEGMENTS: usize = 7;

/// Mesh of a shape about the shape's origin, metres.
#[derive(Clone, Debug, Default)]
pub(super) struct ShapeMesh {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// Point of a profile: distance from the axis and height, then these components of the normal.
type ProfilePoint = [f64; 4];

impl ShapeMesh {
    /// Meshes a box, or a shape with rotational symmetry.
    pub(super) fn new(shape: &Shape) -> Result<Self, Failure> {
        match *shape.kind() {
            ShapeKind::Sphere { radius } => Ok(Self::revolved(&round_ends(radius, 0.0))),
            ShapeKind::Capsule { radius, length } => {
                Ok(Self::revolved(&round_ends(radius, 0.5 * length)))
            }
            ShapeKind::Cylinder { radius, length } => {
                Ok(Self::revolved(&flat_ends(radius, 0.5 * length)))
            }
            ShapeKind::Cuboid { size } => Ok(Self::cuboid(size.map(|length| 0.5 * length))),
            ref other => Err(format!("unsupported shape in the film: {other:?}").into()),
        }
    }

    /// Revolves a profile about z.
    fn revolved(profile: &[ProfilePoint]) -> Self {
        let mut mesh = Self::default();
        for corner in 0..AXIS_SEGMENTS {
            let (sin, cos) = (corner as f64 / AXIS_SEGMENTS as f64 * TAU).sin_cos();
            let rotated = |radial: f64, height: f64| DVec3::new(radial * cos, radial * sin, height);
            for &[radius, height, radial, along] in profile {
                mesh.positions.push(rotated(radius, height));
                mesh.normals.push(rotated(radial, along));
            }
        }
        let rows = profile.len() as u32;
        for corner in 0..AXIS_SEGMENTS as u32 {
            let current = corner * rows;
            let next = (corner + 1) % AXIS_SEGMENTS as u32 * rows;
            for row in 0..rows - 1 {
                let [a, b] = [current + row, next + row];
                mesh.triangles.extend([[a, b, a + 1], [b, b + 1, a + 1]]);
            }
        }
        mesh
    }

    /// A box with these half lengths.
    fn cuboid(half: [f64; 3]) -> Self {
        let mut mesh = Self::default();
        let half = DVec3::from(half);
        for (axis, sign) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
            let first = mesh.positions.len() as u32;
            let normal = DVec3::AXES[axis] * sign;
            let [u, v] = [1, 2].map(|next| DVec3::AXES[(axis + next) % 3]);
            for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                mesh.positions.push((normal + u * x + v * y) * half);
                mesh.normals.push(normal);
            }
            mesh.triangles
                .extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v: u32| v + first)));
        }
        mesh
    }

    /// Adds the mesh to a scene. `world_from_shape` may scale uniformly.
    pub(super) fn add_to(&self, scene: &mut Scene, world_from_shape: DAffine3, colour: DVec3) {
        let position = |p: &DVec3| world_from_shape.transform_point3(*p);
        let normal = |n: &DVec3| world_from_shape.transform_vector3(*n).normalize_or_zero();
        let positions: Vec<DVec3> = self.positions.iter().map(position).collect();
        let normals: Vec<DVec3> = self.normals.iter().map(normal).collect();
        scene.add(&positions, &normals, &self.triangles, colour);
    }
}

/// Profile of a capsule with this half length of its cylinder, from pole to pole.
fn round_ends(radius: f64, half: f64) -> Vec<ProfilePoint> {
    let arc = |centre: f64, first: f64| {
        (0..=QUARTER_SEGMENTS).map(move |step| {
            let (sin, cos) = (first + step as f64 / QUARTER_SEGMENTS as f64 * FRAC_PI_2).sin_cos();
            [radius * cos, centre + radius * sin, cos, sin]
        })
    };
    arc(-half, -FRAC_PI_2).chain(arc(half, 0.0)).collect()
}

/// Profile of a cylinder with this half length, with sharp edges.
fn flat_ends(radius: f64, half: f64) -> Vec<ProfilePoint> {
    vec![
        [0.0, -half, 0.0, -1.0],
        [radius, -half, 0.0, -1.0],
        [radius, -half, 1.0, 0.0],
        [radius, half, 1.0, 0.0],
        [radius, half, 0.0, 1.0],
        [0.0, half, 0.0, 1.0],
    ]
}
