//! Options of retargeting.

use kinopt::motion::retarget::RetargetOptions;

use super::{OptionSpec, Setter};

/// Options of retargeting, by name. Collision avoidance is an object of the interface.
#[must_use]
pub fn options() -> [OptionSpec<RetargetOptions>; 3] {
    [
        OptionSpec {
            name: "contact_speed",
            set: Setter::Number(|mut options, speed| {
                options.contacts.speed = speed;
                options
            }),
            doc: "speed below which a foot is in contact, for legs of 0.9 m, m/s.",
            default: "0.25",
        },
        OptionSpec {
            name: "contact_height",
            set: Setter::Number(|mut options, height| {
                options.contacts.height = height;
                options
            }),
            doc: "height over the ground below which a foot is in contact, in the unit of the target.",
            default: "any height",
        },
        OptionSpec {
            name: "acceleration",
            set: Setter::Number(RetargetOptions::with_acceleration),
            doc: "cost of an acceleration of 1 rad/s² in whole trajectories, metres of position error, at least 0.",
            default: "1e-4",
        },
    ]
}
