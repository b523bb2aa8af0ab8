//! Addition of obstacles by their dimensions.

use std::sync::Arc;

use super::{Obstacle, World, WorldError, rigid};
use crate::collision::shape::{Shape, ShapeError};
use kinopt_kinematics::spatial::{Placement, Vector3};

impl World {
    /// Adds an obstacle that is fixed in the world.
    ///
    /// # Errors
    /// Returns an error if the name exists or is blank, or if the placement is not rigid or farther than 10⁹ m.
    pub fn add(
        &mut self,
        name: &str,
        shape: Shape,
        placement: impl Into<Placement<f64>>,
    ) -> Result<(), WorldError> {
        if name.trim().is_empty() {
            return Err(WorldError::Unnamed(name.to_owned()));
        }
        if self.find(name).is_some() {
            return Err(WorldError::Taken(name.to_owned()));
        }
        let placement = rigid(name, placement.into())?;
        let obstacle = Obstacle::new(name, shape, placement, None);
        self.push(Arc::new(obstacle));
        Ok(())
    }

    fn add_checked(
        &mut self,
        name: &str,
        shape: Result<Shape, ShapeError>,
        placement: impl Into<Placement<f64>>,
    ) -> Result<(), WorldError> {
        match shape {
            Ok(shape) => self.add(name, shape, placement),
            Err(error) => Err(WorldError::Shape {
                name: name.to_owned(),
                error,
            }),
        }
    }
}

/// Generates one method for each shape.
macro_rules! adders {
    ($($(#[$about:meta])* $name:ident($($given:ident: $kind:ty),*) = $shape:expr;)*) => {
        impl World {$(
            $(#[$about])*
            ///
            /// # Errors
            /// Returns an error if the name exists or is blank, if the placement is not rigid, or if the shape is
            /// invalid.
            pub fn $name(
                &mut self,
                name: &str,
                $($given: $kind,)*
                placement: impl Into<Placement<f64>>,
            ) -> Result<(), WorldError> {
                self.add_checked(name, $shape, placement)
            }
        )*}
    };
}

adders! {
    /// Adds a box with its full lengths along x, y and z, metres.
    add_box(size: [f64; 3]) = Shape::cuboid(size);
    /// Adds a sphere with its radius in metres.
    add_sphere(radius: f64) = Shape::sphere(radius);
    /// Adds a cylinder along z. `length` is the distance between its end faces, metres.
    add_cylinder(radius: f64, length: f64) = Shape::cylinder(radius, length);
    /// Adds a capsule along z. `length` is that of its segment, metres.
    add_capsule(radius: f64, length: f64) = Shape::capsule(radius, length);
    /// Adds the half-space below z = 0 of its placement.
    add_plane() = Ok(Shape::half_space());
    /// Adds the convex hull of points.
    add_convex(points: &[Vector3<f64>]) = Shape::convex(points);
    /// Adds a triangle mesh: see [`Shape::mesh`].
    add_mesh(vertices: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) = Shape::mesh(vertices, triangles);
    /// Adds spheres of one radius about points.
    add_points(positions: Vec<Vector3<f64>>, radius: f64) = Shape::points(positions, radius);
    /// Adds a height field: see [`Shape::height_field`].
    add_height_field(heights: Vec<f64>, columns: usize, spacing: [f64; 2]) =
        Shape::height_field(heights, columns, spacing);
}
