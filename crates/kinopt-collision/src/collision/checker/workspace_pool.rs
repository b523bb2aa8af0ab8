//! Pool of workspaces for a residual that many threads evaluate.

use std::sync::{Mutex, PoisonError};

use super::scene_placements::SceneWorkspace;

/// As many workspaces as there were simultaneous visits.
#[derive(Debug, Default)]
pub(super) struct WorkspacePool(Mutex<Vec<SceneWorkspace>>);

impl WorkspacePool {
    pub(super) fn take(&self) -> SceneWorkspace {
        let mut workspaces = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        workspaces.pop().unwrap_or_default()
    }

    pub(super) fn put_back(&self, workspace: SceneWorkspace) {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(workspace);
    }
}

/// A copy starts with an empty pool.
impl Clone for WorkspacePool {
    fn clone(&self) -> Self {
        Self::default()
    }
}
