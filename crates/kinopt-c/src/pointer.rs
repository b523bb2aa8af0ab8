//! Pointers of the caller: checked for null, alignment and length, and converted to references.
//!
//! Every function requires that a pointer which is not null leads to as many values as its length says.

use std::ffi::{CStr, CString, c_char};

use kinopt::spatial::Placement;
use kinopt_bindings::placement::{bad_last_row, of_columns, to_columns};

use crate::error::Failure;

/// Number of numbers of a placement.
const PLACEMENT_LENGTH: usize = 16;

fn check<T>(pointer: *const T, name: &str) -> Result<(), Failure> {
    if pointer.is_null() {
        return Err(Failure::invalid(format!("`{name}` is null")));
    }
    if !pointer.is_aligned() {
        return Err(Failure::invalid(format!("`{name}` is not aligned")));
    }
    Ok(())
}

/// An object or a struct.
pub(crate) unsafe fn object<'a, T>(pointer: *const T, name: &str) -> Result<&'a T, Failure> {
    check(pointer, name)?;
    // SAFETY: not null, aligned, and valid by the contract of the module.
    Ok(unsafe { &*pointer })
}

/// An object that may be null.
pub(crate) unsafe fn optional_object<'a, T>(
    pointer: *const T,
    name: &str,
) -> Result<Option<&'a T>, Failure> {
    match pointer.is_null() {
        true => Ok(None),
        // SAFETY: as for `object`.
        false => unsafe { object(pointer, name) }.map(Some),
    }
}

/// An object or a struct to change.
pub(crate) unsafe fn object_mut<'a, T>(pointer: *mut T, name: &str) -> Result<&'a mut T, Failure> {
    check(pointer, name)?;
    // SAFETY: not null, aligned, and valid by the contract of the module; no other thread uses it.
    Ok(unsafe { &mut *pointer })
}

/// Writes a value to a place of the caller.
pub(crate) unsafe fn write<T>(place: *mut T, value: T, name: &str) -> Result<(), Failure> {
    check(place, name)?;
    // SAFETY: not null, aligned, and valid by the contract of the module. The old value is not read.
    unsafe { place.write(value) };
    Ok(())
}

/// Gives an object to the caller, who frees it.
pub(crate) unsafe fn give<T>(place: *mut *mut T, value: T, name: &str) -> Result<(), Failure> {
    check(place, name)?;
    // SAFETY: as for `write`.
    unsafe { write(place, Box::into_raw(Box::new(value)), name) }
}

/// Frees an object of [`give`]; null is ignored.
pub(crate) unsafe fn free<T>(pointer: *mut T) {
    if !pointer.is_null() {
        // SAFETY: the pointer is that of `give`, and the caller frees it once.
        drop(unsafe { Box::from_raw(pointer) });
    }
}

fn check_length<T>(pointer: *const T, length: usize, name: &str) -> Result<(), Failure> {
    check(pointer, name)?;
    match length <= isize::MAX as usize / size_of::<T>() {
        true => Ok(()),
        false => Err(Failure::invalid(format!(
            "the length {length} of `{name}` is not possible"
        ))),
    }
}

/// An array; null is allowed for length 0.
pub(crate) unsafe fn array<'a, T>(
    pointer: *const T,
    length: usize,
    name: &str,
) -> Result<&'a [T], Failure> {
    if length == 0 {
        return Ok(&[]);
    }
    check_length(pointer, length, name)?;
    // SAFETY: not null, aligned, of possible length, and valid by the contract of the module.
    Ok(unsafe { std::slice::from_raw_parts(pointer, length) })
}

/// Groups of `N` values, one after another; null is allowed for none.
pub(crate) unsafe fn groups<'a, T, const N: usize>(
    pointer: *const T,
    count: usize,
    name: &str,
) -> Result<&'a [[T; N]], Failure> {
    // SAFETY: as for `array`; an array is aligned as its elements.
    unsafe { array(pointer.cast(), count, name) }
}

/// An array, or null for none.
pub(crate) unsafe fn optional_array<'a, T>(
    pointer: *const T,
    length: usize,
    name: &str,
) -> Result<Option<&'a [T]>, Failure> {
    match pointer.is_null() {
        true => Ok(None),
        // SAFETY: as for `array`.
        false => unsafe { array(pointer, length, name) }.map(Some),
    }
}

/// An array to write; null is allowed for length 0.
pub(crate) unsafe fn array_mut<'a, T>(
    pointer: *mut T,
    length: usize,
    name: &str,
) -> Result<&'a mut [T], Failure> {
    if length == 0 {
        return Ok(&mut []);
    }
    check_length(pointer, length, name)?;
    // SAFETY: as for `array`; no other thread uses it.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, length) })
}

