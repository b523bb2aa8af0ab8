//! Batches: one problem from several starts, with several targets.

use std::time::Duration;

use kinopt::Workspace;
use kinopt::ik::MoveLimits;
use kinopt_bindings::jobs::{self, Jobs};
use kinopt_bindings::method::SolverMethod;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyType;

use super::moves::move_limits;
use super::watch::Watch;
use crate::arrays::{self, Picked};
use crate::coordinates::Coordinates;
use crate::error::{OrRaise, invalid};
use crate::has_model::configuration_of_model;
use crate::in_python;
use crate::items::{self, Items};
use crate::object::Object;
use crate::pickling;
use crate::problem::{CompiledProblem, Move, Problem, raised};
use crate::progress::Progress;
use crate::solution::Solution;
use crate::threads;

/// Time between two checks for signals and progress reports of a batch on several threads.
const CHECK_INTERVAL: Duration = Duration::from_millis(20);

/// Solutions of a batch, in the order of its queries: arrays over all of them, and `solutions[i]`.
///
/// A slice, a mask or a list of numbers selects a part: `solutions[~solutions.reached]` are the misses.
#[pyclass(frozen, sequence, module = "kinopt")]
pub(crate) struct Solutions {
    inner: Vec<kinopt::Solution>,
    /// Names, limits and units of the columns of `q`.
    #[pyo3(get)]
    coordinates: Py<Coordinates>,
}

impl Solutions {
    pub(crate) fn new(inner: Vec<kinopt::Solution>, coordinates: Py<Coordinates>) -> Self {
        Self { inner, coordinates }
    }

    fn errors<'py>(
        &self,
        py: Python<'py>,
        error: impl Fn(&kinopt::Solution) -> Option<f64>,
    ) -> Option<Bound<'py, PyArray1<f64>>> {
        let errors: Option<Vec<f64>> = self.inner.iter().map(error).collect();
        errors.map(|errors| arrays::list(py, &errors))
    }
}

#[pymethods]
impl Solutions {
    /// Configurations, shape (N, nq), radians and metres, exactly within all limits.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.inner.iter();
        let numbers: Vec<f64> = rows.flat_map(|solution| &solution.q).copied().collect();
        arrays::list(py, &numbers).reshape([self.inner.len(), self.coordinates.get().names.len()])
    }

    /// True if every required task is within its tolerances, shape (N,).
    #[getter]
    fn reached<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_iter(py, self.inner.iter().map(|solution| solution.reached))
    }

    /// Largest position error of a required task, metres, shape (N,); None if no required task measures metres.
    #[getter]
    fn position_error<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.errors(py, kinopt::Solution::position_error)
    }

    /// Largest orientation error of a required task, radians, shape (N,); None if no required task measures radians.
    #[getter]
    fn orientation_error<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.errors(py, kinopt::Solution::orientation_error)
    }

    /// Half the sum of squared weighted residuals, shape (N,).
    #[getter]
    fn cost<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.inner.iter().map(|solution| solution.cost))
    }

    /// Iterations of all attempts, shape (N,).
    #[getter]
    fn iterations<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let iterations = self.inner.iter().map(|solution| solution.iterations as i64);
        PyArray1::from_iter(py, iterations)
    }

    /// Number of attempts, shape (N,).
    #[getter]
    fn attempts<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let attempts = self.inner.iter().map(|solution| solution.attempts as i64);
        PyArray1::from_iter(py, attempts)
    }

    /// Text of `Solution.explain` for query `i`; without `i` a list for all.
    ///
    /// Raises `IndexError` for an index out of range.
    #[pyo3(signature = (i = None))]
    fn explain<'py>(&self, py: Python<'py>, i: Option<isize>) -> PyResult<Bound<'py, PyAny>> {
        let text = |i: usize| Ok(self.inner[i].explain());
        items::explained(py, i, self.inner.len(), text)
    }

    /// Table with one row for each query: a column for each number of a configuration, then `reached`,
    /// `position_error`, `orientation_error` (where the tasks measure them), `cost`, `iterations` and `attempts`. A
    /// pandas `DataFrame`.
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
        self.inner.len()
    }

    fn __getitem__<'py>(&self, index: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = index.py();
        let indices = match arrays::pick(index, self.inner.len())? {
            Picked::One(i) => {
                let coordinates = self.coordinates.clone_ref(py);
                let solution = Solution::new(self.inner[i].clone(), coordinates);
                return Ok(Bound::new(py, solution)?.into_any());
            }
            Picked::Some(indices) => indices,
        };
        let picked = indices.into_iter().map(|i| self.inner[i].clone());
        let picked = Self::new(picked.collect(), self.coordinates.clone_ref(py));
        Ok(Bound::new(py, picked)?.into_any())
    }

    #[classmethod]
    fn _rebuild(
        _class: &Bound<'_, PyType>,
        solutions: &str,
        coordinates: Py<Coordinates>,
    ) -> PyResult<Self> {
        let inner = serde_json::from_str(solutions).or_raise()?;
        Ok(Self { inner, coordinates })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let json = serde_json::to_string(&self.inner).or_raise()?;
        pickling::by_rebuild::<Self>(py, (json, self.coordinates.clone_ref(py)))
    }

    fn __repr__(&self) -> String {
        let reached = self.inner.iter().filter(|solution| solution.reached);
        format!(
            "Solutions({} of {} reached)",
            reached.count(),
            self.inner.len()
        )
    }
}

/// Queries read from Python.
struct Queries {
    starts: Vec<f64>,
    /// True for one start for each query; false for a common start.
    many_starts: bool,
    dof: usize,
    moves: Vec<Vec<Move>>,
    /// Limits of joint displacement, relative to some start.
    limits: Option<MoveLimits>,
    count: usize,
}

