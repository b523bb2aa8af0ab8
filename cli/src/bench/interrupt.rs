//! Ctrl-C and termination requests: the first stops and keeps results, the second exits immediately.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Outcome;

/// Exit code of a program that an interrupt ended, as in shells.
const INTERRUPTED: i32 = 130;

/// Flag that an interrupt sets.
pub(super) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Installs the handler.
    pub(super) fn listen() -> Outcome<Self> {
        let came = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&came);
        let handler = move || {
            if flag.swap(true, Ordering::Relaxed) {
                std::process::exit(INTERRUPTED);
            }
        };
        ctrlc::set_handler(handler)
            .map_err(|error| failure!("interrupts cannot be caught: {error}"))?;
        Ok(Self(came))
    }

    pub(super) fn came(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    pub(super) fn flow(&self) -> ControlFlow<()> {
        match self.came() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}
