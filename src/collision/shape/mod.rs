//! The shapes: spheres, capsules, cylinders, boxes, half-spaces, convex hulls, triangle meshes, height fields and
//! clouds of points.

mod bounds;
mod convex_hull;
mod error;
mod geodesic;
mod height_field;
mod hull_climb;
mod near_welds;
mod point_cloud;
mod scaled;
mod signed_distance;
mod triangle_mesh;
mod triangle_sides;

use std::sync::Arc;

pub use bounds::Ball;
pub use convex_hull::ConvexHull;
pub(in crate::collision) use error::LARGEST;
pub use error::{ShapeError, ShapeNote};
pub use height_field::HeightField;
pub use point_cloud::PointCloud;
pub(crate) use signed_distance::{
    Nearest, hull_tree, nearest_on_cuboid, nearest_on_cylinder, nearest_on_hull,
};
pub(crate) use triangle_mesh::Feature;
pub use triangle_mesh::TriangleMesh;

use crate::robot::Geometry;
use crate::spatial::Vector3;
use error::{size, sizes};
use geodesic::around_unit_ball;

/// A shape whose numbers are checked, about its own origin; lengths in metres. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Shape {
    kind: ShapeKind,
}

/// What a [`Shape`] is. Lengths are whole lengths, as in [`Geometry`].
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum ShapeKind {
    /// About the origin.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// A cylinder along z with half a sphere at either end.
    Capsule {
        /// Of the cylinder and the spheres.
        radius: f64,
        /// Of the cylinder alone.
        length: f64,
    },
    /// A cylinder along z.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// From one end to the other.
        length: f64,
    },
    /// A box along x, y and z.
    Cuboid {
        /// Its whole lengths.
        size: [f64; 3],
    },
    /// Everything below z = 0.
    HalfSpace,
    /// The convex hull of points.
    Convex(Arc<ConvexHull>),
    /// Triangles, and what they enclose where they are closed.
    Mesh(Arc<TriangleMesh>),
    /// A surface over a grid in x and y, and what is below it.
    HeightField(Arc<HeightField>),
    /// Spheres of one radius about many points.
    Points(Arc<PointCloud>),
}

impl Shape {
    /// A sphere.
    ///
    /// # Errors
    /// A radius that is not a positive finite length.
    pub fn sphere(radius: f64) -> Result<Self, ShapeError> {
        let radius = size("radius of the sphere", radius)?;
        Ok(Self::of(ShapeKind::Sphere { radius }))
    }

    /// A capsule along z: all points at most `radius` from a segment of `length`.
    ///
    /// # Errors
    /// A radius or length that is not a positive finite length, or one 10¹² times the other.
    pub fn capsule(radius: f64, length: f64) -> Result<Self, ShapeError> {
        let [radius, length] = sizes([
            ("radius of the capsule", radius),
            ("length of the capsule", length),
        ])?;
        Ok(Self::of(ShapeKind::Capsule { radius, length }))
    }

    /// A cylinder along z, `length` from one end to the other.
    ///
    /// # Errors
    /// A radius or length that is not a positive finite length, or one 10¹² times the other.
    pub fn cylinder(radius: f64, length: f64) -> Result<Self, ShapeError> {
        let [radius, length] = sizes([
            ("radius of the cylinder", radius),
            ("length of the cylinder", length),
        ])?;
        Ok(Self::of(ShapeKind::Cylinder { radius, length }))
    }

    /// A box with its whole lengths along x, y and z.
    ///
    /// # Errors
    /// A length that is not positive and finite, or is 10¹² times another.
    pub fn cuboid([x, y, z]: [f64; 3]) -> Result<Self, ShapeError> {
        let size = sizes([
            ("length of the box along x", x),
            ("length of the box along y", y),
            ("length of the box along z", z),
        ])?;
        Ok(Self::of(ShapeKind::Cuboid { size }))
    }

