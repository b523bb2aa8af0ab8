//! A line on standard error while a search takes long.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget};
use kinopt::solver::{Iteration, Observer};

/// Searches shorter than this show nothing.
const PATIENCE: Duration = Duration::from_millis(300);
/// How many iterations pass between looks at the clock.
const BETWEEN_LOOKS: usize = 16;

/// Counts attempts and iterations and shows them, on a terminal only.
pub(crate) struct Progress {
    started: Instant,
    bar: Option<ProgressBar>,
    attempts: usize,
    iterations: usize,
    lowest_cost: f64,
}

impl Progress {
    pub(crate) fn new() -> Self {
        Self {
            started: Instant::now(),
            bar: None,
            attempts: 0,
            iterations: 0,
            lowest_cost: f64::INFINITY,
        }
    }

    /// Takes the line away.
    pub(crate) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    fn show(&mut self) {
        if self.started.elapsed() < PATIENCE {
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let spinner = ProgressBar::new_spinner();
            // Hidden by itself when standard error is no terminal.
            spinner.set_draw_target(ProgressDrawTarget::stderr());
            spinner
        });
        bar.set_message(format!(
            "attempt {}, {} iterations, lowest cost {:.3e}",
            self.attempts, self.iterations, self.lowest_cost
        ));
        bar.tick();
    }
}

impl Observer for Progress {
    fn observe(&mut self, iteration: &Iteration<'_>) -> ControlFlow<()> {
        if iteration.index == 0 {
            self.attempts += 1;
        }
        self.iterations += 1;
        self.lowest_cost = self.lowest_cost.min(iteration.cost);
        if self.iterations.is_multiple_of(BETWEEN_LOOKS) {
            self.show();
        }
        ControlFlow::Continue(())
    }
}
