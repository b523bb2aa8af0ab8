//! Kinds and dimensions of the shapes of links, by name.

use kinopt::robot::Geometry;

/// A dimension of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure<'a> {
    /// A length in metres.
    Number(f64),
    /// Three lengths in metres, or three factors.
    Numbers([f64; 3]),
    /// The name of a file.
    Text(&'a str),
}

/// Kind of a geometry.
#[must_use]
pub fn kind(geometry: &Geometry) -> &'static str {
    match geometry {
        Geometry::Box { .. } => "box",
        Geometry::Cylinder { .. } => "cylinder",
        Geometry::Capsule { .. } => "capsule",
        Geometry::Sphere { .. } => "sphere",
        Geometry::Ellipsoid { .. } => "ellipsoid",
        Geometry::Mesh { .. } => "mesh",
    }
}

/// Dimensions of a geometry by name.
#[must_use]
pub fn measures(geometry: &Geometry) -> Vec<(&'static str, Measure<'_>)> {
    match geometry {
        Geometry::Box { size } => vec![("size", Measure::Numbers(*size))],
        Geometry::Cylinder { radius, length } | Geometry::Capsule { radius, length } => vec![
            ("radius", Measure::Number(*radius)),
            ("length", Measure::Number(*length)),
        ],
        Geometry::Sphere { radius } => vec![("radius", Measure::Number(*radius))],
        Geometry::Ellipsoid { radii } => vec![("radii", Measure::Numbers(*radii))],
        Geometry::Mesh { file, scale } => vec![
            ("file", Measure::Text(file)),
            ("scale", Measure::Numbers(*scale)),
        ],
    }
}
