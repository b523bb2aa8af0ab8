//! Typed arrays as views of the module's memory, for data that are read every frame.
//!
//! A view is valid until the memory grows, which any call may cause; then its length is 0. Fetch it again for each
//! frame: no data are copied.

#[cfg(feature = "bodies")]
use js_sys::Float32Array;
use js_sys::{Float64Array, WebAssembly};
use wasm_bindgen::JsCast;

fn buffer() -> wasm_bindgen::JsValue {
    let memory = wasm_bindgen::memory();
    memory.unchecked_into::<WebAssembly::Memory>().buffer()
}

/// View of the numbers of single-precision vectors.
#[cfg(feature = "bodies")]
pub(crate) fn floats<T: bytemuck::Pod>(values: &[T]) -> Float32Array {
    let floats: &[f32] = bytemuck::cast_slice(values);
    let (at, count) = (floats.as_ptr() as usize as u32, floats.len() as u32);
    Float32Array::new_with_byte_offset_and_length(&buffer(), at, count)
}

/// View of double-precision numbers.
pub(crate) fn doubles(values: &[f64]) -> Float64Array {
    let (at, count) = (values.as_ptr() as usize as u32, values.len() as u32);
    Float64Array::new_with_byte_offset_and_length(&buffer(), at, count)
}