/// Copies numbers to an array of the caller of exactly this length.
pub(crate) unsafe fn copy(
    numbers: &[f64],
    pointer: *mut f64,
    length: usize,
    name: &str,
) -> Result<(), Failure> {
    if length != numbers.len() {
        let expected = numbers.len();
        let message = format!("`{name}` has {length} numbers, expected {expected}");
        return Err(Failure::invalid(message));
    }
    // SAFETY: as for `array_mut`.
    unsafe { array_mut(pointer, length, name) }?.copy_from_slice(numbers);
    Ok(())
}

/// A text that ends with a zero byte.
pub(crate) unsafe fn text<'a>(pointer: *const c_char, name: &str) -> Result<&'a str, Failure> {
    check(pointer, name)?;
    // SAFETY: not null, and ends with a zero byte by the contract of the module.
    let text = unsafe { CStr::from_ptr(pointer) };
    text.to_str()
        .map_err(|_| Failure::invalid(format!("`{name}` is not UTF-8")))
}

/// A text, or null for none.
pub(crate) unsafe fn optional_text<'a>(
    pointer: *const c_char,
    name: &str,
) -> Result<Option<&'a str>, Failure> {
    match pointer.is_null() {
        true => Ok(None),
        // SAFETY: as for `text`.
        false => unsafe { text(pointer, name) }.map(Some),
    }
}

/// Writes a text with its final zero byte to a buffer, shortened if the buffer is too small.
///
/// The whole length of the text, without the zero byte, is written to `length`, unless that is null.
pub(crate) unsafe fn write_text(
    text: &str,
    buffer: *mut c_char,
    size: usize,
    length: *mut usize,
) -> Result<(), Failure> {
    if !length.is_null() {
        // SAFETY: checked by `write`.
        unsafe { write(length, text.len(), "length") }?;
    }
    // SAFETY: as for `array_mut`.
    let buffer = unsafe { array_mut(buffer.cast::<u8>(), size, "buffer") }?;
    if let Some(most) = buffer.len().checked_sub(1) {
        // A character is not cut.
        let mut end = most.min(text.len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        buffer[..end].copy_from_slice(&text.as_bytes()[..end]);
        buffer[end] = 0;
    }
    Ok(())
}

/// A text for the caller that the library keeps.
pub(crate) fn kept_text(text: &str) -> CString {
    CString::new(text.replace('\0', "")).unwrap_or_default()
}

/// One of the texts that the library keeps; null for an index out of range.
pub(crate) fn text_at(texts: &[CString], index: usize) -> *const c_char {
    let text = texts.get(index);
    text.map_or(std::ptr::null(), |text| text.as_ptr())
}

/// Numbers that the library keeps, null for none; their count is written to `length`, unless that is null.
pub(crate) unsafe fn kept_numbers(numbers: &[f64], length: *mut usize) -> *const f64 {
    if !length.is_null() {
        // SAFETY: not null, and a place of the caller.
        unsafe { length.write_unaligned(numbers.len()) };
    }
    match numbers.is_empty() {
        true => std::ptr::null(),
        false => numbers.as_ptr(),
    }
}

/// A placement of sixteen numbers by columns.
pub(crate) unsafe fn placement(pointer: *const f64, name: &str) -> Result<Placement<f64>, Failure> {
    // SAFETY: as for `array`.
    let numbers = unsafe { array(pointer, PLACEMENT_LENGTH, name) }?;
    of_numbers(numbers, name)
}

/// A placement, the identity for null.
pub(crate) unsafe fn placement_or_identity(
    pointer: *const f64,
    name: &str,
) -> Result<Placement<f64>, Failure> {
    match pointer.is_null() {
        true => Ok(Placement::identity()),
        // SAFETY: as for `placement`.
        false => unsafe { placement(pointer, name) },
    }
}

/// Placements, one after another.
pub(crate) unsafe fn placements(
    pointer: *const f64,
    count: usize,
    name: &str,
) -> Result<Vec<Placement<f64>>, Failure> {
    let Some(length) = count.checked_mul(PLACEMENT_LENGTH) else {
        return Err(Failure::invalid(format!(
            "the length {count} of `{name}` is not possible"
        )));
    };
    // SAFETY: as for `array`.
    let numbers = unsafe { array(pointer, length, name) }?;
    let rows = numbers.chunks_exact(PLACEMENT_LENGTH).enumerate();
    rows.map(|(row, numbers)| of_numbers(numbers, &format!("{name}[{row}]")))
        .collect()
}

fn of_numbers(numbers: &[f64], name: &str) -> Result<Placement<f64>, Failure> {
    let mut columns = [0.0; PLACEMENT_LENGTH];
    columns.copy_from_slice(numbers);
    of_columns(&columns).map_err(|last_row| Failure::invalid(bad_last_row(name, last_row)))
}

/// Writes a placement.
pub(crate) unsafe fn write_placement(
    placement: &Placement<f64>,
    pointer: *mut f64,
    name: &str,
) -> Result<(), Failure> {
    // SAFETY: as for `copy`.
    unsafe { copy(&to_columns(placement), pointer, PLACEMENT_LENGTH, name) }
}
