//! Times and indices of frames.

use crate::failure::Outcome;

/// More frames than this are a slip of the keyboard.
const MOST: f64 = 1e6;
/// A last frame that rounding puts this share of a frame too late still counts, or as many times what single precision, in
/// which clips end, can tell apart there.
const SLACK: f64 = 1e-6;
const ROUNDINGS: f64 = 4.0;

/// Frames at an even rate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frames {
    per_second: f64,
    start: f64,
    /// Number of frames at the rate.
    count: usize,
    /// Time of a last frame that follows by less than a period, in seconds.
    partial: Option<f64>,
}

impl Frames {
    /// The frames at `start`, `start` + 1/`per_second`, … and at `end`, which may follow the last by less than a period; times in
    /// seconds.
    pub(super) fn new(per_second: f64, start: f64, end: f64) -> Outcome<Self> {
        if end < start {
            return Err(usage!(
                "no frame lies between --from {start} s and --to {end} s"
            ));
        }
        let latest = start.abs().max(end.abs());
        let rounding = ROUNDINGS * f64::from(f32::EPSILON) * latest * per_second;
        let slack = rounding.clamp(SLACK, 0.5);
        let steps = ((end - start) * per_second + slack).floor();
        if steps.is_nan() || steps >= MOST {
            return Err(usage!(
                "{per_second} frames a second from {start} s to {end} s are more than {MOST} files"
            ));
        }
        let left = (end - start) * per_second - steps;
        Ok(Self {
            per_second,
            start,
            count: steps as usize + 1,
            partial: (left > slack).then_some(end),
        })
    }

    pub(super) fn per_second(self) -> f64 {
        self.per_second
    }

    /// The time of the first, in seconds.
    pub(super) fn start(self) -> f64 {
        self.start
    }

    /// The file's name without its extension, and the time in seconds.
    pub(super) fn iter(self) -> impl Iterator<Item = (String, f64)> {
        // Computed by division for each frame, to avoid accumulated drift.
        let times = (0..self.count).map(move |frame| self.start + frame as f64 / self.per_second);
        let last = self.count - usize::from(self.partial.is_none());
        let digits = last.to_string().len().max(4);
        let named = move |(frame, time)| (format!("frame-{frame:0digits$}"), time);
        times.chain(self.partial).enumerate().map(named)
    }
}
