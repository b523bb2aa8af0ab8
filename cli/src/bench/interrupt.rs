//! Ctrl-C and termination requests: the first stops and keeps results, the second exits immediately.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Outcome;

/// Exit code of a program that an interrupt ended, as in shells.
const INTERRUPT_EXIT_CODE: i32 = 130;

/// Flag that an interrupt sets.
pub(super) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Installs the handler.
    pub(super) fn listen() -> Outcome<Self> {
        let is_interrupted = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&is_interrupted);
        let handler = move || {
            if flag.swap(true, Ordering::Relaxed) {
                std::process::exit(INTERRUPT_EXIT_CODE);
            }
        };
        ctrlc::set_handler(handler)
            .map_err(|error| failure!("interrupts cannot be caught: {error}"))?;
        Ok(Self(is_interrupted))
    }

    pub(super) fn is_interrupted(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    pub(super) fn flow(&self) -> ControlFlow<()> {
        match self.is_interrupted() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}
