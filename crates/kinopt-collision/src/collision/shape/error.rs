//! Errors and notes about shapes.

use kinopt_kinematics::plural::counted;
use kinopt_kinematics::spatial::Vector3;

/// Bounds of the lengths of shapes, metres, so that no square of a length over- or underflows.
const MIN_LENGTH: f64 = 1e-9;
pub(in crate::collision) const MAX_LENGTH: f64 = 1e9;
/// Largest ratio of the lengths of one shape: rounding along the longest length is then at most a thousandth of the
/// shortest.
const MAX_LENGTH_RATIO: f64 = 1e12;
/// Largest number of vertices, points or heights of one shape.
const MAX_ELEMENTS: usize = 1 << 28;

/// Reason why a shape cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A length outside the allowed range.
    #[error("the {what} is {value}, not a positive length from {MIN_LENGTH:e} to {MAX_LENGTH:e}")]
    Size {
        /// Name of the length, for instance `radius of the sphere`.
        what: &'static str,
        /// Given value, metres.
        value: f64,
    },
    /// Two lengths whose ratio is so large that distances would be dominated by rounding.
    #[error(
        "the {longest_name} is {longest:e} and the {shortest_name} {shortest:e}: more than {MAX_LENGTH_RATIO:e} times"
    )]
    Slender {
        /// Name of the longest length.
        longest_name: &'static str,
        /// Longest length, metres.
        longest: f64,
        /// Name of the shortest length.
        shortest_name: &'static str,
        /// Shortest length, metres.
        shortest: f64,
    },
    /// A coordinate that is NaN, infinite or beyond 10⁹.
    #[error("{what} {index} has a coordinate that is not finite or beyond {MAX_LENGTH:e}")]
    Coordinate {
        /// `vertex`, `point` or `height`.
        what: &'static str,
        /// Index, from 0.
        index: usize,
    },
    /// Too few points, triangles, rows or columns.
    #[error("a {shape} needs at least {needed} {what}, not {given}")]
    TooFew {
        /// Kind of the shape.
        shape: &'static str,
        /// Name of the elements of which there are too few.
        what: &'static str,
        /// Required number of elements.
        needed: usize,
        /// Given number of elements.
        given: usize,
    },
    /// Too many vertices, points, heights or triangles.
    #[error("{given} {what} are more than the {MAX_ELEMENTS} that a shape may have")]
    TooMany {
        /// Name of the elements.
        what: &'static str,
        /// Given number of elements.
        given: usize,
    },
    /// The points of a convex hull lie in one plane, on one line or at one point.
    #[error("the {points} points of the convex hull lie in one plane{}", thickness_text(*.thickness))]
    Flat {
        /// Number of points.
        points: usize,
        /// Extent of the points across the plane, metres.
        thickness: f64,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are {vertices} vertices")]
    UnknownVertex {
        /// Index of the triangle, from 0.
        triangle: usize,
        /// Index of the missing vertex.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// Heights that do not fill a whole number of rows.
    #[error("{heights} heights do not fill rows of {columns}")]
    RowBlock {
        /// Number of heights.
        heights: usize,
        /// Number of heights a row.
        columns: usize,
    },
    /// The geometry is a mesh in a file of its own, which must be read first.
    #[error("mesh {file:?}: its file must be read first")]
    NeedsFile {
        /// Reference to the mesh file, as the robot's file writes it.
        file: String,
    },
}

/// Finding about a shape that is accepted all the same.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeNote {
    /// Edges that do not join exactly two triangles: the mesh has no inside, only its surface counts.
    #[error("the mesh is open at {}: only its surface is used", counted(*.edges, "edge"))]
    Open {
        /// Number of open edges.
        edges: usize,
    },
    /// Neighbouring triangles with opposite winding: the mesh has no inside, only its surface counts.
    #[error(
        "{} of the mesh {} triangles of opposite orientation: only its surface is used",
        counted(*.edges, "edge"), if *.edges == 1 { "joins" } else { "join" }
    )]
    Winding {
        /// Number of edges between triangles of opposite winding.
        edges: usize,
    },
    /// Close vertices on open edges that were merged, which closes the mesh.
    #[error("{} on open edges within {within:e} m of another {} merged, which closes the mesh",
        counted(*.vertices, "vertex"), if *.vertices == 1 { "was" } else { "were" })]
    Closed {
        /// Number of merged vertices.
        vertices: usize,
        /// Largest distance of merged vertices, metres.
        within: f64,
    },
    /// A closed mesh with clockwise triangles, seen from outside: their winding was reversed.
    #[error("the mesh is inside out: its triangles were reversed")]
    InsideOut,
    /// Triangles with two corners at the same position: removed, as their neighbours cover them.
    #[error(
        "{} without area {} left out",
        counted(*.triangles, "triangle"), if *.triangles == 1 { "was" } else { "were" }
    )]
    WithoutArea {
        /// Number of removed triangles.
        triangles: usize,
    },
}

/// Text for a thickness, metres; empty for 0.
fn thickness_text(thickness: f64) -> String {
    match thickness == 0.0 {
        true => String::new(),
        false => format!(", within {thickness:e}"),
    }
}

/// Returns the length if it is in range.
pub(super) fn size(what: &'static str, value: f64) -> Result<f64, ShapeError> {
    match (MIN_LENGTH..=MAX_LENGTH).contains(&value) {
        true => Ok(value),
        false => Err(ShapeError::Size { what, value }),
    }
}

/// Returns the lengths of one shape if they are in range and their ratio is at most [`MAX_LENGTH_RATIO`].
pub(super) fn sizes<const N: usize>(
    named: [(&'static str, f64); N],
) -> Result<[f64; N], ShapeError> {
    for (what, value) in named {
        size(what, value)?;
    }
    let by_length = |a: &&(&str, f64), b: &&(&str, f64)| a.1.total_cmp(&b.1);
    let longest = named.iter().max_by(by_length);
    let shortest = named.iter().min_by(by_length);
    if let (Some(&(longest_name, longest)), Some(&(shortest_name, shortest))) = (longest, shortest)
        && longest > MAX_LENGTH_RATIO * shortest
    {
        return Err(ShapeError::Slender {
            longest_name,
            longest,
            shortest_name,
            shortest,
        });
    }
    Ok(named.map(|(_, value)| value))
}

/// Checks that all coordinates are in range and that the number of points is at most [`MAX_ELEMENTS`].
pub(super) fn check_points(
    what: &'static str,
    plural: &'static str,
    points: &[Vector3<f64>],
) -> Result<(), ShapeError> {
    check_number(plural, points.len())?;
    let is_in_range = |p: &Vector3<f64>| p.to_array().iter().all(|x| x.abs() <= MAX_LENGTH);
    match points.iter().position(|p| !is_in_range(p)) {
        Some(index) => Err(ShapeError::Coordinate { what, index }),
        None => Ok(()),
    }
}

/// Checks that the number of elements is at most [`MAX_ELEMENTS`].
pub(super) fn check_number(what: &'static str, given: usize) -> Result<(), ShapeError> {
    match given <= MAX_ELEMENTS {
        true => Ok(()),
        false => Err(ShapeError::TooMany { what, given }),
    }
}
