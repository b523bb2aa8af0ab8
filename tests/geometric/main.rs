//! Two bones, CCD and FABRIK.

mod ccd;
mod fabrik;
mod geometric_limits;
mod triangles;
mod two_bone;
mod units_of_length;
mod what_is_in_the_way;
