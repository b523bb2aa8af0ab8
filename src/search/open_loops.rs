//! Which of the model's loops a solution leaves open.

use super::Solution;

/// A loop of the model whose places are farther apart than [`Loop::TOLERANCE`](crate::model::Loop::TOLERANCE).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct OpenLoop<'a> {
    /// The loop's name.
    pub name: &'a str,
    /// How far its places are apart, in metres.
    pub gap: f64,
    /// How far one place is turned from the other, in radians; 0 where the loop holds origins alone.
    pub angle: f64,
}

impl Solution {
    /// Whether every loop of the model is closed at `q`; true where it has none. A solution that is
    /// [reached](Self::reached) has closed them all.
    #[must_use]
    pub fn loops_closed(&self) -> bool {
        self.open_loops().next().is_none()
    }

    /// The loops that are open at `q`, in the model's order.
    pub fn open_loops(&self) -> impl Iterator<Item = OpenLoop<'_>> {
        let names = self.names.as_deref();
        let loops = names.map_or(&[][..], |names| &names.loops);
        let tasks = names.map_or(0, |names| names.tasks.len());
        let own = tasks.saturating_sub(loops.len());
        self.tasks().filter_map(move |task| {
            let closes = task.rows.first()?.task.checked_sub(own)?;
            let name = loops.get(closes).filter(|_| !task.reached)?;
            Some(OpenLoop {
                name,
                gap: task.position_error().unwrap_or(0.0),
                angle: task.orientation_error().unwrap_or(0.0),
            })
        })
    }
}
