//! Typed arrays over the module's own memory, for what is read every frame.
//!
//! A view is valid until the memory grows, which any call may do; then it has length 0. Who draws from one asks for it
//! anew each frame, which costs no copy.

use js_sys::{Float32Array, Float64Array, WebAssembly};
use wasm_bindgen::JsCast;

fn buffer() -> wasm_bindgen::JsValue {
    let memory = wasm_bindgen::memory();
    memory.unchecked_into::<WebAssembly::Memory>().buffer()
}

/// The numbers of these triples where they lie.
pub(crate) fn floats<T: bytemuck::Pod>(values: &[T]) -> Float32Array {
    let floats: &[f32] = bytemuck::cast_slice(values);
    let (at, count) = (floats.as_ptr() as usize as u32, floats.len() as u32);
    Float32Array::new_with_byte_offset_and_length(&buffer(), at, count)
}

/// The same of double precision.
pub(crate) fn doubles(values: &[f64]) -> Float64Array {
    let (at, count) = (values.as_ptr() as usize as u32, values.len() as u32);
    Float64Array::new_with_byte_offset_and_length(&buffer(), at, count)
}
