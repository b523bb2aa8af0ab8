//! The file's degrees against the library's radians.

use crate::model::Limits;

/// Limits of this many degrees or more stand for none.
pub(super) const UNBOUNDED: f64 = 1e10;

/// A range in degrees, in radians.
pub(super) fn limits(min: f64, max: f64) -> Limits {
    let end = |degrees: f64| match degrees.abs() >= UNBOUNDED {
        true => f64::INFINITY.copysign(degrees),
        false => degrees.to_radians(),
    };
    Limits::new(end(min), end(max))
}

/// One end of [`limits`] as the file writes it.
pub(super) fn from_limit(radians: f64) -> f64 {
    if radians.is_infinite() {
        return UNBOUNDED.copysign(radians);
    }
    from_radians(radians)
}

/// The degrees that are read back as exactly this many radians, where there are such.
///
/// Radians are a coarser grid than degrees in places and a finer one in others, so converting back
/// may be off by a step or two; the neighbours are tried.
pub(super) fn from_radians(radians: f64) -> f64 {
    let degrees = radians.to_degrees();
    let (mut below, mut above) = (degrees, degrees);
    for _ in 0..4 {
        for candidate in [below, above] {
            if candidate.to_radians().to_bits() == radians.to_bits() {
                return candidate;
            }
        }
        (below, above) = (below.next_down(), above.next_up());
    }
    degrees
}
