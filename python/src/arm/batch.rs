//! Many targets at once.

use std::sync::Arc;

use kinopt::Arm;
use kinopt::arm::{PoseOutcome, QueryError};
use kinopt::spatial::Placement;
use numpy::ndarray::Ix2;
use numpy::{PyArray1, PyArrayMethods, PyReadwriteArray};
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyType};

use crate::arrays::{self, Rows, Vector, axes};
use crate::error::{OrRaise, invalid};
use crate::items::Items;
use crate::placement::{self, Placements, placement, placements};
use crate::progress::Progress;
use crate::solution::Solution;
use crate::threads;

/// Targets between two looks at signals, a thread.
const PIECE: usize = 2048;

/// The solutions of many targets, as arrays: item i of each belongs to target i.
///
/// `batch[i]` is the whole `Solution` of target i, found once more, which gives the same q bit for bit
/// (without a time limit) and says what `solve` says.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Batch {
    arm: Arc<Arm>,
    /// The same arm in Python, which knows how it is built again.
    owner: Py<PyAny>,
    targets: Py<PyAny>,
    starts: Py<PyAny>,
    count: usize,
    /// Shape (N, dof), radians or metres, each within its limits.
    #[pyo3(get)]
    q: Py<PyAny>,
    /// Shape (N,), bool: whether each target is reached within the tolerances.
    #[pyo3(get)]
    reached: Py<PyArray1<bool>>,
    /// Shape (N,), metres: how far the tool is from its target at q.
    #[pyo3(get)]
    position_error: Py<PyArray1<f64>>,
    /// Shape (N,), radians: the angle between the tool and its target at q.
    #[pyo3(get)]
    orientation_error: Py<PyArray1<f64>>,
    /// Shape (N,), uint32: iterations of all attempts together.
    #[pyo3(get)]
    iterations: Py<PyArray1<u32>>,
    /// Shape (N,), uint32: attempts begun.
    #[pyo3(get)]
    attempts: Py<PyArray1<u32>>,
}

/// One start a target, or one for all.
enum Starts<'py> {
    Each(Rows<'py>),
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

    /// The starts of some targets, in `memory` where they have to be written out.
    fn of<'a>(&'a self, first: usize, count: usize, memory: &'a mut Vec<f64>) -> &'a [f64] {
        match self {
            Self::Each(rows) => {
                let dof = rows.shape()[1];
                &rows[first * dof..(first + count) * dof]
            }
            Self::Same(start) => {
                let wanted = count * start.len();
                if memory.len() < wanted {
                    *memory = start.repeat(count);
                }
                &memory[..wanted]
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
    let given = targets;
    let targets = placements(given, "target")?;
    let count = targets.len();
    let given_starts = starts;
    let starts = Starts::new(given_starts, count, dof)?;
    let q = arrays::room(py, out, count, dof)?;
    let columns = Columns::new(py, count);
    {
        let busy = |_| invalid("out is in use by another call");
        let mut q = q.try_readwrite().map_err(busy)?;
        let progress = Progress::new(py, progress, count)?;
        solve_all(
            py, arm, &targets, &starts, threads, &mut q, &columns, &progress,
        )?;
    }
    Ok(Batch {
        arm: Arc::clone(arm),
        owner: owner.clone().into_any().unbind(),
        targets: given.clone().unbind(),
        starts: given_starts.clone().unbind(),
        count,
        q: q.into_any().unbind(),
        reached: columns.reached.unbind(),
        position_error: columns.position_error.unbind(),
        orientation_error: columns.orientation_error.unbind(),
        iterations: columns.iterations.unbind(),
        attempts: columns.attempts.unbind(),
    })
}

/// What is told of each target.
struct Columns<'py> {
    reached: Bound<'py, PyArray1<bool>>,
    position_error: Bound<'py, PyArray1<f64>>,
    orientation_error: Bound<'py, PyArray1<f64>>,
    iterations: Bound<'py, PyArray1<u32>>,
    attempts: Bound<'py, PyArray1<u32>>,
}

impl<'py> Columns<'py> {
    fn new(py: Python<'py>, count: usize) -> Self {
        Self {
            reached: PyArray1::zeros(py, count, false),
            position_error: PyArray1::zeros(py, count, false),
            orientation_error: PyArray1::zeros(py, count, false),
            iterations: PyArray1::zeros(py, count, false),
            attempts: PyArray1::zeros(py, count, false),
        }
    }

    fn write(&self, first: usize, outcomes: &[PoseOutcome]) {
        fill(&self.reached, first, outcomes, |o| o.reached);
        fill(&self.position_error, first, outcomes, |o| o.position_error);
        fill(&self.orientation_error, first, outcomes, |o| {
            o.orientation_error
        });
        fill(&self.iterations, first, outcomes, |o| o.iterations);
        fill(&self.attempts, first, outcomes, |o| o.attempts);
    }
}

fn fill<T: numpy::Element + Copy>(
    column: &Bound<'_, PyArray1<T>>,
    first: usize,
    outcomes: &[PoseOutcome],
    value: impl Fn(&PoseOutcome) -> T,
) {
    let mut column = column.readwrite();
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
    columns: &Columns<'_>,
    progress: &Progress,
) -> PyResult<()> {
    let dof = arm.joint_count();
    let pool = threads::pool(threads)?;
    let piece = PIECE
        * pool
            .as_ref()
            .map_or(1, rayon::ThreadPool::current_num_threads);
    let q = q
        .as_slice_mut()
        .map_err(|error| invalid(error.to_string()))?;
    let mut placements: Vec<Placement<f64>> = Vec::new();
    let mut outcomes = Vec::new();
    let mut memory = Vec::new();
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
        let starts = starts.of(first, placements.len(), &mut memory);
        let answered = py.detach(|| match &pool {
            Some(pool) => pool
                .install(|| arm.solve_batch_into_parallel(&placements, starts, q, &mut outcomes)),
            None => arm.solve_batch_into(&placements, starts, q, &mut outcomes),
        });
        answered
            .map_err(|error| counted_from(first, error))
            .or_raise()?;
        columns.write(first, &outcomes);
        progress.done(first + placements.len())?;
    }
    Ok(())
}

/// An error of a piece, with the number that its query has among all.
fn counted_from(first: usize, error: QueryError) -> QueryError {
    match error {
        QueryError::StartNotFinite {
            query,
            joint,
            value,
        } => QueryError::StartNotFinite {
            query: first + query,
            joint,
            value,
        },
        QueryError::Target { query, problem } => QueryError::Target {
            query: first + query,
            problem,
        },
        other => other,
    }
}

impl Batch {
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
        py.detach(|| self.arm.solve(target, start)).or_raise()
    }
}

