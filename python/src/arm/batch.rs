//! Batches of targets.

use kinopt::Arm;
use kinopt::arm::{PoseOutcome, QueryError};
use kinopt::spatial::Placement;
use numpy::ndarray::{Dimension, Ix1, Ix2};
use numpy::{PyArray, PyArray1, PyArray2, PyArrayMethods, PyReadwriteArray};
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyType};

use crate::arrays::{self, Picked, RowBlock, Vector, axes};
use crate::coordinates::Coordinates;
use crate::error::{OrRaise, invalid};
use crate::in_python;
use crate::items::{self, Items};
use crate::pickling;
use crate::placement::{self, Placements, placement};
use crate::progress::Progress;
use crate::threads;

/// Targets of a thread between two checks for signals.
const TARGETS_AT_A_TIME: usize = 2048;

/// Solutions of a batch of targets, as arrays: item i of each belongs to target i.
///
/// `batch[i]` is the whole `Solution` of target i, computed again with exactly the same q (without a time limit). A
/// slice, a mask or a list of numbers selects a part of the batch: `batch[~batch.reached]` are the misses. The arrays
/// of targets and starts are not copied: changes to them change the result of `batch[i]`.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Batch {
    /// The arm, with the data that rebuild it.
    arm: Py<super::Arm>,
    /// Shape (N, 4, 4).
    targets: Py<PyAny>,
    /// Shape (N, dof), or (dof,) for a common start.
    starts: Py<PyAny>,
    count: usize,
    /// Shape (N, dof), radians or metres, each within its limits.
    #[pyo3(get)]
    q: Py<PyArray2<f64>>,
    /// Shape (N,), bool: true for each target that is reached within the tolerances.
    #[pyo3(get)]
    reached: Py<PyArray1<bool>>,
    /// Shape (N,), metres: distance of the tool from its target at q.
    #[pyo3(get)]
    position_error: Py<PyArray1<f64>>,
    /// Shape (N,), radians: the angle between the tool and its target at q.
    #[pyo3(get)]
    orientation_error: Py<PyArray1<f64>>,
    /// Shape (N,), uint32: iterations of all attempts together.
    #[pyo3(get)]
    iterations: Py<PyArray1<u32>>,
    /// Shape (N,), uint32: number of attempts.
    #[pyo3(get)]
    attempts: Py<PyArray1<u32>>,
}

/// Data that rebuild a batch, next to its arm: targets, starts, and its arrays in the order of its fields.
type Parts = (
    Py<PyAny>,
    Py<PyAny>,
    Py<PyArray2<f64>>,
    Py<PyArray1<bool>>,
    [Py<PyArray1<f64>>; 2],
    [Py<PyArray1<u32>>; 2],
);

/// One start for each target, or a common one.
enum Starts<'py> {
    Each(RowBlock<'py>),
    Same(Vector<'py>),
}

impl<'py> Starts<'py> {
    fn new(starts: &Bound<'py, PyAny>, count: usize, dof: usize) -> PyResult<Self> {
        if axes(starts)? < 2 {
            return Ok(Self::Same(arrays::vector_of(starts, "starts", dof)?));
        }
        let rows = arrays::rows(starts, "starts", dof)?;
        match rows.shape()[0] == count {
            true => Ok(Self::Each(rows)),
            false => Err(invalid(format!(
                "starts has {} rows, targets has {count}",
                rows.shape()[0]
            ))),
        }
    }

    /// Returns the array object, to store it.
    fn keep(&self) -> Py<PyAny> {
        match self {
            Self::Each(rows) => rows.keep(),
            Self::Same(start) => start.keep(),
        }
    }

    /// Starts of a range of targets; a common start is repeated in `buffer`.
    fn of<'a>(&'a self, first: usize, count: usize, buffer: &'a mut Vec<f64>) -> &'a [f64] {
        match self {
            Self::Each(rows) => {
                let dof = rows.shape()[1];
                &rows[first * dof..(first + count) * dof]
            }
            Self::Same(start) => {
                let length = count * start.len();
                if buffer.len() < length {
                    *buffer = start.repeat(count);
                }
                &buffer[..length]
            }
        }
    }
}

/// Solves all targets.
pub(super) fn solve<'py>(
    owner: &Bound<'py, super::Arm>,
    targets: &Bound<'py, PyAny>,
    starts: &Bound<'py, PyAny>,
    threads: Option<usize>,
    out: Option<&Bound<'py, PyAny>>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Batch> {
    let arm = &owner.get().inner;
    let (py, dof) = (targets.py(), arm.joint_count());
    let targets = placement::targets(targets, "target", &arm.goal())?;
    let count = targets.len();
    let starts = Starts::new(starts, count, dof)?;
    let q = arrays::output_rows(py, out, count, dof)?;
    let batch = Batch {
        arm: owner.clone().unbind(),
        targets: targets.keep(),
        starts: starts.keep(),
        count,
        q: q.clone().unbind(),
        reached: arrays::zeros(py, Ix1(count))?.unbind(),
        position_error: arrays::zeros(py, Ix1(count))?.unbind(),
        orientation_error: arrays::zeros(py, Ix1(count))?.unbind(),
        iterations: arrays::zeros(py, Ix1(count))?.unbind(),
        attempts: arrays::zeros(py, Ix1(count))?.unbind(),
    };
    let busy = |_| invalid("out is in use by another call");
    let mut q = q.try_readwrite().map_err(busy)?;
    let progress = Progress::new(py, progress, count)?;
    solve_all(
        py, arm, &targets, &starts, threads, &mut q, &batch, &progress,
    )?;
    Ok(batch)
}

