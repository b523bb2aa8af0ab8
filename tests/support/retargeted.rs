//! Errors of retargeted motions.

use kinopt::motion::Trajectory;
use kinopt::motion::retarget::{RetargetReport, Retargeting};

/// Mean distance of the driven points from their targets, metres.
pub fn mean_target_error(retargeting: &Retargeting<'_>, found: &Trajectory<RetargetReport>) -> f64 {
    let errors = retargeting.errors(found).unwrap();
    errors.iter().sum::<f64>() / errors.len() as f64
}
