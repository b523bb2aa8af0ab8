//! Placements in all forms that Python accepts, and as 4 x 4 arrays.

use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::PoseBounds;
use kinopt_bindings::placement::{PoseTarget, bad_last_row, of_quaternion, of_rows, to_rows};
use numpy::{PyArray2, PyArray3, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{self, shape_text};
use crate::error::invalid;

/// Placements between two checks for signals.
const ROWS_AT_A_TIME: usize = 4096;

/// Placements of targets, borrowed as numbers.
pub(crate) struct Placements<'py> {
    numbers: arrays::Numbers<'py, numpy::ndarray::Ix3>,
    /// False if a placement is a position without orientation.
    pub(crate) oriented: bool,
}

impl Placements<'_> {
    pub(crate) fn len(&self) -> usize {
        self.numbers.shape()[0]
    }

    /// All numbers, sixteen for each placement, row-major.
    pub(crate) fn numbers(&self) -> &[f64] {
        &self.numbers
    }

    /// Returns the array object, to store it.
    pub(crate) fn keep(&self) -> Py<PyAny> {
        self.numbers.keep()
    }

    /// All placements, checked.
    pub(crate) fn to_vec(&self, what: &str) -> PyResult<Vec<Placement<f64>>> {
        let mut placements = Vec::with_capacity(self.len());
        read_all(self.numbers(), what, 0, &mut placements)?;
        Ok(placements)
    }
}

/// Reads placements of sixteen numbers each; `first` is the index of the first in messages.
pub(crate) fn read_all(
    numbers: &[f64],
    what: &str,
    first: usize,
    placements: &mut Vec<Placement<f64>>,
) -> PyResult<()> {
    for (i, numbers) in numbers.chunks_exact(16).enumerate() {
        let Ok(numbers) = numbers.try_into() else {
            continue;
        };
        let placement = of_rows(numbers);
        let placement = placement.map_err(|last_row| {
            invalid(bad_last_row(&format!("{what} {}", first + i), last_row))
        })?;
        placements.push(placement);
    }
    Ok(())
}

/// Converts the sixteen numbers of a matrix to a placement.
fn of_matrix(numbers: &[f64], what: &str) -> PyResult<Placement<f64>> {
    let numbers = numbers
        .try_into()
        .map_err(|_| invalid(format!("{what} is no matrix of 4 x 4")))?;
    of_rows(numbers).map_err(|last_row| invalid(bad_last_row(what, last_row)))
}

/// Forms of a placement, in messages.
const FORMS: &str = "a matrix (4, 4), a position (3,), (7,) as x, y, z, qw, qx, qy, qz, or a tuple (position, \
    rotation) with a quaternion w, x, y, z, with roll, pitch and yaw, or with a matrix (3, 3)";

