//! Where playback of a clip is.

/// Time that passes while a clip plays, at a speed that may be negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playhead {
    elapsed: f64,
    started: bool,
    /// How many seconds of the clip pass in a second; negative plays backwards.
    pub speed: f64,
}

/// The stretch of time between two moments of playback, in seconds since it started. A chain of
/// passages covers each moment once: the later end belongs to a passage, the earlier one only where
/// playback starts there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Passage {
    /// Where playback was.
    pub from: f64,
    /// Where it is now; before `from` when it plays backwards.
    pub to: f64,
    /// Whether playback started at `from`.
    pub starts: bool,
}

impl Passage {
    /// Whether a moment lies in it.
    pub(super) fn passes(&self, moment: f64) -> bool {
        let Self { from, to, starts } = *self;
        if moment == from {
            return starts;
        }
        (from < moment && moment <= to) || (to <= moment && moment < from)
    }
}

impl Default for Playhead {
    fn default() -> Self {
        Self::new()
    }
}

impl Playhead {
    /// At the start, at normal speed.
    #[must_use]
    pub fn new() -> Self {
        Self::starting_at(0.0)
    }

    /// So many seconds after the start.
    #[must_use]
    pub fn starting_at(elapsed: f64) -> Self {
        Self {
            elapsed,
            started: false,
            speed: 1.0,
        }
    }

    /// Plays on for so many seconds; not at all for a number that is not finite.
    pub fn advance(&mut self, seconds: f64) -> Passage {
        let from = self.elapsed;
        let step = seconds * self.speed;
        if step.is_finite() {
            self.elapsed += step;
        }
        let starts = !self.started;
        self.started = true;
        Passage {
            from,
            to: self.elapsed,
            starts,
        }
    }

    /// Seconds of the clip since playback started. The clip's start plus these is the time for [`Clip::sample`](super::Clip::sample).
    #[must_use]
    pub fn elapsed(&self) -> f64 {
        self.elapsed
    }
}
