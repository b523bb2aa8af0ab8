//! Two bones, CCD and FABRIK.

mod ccd;
mod fabrik;
mod geometric_limits;
mod triangles;
mod two_bone;
