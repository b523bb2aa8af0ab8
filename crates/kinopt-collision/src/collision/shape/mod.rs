//! Collision shapes: spheres, capsules, cylinders, boxes, half-spaces, convex hulls, triangle meshes, height fields and
//! point clouds.

mod bounds;
mod convex_hull;
mod error;
mod geodesic;
mod height_field;
mod hull_climb;
mod near_welds;
mod nearest_on_solid;
mod point_cloud;
mod scaled;
mod signed_distance;
mod triangle_mesh;
mod triangle_sides;

use std::sync::Arc;

pub use bounds::Ball;
pub use convex_hull::ConvexHull;
pub(in crate::collision) use error::MAX_LENGTH;
pub use error::{ShapeError, ShapeNote};
pub use height_field::HeightField;
pub(crate) use nearest_on_solid::{Nearest, nearest_on_cuboid, nearest_on_cylinder};
pub use point_cloud::PointCloud;
pub(crate) use signed_distance::{hull_tree, nearest_on_hull};
pub use triangle_mesh::TriMesh;
pub(crate) use triangle_mesh::TriangleFeature;

use error::{size, sizes};
use geodesic::around_unit_ball;
use kinopt_kinematics::spatial::Vector3;
use kinopt_robot::robot::Geometry;

/// A validated collision shape about its own origin. Lengths are in metres. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Shape {
    kind: ShapeKind,
}

/// The kind of a [`Shape`], with its dimensions in metres. Lengths are full lengths, as in [`Geometry`].
#[derive(Clone, Debug)]
pub enum ShapeKind {
    /// A sphere about the origin.
    Sphere {
        /// Radius, metres.
        radius: f64,
    },
    /// A cylinder along z with a hemisphere at each end.
    Capsule {
        /// Radius of the cylinder and of the hemispheres, metres.
        radius: f64,
        /// Length of the cylinder without the hemispheres, metres.
        length: f64,
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius, metres.
        radius: f64,
        /// Distance between the two end faces, metres.
        length: f64,
    },
    /// A box aligned with x, y and z, centred on the origin.
    Cuboid {
        /// Full lengths along x, y and z, metres.
        size: [f64; 3],
    },
    /// The half-space below z = 0.
    HalfSpace,
    /// The convex hull of a set of points.
    Convex(Arc<ConvexHull>),
    /// A triangle mesh: the enclosed solid if it is closed, else its surface.
    Mesh(Arc<TriMesh>),
    /// A surface over a grid in x and y, and the solid below it.
    HeightField(Arc<HeightField>),
    /// Spheres of one radius about a set of points.
    Points(Arc<PointCloud>),
}

impl Shape {
    /// A sphere.
    ///
    /// # Errors
    /// Returns [`ShapeError::Size`] if the radius is not between 1e-9 and 1e9 m.
    pub fn sphere(radius: f64) -> Result<Self, ShapeError> {
        let radius = size("radius of the sphere", radius)?;
        Ok(Self::of(ShapeKind::Sphere { radius }))
    }

    /// A capsule along z: all points at most `radius` from a segment of `length`.
    ///
    /// # Errors
    /// Returns [`ShapeError::Size`] if the radius or the length is not between 1e-9 and 1e9 m. Returns
    /// [`ShapeError::Slender`] if one is more than 10¹² times the other.
    pub fn capsule(radius: f64, length: f64) -> Result<Self, ShapeError> {
        let [radius, length] = sizes([
            ("radius of the capsule", radius),
            ("length of the capsule", length),
        ])?;
        Ok(Self::of(ShapeKind::Capsule { radius, length }))
    }

    /// A cylinder along z. `length` is the distance between its end faces.
    ///
    /// # Errors
    /// Returns [`ShapeError::Size`] if the radius or the length is not between 1e-9 and 1e9 m. Returns
    /// [`ShapeError::Slender`] if one is more than 10¹² times the other.
    pub fn cylinder(radius: f64, length: f64) -> Result<Self, ShapeError> {
        let [radius, length] = sizes([
            ("radius of the cylinder", radius),
            ("length of the cylinder", length),
        ])?;
        Ok(Self::of(ShapeKind::Cylinder { radius, length }))
    }

