//! A bar on standard error while many targets are solved, on a terminal only.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Counts answers. It is told between questions, so no time that is taken holds its drawing.
pub(super) struct Countdown(Option<ProgressBar>);

/// How many drawings a second.
const DRAWINGS: u8 = 10;

impl Countdown {
    pub(super) fn new(questions: usize) -> Self {
        let target = ProgressDrawTarget::stderr_with_hz(DRAWINGS);
        if target.is_hidden() {
            return Self(None);
        }
        let length = u64::try_from(questions).unwrap_or(u64::MAX);
        let bar = ProgressBar::with_draw_target(Some(length), target);
        let style = ProgressStyle::with_template("{wide_bar} {pos} of {len} targets, {eta} left");
        Self(Some(match style {
            Ok(style) => bar.with_style(style),
            Err(_) => bar,
        }))
    }

    pub(super) fn one_more(&self) {
        // Short runs show nothing.
        if let Some(bar) = &self.0 {
            let quick = bar.elapsed() < Duration::from_millis(300);
            if quick {
                bar.update(|state| state.set_pos(state.pos() + 1));
            } else {
                bar.inc(1);
            }
        }
    }

    /// Takes the bar away.
    pub(super) fn finish(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}
