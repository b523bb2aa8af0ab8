//! Limits of time, by the clock of whoever runs the module.

use std::time::Duration;

use wasm_bindgen::prelude::*;

use crate::given::Given;

#[wasm_bindgen]
extern "C" {
    /// Milliseconds since the page, the worker or Node began.
    #[wasm_bindgen(js_namespace = performance)]
    fn now() -> f64;
}

/// The limit that is given under `timeLimit`, seconds.
pub(crate) fn time_limit(given: &Given) -> Result<Option<Duration>, JsError> {
    let Some(seconds) = given.number("timeLimit")? else {
        return Ok(None);
    };
    kinopt::clock::set(|| Duration::from_secs_f64(1e-3 * now()));
    let limit = Duration::try_from_secs_f64(seconds);
    let wrong = |_| {
        JsError::new(&format!(
            "timeLimit is {seconds} s: a finite number of at least 0 is wanted"
        ))
    };
    limit.map(Some).map_err(wrong)
}
