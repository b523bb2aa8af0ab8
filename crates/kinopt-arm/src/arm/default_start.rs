//! Default start configuration of an arm.

#[cfg(feature = "xml")]
use std::collections::HashMap;

use kinopt_kinematics::model::Limits;

/// SRDF states for the default start, in order of preference.
#[cfg(feature = "xml")]
const STATES: [&str; 2] = ["ready", "home"];

/// Default start by a state of the SRDF file; joints without a value are at the middle of their limits.
///
/// `joint_coordinates` and `limits` have one element per joint of the arm.
#[cfg(feature = "xml")]
pub(super) fn srdf_start(
    srdf: &kinopt_robot::robot::Srdf,
    joint_coordinates: &[usize],
    limits: impl Iterator<Item = Limits>,
) -> Vec<f64> {
    // Groups may share a state's name; the last value of a joint counts.
    let values_of = |name: &str| -> HashMap<usize, f64> {
        let states = srdf.states.iter();
        let named = states.filter(|state| state.name.eq_ignore_ascii_case(name));
        named.flat_map(|state| &state.values).copied().collect()
    };
    let mut states = STATES.into_iter().map(values_of);
    let state = states.find(|values| {
        joint_coordinates
            .iter()
            .any(|coordinate| values.contains_key(coordinate))
    });
    let state = state.unwrap_or_default();
    let start = joint_coordinates
        .iter()
        .zip(limits)
        .map(|(coordinate, limits)| match state.get(coordinate) {
            Some(value) => limits.clamp(*value),
            None => middle_of(limits),
        });
    start.collect()
}

/// The middle of limits, or the value closest to 0 if a limit is missing.
pub(super) fn middle_of(limits: Limits) -> f64 {
    match limits.lower.is_finite() && limits.upper.is_finite() {
        true => limits.clamp(0.5 * limits.lower + 0.5 * limits.upper),
        false => limits.clamp(0.0),
    }
}
