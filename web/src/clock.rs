//! Time limits by the clock of JavaScript.

use std::time::Duration;

use wasm_bindgen::prelude::*;

use crate::error::Exception;

#[wasm_bindgen]
extern "C" {
    /// Milliseconds since the start of the page, the worker or Node.
    #[wasm_bindgen(js_namespace = performance)]
    fn now() -> f64;
}

/// Converts a time limit in seconds, and sets the library's clock; `what` names it in messages.
pub(crate) fn time_limit(seconds: f64, what: &str) -> Result<Duration, Exception> {
    kinopt::clock::set(|| Duration::from_secs_f64(1e-3 * now()));
    Duration::try_from_secs_f64(seconds).map_err(|_| {
        Exception::new(&format!(
            "{what} is {seconds} s, expected a finite number of at least 0"
        ))
    })
}
