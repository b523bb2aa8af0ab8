//! Where a clip was sampled last.

use std::sync::{Arc, Weak};

use super::tracks::{Segments, Tracks};

/// Where a clip was sampled last: the keys around that time, so that a frame of playback only takes
/// up the keys that it passes. It may be used with any clip and any time; a change of clip or a leap
/// in time only costs a search.
#[derive(Clone, Debug, Default)]
pub struct Cursor {
    /// Whose segments these are. A weak reference keeps no keys, but keeps their address from being
    /// used again.
    of: Weak<Tracks>,
    segments: Segments,
}

impl Cursor {
    /// At the start of whatever clip.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// What it keeps of these tracks.
    #[inline]
    pub(super) fn on(&mut self, tracks: &Arc<Tracks>) -> &mut Segments {
        if self.of.as_ptr() != Arc::as_ptr(tracks) {
            self.segments = tracks.start();
            self.of = Arc::downgrade(tracks);
        }
        &mut self.segments
    }
}
