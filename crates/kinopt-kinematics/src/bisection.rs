//! Bisection of an interval.

/// Halves the interval between `holding` and `failing` `halvings` times by the predicate `holds`.
///
/// `holds` is true at `holding` and false at `failing`. Returns the end of the last interval at which it is true.
#[doc(hidden)]
pub fn bisect(
    mut holding: f64,
    mut failing: f64,
    halvings: usize,
    mut holds: impl FnMut(f64) -> bool,
) -> f64 {
    for _ in 0..halvings {
        let middle = 0.5 * (holding + failing);
        match holds(middle) {
            true => holding = middle,
            false => failing = middle,
        }
    }
    holding
}
