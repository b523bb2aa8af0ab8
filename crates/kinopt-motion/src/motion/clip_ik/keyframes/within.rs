//! Smallest change that brings keys within their limits.

use std::convert::Infallible;

use nalgebra::{DMatrix, DVector};

use super::basis::Row;
use super::interior::{Cost, minimise};

/// Distance from its limits to which a clip is brought, radians: the slack for the targets.
const SLACK: f64 = 1e-5;
/// Weight of a change relative to an excess, small enough that the remaining excess is less than the slack.
const CHANGE_WEIGHT: f64 = 1e-4;

/// ½ ‖excess‖² and ½ λ² ‖x − clamped‖².
struct KeyExcess<'a> {
    rows: &'a [Row],
    clamped: DVector<f64>,
}

impl KeyExcess<'_> {
    fn excess(row: &Row, x: &DVector<f64>) -> f64 {
        (row.excess(x) + SLACK).max(0.0)
    }
}

impl Cost for KeyExcess<'_> {
    type Error = Infallible;

    fn value(&mut self, x: &DVector<f64>) -> Result<f64, Infallible> {
        let excess = self.rows.iter().map(|row| Self::excess(row, x));
        let excess = excess.map(|distance| distance * distance);
        let moved = CHANGE_WEIGHT * CHANGE_WEIGHT * (x - &self.clamped).norm_squared();
        Ok(0.5 * (excess.sum::<f64>() + moved))
    }

    fn linearise(
        &mut self,
        x: &DVector<f64>,
        gradient: &mut DVector<f64>,
        hessian: &mut DMatrix<f64>,
    ) -> Result<f64, Infallible> {
        gradient.copy_from(&((x - &self.clamped) * (CHANGE_WEIGHT * CHANGE_WEIGHT)));
        hessian.fill(0.0);
        hessian.fill_diagonal(CHANGE_WEIGHT * CHANGE_WEIGHT);
        for row in self.rows {
            let excess = Self::excess(row, x);
            if excess == 0.0 {
                continue;
            }
            for &(a, gain) in &row.gains {
                gradient[a] += gain * excess;
                for &(b, other) in &row.gains {
                    hessian[(a, b)] += gain * other;
                }
            }
        }
        self.value(x)
    }
}

/// Returns the smallest change that also brings the splines between the keys within their limits. `clamped` is the
/// change that brings each key within its own limits. Rows that cannot be satisfied together get an allowed excess.
pub(super) fn limited_change(rows: &mut [Row], clamped: DVector<f64>) -> DVector<f64> {
    if rows.iter().all(|row| row.excess(&clamped) <= 0.0) {
        return clamped;
    }
    let mut problem = KeyExcess { rows, clamped };
    let start = problem.clamped.clone();
    let x = match minimise(&mut problem, &[], start) {
        Ok(x) => x,
        Err(never) => match never {},
    };
    for row in rows {
        let remaining = row.excess(&x);
        if remaining > 0.0 {
            row.allowed += remaining + SLACK;
        }
    }
    x
}
