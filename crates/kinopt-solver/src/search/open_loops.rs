//! Loop closures that a solution violates.

use super::Solution;

/// A loop of the model whose closure error exceeds [`Loop::TOLERANCE`](kinopt_kinematics::model::Loop::TOLERANCE).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct OpenLoop<'a> {
    /// Name of the loop.
    pub name: &'a str,
    /// Distance of the closure points, metres.
    pub gap: f64,
    /// Angle between the closure frames, radians; 0 for loops that constrain points only.
    pub angle: f64,
}

impl Solution {
    /// Reports whether every loop of the model is closed at `q`; true for a model without loops. In a
    /// [reached](Self::reached) solution all loops are closed.
    #[must_use]
    pub fn loops_closed(&self) -> bool {
        self.open_loops().next().is_none()
    }

    /// The loops that are open at `q`, in the order of the model.
    pub fn open_loops(&self) -> impl Iterator<Item = OpenLoop<'_>> {
        let names = self.names.as_deref();
        let loops = names.map_or(&[][..], |names| &names.loops);
        let tasks = names.map_or(0, |names| names.tasks.len());
        let first_loop_task = tasks.saturating_sub(loops.len());
        self.tasks().filter_map(move |task| {
            let loop_index = task.rows.first()?.task.checked_sub(first_loop_task)?;
            let name = loops.get(loop_index).filter(|_| !task.reached)?;
            Some(OpenLoop {
                name,
                gap: task.position_error().unwrap_or(0.0),
                angle: task.orientation_error().unwrap_or(0.0),
            })
        })
    }
}