/// Reads one placement, in metres and radians. A position alone is a translation.
///
/// - A matrix of shape (4, 4), or an object that has `homogeneous` (pinocchio's SE3), `as_matrix()` or `A`
///   (spatialmath).
/// - A position of shape (3,).
/// - A position and a quaternion of shape (7,): x, y, z, qw, qx, qy, qz.
/// - A tuple of a position and a rotation: a quaternion w, x, y, z; roll, pitch and yaw about fixed axes, as in URDF; a
///   matrix of shape (3, 3), or an object that has one (scipy's Rotation).
pub(crate) fn placement(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Placement<f64>> {
    Ok(pose_target(value, what)?.placement)
}

/// Reads one placement as a target under goal bounds, which must leave the orientation free for a position alone.
pub(crate) fn target(
    value: &Bound<'_, PyAny>,
    what: &str,
    bounds: &PoseBounds,
) -> PyResult<Placement<f64>> {
    let target = pose_target(value, what)?;
    target.within(bounds, what).map_err(invalid)
}

/// Reads one placement, or a position without orientation.
pub(crate) fn pose_target(value: &Bound<'_, PyAny>, what: &str) -> PyResult<PoseTarget> {
    if let Ok(array) = value.cast::<PyArray2<f64>>() {
        if array.shape() == [4, 4] && array.is_c_contiguous() {
            // A copy is faster than registering a borrow.
            if let Ok(numbers) = array.to_vec() {
                return Ok(oriented(of_matrix(&numbers, what)?));
            }
        }
    }
    if let Some((position, rotation)) = pair_of(value) {
        let position = arrays::array(&position, &format!("the position of {what}"))?;
        let rotation = any_rotation(&rotation, what)?;
        return Ok(oriented(Placement::new(rotation, position.into())));
    }
    let numbers = any_array(&matrix_of(value)?, what)?;
    match (numbers.shape(), &*numbers) {
        ([4, 4], numbers) => Ok(oriented(of_matrix(numbers, what)?)),
        ([3 | 7], numbers) => {
            let fault = |problem| invalid(format!("{what}: {problem}"));
            PoseTarget::of_numbers(numbers).map_err(fault)
        }
        (shape, _) => Err(wrong_shape(what, shape)),
    }
}

fn oriented(placement: Placement<f64>) -> PoseTarget {
    PoseTarget {
        placement,
        has_orientation: true,
    }
}

fn any_array<'py>(
    value: &Bound<'py, PyAny>,
    what: &str,
) -> PyResult<arrays::Numbers<'py, numpy::ndarray::IxDyn>> {
    // The conversion makes a list of a scalar, so the axes are counted first.
    match arrays::axes(value) {
        Ok(0) => Err(wrong_shape(what, &[])),
        _ => arrays::numbers(value, what, FORMS),
    }
}

fn wrong_shape(what: &str, shape: &[usize]) -> PyErr {
    let shape = shape_text(shape);
    invalid(format!("{what} has shape {shape}, expected {FORMS}"))
}

/// Reads the rotation of a tuple (position, rotation).
fn any_rotation(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Matrix3<f64>> {
    let numbers = any_array(&matrix_of(value)?, &format!("the rotation of {what}"))?;
    match (numbers.shape(), &*numbers) {
        ([4], &[w, x, y, z]) => {
            let fault = |problem| invalid(format!("{what}: {problem}"));
            of_quaternion([w, x, y, z]).map_err(fault)
        }
        ([3], &[roll, pitch, yaw]) => Ok(Matrix3::from_roll_pitch_yaw([roll, pitch, yaw])),
        ([3, 3], numbers) => {
            let column = |k: usize| Vector3::new(numbers[k], numbers[3 + k], numbers[6 + k]);
            Ok(Matrix3::from_columns(column(0), column(1), column(2)))
        }
        (shape, _) => Err(invalid(format!(
            "the rotation of {what} has shape {}, expected a quaternion w, x, y, z, roll, pitch and yaw (3,), or a matrix (3, 3)",
            shape_text(shape)
        ))),
    }
}

/// Reads a rotation matrix: a 3 x 3 array, the rotation of a placement, or an object that has `as_matrix()` (scipy's
/// Rotation) or `A` (spatialmath).
pub(crate) fn rotation(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Matrix3<f64>> {
    let matrix = matrix_of(value)?;
    let rows: usize = matrix.len().unwrap_or(0);
    if rows == 4 {
        return Ok(placement(&matrix, what)?.rotation);
    }
    let [a, b, c] = arrays::table::<3, 3>(&matrix, what)?;
    let column = |k: usize| Vector3::new(a[k], b[k], c[k]);
    Ok(Matrix3::from_columns(column(0), column(1), column(2)))
}

/// Reads several placements, in metres and radians: an array of shape (N, 4, 4), (N, 7) or (N, 3), a tuple of N
/// positions and N rotations, as arrays, or a list of values that [`placement`] reads.
pub(crate) fn placements<'py>(value: &Bound<'py, PyAny>, what: &str) -> PyResult<Placements<'py>> {
    let stacked = stack_of(value)?;
    if let Some([_, 4, 4]) = shape_of(&stacked)?.as_deref() {
        return Ok(Placements {
            numbers: arrays::matrices(&stacked, what, [4, 4])?,
            oriented: true,
        });
    }
    let targets = pose_targets(&stacked, what)?;
    let rows = targets.iter().map(|target| to_rows(&target.placement));
    let numbers: Vec<f64> = rows.flatten().collect();
    let array = arrays::list(value.py(), &numbers).reshape([targets.len(), 4, 4])?;
    Ok(Placements {
        numbers: arrays::matrices(array.as_any(), what, [4, 4])?,
        oriented: targets.iter().all(|target| target.has_orientation),
    })
}