fn fill<T: numpy::Element + Copy>(
    column: &Bound<'_, PyArray1<T>>,
    first: usize,
    outcomes: &[PoseOutcome],
    value: impl Fn(&PoseOutcome) -> T,
) {
    let Ok(mut column) = column.try_readwrite() else {
        return;
    };
    if let Ok(column) = column.as_slice_mut() {
        for (entry, outcome) in column[first..].iter_mut().zip(outcomes) {
            *entry = value(outcome);
        }
    }
}

#[allow(clippy::too_many_arguments, reason = "one loop over all of them")]
fn solve_all(
    py: Python<'_>,
    arm: &Arm,
    targets: &Placements<'_>,
    starts: &Starts<'_>,
    threads: Option<usize>,
    q: &mut PyReadwriteArray<'_, f64, Ix2>,
    batch: &Batch,
    progress: &Progress,
) -> PyResult<()> {
    let dof = arm.joint_count();
    let pool = threads::pool(threads, batch.count)?;
    let piece = TARGETS_AT_A_TIME * pool.as_ref().map_or(1, |pool| pool.current_num_threads());
    let q = q
        .as_slice_mut()
        .map_err(|error| invalid(error.to_string()))?;
    let mut placements: Vec<Placement<f64>> = Vec::new();
    let mut outcomes = Vec::new();
    let mut start_buffer = Vec::new();
    let pieces = targets
        .numbers()
        .chunks(16 * piece)
        .zip(q.chunks_mut(dof * piece));
    for (number, (numbers, q)) in pieces.enumerate() {
        py.check_signals()?;
        let first = number * piece;
        placements.clear();
        placement::read_all(numbers, "target", first, &mut placements)?;
        outcomes.clear();
        outcomes.resize(placements.len(), PoseOutcome::default());
        let starts = starts.of(first, placements.len(), &mut start_buffer);
        let result = py.detach(|| match &pool {
            Some(pool) => pool
                .install(|| arm.solve_batch_into_parallel(&placements, starts, q, &mut outcomes)),
            None => arm.solve_batch_into(&placements, starts, q, &mut outcomes),
        });
        result
            .map_err(|error| counted_from(first, error))
            .or_raise()?;
        batch.write(py, first, &outcomes);
        progress.done(first + placements.len())?;
    }
    Ok(())
}

/// Changes the index of an error from that in a piece to that in the batch.
fn counted_from(first: usize, error: QueryError) -> QueryError {
    match error {
        QueryError::StartNotFinite {
            query,
            joint,
            value,
        } => QueryError::StartNotFinite {
            query: query.map(|query| first + query),
            joint,
            value,
        },
        QueryError::Target { query, problem } => QueryError::Target {
            query: query.map(|query| first + query),
            problem,
        },
        other => other,
    }
}

impl Batch {
    fn write(&self, py: Python<'_>, first: usize, outcomes: &[PoseOutcome]) {
        let errors = [
            self.position_error.bind(py),
            self.orientation_error.bind(py),
        ];
        let counts = [self.iterations.bind(py), self.attempts.bind(py)];
        fill(self.reached.bind(py), first, outcomes, |o| o.reached);
        fill(errors[0], first, outcomes, |o| o.position_error);
        fill(errors[1], first, outcomes, |o| o.orientation_error);
        fill(counts[0], first, outcomes, |o| o.iterations);
        fill(counts[1], first, outcomes, |o| o.attempts);
    }

