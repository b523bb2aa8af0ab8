//! What can be wrong with a shape, and what is only told.

use crate::plural::counted;
use crate::spatial::Vector3;

/// Lengths of shapes, so that no square of one over- or underflows.
const SMALLEST: f64 = 1e-9;
pub(in crate::collision) const LARGEST: f64 = 1e9;
/// How many times as long as thick a shape may be: rounding along it is then a thousandth of what it is across.
const SLENDEREST: f64 = 1e12;
/// Vertices, points and heights of one shape.
const MOST: usize = 1 << 28;

/// Why there is no such shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A length that is no length.
    #[error("the {what} is {value}, not a positive length from {SMALLEST:e} to {LARGEST:e}")]
    Size {
        /// Which: `radius of the sphere`, say.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// Lengths so far apart that distances would be rounding.
    #[error(
        "the {longest_name} is {longest:e} and the {shortest_name} {shortest:e}: more than {SLENDEREST:e} times"
    )]
    Slender {
        /// Which is longest.
        longest_name: &'static str,
        /// How long it is.
        longest: f64,
        /// Which is shortest.
        shortest_name: &'static str,
        /// How long it is.
        shortest: f64,
    },
    /// A coordinate that is NaN, infinite or beyond 10⁹.
    #[error("{what} {index} has a coordinate that is not finite or beyond {LARGEST:e}")]
    Coordinate {
        /// `vertex`, `point` or `height`.
        what: &'static str,
        /// Which, counted from 0.
        index: usize,
    },
    /// Too few of something.
    #[error("a {shape} needs at least {needed} {what}, not {given}")]
    TooFew {
        /// Of what.
        shape: &'static str,
        /// What there is too little of.
        what: &'static str,
        /// How many it takes.
        needed: usize,
        /// How many there are.
        given: usize,
    },
    /// Too many of something.
    #[error("{given} {what} are more than the {MOST} that a shape may have")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many there are.
        given: usize,
    },
    /// The points of a convex hull lie in a plane, on a line or at one place.
    #[error("the {points} points of the convex hull lie in one plane{}", within(*.thickness))]
    Flat {
        /// How many points there are.
        points: usize,
        /// How thick they are across it.
        thickness: f64,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are {vertices} vertices")]
    UnknownVertex {
        /// Which triangle, from 0.
        triangle: usize,
        /// What it names.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// Heights that fill no whole number of rows.
    #[error("{heights} heights do not fill rows of {columns}")]
    Rows {
        /// How many heights there are.
        heights: usize,
        /// How many a row has.
        columns: usize,
    },
    /// A mesh of a robot's file is another file, which must be read first.
    #[error("the mesh {file:?} is in a file of its own, which must be read for it")]
    NeedsFile {
        /// As the robot's file names it.
        file: String,
    },
}

/// What was found about a shape that is taken all the same.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeNote {
    /// Edges with another number of triangles than two: there is no inside, the surface alone counts.
    #[error("the mesh is open at {}: its surface alone counts, it has no inside", counted(*.edges, "edge"))]
    Open {
        /// How many.
        edges: usize,
    },
    /// Neighbouring triangles that are wound against each other, so that inside and outside are not told apart.
    #[error(
        "{} of the mesh {} triangles wound against each other: its surface alone counts",
        counted(*.edges, "edge"), if *.edges == 1 { "joins" } else { "join" }
    )]
    Winding {
        /// How many.
        edges: usize,
    },
    /// Corners on open edges that were next to each other and are one now, so that the mesh is closed.
    #[error("{} on open edges within {within:e} m of another {} made one with it, which closes the mesh",
        counted(*.vertices, "vertex"), if *.vertices == 1 { "was" } else { "were" })]
    Closed {
        /// How many are no more.
        vertices: usize,
        /// How far apart they were at most, metres.
        within: f64,
    },
    /// A closed mesh whose triangles are clockwise seen from outside: they were turned.
    #[error("the mesh is inside out: its triangles were turned")]
    InsideOut,
    /// Triangles with two corners at one place, left out as their neighbours cover them.
    #[error(
        "{} without area {} left out",
        counted(*.triangles, "triangle"), if *.triangles == 1 { "was" } else { "were" }
    )]
    WithoutArea {
        /// How many.
        triangles: usize,
    },
}

/// How thick something is, where that is more than nothing.
fn within(thickness: f64) -> String {
    match thickness == 0.0 {
        true => String::new(),
        false => format!(", within {thickness:e}"),
    }
}

/// A length, if it is one.
pub(super) fn size(what: &'static str, value: f64) -> Result<f64, ShapeError> {
    match (SMALLEST..=LARGEST).contains(&value) {
        true => Ok(value),
        false => Err(ShapeError::Size { what, value }),
    }
}

/// The lengths of one shape, if they are some and not too far apart.
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
        && longest > SLENDEREST * shortest
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

/// Whether all are in range, and not too many for 32 bits.
pub(super) fn check_points(
    what: &'static str,
    plural: &'static str,
    points: &[Vector3<f64>],
) -> Result<(), ShapeError> {
    check_number(plural, points.len())?;
    let fine = |p: &Vector3<f64>| p.to_array().iter().all(|x| x.abs() <= LARGEST);
    match points.iter().position(|p| !fine(p)) {
        Some(index) => Err(ShapeError::Coordinate { what, index }),
        None => Ok(()),
    }
}

/// Whether there are not too many for 32 bits.
pub(super) fn check_number(what: &'static str, given: usize) -> Result<(), ShapeError> {
    match given <= MOST {
        true => Ok(()),
        false => Err(ShapeError::TooMany { what, given }),
    }
}
