//! Plain objects for results.

use js_sys::{Object, Reflect};
use wasm_bindgen::JsValue;

/// Creates an object with these fields.
pub(crate) fn of<const N: usize>(fields: [(&str, JsValue); N]) -> Object {
    let object = Object::new();
    add(&object, fields);
    object
}

/// Adds fields to an object.
pub(crate) fn add<const N: usize>(object: &Object, fields: [(&str, JsValue); N]) {
    for (name, value) in fields {
        // Fails for frozen objects only.
        let _ = Reflect::set(object, &name.into(), &value);
    }
}
