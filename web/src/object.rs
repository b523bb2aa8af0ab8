//! Plain objects, for what is told and not asked again.

use js_sys::{Object, Reflect};
use wasm_bindgen::JsValue;

/// An object of these names.
pub(crate) fn of<const N: usize>(fields: [(&str, JsValue); N]) -> Object {
    let object = Object::new();
    add(&object, fields);
    object
}

/// Adds names to an object.
pub(crate) fn add<const N: usize>(object: &Object, fields: [(&str, JsValue); N]) {
    for (name, value) in fields {
        // Fails for frozen objects alone.
        let _ = Reflect::set(object, &name.into(), &value);
    }
}
