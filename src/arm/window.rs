//! The bounds of one question: the limits, or less where moves are bounded.

use super::desk::Desk;
use super::query::Arm;

impl Arm {
    /// Sets the desk's bounds and its start, which is projected into the limits.
    pub(super) fn open_window(&self, desk: &mut Desk, start: &[f64]) {
        let map = &self.serial.map;
        for (i, value) in desk.start.iter_mut().enumerate() {
            *value = start[i].max(map.lower()[i]).min(map.upper()[i]);
        }
        let Some(max_move) = &self.options.max_move else {
            return;
        };
        for (i, &most) in max_move.iter().enumerate() {
            desk.lower[i] = map.lower()[i].max(within(desk.start[i], -most));
            desk.upper[i] = map.upper()[i].min(within(desk.start[i], most));
        }
        desk.problem.set_bounds(&desk.lower, &desk.upper);
        if let Some(lanes) = &self.lanes {
            desk.windowed
                .get_or_insert_with(|| lanes.without_atlas())
                .set_bounds(&desk.lower, &desk.upper);
        }
    }
}

/// `start + by`, rounded so that it is no further away than `by` in floating point.
fn within(start: f64, by: f64) -> f64 {
    let end = start + by;
    if (end - start).abs() <= by.abs() {
        end
    } else if by > 0.0 {
        end.next_down()
    } else {
        end.next_up()
    }
}
