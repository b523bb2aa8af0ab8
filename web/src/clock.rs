//! Time limits by the clock of JavaScript.

use std::time::Duration;

use wasm_bindgen::prelude::*;

use crate::arguments::NamedArguments;

#[wasm_bindgen]
extern "C" {
    /// Milliseconds since the start of the page, the worker or Node.
    #[wasm_bindgen(js_namespace = performance)]
    fn now() -> f64;
}

/// Reads the option `timeLimit`, seconds.
pub(crate) fn time_limit(options: &NamedArguments) -> Result<Option<Duration>, JsError> {
    let Some(seconds) = options.number("timeLimit")? else {
        return Ok(None);
    };
    kinopt::clock::set(|| Duration::from_secs_f64(1e-3 * now()));
    let limit = Duration::try_from_secs_f64(seconds);
    let invalid = |_| {
        JsError::new(&format!(
            "timeLimit is {seconds} s, expected a finite number of at least 0"
        ))
    };
    limit.map(Some).map_err(invalid)
}
