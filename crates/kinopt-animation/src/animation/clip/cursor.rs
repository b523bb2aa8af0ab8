//! Playback cursors of clips.

use std::sync::{Arc, Weak};

use super::tracks::{Segments, Tracks};

/// Playback cursor: the keys around the last sample time. During playback, a sample then only processes the keys passed
/// since. A cursor is valid for any clip and time; a change of clip or a seek costs a search.
#[derive(Clone, Debug, Default)]
pub struct Cursor {
    /// Tracks to which the segments belong. The weak reference does not keep the keys alive, but prevents reuse of
    /// their address.
    tracks: Weak<Tracks>,
    segments: Segments,
}

impl Cursor {
    /// A cursor at the start of any clip.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The segments stored for these tracks.
    #[inline]
    pub(super) fn segments_for(&mut self, tracks: &Arc<Tracks>) -> &mut Segments {
        if self.tracks.as_ptr() != Arc::as_ptr(tracks) {
            self.segments = tracks.start();
            self.tracks = Arc::downgrade(tracks);
        }
        &mut self.segments
    }
}
