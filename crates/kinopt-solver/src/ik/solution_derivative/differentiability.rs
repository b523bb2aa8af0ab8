//! Differentiability of a solution.

/// Differentiability of a solution with respect to the parameters of its problem.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Differentiability {
    /// The solution is locally a smooth function of the parameters, and the derivative is exact.
    Unique,
    /// Other configurations also solve the problem, so the solution is not a function of the parameters.
    ///
    /// The computed change is the shortest, in radians and metres of the model's velocity. A posture as a soft task
    /// would make the solution unique.
    ShortestOfMany {
        /// Dimension of the set of solutions.
        directions: usize,
    },
    /// The solution is not differentiable. The computed value is invalid, or at most a one-sided derivative.
    DoesNotExist(NoDerivative),
}

impl Differentiability {
    /// Returns whether the solution is differentiable.
    #[must_use]
    pub fn is_unique(&self) -> bool {
        *self == Self::Unique
    }

    /// Returns the name of the case: `unique`, `shortest_of_many`, `on_limit`, `at_kink`, `singular`, `not_stationary`
    /// or `not_finite`.
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

impl std::fmt::Display for Differentiability {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unique => f.write_str("the solution is differentiable"),
            Self::ShortestOfMany { directions } => write!(
                f,
                "the solution is one of many, free in {directions} directions: the shortest change is returned"
            ),
            Self::DoesNotExist(reason) => write!(f, "the solution has no derivative: {reason}"),
        }
    }
}

/// Reason why a solution has no derivative.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum NoDerivative {
    /// A joint is at its limit with zero multiplier: it would leave the limit in one direction only.
    OnLimit {
        /// Name of the joint, as in [`ActiveLimit`](super::super::ActiveLimit).
        joint: String,
    },
    /// A task is at the edge of its bounds with zero multiplier.
    AtKink {
        /// Name of the task.
        task: String,
    },
    /// The required tasks or the cost lose rank here: the solution branches or ends.
    Singular {
        /// Number of lost ranks.
        directions: usize,
    },
    /// The configuration is not stationary: the search was cut short, or solved another problem.
    NotStationary {
        /// Length of the remaining Newton step, radians or metres.
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
