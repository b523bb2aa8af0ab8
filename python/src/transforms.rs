//! Single-precision transforms of meshes: 4 x 4 matrices of float32, row-major. Quaternions in the component order of
//! their argument names.

use kinopt::glam::{Affine3A, Mat3A, Quat, Vec3A, Vec4};
use numpy::ndarray::{Ix2, IxDyn};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{self, Numbers, shape_text};
use crate::error::invalid;

/// Largest deviation of the last row from 0 0 0 1.
const LAST_ROW_TOLERANCE: f32 = 1e-6;

/// Sixteen numbers, row-major.
pub(crate) fn to_numbers(transform: &Affine3A) -> [f32; 16] {
    let Mat3A {
        x_axis: x,
        y_axis: y,
        z_axis: z,
    } = transform.matrix3;
    let t = transform.translation;
    [
        x.x, y.x, z.x, t.x, //
        x.y, y.y, z.y, t.y, //
        x.z, y.z, z.z, t.z, //
        0.0, 0.0, 0.0, 1.0,
    ]
}

/// Writes transforms one after another.
pub(crate) fn write(transforms: &[Affine3A], buffer: &mut [f32]) {
    for (transform, buffer) in transforms.iter().zip(buffer.chunks_exact_mut(16)) {
        buffer.copy_from_slice(&to_numbers(transform));
    }
}

/// A new array of shape (N, 4, 4).
pub(crate) fn to_array<'py>(
    py: Python<'py>,
    transforms: &[Affine3A],
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    let numbers: Vec<f32> = transforms.iter().flat_map(to_numbers).collect();
    shaped(py, numbers, &[transforms.len(), 4, 4])
}

/// A new 4 x 4 array.
pub(crate) fn one_to_array<'py>(
    py: Python<'py>,
    transform: &Affine3A,
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    shaped(py, to_numbers(transform).to_vec(), &[4, 4])
}

/// New array of these numbers.
pub(crate) fn shaped<'py, T: numpy::Element>(
    py: Python<'py>,
    numbers: Vec<T>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    PyArray1::from_vec(py, numbers).reshape(shape)
}

/// Reads transforms of shape (..., 4, 4), with the leading axes of the shape.
pub(crate) fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<(Vec<Affine3A>, Vec<usize>)> {
    let numbers: Numbers<'_, IxDyn, f32> = arrays::numbers(value, what, "(..., 4, 4)")?;
    let shape = match numbers.shape() {
        [before @ .., 4, 4] => before.to_vec(),
        shape => {
            return Err(invalid(format!(
                "{what} has shape {}, expected (..., 4, 4)",
                shape_text(shape)
            )));
        }
    };
    let transforms = numbers.chunks_exact(16).enumerate().map(|(i, m)| {
        let last = [m[12], m[13], m[14], m[15] - 1.0];
        // Negated test: NaN fails it.
        if !last.iter().all(|value| value.abs() <= LAST_ROW_TOLERANCE) {
            return Err(invalid(format!(
                "{what} {i}: the last row of the matrix is {:?}, not [0, 0, 0, 1]",
                &m[12..]
            )));
        }
        let column = |j: usize| Vec3A::new(m[j], m[4 + j], m[8 + j]);
        Ok(Affine3A {
            matrix3: Mat3A::from_cols(column(0), column(1), column(2)),
            translation: column(3),
        })
    });
    Ok((transforms.collect::<PyResult<_>>()?, shape))
}

