//! Criteria that rank the solutions of goals.

use std::fmt;

use super::super::QueryError;
use super::super::arm::Arm;
use super::super::distances::weighted_distance;
use kinopt_kinematics::kinematics::Jacobian;

/// Ranks configurations: the least cost is the best.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub enum Criterion<'a> {
    /// Weighted joint distance from the start, radians.
    Distance,
    /// The negative of Yoshikawa's manipulability √det(J Jᵀ) of the tool (1985, "Manipulability of robotic
    /// mechanisms"), m³ for six or more joints. For fewer joints √det(Jᵀ J).
    Manipulability,
    /// The negative of the smallest distance to an obstacle or between links, metres, up to `max_distance`.
    ///
    /// A smaller `max_distance` takes less time.
    #[cfg(feature = "collision")]
    Clearance {
        /// Distance beyond which clearances are equal, metres.
        max_distance: f64,
    },
    /// The caller's cost of a configuration of an arm.
    Cost(&'a (dyn Fn(&[f64]) -> f64 + Sync)),
}

impl fmt::Debug for Criterion<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Distance => f.write_str("Distance"),
            Self::Manipulability => f.write_str("Manipulability"),
            #[cfg(feature = "collision")]
            Self::Clearance { max_distance } => f
                .debug_struct("Clearance")
                .field("max_distance", max_distance)
                .finish(),
            Self::Cost(_) => f.debug_tuple("Cost").finish_non_exhaustive(),
        }
    }
}

/// Cost of configurations of one arm, with its memory.
pub(super) struct CostOf<'a> {
    arm: &'a Arm,
    start: &'a [f64],
    criterion: Criterion<'a>,
    jacobian: Option<Jacobian>,
}

impl<'a> CostOf<'a> {
    pub(super) fn new(
        arm: &'a Arm,
        start: &'a [f64],
        criterion: Criterion<'a>,
    ) -> Result<Self, QueryError> {
        let jacobian = match criterion {
            Criterion::Manipulability => Some(arm.jacobian()?),
            _ => None,
        };
        Ok(Self {
            arm,
            start,
            criterion,
            jacobian,
        })
    }

    pub(super) fn at(&mut self, q: &[f64]) -> Result<f64, QueryError> {
        Ok(match self.criterion {
            Criterion::Distance => weighted_distance(self.arm, q, self.start),
            Criterion::Cost(cost) => cost(q),
            #[cfg(feature = "collision")]
            Criterion::Clearance { max_distance } => {
                -self.arm.clearance(q, max_distance)?.unwrap_or(max_distance)
            }
            Criterion::Manipulability => {
                let Some(jacobian) = &mut self.jacobian else {
                    return Ok(f64::INFINITY);
                };
                let j = jacobian.at(q)?;
                let gram = match j.ncols() >= j.nrows() {
                    true => j * j.transpose(),
                    false => j.transpose() * j,
                };
                -gram.determinant().max(0.0).sqrt()
            }
        })
    }
}
