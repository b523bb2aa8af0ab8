//! Trajectory: configurations with times, and a report.

/// Trajectory: one configuration for each sample time, with a report.
///
/// The report `R` depends on the origin of the trajectory: a joint path with its times, trajectory optimisation or
/// retargeting.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Trajectory<R> {
    /// Sample times, seconds, starting at 0. They do not descend.
    pub times: Vec<f64>,
    /// Configurations, one after another, radians or metres.
    pub q: Vec<f64>,
    /// Length of a configuration.
    pub nq: usize,
    /// Errors or further data of the trajectory.
    pub report: R,
}

impl<R> Trajectory<R> {
    /// Iterates over the configurations.
    pub fn rows(&self) -> std::slice::ChunksExact<'_, f64> {
        self.q.chunks_exact(self.nq.max(1))
    }

    /// Returns the configuration of a sample.
    #[must_use]
    pub fn row(&self, row: usize) -> Option<&[f64]> {
        self.rows().nth(row)
    }

    /// Time of the last sample, seconds.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// Separates the report from the configurations.
    #[must_use]
    pub fn split_report(self) -> (Trajectory<()>, R) {
        let trajectory = Trajectory {
            times: self.times,
            q: self.q,
            nq: self.nq,
            report: (),
        };
        (trajectory, self.report)
    }
}
