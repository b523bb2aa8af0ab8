//! The bounds of one question: the limits, or less where moves are bounded.

use super::query::Arm;
use super::workspace::Workspace;

impl Arm {
    /// Sets the workspace's bounds and its start, which is projected into the limits.
    pub(super) fn open_window(&self, workspace: &mut Workspace, start: &[f64]) {
        let map = &self.serial.map;
        for (i, value) in workspace.start.iter_mut().enumerate() {
            *value = start[i].max(map.lower()[i]).min(map.upper()[i]);
        }
        let Some(max_move) = &self.options.max_move else {
            return;
        };
        for (i, &most) in max_move.iter().enumerate() {
            workspace.lower[i] = map.lower()[i].max(within(workspace.start[i], -most));
            workspace.upper[i] = map.upper()[i].min(within(workspace.start[i], most));
        }
        workspace
            .problem
            .set_bounds(&workspace.lower, &workspace.upper);
        if let Some(lanes) = &self.lanes {
            workspace
                .windowed
                .get_or_insert_with(|| lanes.without_atlas())
                .set_bounds(&workspace.lower, &workspace.upper);
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
