//! Progress line on standard error during long work, on a terminal only.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use kinopt::solver::{Iteration, Observer};

/// Time until the line appears.
const DELAY: Duration = Duration::from_millis(300);
/// Refresh rate, in hertz.
const REFRESH_RATE: u8 = 10;
/// Number of iterations between two checks of the time.
const ITERATIONS_PER_CHECK: usize = 16;

/// Progress line that appears late and is removed on drop.
struct Line {
    started: Instant,
    /// Bar of a terminal; `None` without one.
    bar: Option<ProgressBar>,
}

impl Line {
    /// Line with a template, and a length if it is known.
    fn new(length: Option<usize>, shape: &str) -> Self {
        let target = ProgressDrawTarget::stderr_with_hz(REFRESH_RATE);
        let bar = (!target.is_hidden()).then(|| {
            let length = length.map(|length| u64::try_from(length).unwrap_or(u64::MAX));
            let bar = ProgressBar::with_draw_target(length, target);
            match ProgressStyle::with_template(shape) {
                Ok(style) => bar.with_style(style),
                Err(_) => bar,
            }
        });
        let started = Instant::now();
        Self { started, bar }
    }

    /// Bar, after the initial delay.
    fn bar_after_delay(&self) -> Option<&ProgressBar> {
        let bar = self.bar.as_ref();
        bar.filter(|_| self.started.elapsed() > DELAY)
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Counter of solved queries. It is updated between queries, so that measured times do not contain it.
pub(crate) struct Countdown {
    line: Line,
    done: AtomicU64,
}

impl Countdown {
    /// Counter up to `total`; `noun` is the counted unit.
    pub(crate) fn new(total: usize, noun: &str) -> Self {
        let shape = format!("{{bar:40}} {{pos}} of {{len}} {noun}, {{eta}} left");
        let line = Line::new(Some(total), &shape);
        let done = AtomicU64::new(0);
        Self { line, done }
    }

    pub(crate) fn one_more(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        if let Some(bar) = self.line.bar_after_delay() {
            bar.set_position(done);
        }
    }
}

/// Counter of attempts and iterations of one search.
pub(crate) struct Progress {
    line: Line,
    attempts: usize,
    iterations: usize,
    lowest_cost: f64,
}

impl Progress {
    pub(crate) fn new() -> Self {
        Self {
            line: Line::new(None, "{spinner} {msg}"),
            attempts: 0,
            iterations: 0,
            lowest_cost: f64::INFINITY,
        }
    }
}

impl Observer for Progress {
    fn observe(&mut self, iteration: &Iteration<'_>) -> ControlFlow<()> {
        self.attempts += usize::from(iteration.index == 0);
        self.iterations += 1;
        self.lowest_cost = self.lowest_cost.min(iteration.cost);
        if self.iterations.is_multiple_of(ITERATIONS_PER_CHECK) {
            if let Some(bar) = self.line.bar_after_delay() {
                let (attempts, iterations) = (self.attempts, self.iterations);
                let cost = self.lowest_cost;
                bar.set_message(format!(
                    "attempt {attempts}, {iterations} iterations, lowest cost {cost:.3e}"
                ));
                bar.tick();
            }
        }
        ControlFlow::Continue(())
    }
}
