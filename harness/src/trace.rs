//! Trace of a solver's configurations, recorded with the clock stopped.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

use crate::clock;

/// Largest number of marks: 100 000 of 60 variables are 50 MB.
const MAX_MARKS: usize = 100_000;

/// Configuration after an iteration, with the solver's time until then.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mark {
    pub(crate) at: Duration,
    pub(crate) configuration: Vec<f64>,
}

/// Recorder of a solver's marks. Off in the untraced solve, on in the traced one. Clones share the marks, for observers
/// that must own their recorder.
#[derive(Clone, Debug)]
pub struct Trace(Option<Rc<RefCell<Recording>>>);

#[derive(Debug)]
struct Recording {
    solver_time: Duration,
    /// Time of the last resume, by [`clock::now`].
    resumed: Duration,
    marks: Vec<Mark>,
    /// Number of marks that are configurations already.
    translated: usize,
}

impl Trace {
    /// A trace that records no marks.
    #[must_use]
    pub fn off() -> Self {
        Self(None)
    }

    /// A trace whose clock starts now.
    pub(crate) fn on() -> Self {
        Self(Some(Rc::new(RefCell::new(Recording {
            solver_time: Duration::ZERO,
            resumed: clock::now(),
            marks: Vec::new(),
            translated: 0,
        }))))
    }

    /// True if marks are recorded.
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.0.is_some()
    }

    /// Records the configuration after an iteration, and the start before the first. Variables of the solver's own need
    /// a later [`translate`](Self::translate). The clock is stopped meanwhile.
    pub fn mark(&self, configuration: &[f64]) {
        self.paused(|recording| {
            if recording.marks.len() < MAX_MARKS {
                recording.marks.push(Mark {
                    at: recording.solver_time,
                    configuration: configuration.to_vec(),
                });
            }
        });
    }

    /// Converts the marks since the last translation to configurations. The clock is stopped meanwhile.
    pub fn translate(&self, to_configuration: impl Fn(&[f64]) -> Vec<f64>) {
        self.paused(|recording| {
            let first = recording.translated;
            for mark in recording.marks.iter_mut().skip(first) {
                mark.configuration = to_configuration(&mark.configuration);
            }
            recording.translated = recording.marks.len();
        });
    }

    /// Returns the marks, and the total time of the solver.
    pub(crate) fn finish(self) -> (Vec<Mark>, Duration) {
        let mut result = (Vec::new(), Duration::ZERO);
        self.paused(|recording| {
            result = (std::mem::take(&mut recording.marks), recording.solver_time);
        });
        result
    }

    fn paused(&self, work: impl FnOnce(&mut Recording)) {
        let Some(shared) = &self.0 else { return };
        let now = clock::now();
        // Fails only if an adapter marks within its own translation: that mark is dropped.
        let Ok(mut recording) = shared.try_borrow_mut() else {
            return;
        };
        let resumed = recording.resumed;
        recording.solver_time += now.saturating_sub(resumed);
        work(&mut recording);
        recording.resumed = clock::now();
    }
}
