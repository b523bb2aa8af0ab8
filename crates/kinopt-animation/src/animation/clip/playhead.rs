//! Playback position of a clip.

/// Playback position that advances at a speed, which may be negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playhead {
    elapsed: f64,
    started: bool,
    /// Clip seconds per second; negative plays backwards.
    pub speed: f64,
}

/// Interval between two playback positions, in seconds since playback started. It includes `to`, and includes `from`
/// only if playback starts there. A chain of passages thus covers each time once.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Passage {
    /// Position at the start of the passage, seconds.
    pub from: f64,
    /// Position at the end of the passage, seconds; less than `from` in backward playback.
    pub to: f64,
    /// True if playback started at `from`.
    pub starts: bool,
}

impl Passage {
    /// True if the passage includes a time.
    pub(super) fn passes(&self, time: f64) -> bool {
        let Self { from, to, starts } = *self;
        if time == from {
            return starts;
        }
        (from < time && time <= to) || (to <= time && time < from)
    }
}

impl Default for Playhead {
    fn default() -> Self {
        Self::new()
    }
}

impl Playhead {
    /// Playhead at the start, at normal speed.
    #[must_use]
    pub fn new() -> Self {
        Self::starting_at(0.0)
    }

    /// Playhead at `elapsed` seconds after the start.
    #[must_use]
    pub fn starting_at(elapsed: f64) -> Self {
        Self {
            elapsed,
            started: false,
            speed: 1.0,
        }
    }

    /// Advances by the given seconds. Does nothing if the number is not finite.
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

    /// Clip seconds since playback started. Add the clip's start for the time of [`Clip::sample`](super::Clip::sample).
    #[must_use]
    pub fn elapsed(&self) -> f64 {
        self.elapsed
    }
}
