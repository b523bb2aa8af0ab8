//! Shapes and masses of links. Kinematics does not use them.

use kinopt_kinematics::spatial::Placement;

/// Shapes and mass of a link, as its file states them.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Link {
    /// Shapes for display.
    pub visuals: Vec<GeometryObject>,
    /// Shapes for collision checks.
    pub collisions: Vec<GeometryObject>,
    /// Mass and inertia. `None` if the file states none, or if they depend on mesh files.
    pub inertial: Option<Inertial>,
    /// The part of the inertia that depends on mesh files, which the reader does not open. Only MJCF computes masses
    /// from shapes.
    pub left_to_meshes: Option<MissingInertia>,
}

/// Mass properties that are unknown without opening a mesh file.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum MissingInertia {
    /// The mass: a volume times a density.
    Mass,
    /// The centre of mass; the mass itself is known.
    Centre {
        /// Mass in kilograms, as the file states it.
        mass: f64,
    },
}

/// A shape of a link, for display or for collision checks.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GeometryObject {
    /// Name of the shape, if the file gives one.
    pub name: Option<String>,
    /// Pose of the shape in the link's frame.
    pub link_from_shape: Placement<f64>,
    /// Type and dimensions.
    pub geometry: Geometry,
}

/// Types of shapes, each centred on its origin; lengths in metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// A box.
    Box {
        /// Full lengths along x, y and z.
        size: [f64; 3],
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Length along z, from end to end.
        length: f64,
    },
    /// A capsule: a cylinder along z with a half-sphere at each end.
    Capsule {
        /// Radius of the cylinder and of the half-spheres.
        radius: f64,
        /// Length of the cylinder without the half-spheres.
        length: f64,
    },
    /// A sphere.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// An ellipsoid (MJCF only).
    Ellipsoid {
        /// Radii along x, y and z.
        radii: [f64; 3],
    },
    /// A mesh in a separate file, which the reader does not open.
    Mesh {
        /// Reference as the robot's file states it: `package://…`, `file://…` or a path.
        file: String,
        /// Scale factors along x, y and z.
        scale: [f64; 3],
    },
}

/// Mass and moments of inertia of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Inertial {
    /// Mass, kilograms.
    pub mass: f64,
    /// Pose of the inertia frame in the link's frame; its origin is the centre of mass.
    pub link_from_inertia: Placement<f64>,
    /// Moments of inertia about the centre of mass in the inertia frame, kg·m²: rows of the symmetric matrix.
    pub moments: [[f64; 3]; 3],
}
