//! Conversion between degrees of the file and radians.

use kinopt_kinematics::model::Limits;

/// Smallest absolute limit in degrees that means unbounded.
pub(super) const UNBOUNDED: f64 = 1e10;

/// Limits in radians from a range in degrees.
pub(super) fn limits(min: f64, max: f64) -> Limits {
    let end = |degrees: f64| match degrees.abs() >= UNBOUNDED {
        true => f64::INFINITY.copysign(degrees),
        false => degrees.to_radians(),
    };
    Limits::new(end(min), end(max))
}

/// One bound of [`limits`] in degrees.
pub(super) fn from_limit(radians: f64) -> f64 {
    if radians.is_infinite() {
        return UNBOUNDED.copysign(radians);
    }
    from_radians(radians)
}

/// The degrees that convert to exactly the given radians, if they exist.
///
/// Conversion by rounding may be off by one or two steps of floating-point numbers, so neighbours are tried.
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