    fn solution(&self, py: Python<'_>, i: usize) -> PyResult<kinopt::Solution> {
        let target = self.targets.bind(py).get_item(i)?;
        let target = placement(&target, &format!("target {i}"))?;
        let starts = self.starts.bind(py);
        let start = if axes(starts)? < 2 {
            starts.clone()
        } else {
            starts.get_item(i)?
        };
        let start = arrays::vector(&start, "start")?;
        let start: &[f64] = &start;
        let arm = &self.arm.get().inner;
        py.detach(|| arm.solve(target, start)).or_raise()
    }

    /// Returns the batch of some of the targets.
    fn some(&self, py: Python<'_>, indices: &[usize]) -> PyResult<Self> {
        let count = indices.len();
        let indices = indices.iter().map(|&index| index as i64);
        let indices = &PyArray1::from_iter(py, indices);
        let starts = self.starts.bind(py);
        let starts = if axes(starts)? < 2 {
            starts.clone()
        } else {
            starts.get_item(indices)?
        };
        Ok(Self {
            arm: self.arm.clone_ref(py),
            targets: self.targets.bind(py).get_item(indices)?.unbind(),
            starts: starts.unbind(),
            count,
            q: take_rows(&self.q, indices)?,
            reached: take_rows(&self.reached, indices)?,
            position_error: take_rows(&self.position_error, indices)?,
            orientation_error: take_rows(&self.orientation_error, indices)?,
            iterations: take_rows(&self.iterations, indices)?,
            attempts: take_rows(&self.attempts, indices)?,
        })
    }
}

/// Selects rows of a column.
fn take_rows<T: numpy::Element, D: Dimension>(
    column: &Py<PyArray<T, D>>,
    indices: &Bound<'_, PyArray1<i64>>,
) -> PyResult<Py<PyArray<T, D>>> {
    let rows = column.bind(indices.py()).as_any().get_item(indices)?;
    Ok(rows.cast_into::<PyArray<T, D>>()?.unbind())
}

#[pymethods]
impl Batch {
    /// Text of `Solution.explain` for target `i`; without `i` a list for all.
    ///
    /// Raises `IndexError` for an index out of range.
    #[pyo3(signature = (i = None))]
    fn explain<'py>(&self, py: Python<'py>, i: Option<isize>) -> PyResult<Bound<'py, PyAny>> {
        let text = |i| Ok(self.solution(py, i)?.explain());
        items::explained(py, i, self.count, text)
    }

    /// Names, limits and units of the columns of `q`.
    #[getter]
    fn coordinates(&self, py: Python<'_>) -> Py<Coordinates> {
        self.arm.get().coordinates.clone_ref(py)
    }

    /// Table with one row for each target: a column for each joint, then `reached`, `position_error`,
    /// `orientation_error`, `iterations` and `attempts`. A pandas `DataFrame`.
    ///
    /// Raises `ImportError` without pandas, which the extra `tables` installs.
    fn to_frame<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python::call("to_frame", "kinopt.tables", slf, &[])
    }

    /// Table as of `to_frame`: a pyarrow `Table`.
    ///
    /// Raises `ImportError` without pyarrow, which the extra `tables` installs.
    fn to_arrow<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python::call("to_arrow", "kinopt.tables", slf, &[])
    }

    fn __iter__(slf: &Bound<'_, Self>) -> PyResult<Items> {
        Items::of(slf)
    }

    fn __len__(&self) -> usize {
        self.count
    }

    fn __getitem__<'py>(&self, index: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = index.py();
        match arrays::pick(index, self.count)? {
            Picked::One(i) => {
                let solution = self.arm.get().solution(py, self.solution(py, i)?);
                Ok(Bound::new(py, solution)?.into_any())
            }
            Picked::Some(indices) => Ok(Bound::new(py, self.some(py, &indices)?)?.into_any()),
        }
    }

    #[classmethod]
    fn _rebuild(class: &Bound<'_, PyType>, arm: Py<super::Arm>, parts: Parts) -> PyResult<Self> {
        let (targets, starts, q, reached, errors, counts) = parts;
        let [position_error, orientation_error] = errors;
        let [iterations, attempts] = counts;
        Ok(Self {
            arm,
            targets,
            starts,
            count: reached.bind(class.py()).len()?,
            q,
            reached,
            position_error,
            orientation_error,
            iterations,
            attempts,
        })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (
            self.targets.bind(py),
            self.starts.bind(py),
            self.q.bind(py),
            self.reached.bind(py),
            [
                self.position_error.bind(py),
                self.orientation_error.bind(py),
            ],
            [self.iterations.bind(py), self.attempts.bind(py)],
        );
        let arguments = (self.arm.bind(py), parts);
        pickling::by_rebuild::<Self>(py, arguments)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let reached: usize = self.reached.bind(py).call_method0("sum")?.extract()?;
        Ok(format!("Batch({reached} of {} reached)", self.count))
    }
}
