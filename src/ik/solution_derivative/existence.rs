//! Whether a solution has a derivative, and if not, why.

/// Whether a solution changes with what is asked in one certain way.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Existence {
    /// It does: near here the solution is a smooth function of the parameters, and this is its derivative.
    Unique,
    /// Other configurations answer as well, and nothing decides between them, so that the solution is no function
    /// of the parameters. The change that is told is the shortest, in radians and metres of the model's velocity;
    /// a posture as a preference would make it the only one.
    ShortestOfMany {
        /// In how many directions the solution is free.
        directions: usize,
    },
    /// There is none, and what is told is not one. It may be a one-sided one, or none at all.
    DoesNotExist(NoDerivative),
}

impl Existence {
    /// Whether the solution is differentiable.
    #[must_use]
    pub fn is_unique(&self) -> bool {
        *self == Self::Unique
    }

    /// A word for it: `unique`, `shortest_of_many`, `on_limit`, `at_kink`, `singular`, `not_stationary` or
    /// `not_finite`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Unique => "unique",
            Self::ShortestOfMany { .. } => "shortest_of_many",
            Self::DoesNotExist(NoDerivative::OnLimit { .. }) => "on_limit",
            Self::DoesNotExist(NoDerivative::AtKink { .. }) => "at_kink",
            Self::DoesNotExist(NoDerivative::Singular { .. }) => "singular",
            Self::DoesNotExist(NoDerivative::NotStationary { .. }) => "not_stationary",
            Self::DoesNotExist(NoDerivative::NotFinite) => "not_finite",
        }
    }
}

impl std::fmt::Display for Existence {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unique => f.write_str("the solution is differentiable"),
            Self::ShortestOfMany { directions } => write!(
                f,
                "the solution is one of many, free in {directions} directions: the shortest change is told"
            ),
            Self::DoesNotExist(reason) => write!(f, "the solution has no derivative: {reason}"),
        }
    }
}

/// Why a solution has no derivative.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum NoDerivative {
    /// A joint stands on its limit and nothing pushes it outward: one way it would leave, the other way it would
    /// stay.
    OnLimit {
        /// The joint, as [`ActiveLimit`](super::super::ActiveLimit) names it.
        joint: String,
    },
    /// A task with room stands on its edge and nothing pushes it outward.
    AtKink {
        /// The task.
        task: String,
    },
    /// The goals, or the cost, lose rank here: the solution has branches, or ends.
    Singular {
        /// In how many directions.
        directions: usize,
    },
    /// The place is none where a search ends by itself: it was cut short, or is of another question.
    NotStationary {
        /// How far a step of Newton's method would still lead, radians or metres.
        distance: f64,
    },
    /// A residual or a derivative is not finite.
    NotFinite,
}

impl std::fmt::Display for NoDerivative {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::OnLimit { joint } => {
                write!(f, "`{joint}` is on its limit, and nothing pushes it there")
            }
            Self::AtKink { task } => {
                write!(
                    f,
                    "`{task}` is on the edge of its room, and nothing pushes it there"
                )
            }
            Self::Singular { directions } => {
                write!(f, "it is singular in {directions} directions")
            }
            Self::NotStationary { distance } => write!(
                f,
                "no search would end there by itself (a step of {distance:.1e} is left)"
            ),
            Self::NotFinite => f.write_str("a residual or a derivative is not finite"),
        }
    }
}