/// Reads placements as [`placements`], and positions without orientation.
pub(crate) fn pose_targets(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<PoseTarget>> {
    let py = value.py();
    let stacked = stack_of(value)?;
    let fault = |shape: &[usize]| {
        invalid(format!(
            "{what} has shape {}, expected (N, 4, 4), (N, 7), (N, 3) or a list of placements: each {FORMS}",
            shape_text(shape)
        ))
    };
    if let Some(shape) = shape_of(&stacked)? {
        if !matches!(*shape, [_, 4, 4] | [_, 3 | 7]) {
            return Err(fault(&shape));
        }
    }
    if let Some((positions, rotations)) = stacks(&stacked)? {
        let (count, rotation_count) = (positions.len()?, rotations.len()?);
        if count != rotation_count {
            return Err(invalid(format!(
                "{what} has {count} positions, but {rotation_count} rotations"
            )));
        }
        let pairs = positions.try_iter()?.zip(rotations.try_iter()?).enumerate();
        let pair = |(i, (position, rotation)): (usize, (PyResult<_>, PyResult<_>))| {
            let pair = PyTuple::new(py, [position?, rotation?])?;
            pose_target(&pair, &format!("{what} {i}"))
        };
        return pairs.map(pair).collect();
    }
    let items = stacked.try_iter().map_err(|_| fault(&[]))?.enumerate();
    let item = |(i, item): (usize, PyResult<Bound<'_, PyAny>>)| {
        let item = item?;
        match item.extract::<f64>() {
            Ok(_) => Err(fault(&[stacked.len()?])),
            Err(_) => pose_target(&item, &format!("{what} {i}")),
        }
    };
    items.map(item).collect()
}

/// Reads one placement, as [`pose_target`], or several, as [`pose_targets`].
pub(crate) fn one_or_more(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<PoseTarget>> {
    let numpy_shape =
        arrays::numpy(value.py())?.call_method1(intern!(value.py(), "shape"), (value,));
    let shape = numpy_shape.and_then(|shape| shape.extract::<Vec<usize>>());
    let is_pair = pair_of(value).is_some() && stacks(value)?.is_none();
    let is_one = match shape.as_deref() {
        Ok([4, 4] | []) => true,
        // A list of objects has one axis too.
        Ok([_]) => value
            .get_item(0)
            .is_ok_and(|first| first.extract::<f64>().is_ok()),
        Ok([2, 3]) | Err(_) => is_pair && value.get_item(0)?.extract::<[f64; 3]>().is_ok(),
        Ok(_) => false,
    };
    match is_one {
        true => Ok(vec![pose_target(value, what)?]),
        false => pose_targets(value, what),
    }
}

/// Returns the matrices of an array-like object, and any other value as it is.
fn stack_of<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    match value.hasattr(intern!(value.py(), "shape"))? {
        true => matrix_of(value),
        false => Ok(value.clone()),
    }
}

/// Shape of an array; `None` for other values.
fn shape_of(value: &Bound<'_, PyAny>) -> PyResult<Option<Vec<usize>>> {
    let shape = value.getattr_opt(intern!(value.py(), "shape"))?;
    shape.map(|shape| shape.extract()).transpose()
}

/// Reads several placements as targets under goal bounds, which must leave the orientation free for positions alone.
pub(crate) fn targets<'py>(
    value: &Bound<'py, PyAny>,
    what: &str,
    bounds: &PoseBounds,
) -> PyResult<Placements<'py>> {
    let placements = placements(value, what)?;
    if let (false, Some(first)) = (placements.oriented, placements.numbers().first_chunk()) {
        let target = PoseTarget {
            placement: of_rows(first).unwrap_or(Placement::identity()),
            has_orientation: false,
        };
        target.within(bounds, what).map_err(invalid)?;
    }
    Ok(placements)
}

