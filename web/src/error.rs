//! Exceptions of the classes in `js/errors.js`.

use kinopt_bindings::{Classify, ErrorKind};
use wasm_bindgen::prelude::*;

use crate::names;

#[wasm_bindgen(raw_module = "./errors.js")]
extern "C" {
    #[wasm_bindgen(js_name = errorOf)]
    fn error_of(class: &str, message: &str) -> JsValue;
}

/// An exception for JavaScript.
pub struct Exception(JsValue);

impl Exception {
    /// Creates an exception of this kind. Options in the message get their names in JavaScript.
    pub(crate) fn of(kind: ErrorKind, message: &str) -> Self {
        let class = match kind {
            ErrorKind::InvalidValue => "InvalidValueError",
            ErrorKind::UnknownName => "UnknownNameError",
            ErrorKind::InvalidFile => "InvalidFileError",
            ErrorKind::File => "FileError",
        };
        Self(error_of(class, &names::of_javascript(message)))
    }

    /// Creates an exception for an invalid value.
    pub(crate) fn new(message: &str) -> Self {
        Self::of(ErrorKind::InvalidValue, message)
    }
}

impl From<Exception> for JsValue {
    fn from(exception: Exception) -> Self {
        exception.0
    }
}

/// Exception of an error of the library.
pub(crate) fn raise(error: impl Classify) -> Exception {
    Exception::of(error.kind(), &error.to_string())
}
