//! Goal sets: many targets for several arms or tools in one call.

use kinopt::arm::{GoalOutcome, GoalSet, GoalStatus};
use kinopt::spatial::Placement;
use kinopt_bindings::goal_set::{criterion as criterion_of, status};
use numpy::ndarray::Array2;
use numpy::{PyArray2, ToPyArray};
use pyo3::prelude::*;

use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::placement::targets as targets_of;
use crate::threads;

/// Result of `solve_goals`: arrays with a row for each arm or tool and a column for each target.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct GoalSetSolution {
    inner: kinopt::arm::GoalSetSolution,
    arms: Vec<kinopt::Arm>,
    targets: Vec<Placement<f64>>,
    starts: Vec<Vec<f64>>,
}

impl GoalSetSolution {
    fn table<T: numpy::Element + Clone>(
        &self,
        py: Python<'_>,
        value: impl Fn(&GoalOutcome) -> T,
    ) -> Py<PyArray2<T>> {
        let shape = (self.arms.len(), self.inner.goals);
        let table =
            Array2::from_shape_fn(shape, |(arm, goal)| value(self.inner.outcome(arm, goal)));
        table.to_pyarray(py).unbind()
    }

    fn check(&self, arm: usize, target: usize) -> PyResult<()> {
        match arm < self.arms.len() && target < self.inner.goals {
            true => Ok(()),
            false => Err(invalid(format!(
                "no arm {arm} and target {target}: there are {} and {}",
                self.arms.len(),
                self.inner.goals
            ))),
        }
    }
}

#[pymethods]
impl GoalSetSolution {
    /// Shape (arms, targets), bool: true for each target that an arm reaches, free of collisions.
    #[getter]
    fn reached(&self, py: Python<'_>) -> Py<PyArray2<bool>> {
        self.table(py, |outcome| outcome.status == GoalStatus::Reached)
    }

    /// Shape (arms, targets): cost of each configuration by the criterion, smallest for the best; infinite unless the
    /// target is reached. Manipulability and clearance are negative costs.
    #[getter]
    fn cost(&self, py: Python<'_>) -> Py<PyArray2<f64>> {
        self.table(py, |outcome| outcome.cost)
    }

    /// Results by arm and target: "reached", "in collision", "out of reach" (proven) or "missed".
    #[getter]
    fn status(&self) -> Vec<Vec<&'static str>> {
        let rows = self.inner.outcomes.iter();
        rows.map(|row| row.iter().map(|outcome| status(outcome.status)).collect())
            .collect()
    }

    /// Configurations of each arm, shape (targets, dof), radians or metres: the closest one found if a target is not
    /// reached, NaN if it is out of reach.
    #[getter]
    fn q(&self, py: Python<'_>) -> PyResult<Vec<Py<PyArray2<f64>>>> {
        let rows = self.inner.q.iter().zip(&self.arms);
        rows.map(|(q, arm)| {
            let shape = (self.inner.goals, arm.joint_count());
            let table = Array2::from_shape_vec(shape, q.clone());
            let table = table.map_err(|error| invalid(error.to_string()))?;
            Ok(table.to_pyarray(py).unbind())
        })
        .collect()
    }

    /// Indices of the best arm and target; None if no target is reached.
    #[getter]
    fn best(&self) -> Option<(usize, usize)> {
        self.inner.best()
    }

    /// Indices of arm and target of all reached targets, shape (K, 2), least cost first.
    #[getter]
    fn ranking(&self, py: Python<'_>) -> Py<PyArray2<i64>> {
        let pairs = self.inner.ranking();
        let numbers = Array2::from_shape_fn((pairs.len(), 2), |(row, column)| {
            let (arm, goal) = pairs[row];
            [arm as i64, goal as i64][column]
        });
        numbers.to_pyarray(py).unbind()
    }

    /// Why `arm` does not reach `target`, in words, with the colliding pairs or the proof if there is one. It solves the
    /// target again, and looks for a proof with up to `max_boxes` boxes of joint values.
    ///
    /// Raises `InvalidValueError` for indices out of range.
    #[pyo3(signature = (arm, target, *, max_boxes = 20_000))]
    fn explain(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = crate::arrays::whole)] arm: usize,
        #[pyo3(from_py_with = crate::arrays::whole)] target: usize,
        #[pyo3(from_py_with = crate::arrays::whole)] max_boxes: usize,
    ) -> PyResult<String> {
        self.check(arm, target)?;
        let (start, target) = (&self.starts[arm], self.targets[target]);
        let arm = &self.arms[arm];
        let answer = py.detach(|| arm.reachability(target, start, max_boxes));
        Ok(answer.or_raise()?.solution().explain())
    }

    fn __repr__(&self) -> String {
        format!(
            "GoalSetSolution({} arms, {} targets, {} reached)",
            self.arms.len(),
            self.inner.goals,
            self.inner.ranking().len()
        )
    }
}

/// Solves every target for every arm and ranks the results.
pub(super) fn solve(
    py: Python<'_>,
    arms: Vec<kinopt::Arm>,
    targets: &Bound<'_, PyAny>,
    starts: Vec<Vec<f64>>,
    criterion: Option<&Bound<'_, PyAny>>,
    threads: Option<usize>,
) -> PyResult<GoalSetSolution> {
    let goal = arms.first().map(kinopt::Arm::goal).unwrap_or_default();
    let targets = targets_of(targets, "target", &goal)?.to_vec("target")?;
    let function = criterion.filter(|criterion| criterion.is_callable());
    let name = match criterion {
        Some(criterion) if function.is_none() => arrays::name(criterion, "criterion")?,
        _ => "distance".to_owned(),
    };
    let ranked_by = criterion_of(&name).or_raise()?;
    let set = GoalSet::new(arms);
    let pool = threads::pool(threads, targets.len())?;
    let inner = py.detach(|| match &pool {
        Some(pool) => pool.install(|| set.solve_parallel(&targets, &starts, ranked_by)),
        None => set.solve(&targets, &starts, ranked_by),
    });
    let mut inner = inner.or_raise()?;
    if let Some(function) = function {
        cost_by_function(py, &set, &mut inner, function)?;
    }
    Ok(GoalSetSolution {
        inner,
        arms: set.arms().to_vec(),
        targets,
        starts,
    })
}

/// Replaces the costs of the reached targets by those of a function of (arm, q), with q of shape (K, dof).
fn cost_by_function(
    py: Python<'_>,
    set: &GoalSet,
    solution: &mut kinopt::arm::GoalSetSolution,
    function: &Bound<'_, PyAny>,
) -> PyResult<()> {
    for (index, arm) in set.arms().iter().enumerate() {
        let reached: Vec<usize> = (0..solution.goals)
            .filter(|&goal| solution.outcomes[index][goal].status == GoalStatus::Reached)
            .collect();
        let dof = arm.joint_count();
        let rows = Array2::from_shape_fn((reached.len(), dof), |(row, joint)| {
            solution.q[index][reached[row] * dof + joint]
        });
        let costs = function.call1((index, rows.to_pyarray(py)))?;
        let costs = arrays::vector_of(&costs, "the costs", reached.len())?;
        for (&goal, cost) in reached.iter().zip(costs.iter()) {
            solution.outcomes[index][goal].cost = *cost;
        }
    }
    Ok(())
}
