//! Referenced files, opened by a function of the caller.

use js_sys::{Function, Uint8Array};
use kinopt::io::{FileLocation, ReadError};
use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Returns the bytes of a referenced file, or `undefined` if it does not exist. */
export type Open = (file: string) => Uint8Array | undefined;
"#;

#[wasm_bindgen]
extern "C" {
    /// A function that opens files.
    #[wasm_bindgen(typescript_type = "Open")]
    pub type Open;
}

/// Parses a file; `open` reads further files. An exception of `open` has priority over the parse error.
pub(crate) fn parsed<T>(
    open: Option<Open>,
    parse: impl FnOnce(&mut dyn FnMut(&str) -> Result<Vec<u8>, ReadError>) -> Result<T, ReadError>,
) -> Result<T, JsValue> {
    let open = open.and_then(|open| JsValue::from(open).dyn_into::<Function>().ok());
    let mut raised = None;
    let parsed = parse(&mut |file| {
        let missing = || {
            let text = "not given with the file that refers to it";
            fail(file, std::io::ErrorKind::NotFound, text)
        };
        let open = open.as_ref().ok_or_else(missing)?;
        match open.call1(&JsValue::UNDEFINED, &file.into()) {
            Ok(bytes) if bytes.is_undefined() || bytes.is_null() => Err(missing()),
            Ok(bytes) => match bytes.dyn_into::<Uint8Array>() {
                Ok(bytes) => Ok(bytes.to_vec()),
                Err(_) => Err(fail(
                    file,
                    std::io::ErrorKind::InvalidInput,
                    "`open` returned no Uint8Array",
                )),
            },
            Err(error) => {
                raised = Some(error);
                Err(fail(file, std::io::ErrorKind::Other, "not opened"))
            }
        }
    });
    match raised {
        Some(error) => Err(error),
        None => parsed.map_err(|error| crate::error::raise(error).into()),
    }
}

fn fail(file: &str, kind: std::io::ErrorKind, text: &str) -> ReadError {
    ReadError {
        file: file.to_owned(),
        place: FileLocation::File,
        problem: std::io::Error::new(kind, text).into(),
    }
}