    /// What holds an ellipsoid with these radii along x, y and z: a convex hull of 162 points, which sticks out of it by less than 2 % of a radius.
    ///
    /// # Errors
    /// A radius that is not positive and finite, or is 10¹² times another.
    pub fn ellipsoid([x, y, z]: [f64; 3]) -> Result<Self, ShapeError> {
        let radii = Vector3::from(sizes([
            ("radius of the ellipsoid along x", x),
            ("radius of the ellipsoid along y", y),
            ("radius of the ellipsoid along z", z),
        ])?);
        let scaled = |p: &Vector3<f64>| Vector3::new(p.x * radii.x, p.y * radii.y, p.z * radii.z);
        let corners: Vec<_> = around_unit_ball().iter().map(scaled).collect();
        Self::convex(&corners)
    }

    /// Everything below z = 0: a floor, or a wall where it is turned.
    #[must_use]
    pub fn half_space() -> Self {
        Self::of(ShapeKind::HalfSpace)
    }

    /// The convex hull of points that span a volume.
    ///
    /// # Errors
    /// Fewer than four points, points that are not finite, or that lie in one plane.
    pub fn convex(points: &[Vector3<f64>]) -> Result<Self, ShapeError> {
        Ok(Self::of(ShapeKind::Convex(Arc::new(ConvexHull::new(
            points,
        )?))))
    }

    /// A triangle mesh. Where it is closed, what it encloses belongs to it; else it is its surface alone, which
    /// [`notes`](Self::notes) tell. Vertices at one place count as one.
    ///
    /// # Errors
    /// No triangles, vertices that are not finite, or triangles of vertices that are not there.
    pub fn mesh(vertices: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Result<Self, ShapeError> {
        Ok(Self::of(ShapeKind::Mesh(Arc::new(TriangleMesh::new(
            vertices, triangles,
        )?))))
    }

    /// A ground: `heights` over a grid of `columns` places along x, row after row along y, `spacing` apart and
    /// centred on the origin; each cell is two triangles, and what is below the surface is solid, as far down from
    /// its lowest place as its longer side is.
    ///
    /// # Errors
    /// Fewer than two rows or columns, heights that are not finite or no whole number of rows, or a spacing that
    /// is not positive and finite.
    pub fn height_field(
        heights: Vec<f64>,
        columns: usize,
        spacing: [f64; 2],
    ) -> Result<Self, ShapeError> {
        Ok(Self::of(ShapeKind::HeightField(Arc::new(
            HeightField::new(heights, columns, spacing)?,
        ))))
    }

    /// Spheres of one `radius` about points, as of a camera's cloud.
    ///
    /// # Errors
    /// No points, points that are not finite, or a radius that is not a positive finite length.
    pub fn points(positions: Vec<Vector3<f64>>, radius: f64) -> Result<Self, ShapeError> {
        Ok(Self::of(ShapeKind::Points(Arc::new(PointCloud::new(
            positions, radius,
        )?))))
    }

    fn of(kind: ShapeKind) -> Self {
        Self { kind }
    }

    /// What it is.
    #[must_use]
    pub fn kind(&self) -> &ShapeKind {
        &self.kind
    }

    /// What was found and mended, or what it means for distances: an open mesh has no inside, say.
    #[must_use]
    pub fn notes(&self) -> &[ShapeNote] {
        match &self.kind {
            ShapeKind::Mesh(mesh) => mesh.notes(),
            _ => &[],
        }
    }
}

/// Shapes of a robot's file, but for meshes, which are files of their own.
impl TryFrom<&Geometry> for Shape {
    type Error = ShapeError;

    fn try_from(geometry: &Geometry) -> Result<Self, ShapeError> {
        match geometry {
            Geometry::Box { size } => Self::cuboid(*size),
            Geometry::Cylinder { radius, length } => Self::cylinder(*radius, *length),
            Geometry::Capsule { radius, length } => Self::capsule(*radius, *length),
            Geometry::Sphere { radius } => Self::sphere(*radius),
            Geometry::Ellipsoid { radii } => Self::ellipsoid(*radii),
            Geometry::Mesh { file, .. } => Err(ShapeError::NeedsFile { file: file.clone() }),
        }
    }
}
