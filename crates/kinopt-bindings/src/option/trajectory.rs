//! Options of a trajectory along a joint path, next to its limits.

use kinopt::motion::path::TimingLimits;

use super::{OptionSpec, Setter};

/// Options of a trajectory, by name. Limits are arguments of the interfaces.
#[must_use]
pub fn options<'a>() -> [OptionSpec<TimingLimits<'a>>; 3] {
    [
        OptionSpec {
            name: "corner_tolerance",
            set: Setter::Number(TimingLimits::with_corner_tolerance),
            doc: "largest distance of a joint from the path at a blended corner, radians or metres; 0 stops there.",
            default: "1e-3",
        },
        OptionSpec {
            name: "grid_points",
            set: Setter::Whole(|limits, count| limits.with_grid_points(count as usize)),
            doc: "number of samples of the speed profile over the whole path, 2 to 1000000.",
            default: "1000",
        },
        OptionSpec {
            name: "allow_unreached",
            set: Setter::Switch(TimingLimits::with_unreached_allowed),
            doc: "times a path with rows that are not reached or not proven collision-free too.",
            default: "False, an error",
        },
    ]
}
