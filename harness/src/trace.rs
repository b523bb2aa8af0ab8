//! Where a solver stood when, taken with the clock stopped.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::{Duration, Instant};

/// A trace stops growing here: 100 000 steps of 60 variables are 50 MB.
const MOST_MARKS: usize = 100_000;

/// A place after a step, and how long the solver had worked until then.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mark {
    pub(crate) at: Duration,
    pub(crate) place: Vec<f64>,
}

/// Where adapters mark what they pass. Off in the plain ask, on in the traced one. Clones share the
/// marks, so that an observer that must own what it writes to can.
#[derive(Clone, Debug)]
pub struct Trace(Option<Rc<RefCell<Recording>>>);

#[derive(Debug)]
struct Recording {
    worked: Duration,
    resumed: Instant,
    marks: Vec<Mark>,
    /// Marks before this one are configurations already.
    translated: usize,
}

impl Trace {
    /// A trace that takes no marks.
    #[must_use]
    pub fn off() -> Self {
        Self(None)
    }

    /// A trace whose clock starts now.
    pub(crate) fn on() -> Self {
        Self(Some(Rc::new(RefCell::new(Recording {
            worked: Duration::ZERO,
            resumed: Instant::now(),
            marks: Vec::new(),
            translated: 0,
        }))))
    }

    /// Whether marks are taken.
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.0.is_some()
    }

    /// Marks where the solver stands after a step, and its start before the first one. A
    /// configuration; or numbers of the solver's own, which [`translate`](Self::translate) then
    /// turns into configurations. The clock stands still meanwhile.
    pub fn mark(&self, place: &[f64]) {
        self.paused(|recording| {
            if recording.marks.len() < MOST_MARKS {
                recording.marks.push(Mark {
                    at: recording.worked,
                    place: place.to_vec(),
                });
            }
        });
    }

    /// Turns the marks since the last translation into configurations. The clock stands still
    /// meanwhile.
    pub fn translate(&self, configuration: impl Fn(&[f64]) -> Vec<f64>) {
        self.paused(|recording| {
            let first = recording.translated;
            for mark in recording.marks.iter_mut().skip(first) {
                mark.place = configuration(&mark.place);
            }
            recording.translated = recording.marks.len();
        });
    }

    /// The marks, and how long the solver worked.
    pub(crate) fn finish(self) -> (Vec<Mark>, Duration) {
        let mut found = (Vec::new(), Duration::ZERO);
        self.paused(|recording| {
            found = (std::mem::take(&mut recording.marks), recording.worked);
        });
        found
    }

    fn paused(&self, work: impl FnOnce(&mut Recording)) {
        let now = Instant::now();
        let Some(shared) = &self.0 else { return };
        // Taken only if an adapter marks from within its own translation: that mark is dropped.
        let Ok(mut recording) = shared.try_borrow_mut() else {
            return;
        };
        let resumed = recording.resumed;
        recording.worked += now.saturating_duration_since(resumed);
        work(&mut recording);
        recording.resumed = Instant::now();
    }
}
