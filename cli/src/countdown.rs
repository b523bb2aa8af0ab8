//! A bar on standard error while many things are done, on a terminal only.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Runs shorter than this show nothing.
const PATIENCE: Duration = Duration::from_millis(300);
/// How many drawings a second.
const DRAWINGS: u8 = 10;

/// Counts answers. It counts between questions, so no time that is taken holds its drawing.
pub(crate) struct Countdown {
    started: Instant,
    done: AtomicU64,
    /// None where nobody would see it.
    bar: Option<ProgressBar>,
}

impl Countdown {
    /// Counts up to `total`; `noun` is what is counted.
    pub(crate) fn new(total: usize, noun: &str) -> Self {
        let target = ProgressDrawTarget::stderr_with_hz(DRAWINGS);
        let bar = (!target.is_hidden()).then(|| {
            let length = u64::try_from(total).unwrap_or(u64::MAX);
            let bar = ProgressBar::with_draw_target(Some(length), target);
            let shape = format!("{{bar:40}} {{pos}} of {{len}} {noun}, {{eta}} left");
            match ProgressStyle::with_template(&shape) {
                Ok(style) => bar.with_style(style),
                Err(_) => bar,
            }
        });
        Self {
            started: Instant::now(),
            done: AtomicU64::new(0),
            bar,
        }
    }

    pub(crate) fn one_more(&self) {
        if let Some(bar) = &self.bar {
            let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
            if self.started.elapsed() > PATIENCE {
                bar.set_position(done);
            }
        }
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
