//! Times and indices of frames.

use crate::failure::Outcome;

/// Limit of the number of frames.
const MAX_FRAMES: f64 = 1e6;
/// Tolerance of the last frame's time, in frames: `MIN_TOLERANCE`, or `MAX_ROUNDINGS` times the single-precision rounding error
/// of the end time if that is larger.
const MIN_TOLERANCE: f64 = 1e-6;
const MAX_ROUNDINGS: f64 = 4.0;

/// Frames at a constant rate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frames {
    per_second: f64,
    start: f64,
    /// Number of frames at the constant rate.
    count: usize,
    /// Time of an additional last frame, in seconds. It follows by less than a period.
    partial: Option<f64>,
}

impl Frames {
    /// Frames at `start`, `start` + 1/`per_second`, … and at `end`. The last step can be shorter than a period. Times
    /// are in seconds.
    pub(super) fn new(per_second: f64, start: f64, end: f64) -> Outcome<Self> {
        if end < start {
            return Err(usage!(
                "no frame between --from {start} s and --to {end} s: --to must not be before --from"
            ));
        }
        let latest = start.abs().max(end.abs());
        let rounding = MAX_ROUNDINGS * f64::from(f32::EPSILON) * latest * per_second;
        let tolerance = rounding.clamp(MIN_TOLERANCE, 0.5);
        let steps = ((end - start) * per_second + tolerance).floor();
        if steps.is_nan() || steps >= MAX_FRAMES {
            return Err(usage!(
                "--fps {per_second} from {start} s to {end} s needs more than {MAX_FRAMES} frames, the maximum"
            ));
        }
        let remainder = (end - start) * per_second - steps;
        Ok(Self {
            per_second,
            start,
            count: steps as usize + 1,
            partial: (remainder > tolerance).then_some(end),
        })
    }

    pub(super) fn per_second(self) -> f64 {
        self.per_second
    }

    /// Time of the first frame, in seconds.
    pub(super) fn start(self) -> f64 {
        self.start
    }

    /// Each frame's file name without extension, and its time in seconds.
    pub(super) fn iter(self) -> impl Iterator<Item = (String, f64)> {
        // Computed by division for each frame, to avoid accumulated drift.
        let times = (0..self.count).map(move |frame| self.start + frame as f64 / self.per_second);
        let last = self.count - usize::from(self.partial.is_none());
        let digits = last.to_string().len().max(4);
        let named = move |(frame, time)| (format!("frame-{frame:0digits$}"), time);
        times.chain(self.partial).enumerate().map(named)
    }
}