/// Items of a tuple of two.
type Pair<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// The items of a tuple of two; `None` for any other value.
fn pair_of<'py>(value: &Bound<'py, PyAny>) -> Option<Pair<'py>> {
    value.cast::<PyTuple>().ok()?.extract().ok()
}

/// Positions and rotations of a tuple of two stacks; `None` for a tuple of two placements and any other value.
fn stacks<'py>(value: &Bound<'py, PyAny>) -> PyResult<Option<Pair<'py>>> {
    let Some((positions, rotations)) = pair_of(value) else {
        return Ok(None);
    };
    if positions.is_instance_of::<PyTuple>() {
        return Ok(None);
    }
    let py = value.py();
    let shape = arrays::numpy(py)?.call_method1(intern!(py, "shape"), (&positions,));
    let shape = shape.and_then(|shape| shape.extract::<Vec<usize>>());
    Ok(match shape.as_deref() {
        Ok([_, 3]) => {
            // Rotation objects of other libraries hold a stack of matrices.
            Some((positions, matrix_of(&rotations)?))
        }
        _ => None,
    })
}

/// Returns the matrix of an object of another library, or the object itself.
fn matrix_of<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = value.py();
    if let Some(matrix) = value.getattr_opt(intern!(py, "homogeneous"))? {
        return Ok(matrix);
    }
    if let Some(method) = value.getattr_opt(intern!(py, "as_matrix"))? {
        return method.call0();
    }
    if let Some(matrix) = value.getattr_opt(intern!(py, "A"))? {
        return Ok(matrix);
    }
    Ok(value.clone())
}

/// Placement of a field, which Python reads as a new 4 x 4 array.
#[derive(Clone)]
pub(crate) struct Matrix(pub(crate) Placement<f64>);

impl<'py> IntoPyObject<'py> for &Matrix {
    type Target = PyArray2<f64>;
    type Output = Bound<'py, PyArray2<f64>>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        to_array(py, &self.0)
    }
}

/// A new 4 x 4 array.
pub(crate) fn to_array<'py>(
    py: Python<'py>,
    placement: &Placement<f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    arrays::list(py, &to_rows(placement)).reshape([4, 4])
}

/// A new array of shape (N, 4, 4).
pub(crate) fn to_arrays<'py>(
    py: Python<'py>,
    placements: &[Placement<f64>],
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let numbers: Vec<f64> = placements.iter().flat_map(to_rows).collect();
    arrays::list(py, &numbers).reshape([placements.len(), 4, 4])
}

/// Interpolates from the placement `a` (`t` 0) to `b` (`t` 1): positions on a straight line, rotations about one axis by
/// the smaller angle. Shape (4, 4) for a number `t`, (T, 4, 4) for (T,).
///
/// Raises `InvalidValueError` for placements that are not rigid, and for a `t` that is not finite.
#[pyfunction]
pub(crate) fn interpolate<'py>(
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    t: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let rigid = |value: &Bound<'_, PyAny>, what: &str| {
        let placement = placement(value, what)?;
        let checked = placement.check_rigid(1e-6);
        checked.map_err(|defect| invalid(format!("{what}: {defect}")))?;
        PyResult::Ok(placement)
    };
    let (from, to) = (rigid(a, "a")?, rigid(b, "b")?);
    let times = arrays::Queries::numbers(t, "t")?;
    times.compute((a.py(), None), &[4, 4], ROWS_AT_A_TIME, |t, numbers| {
        let [t] = t else { return Ok(()) };
        let between = from.interpolated(&to, arrays::finite(*t, "t")?);
        numbers.copy_from_slice(&to_rows(&between.made_rigid()));
        Ok(())
    })
}
