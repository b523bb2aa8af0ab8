//! Geometric solvers: two bones, CCD and FABRIK.

mod ccd;
mod fabrik;
mod geometric_limits;
mod reported_contacts;
mod triangles;
mod two_bone;
mod units_of_length;
