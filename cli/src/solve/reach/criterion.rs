//! Criterion of a ranking, by its name on the command line.

use kinopt::arm::Criterion;
use kinopt::model::UnknownName;
use kinopt_bindings::goal_set::MAX_CLEARANCE;

/// Criteria of the command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum RankedBy {
    #[default]
    Distance,
    Manipulability,
    Clearance,
}

impl RankedBy {
    const NAMES: [&'static str; 3] = ["distance", "manipulability", "clearance"];

    pub(super) fn parse(text: &str) -> Result<Self, String> {
        match text {
            "distance" => Ok(Self::Distance),
            "manipulability" => Ok(Self::Manipulability),
            "clearance" => Ok(Self::Clearance),
            _ => Err(UnknownName::new("criterion", text, Self::NAMES).to_string()),
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Distance => "distance",
            Self::Manipulability => "manipulability",
            Self::Clearance => "clearance",
        }
    }

    /// Column of the value in text, with its unit.
    pub(super) fn column(self) -> &'static str {
        match self {
            Self::Distance => "distance (rad)",
            Self::Manipulability => "manipulability",
            Self::Clearance => "clearance (m)",
        }
    }

    /// Criterion of a goal set.
    pub(super) fn criterion(self) -> Criterion<'static> {
        match self {
            Self::Distance => Criterion::Distance,
            Self::Manipulability => Criterion::Manipulability,
            Self::Clearance => Criterion::Clearance {
                max_distance: MAX_CLEARANCE,
            },
        }
    }

    /// Value of the criterion from the cost of a goal set: manipulability and clearance are negative costs.
    pub(super) fn value(self, cost: f64) -> f64 {
        match self {
            Self::Distance => cost,
            Self::Manipulability | Self::Clearance => -cost,
        }
    }
}
