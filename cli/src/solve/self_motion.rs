//! Self-motions of a target, in terms of the whole model.

use kinopt::counted;
use serde::Serialize;

use crate::table::Table;

/// Curve of configurations that reach the target.
#[derive(Clone, Debug, Serialize)]
pub(super) struct SelfMotionCurve {
    /// True if the last configuration is followed by the first.
    pub(super) closed: bool,
    /// Successive configurations of the model, radians or metres.
    pub(super) q: Vec<Vec<f64>>,
}

/// Number of samples of every curve.
pub(super) fn text(curves: &[SelfMotionCurve]) -> String {
    let mut table = Table::new(">curve | >configurations | ");
    for (index, curve) in curves.iter().enumerate() {
        let ends = if curve.closed { "closed" } else { "open" };
        let samples = curve.q.len().to_string();
        table.row([index.to_string(), samples, ends.to_owned()]);
    }
    format!(
        "\n{} in steps of at most 0.05 rad; all configurations with --json:\n{}",
        counted(curves.len(), "self-motion"),
        table.text()
    )
}
