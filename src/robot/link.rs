//! What a link is made of: shapes and mass. Kinematics needs none of it.

use crate::spatial::Placement;

/// A link's shapes and mass, as its file gives them.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Link {
    /// What it looks like.
    pub visuals: Vec<Shape>,
    /// What it bumps into things with.
    pub collisions: Vec<Shape>,
    /// Its mass; `None` where the file states none, or leaves it to meshes.
    pub inertial: Option<Inertial>,
    /// What of its mass stands in the files of meshes, which are not opened: MJCF weighs shapes.
    pub left_to_meshes: Option<LeftToMeshes>,
}

/// What of a mass cannot be known without opening the file of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum LeftToMeshes {
    /// How much there is: a volume times a density.
    Mass,
    /// Where its centre is.
    Centre {
        /// Kilograms, which are stated.
        mass: f64,
    },
}

/// A body of a link.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Shape {
    /// Its name, which few have.
    pub name: Option<String>,
    /// Where it stands in the link's frame.
    pub link_from_shape: Placement<f64>,
    /// What it is.
    pub geometry: Geometry,
}

/// The kinds of bodies, centred on their own origins; lengths in metres.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Geometry {
    /// A box with its whole lengths along x, y and z.
    Box {
        /// Along x, y and z.
        size: [f64; 3],
    },
    /// A cylinder along z.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// From one end to the other.
        length: f64,
    },
    /// A cylinder along z with half a sphere at either end.
    Capsule {
        /// Of the cylinder and the spheres.
        radius: f64,
        /// Of the cylinder alone.
        length: f64,
    },
    /// A sphere.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// An ellipsoid, which MJCF knows.
    Ellipsoid {
        /// Its radii along x, y and z.
        radii: [f64; 3],
    },
    /// A mesh in a file of its own, which is not opened.
    Mesh {
        /// As it stands in the robot's file: `package://…`, `file://…` or a path.
        file: String,
        /// Factors along x, y and z.
        scale: [f64; 3],
    },
}

/// The mass of a link and how it is spread.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Inertial {
    /// Kilograms.
    pub mass: f64,
    /// The frame that the moments are in; its origin is the centre of mass, in the link's frame.
    pub link_from_inertia: Placement<f64>,
    /// Moments of inertia about the centre of mass, kg·m²: symmetric, rows of the matrix.
    pub moments: [[f64; 3]; 3],
}