/// Arguments of a batch: starts, targets by task, and limits of joint displacement.
type BatchArrays<'a, 'py> = (
    &'a Bound<'py, PyAny>,
    Option<&'a Bound<'py, PyAny>>,
    Option<&'a Bound<'py, PyAny>>,
);

impl Queries {
    fn read(
        (python_problem, problem): (&Problem, &CompiledProblem),
        (starts, targets, max_move): BatchArrays<'_, '_>,
    ) -> PyResult<Self> {
        let dof = problem.inner.configuration_len();
        let model = python_problem.model(starts.py());
        let starts = &configuration_of_model(model.bind(starts.py()), starts, "starts")?;
        let many_starts = arrays::axes(starts)? == 2;
        let (starts, mut count) = match many_starts {
            true => {
                let rows = arrays::rows(starts, "starts", dof)?;
                (rows.to_vec(), Some(("starts".to_owned(), rows.shape()[0])))
            }
            false => (arrays::vector_of(starts, "starts", dof)?.to_vec(), None),
        };
        let mut moves: Vec<Vec<Move>> = Vec::new();
        for (task, values) in problem.targets_by_task(targets)? {
            let name = problem.inner.task_name(task).unwrap_or_default();
            let length = values
                .len()
                .map_err(|_| invalid(format!("targets holds no list of targets for {name}")))?;
            match &count {
                Some((other, count)) if *count != length => {
                    return Err(invalid(format!(
                        "targets has {length} for {name}, but there are {count} {other}"
                    )));
                }
                _ => count = Some((format!("targets for {name}"), length)),
            }
            moves.resize_with(length, Vec::new);
            for (moves, value) in moves.iter_mut().zip(values.try_iter()?) {
                moves.push(problem.read(task, &Object::of(&value?))?);
            }
        }
        let count = count.map_or(1, |(_, count)| count);
        moves.resize_with(count, Vec::new);
        let mut queries = Self {
            starts,
            many_starts,
            dof,
            moves,
            limits: None,
            count,
        };
        if let Some(max_move) = max_move.filter(|_| count > 0) {
            let limits = move_limits((python_problem, problem), max_move, queries.start(0))?;
            queries.limits = Some(limits);
        }
        Ok(queries)
    }

    fn start(&self, index: usize) -> &[f64] {
        let first = if self.many_starts {
            index * self.dof
        } else {
            0
        };
        &self.starts[first..first + self.dof]
    }

    fn solve(
        &self,
        index: usize,
        (engine, problem): (&SolverMethod, &CompiledProblem),
        workspace: &mut Workspace,
        watch: &mut Watch<'_>,
    ) -> PyResult<kinopt::Solution> {
        let targets = problem.targets_with(&self.moves[index])?;
        let (mut instance, start) = (problem.instance(&targets)?, self.start(index));
        let mut limits = self.limits.clone();
        if let Some(limits) = &mut limits {
            limits.start_at(&problem.inner, start).or_raise()?;
            instance = instance.with_moves(limits).or_raise()?;
        }
        let solution = engine.solve::<Object>(instance, start, workspace, watch);
        raised().and(solution)
    }
}

pub(super) fn solve(
    engine: &SolverMethod,
    problem: &Bound<'_, Problem>,
    arguments: BatchArrays<'_, '_>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Solutions> {
    let py = problem.py();
    let python_problem = problem.get();
    let problem = &*python_problem.compiled()?;
    let queries = Queries::read((python_problem, problem), arguments)?;
    let threads = threads::count(threads, queries.count)?;
    let progress = Progress::new(py, progress, queries.count)?;
    let engine_and_problem = (engine, problem);
    let inner = py.detach(|| match threads {
        0 | 1 => one_by_one(&queries, engine_and_problem, &progress),
        threads => on_threads(&queries, engine_and_problem, threads, &progress),
    })?;
    Ok(Solutions::new(inner, problem.coordinates(py)?))
}

fn one_by_one(
    queries: &Queries,
    engine_and_problem: (&SolverMethod, &CompiledProblem),
    progress: &Progress,
) -> PyResult<Vec<kinopt::Solution>> {
    let total = queries.count;
    let mut solutions = Vec::with_capacity(total);
    let mut reported_at = std::time::Instant::now();
    engine_and_problem.1.workspaces.with(|workspace| {
        let mut watch = Watch::new(None);
        for index in 0..total {
            solutions.push(queries.solve(index, engine_and_problem, workspace, &mut watch)?);
            watch.look_at_signals();
            raised()?;
            if reported_at.elapsed() >= CHECK_INTERVAL {
                progress.done(index + 1)?;
                reported_at = std::time::Instant::now();
            }
        }
        progress.done(total)
    })?;
    Ok(solutions)
}

/// Distributes the queries over threads; the calling thread checks for signals.
fn on_threads(
    queries: &Queries,
    engine_and_problem: (&SolverMethod, &CompiledProblem),
    threads: usize,
    progress: &Progress,
) -> PyResult<Vec<kinopt::Solution>> {
    let (engine, problem) = engine_and_problem;
    let work = |jobs: &Jobs<kinopt::Solution, PyErr>| {
        problem.workspaces.with(|workspace| {
            let mut watch = Watch::until(jobs.stopped());
            while let Some(index) = jobs.next() {
                let solution = queries.solve(index, (engine, problem), workspace, &mut watch);
                jobs.finish(index, solution);
            }
        });
    };
    let poll = |done: usize| {
        let signals = Python::attach(|py| py.check_signals());
        let report = progress.done(done);
        signals.and(report)
    };
    let solutions = jobs::run(queries.count, threads, work, (CHECK_INTERVAL, poll))?;
    progress.done(queries.count)?;
    Ok(solutions)
}
