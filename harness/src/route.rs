//! The names of derivative routes in tables and files.

use kinopt::problem::Derivatives;

/// The name of a derivative route in results and on the command line.
pub(crate) fn route_name(route: Derivatives) -> &'static str {
    match route {
        Derivatives::Analytic => "analytic",
        Derivatives::Dual => "dual",
        Derivatives::ForwardDifference => "fd",
        Derivatives::CentralDifference => "central",
        _ => "other",
    }
}
