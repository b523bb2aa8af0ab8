//! Names of derivative modes in tables and files.

use kinopt::problem::Derivatives;

/// Name of a derivative mode in results and on the command line.
pub(crate) fn route_name(route: Derivatives) -> &'static str {
    match route {
        Derivatives::Analytic => "analytic",
        Derivatives::Dual => "dual",
        Derivatives::ForwardDifference => "fd",
        Derivatives::CentralDifference => "central",
        _ => "other",
    }
}
