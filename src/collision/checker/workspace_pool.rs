//! Memory that a residual lends itself, which is asked by many threads and changes nothing.

use std::sync::{Mutex, PoisonError};

use super::scene_placements::SceneRoom;

/// Room for as many visits as there were at once.
#[derive(Debug, Default)]
pub(super) struct Rooms(Mutex<Vec<SceneRoom>>);

impl Rooms {
    pub(super) fn take(&self) -> SceneRoom {
        let mut rooms = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        rooms.pop().unwrap_or_default()
    }

    pub(super) fn put_back(&self, room: SceneRoom) {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(room);
    }
}

/// A copy makes its own.
impl Clone for Rooms {
    fn clone(&self) -> Self {
        Self::default()
    }
}
