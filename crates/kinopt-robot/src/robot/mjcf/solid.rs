//! Volumes and moments of inertia of solids of uniform density.

use std::f64::consts::PI;

/// A solid centred on its origin, lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum GeomSolid {
    /// Half-lengths along x, y and z.
    Box([f64; 3]),
    /// Radii along x, y and z.
    Ellipsoid([f64; 3]),
    /// Radius, and half-length along z.
    Cylinder(f64, f64),
    /// Radius, and half-length of the cylinder along z.
    Capsule(f64, f64),
}

impl GeomSolid {
    /// Volume, m³.
    pub(super) fn volume(&self) -> f64 {
        match *self {
            Self::Box([x, y, z]) => 8.0 * x * y * z,
            Self::Ellipsoid([x, y, z]) => 4.0 / 3.0 * PI * x * y * z,
            Self::Cylinder(radius, half) => PI * radius * radius * 2.0 * half,
            Self::Capsule(radius, half) => PI * radius * radius * (2.0 * half + 4.0 / 3.0 * radius),
        }
    }

    /// Moments of inertia about x, y and z per unit mass, m².
    pub(super) fn moments(&self) -> [f64; 3] {
        let across = |x: f64, y: f64, z: f64| [y + z, x + z, x + y];
        match *self {
            Self::Box([x, y, z]) => across(x * x / 3.0, y * y / 3.0, z * z / 3.0),
            Self::Ellipsoid([x, y, z]) => across(x * x / 5.0, y * y / 5.0, z * z / 5.0),
            Self::Cylinder(radius, half) => {
                let round = radius * radius / 4.0;
                across(round, round, half * half / 3.0)
            }
            Self::Capsule(radius, half) => {
                // A cylinder and two half-spheres.
                let ball = 4.0 / 3.0 * radius / (2.0 * half + 4.0 / 3.0 * radius);
                let cylinder = 1.0 - ball;
                let round = radius * radius * (cylinder / 4.0 + ball / 5.0);
                let moved = half * half + 0.75 * half * radius;
                let along = cylinder * half * half / 3.0 + ball * (radius * radius / 5.0 + moved);
                across(round, round, along)
            }
        }
    }
}