#[pymethods]
impl Batch {
    /// What `Solution.explain` says of target `i`; without `i` a list for all.
    #[pyo3(signature = (i = None))]
    fn explain<'py>(&self, py: Python<'py>, i: Option<isize>) -> PyResult<Bound<'py, PyAny>> {
        if let Some(i) = i {
            let text = self.solution(py, self.place(i)?)?.explain();
            return Ok(text.into_pyobject(py)?.into_any());
        }
        let mut texts = Vec::with_capacity(self.count);
        for i in 0..self.count {
            if i.is_multiple_of(1024) {
                py.check_signals()?;
            }
            texts.push(self.solution(py, i)?.explain());
        }
        Ok(texts.into_pyobject(py)?.into_any())
    }

    fn __iter__(slf: &Bound<'_, Self>) -> PyResult<Items> {
        Items::of(slf)
    }

    fn __len__(&self) -> usize {
        self.count
    }

    fn __getitem__(&self, py: Python<'_>, i: isize) -> PyResult<Solution> {
        self.solution(py, self.place(i)?).map(Solution::from)
    }

    #[classmethod]
    #[allow(clippy::too_many_arguments, reason = "it is what `__reduce__` gives")]
    fn _rebuild(
        _class: &Bound<'_, PyType>,
        arm: &Bound<'_, super::Arm>,
        targets: Py<PyAny>,
        starts: Py<PyAny>,
        q: Py<PyAny>,
        reached: Py<PyArray1<bool>>,
        errors: (Py<PyArray1<f64>>, Py<PyArray1<f64>>),
        iterations: Py<PyArray1<u32>>,
        attempts: Py<PyArray1<u32>>,
    ) -> PyResult<Self> {
        Ok(Self {
            arm: Arc::clone(&arm.get().inner),
            owner: arm.clone().into_any().unbind(),
            targets,
            starts,
            count: reached.bind(arm.py()).len()?,
            q,
            reached,
            position_error: errors.0,
            orientation_error: errors.1,
            iterations,
            attempts,
        })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let arguments = (
            self.owner.bind(py),
            self.targets.bind(py),
            self.starts.bind(py),
            self.q.bind(py),
            self.reached.bind(py),
            (
                self.position_error.bind(py),
                self.orientation_error.bind(py),
            ),
            self.iterations.bind(py),
            self.attempts.bind(py),
        );
        let rebuild = py.get_type::<Self>().getattr("_rebuild")?;
        Ok((rebuild, arguments).into_pyobject(py)?.into_any())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let reached: usize = self.reached.bind(py).call_method0("sum")?.extract()?;
        Ok(format!("Batch({reached} of {} reached)", self.count))
    }
}

impl Batch {
    fn place(&self, i: isize) -> PyResult<usize> {
        arrays::place(i, self.count)
    }
}
