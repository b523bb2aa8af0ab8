//! Promises of kinopt-robot: URDF, MJCF and SRDF files.

mod mjcf;
mod srdf;
mod urdf;
