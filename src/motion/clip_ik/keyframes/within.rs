//! Smallest change that brings keys within their limits.

use std::convert::Infallible;

use nalgebra::{DMatrix, DVector};

use super::basis::Row;
use super::interior::{Cost, minimise};

/// Distance from its limits to which a clip is brought, radians: the slack for the targets.
const ROOM: f64 = 1e-5;
/// Weight of a change relative to an excess, small enough that the remaining excess is less than the slack.
const CHANGE: f64 = 1e-4;

/// ½ ‖excess‖² and ½ λ² ‖x − clamped‖².
struct Gap<'a> {
    rows: &'a [Row],
    clamped: DVector<f64>,
}

impl Gap<'_> {
    fn beyond(row: &Row, x: &DVector<f64>) -> f64 {
        (row.excess(x) + ROOM).max(0.0)
    }
}

impl Cost for Gap<'_> {
    type Error = Infallible;

    fn value(&mut self, x: &DVector<f64>) -> Result<f64, Infallible> {
        let beyond = self.rows.iter().map(|row| Self::beyond(row, x));
        let beyond = beyond.map(|by| by * by);
        let moved = CHANGE * CHANGE * (x - &self.clamped).norm_squared();
        Ok(0.5 * (beyond.sum::<f64>() + moved))
    }

    fn linearise(
        &mut self,
        x: &DVector<f64>,
        gradient: &mut DVector<f64>,
        hessian: &mut DMatrix<f64>,
    ) -> Result<f64, Infallible> {
        gradient.copy_from(&((x - &self.clamped) * (CHANGE * CHANGE)));
        hessian.fill(0.0);
        hessian.fill_diagonal(CHANGE * CHANGE);
        for row in self.rows {
            let beyond = Self::beyond(row, x);
            if beyond == 0.0 {
                continue;
            }
            for &(a, gain) in &row.gains {
                gradient[a] += gain * beyond;
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
pub(super) fn brought_within(rows: &mut [Row], clamped: DVector<f64>) -> DVector<f64> {
    if rows.iter().all(|row| row.excess(&clamped) <= 0.0) {
        return clamped;
    }
    let mut gap = Gap { rows, clamped };
    let start = gap.clamped.clone();
    let x = match minimise(&mut gap, &[], start) {
        Ok(x) => x,
        Err(never) => match never {},
    };
    for row in rows {
        let over = row.excess(&x);
        if over > 0.0 {
            row.allowed += over + ROOM;
        }
    }
    x
}
