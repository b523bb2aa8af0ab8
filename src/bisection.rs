//! Halving an interval.

/// Halves the interval between a number at which something holds and one at which it does not so many times; the end of what is
/// left at which it holds.
pub(crate) fn bisect(
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