    /// A box with the given full lengths along x, y and z.
    ///
    /// # Errors
    /// Returns [`ShapeError::Size`] if a length is not between 1e-9 and 1e9 m. Returns [`ShapeError::Slender`] if one
    /// is more than 10¹² times another.
    pub fn cuboid([x, y, z]: [f64; 3]) -> Result<Self, ShapeError> {
        let size = sizes([
            ("length of the box along x", x),
            ("length of the box along y", y),
            ("length of the box along z", z),
        ])?;
        Ok(Self::of(ShapeKind::Cuboid { size }))
    }

    /// A convex hull of 162 points that encloses the ellipsoid with the given radii along x, y and z.
    ///
    /// The hull protrudes from the ellipsoid by less than 2 % of a radius.
    ///
    /// # Errors
    /// Returns [`ShapeError::Size`] if a radius is not between 1e-9 and 1e9 m. Returns [`ShapeError::Slender`] if one
    /// is more than 10¹² times another.
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

    /// The half-space below z = 0: a floor, or a wall once it is rotated.
    #[must_use]
    pub fn half_space() -> Self {
        Self::of(ShapeKind::HalfSpace)
    }

    /// The convex hull of `points`, which must span a volume.
    ///
    /// # Errors
    /// Returns an error if there are fewer than four points, a coordinate is not finite or exceeds 10⁹, or the points
    /// are coplanar.
    pub fn convex(points: &[Vector3<f64>]) -> Result<Self, ShapeError> {
        Ok(Self::of(ShapeKind::Convex(Arc::new(ConvexHull::new(
            points,
        )?))))
    }

    /// A triangle mesh. A closed mesh is the enclosed solid. An open mesh is its surface alone, as
    /// [`notes`](Self::notes) report. Vertices at the same position are merged.
    ///
    /// # Errors
    /// Returns an error if there are no triangles or a coordinate is not finite or exceeds 10⁹. Also if a triangle has
    /// the index of a vertex that does not exist.
    pub fn mesh(vertices: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Result<Self, ShapeError> {
        Ok(Self::of(ShapeKind::Mesh(Arc::new(TriMesh::new(
            vertices, triangles,
        )?))))
    }

    /// A terrain given by `heights` over a grid that is centred on the origin.
    ///
    /// `heights` holds one row along x after the other along y, with `columns` heights a row. `spacing` is the distance
    /// of neighbours along x and y. Each cell consists of two triangles. The volume below the surface is solid. Its
    /// floor lies below the lowest height by the length of the grid's longer side.
    ///
    /// # Errors
    /// Returns an error if there are fewer than two rows or columns, or if the heights do not fill a whole number of
    /// rows. Returns [`ShapeError::Coordinate`] if a height is not finite or exceeds 10⁹ m. Returns
    /// [`ShapeError::Size`] if a spacing is not between 1e-9 and 1e9 m.
    pub fn height_field(
        heights: Vec<f64>,
        columns: usize,
        spacing: [f64; 2],
    ) -> Result<Self, ShapeError> {
        Ok(Self::of(ShapeKind::HeightField(Arc::new(
            HeightField::new(heights, columns, spacing)?,
        ))))
    }

    /// Spheres of one `radius` about `positions`, such as the point cloud of a depth camera.
    ///
    /// # Errors
    /// Returns an error if there are no points, or if a coordinate is not finite or exceeds 10⁹ m. Returns
    /// [`ShapeError::Size`] if the radius is not between 1e-9 and 1e9 m.
    pub fn points(positions: Vec<Vector3<f64>>, radius: f64) -> Result<Self, ShapeError> {
        Ok(Self::of(ShapeKind::Points(Arc::new(PointCloud::new(
            positions, radius,
        )?))))
    }

    fn of(kind: ShapeKind) -> Self {
        Self { kind }
    }

    /// The kind of the shape, with its dimensions.
    #[must_use]
    pub fn kind(&self) -> &ShapeKind {
        &self.kind
    }

    /// Findings about the shape: repairs, and properties that affect distances, such as an open mesh without an inside.
    #[must_use]
    pub fn notes(&self) -> &[ShapeNote] {
        match &self.kind {
            ShapeKind::Mesh(mesh) => mesh.notes(),
            _ => &[],
        }
    }
}

/// Converts all geometries of a robot's file except meshes, which lie in files of their own.
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
