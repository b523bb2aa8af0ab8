//! Pool of workspaces for a residual that many threads evaluate.

use std::sync::{Mutex, PoisonError};

use super::scene_placements::SceneWorkspace;

/// As many workspaces as there were simultaneous visits.
#[derive(Debug, Default)]
pub(super) struct WorkspacePool(Mutex<Vec<SceneWorkspace>>);

impl WorkspacePool {
    pub(super) fn take(&self) -> SceneWorkspace {
        let mut rooms = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        rooms.pop().unwrap_or_default()
    }

    pub(super) fn put_back(&self, room: SceneWorkspace) {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(room);
    }
}

/// A copy starts with an empty pool.
impl Clone for WorkspacePool {
    fn clone(&self) -> Self {
        Self::default()
    }
}