/// Reads one 4 x 4 transform.
pub(crate) fn read_one(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Affine3A> {
    let (transforms, shape) = read(value, what)?;
    match (transforms.as_slice(), shape.as_slice()) {
        ([one], []) => Ok(*one),
        _ => Err(invalid(format!("{what} must have shape (4, 4)"))),
    }
}

/// Reads one transform for each bone, shape (bones, 4, 4).
pub(crate) fn read_list(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<Affine3A>> {
    let (transforms, shape) = read(value, what)?;
    match shape.as_slice() {
        [_] => Ok(transforms),
        _ => Err(invalid(format!("{what} must have shape (N, 4, 4)"))),
    }
}

/// Component order of a quaternion.
#[derive(Clone, Copy)]
pub(crate) enum Order {
    Xyzw,
    Wxyz,
}

impl Order {
    pub(crate) fn to_array(self, q: Quat) -> [f32; 4] {
        match self {
            Self::Xyzw => [q.x, q.y, q.z, q.w],
            Self::Wxyz => [q.w, q.x, q.y, q.z],
        }
    }

    pub(crate) fn of_slice(self, numbers: &[f32]) -> Vec4 {
        match (self, numbers) {
            (Self::Xyzw, &[x, y, z, w]) | (Self::Wxyz, &[w, x, y, z]) => Vec4::new(x, y, z, w),
            _ => Vec4::ZERO,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Xyzw => "xyzw",
            Self::Wxyz => "wxyz",
        }
    }
}

/// Returns the given one of two arguments, with its order.
pub(crate) fn quaternion_argument<'a, 'py>(
    xyzw: Option<&'a Bound<'py, PyAny>>,
    wxyz: Option<&'a Bound<'py, PyAny>>,
    what: &str,
) -> PyResult<Option<(&'a Bound<'py, PyAny>, Order)>> {
    match (xyzw, wxyz) {
        (Some(value), None) => Ok(Some((value, Order::Xyzw))),
        (None, Some(value)) => Ok(Some((value, Order::Wxyz))),
        (None, None) => Ok(None),
        (Some(_), Some(_)) => Err(invalid(format!("{what} are given as xyzw and as wxyz"))),
    }
}

/// Reads quaternions, shape (N, 4).
pub(crate) fn quaternions(value: &Bound<'_, PyAny>, order: Order) -> PyResult<Vec<Quat>> {
    let rows = four_columns(value, order)?;
    let rows = rows.chunks_exact(4);
    Ok(rows
        .map(|row| Quat::from_vec4(order.of_slice(row)))
        .collect())
}

/// Reads the derivatives of quaternion components, shape (N, 2, 4).
pub(crate) fn quaternion_rates(value: &Bound<'_, PyAny>, order: Order) -> PyResult<Vec<[Vec4; 2]>> {
    let numbers: Numbers<'_, IxDyn, f32> = arrays::numbers(value, "tangents", "(N, 2, 4)")?;
    match numbers.shape() {
        [_, 2, 4] => {}
        shape => {
            return Err(invalid(format!(
                "tangents has shape {}, expected (N, 2, 4)",
                shape_text(shape)
            )));
        }
    }
    let pairs = numbers.chunks_exact(8);
    Ok(pairs
        .map(|pair| [order.of_slice(&pair[..4]), order.of_slice(&pair[4..])])
        .collect())
}

/// Reads one quaternion, shape (4,).
pub(crate) fn quaternion(value: &Bound<'_, PyAny>, order: Order) -> PyResult<Quat> {
    let numbers = numbers(value, order.name(), Some(4))?;
    Ok(Quat::from_vec4(order.of_slice(&numbers)))
}

/// Reads a quaternion whose numbers are finite, shape (4,).
pub(crate) fn finite_quaternion(value: &Bound<'_, PyAny>, order: Order) -> PyResult<Quat> {
    let quaternion = quaternion(value, order)?;
    match quaternion.is_finite() {
        true => Ok(quaternion),
        false => Err(invalid(format!("{} is not finite", order.name()))),
    }
}

fn four_columns<'py>(value: &Bound<'py, PyAny>, order: Order) -> PyResult<Numbers<'py, Ix2, f32>> {
    let rows: Numbers<'py, Ix2, f32> = arrays::numbers(value, order.name(), "(N, 4)")?;
    match rows.shape()[1] {
        4 => Ok(rows),
        _ => Err(invalid(format!(
            "{} has shape {}, expected (N, 4)",
            order.name(),
            shape_text(rows.shape())
        ))),
    }
}

/// Reads a list of numbers of single precision, of a fixed length or any.
pub(crate) fn numbers(
    value: &Bound<'_, PyAny>,
    what: &str,
    length: Option<usize>,
) -> PyResult<Vec<f32>> {
    let numbers: Numbers<'_, numpy::ndarray::Ix1, f32> =
        arrays::numbers(value, what, "one list of numbers")?;
    match length {
        Some(length) if length != numbers.len() => Err(invalid(format!(
            "{what} has shape ({},), expected ({length},)",
            numbers.len()
        ))),
        _ => Ok(numbers.to_vec()),
    }
}

/// Reads a point or direction, shape (3,).
pub(crate) fn vector(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec3A> {
    Ok(Vec3A::from_slice(&numbers(value, what, Some(3))?))
}

/// Reads a point or direction whose numbers are finite, shape (3,).
pub(crate) fn finite_vector(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec3A> {
    let vector = vector(value, what)?;
    for part in vector.to_array() {
        arrays::finite(part.into(), what)?;
    }
    Ok(vector)
}

/// Reads points or directions, shape (N, 3).
pub(crate) fn vectors(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<Vec3A>> {
    let vectors = crate::vertices::vectors(value, what)?;
    Ok(vectors.iter().map(|&v| v.into()).collect())
}

/// Components of vectors, one after another.
pub(crate) fn flat(vectors: &[Vec3A]) -> impl Iterator<Item = f32> + '_ {
    vectors.iter().flat_map(|v| v.to_array())
}
