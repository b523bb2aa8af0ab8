//! Joint path: configurations of an arm without times, with a report.

use kinopt_solver::ik::{JointJump, Solution};

/// Joint path of an arm: one configuration a row, with its jumps and a report.
///
/// The report `R` depends on the origin of the path. [`Arm::track`](super::Arm::track) solves row by row and reports a
/// [`Solution`] for each. [`PathSolver`](crate::path::PathSolver) solves all rows as one problem and reports the
/// [errors of the path](crate::path::PathReport). Without a report, `R` is `()`.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JointPath<R> {
    /// Configurations, one after another, radians or metres.
    pub q: Vec<f64>,
    /// Length of a configuration: the number of joints.
    pub nq: usize,
    /// Jumps between rows, in order.
    pub jumps: Vec<JointJump>,
    /// Rows that are not reached, or whose step is not proven collision-free, in order.
    pub unreached: Vec<usize>,
    /// Errors of the path.
    pub report: R,
}

impl<R> JointPath<R> {
    /// Iterates over the configurations.
    pub fn rows(&self) -> std::slice::ChunksExact<'_, f64> {
        self.q.chunks_exact(self.nq.max(1))
    }

    /// Returns the configuration of a row.
    #[must_use]
    pub fn row(&self, row: usize) -> Option<&[f64]> {
        self.rows().nth(row)
    }

    /// Separates the report from the configurations.
    #[must_use]
    pub fn split_report(self) -> (JointPath<()>, R) {
        let path = JointPath {
            q: self.q,
            nq: self.nq,
            jumps: self.jumps,
            unreached: self.unreached,
            report: (),
        };
        (path, self.report)
    }
}

impl JointPath<Vec<Solution>> {
    /// Returns true if all targets are reached without jumps.
    #[must_use]
    pub fn reached(&self) -> bool {
        self.jumps.is_empty() && self.report.iter().all(|solution| solution.reached)
    }
}
