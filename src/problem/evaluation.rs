//! Evaluation of a problem: residuals by one forward pass, which the derivatives reuse.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::compiled_task::CompiledTask;
use super::{Derivatives, Problem, ProblemInstance, ReportNames, TaskSubset};
use crate::kinematics::{Partials, Tree, TreeState, Wrench, Wrenches};
use crate::scalar::{Dual, Scalar};
use crate::solver::{ConfigurationSpace, LeastSquares};
use crate::spatial::{Placement, Vector3};
use crate::task::{CHUNK, DualScratch, ErasedResidual, LocalJacobian};

/// Workspace of a problem. One caller uses it at a time; a problem may have many.
#[derive(Clone, Debug)]
pub struct Scratch {
    /// Identifies the problem of this workspace.
    owner: Arc<ReportNames>,
    state: TreeState<f64>,
    /// The x of the last forward pass; NaN before the first.
    last_x: Vec<f64>,
    q: Vec<f64>,
    frames: Vec<Placement<f64>>,
    joints: Vec<f64>,
    local: LocalJacobian,
    local_dual: DualScratch,
    wrenches: Wrenches,
    pub(super) dual: Box<DualPass>,
    pub(super) shifted: Vec<f64>,
    pub(super) shifted_residual: [Vec<f64>; 2],
}

/// Workspace of the forward pass on dual numbers.
#[derive(Clone, Debug)]
pub(super) struct DualPass {
    pub(super) state: TreeState<Dual<CHUNK>>,
    pub(super) x: Vec<Dual<CHUNK>>,
    pub(super) q: Vec<Dual<CHUNK>>,
    pub(super) gathered: DualScratch,
}

impl Scratch {
    pub(super) fn new(problem: &Problem) -> Self {
        let (n, m, dof) = (
            problem.variables(),
            problem.rows(),
            problem.configuration_len(),
        );
        let zero = Dual::zero();
        let mut local = LocalJacobian::default();
        let mut gathered = DualScratch::default();
        for task in &problem.tasks {
            let rows = task.rows.len().max(task.slack_weights.len());
            let (frames, joints) = (task.frames.len(), task.coordinates.len());
            local.reserve(rows, frames, joints);
            gathered.reserve(rows, frames, joints);
        }
        let max_count =
            |count: fn(&CompiledTask) -> usize| problem.tasks.iter().map(count).max().unwrap_or(0);
        Self {
            owner: Arc::clone(&problem.names),
            state: TreeState::new(&problem.tree),
            last_x: vec![f64::NAN; n],
            q: vec![0.0; dof],
            frames: Vec::with_capacity(max_count(|task| task.frames.len())),
            joints: Vec::with_capacity(max_count(|task| task.coordinates.len())),
            local,
            local_dual: gathered.clone_empty(),
            wrenches: Wrenches::new(&problem.tree),
            dual: Box::new(DualPass {
                state: TreeState::new(&problem.tree),
                x: vec![zero; n],
                q: vec![zero; dof],
                gathered,
            }),
            shifted: vec![0.0; n],
            shifted_residual: [vec![0.0; m], vec![0.0; m]],
        }
    }
}

impl Scratch {
    /// Invalidates the last forward pass, after joints or frames moved.
    pub(crate) fn invalidate(&mut self) {
        self.last_x.fill(f64::NAN);
    }

    /// The frames and joint values of the task gathered last.
    pub(super) fn task_inputs(&self) -> (&[Placement<f64>], &[f64]) {
        (&self.frames, &self.joints)
    }

    /// The frames and joint values of the task gathered last, with the workspace for its derivatives.
    pub(super) fn differentiation_inputs(
        &mut self,
    ) -> (
        &[Placement<f64>],
        &[f64],
        &mut LocalJacobian,
        &mut DualScratch,
    ) {
        let (local, dual) = (&mut self.local, &mut self.local_dual);
        (&self.frames, &self.joints, local, dual)
    }

    /// The state of the tree after the last forward pass.
    #[must_use]
    pub(super) fn state(&self) -> &TreeState<f64> {
        &self.state
    }

    /// The weighted derivatives of the task differentiated last.
    #[must_use]
    pub(super) fn local(&self) -> &LocalJacobian {
        &self.local
    }

    /// The configuration of the last forward pass.
    #[must_use]
    pub(crate) fn q(&self) -> &[f64] {
        &self.q
    }

    /// True if this workspace was made for `problem`.
    pub(crate) fn fits(&self, problem: &Problem) -> bool {
        Arc::ptr_eq(&self.owner, &problem.names)
    }
}

/// A problem instance with the workspace to evaluate it.
#[derive(Debug)]
pub struct Evaluation<'a> {
    pub(super) instance: ProblemInstance<'a>,
    pub(super) subset: TaskSubset,
    pub(super) scratch: &'a mut Scratch,
}

impl<'a> Evaluation<'a> {
    /// Evaluates a problem with a workspace from its [`Problem::scratch`].
    ///
    /// A workspace of another problem is replaced. Arguments of wrong length give NaN in every entry.
    #[must_use]
    pub fn new(instance: impl Into<ProblemInstance<'a>>, scratch: &'a mut Scratch) -> Self {
        Self::of(TaskSubset::All, instance.into(), scratch)
    }

    /// Does the same as [`new`](Self::new), for a subset of the tasks.
    pub(crate) fn of(
        subset: TaskSubset,
        instance: ProblemInstance<'a>,
        scratch: &'a mut Scratch,
    ) -> Self {
        if !scratch.fits(instance.problem) {
            *scratch = instance.problem.scratch();
        }
        Self {
            instance,
            subset,
            scratch,
        }
    }

    /// r(x) of the whole problem before weighting.
    pub(crate) fn unweighted(&mut self, x: &[f64]) -> &[f64] {
        self.forward(x);
        // Reuses the buffer of finite differences, which keep nothing in it.
        let mut residual = std::mem::take(&mut self.scratch.shifted_residual[0]);
        for (index, task) in self.instance.problem.tasks.iter().enumerate() {
            Self::gather(self.scratch, task);
            let rows = &mut residual[task.rows.clone()];
            let residual_function = self.instance.residual(index);
            residual_function.evaluate(&self.scratch.frames, &self.scratch.joints, rows);
        }
        self.scratch.shifted_residual[0] = residual;
        &self.scratch.shifted_residual[0]
    }

    /// The placement of a task's first frame at x.
    pub(crate) fn first_frame(&mut self, x: &[f64], task: usize) -> Option<Placement<f64>> {
        self.forward(x);
        let slot = self.instance.problem.tasks.get(task)?.frames.first()?;
        self.scratch.state.frames().get(*slot).copied()
    }

    fn fits(&self, x: &[f64], rows: usize) -> bool {
        x.len() == self.instance.problem.variables() && rows == self.rows()
    }

    /// Runs the forward pass, unless the last one was at the same x.
    pub(super) fn forward(&mut self, x: &[f64]) {
        let scratch = &mut *self.scratch;
        if scratch.last_x != x {
            scratch.last_x.copy_from_slice(x);
            self.instance.tree().forward(x, &mut scratch.state);
            self.instance.problem.map.scatter(x, &mut scratch.q);
        }
    }

    /// Copies the input of a task into consecutive memory.
    pub(super) fn gather(scratch: &mut Scratch, task: &CompiledTask) {
        let all_frames = scratch.state.frames();
        scratch.frames.clear();
        scratch
            .frames
            .extend(task.frames.iter().map(|&slot| all_frames[slot]));
        scratch.joints.clear();
        scratch
            .joints
            .extend(task.coordinates.iter().map(|&c| scratch.q[c]));
    }

    /// The weighted local derivatives of one task at the last forward pass.
    pub(super) fn differentiate(
        scratch: &mut Scratch,
        task: &CompiledTask,
        residual: &dyn ErasedResidual,
    ) {
        Self::gather(scratch, task);
        let (frames, joints, local, dual) = scratch.differentiation_inputs();
        local.reset(task.rows.len(), frames.len(), joints.len());
        residual.differentiate(frames, joints, local, dual);
        local.scale_rows(&task.weights);
    }

    /// The Jacobian by the variables themselves, not by the components of a step.
    ///
    /// The rows of a task are W (Σ_k L_k Jv_k + A_k Jω_k + Σ_j ∂r/∂q_j ∂q_j/∂x). L_k and A_k are the derivatives by
    /// velocity and angular velocity of frame k; Jv_k and Jω_k are its geometric Jacobian.
    pub(crate) fn analytic_jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.forward(x);
        // A slice fill, because nalgebra's `fill` writes entry by entry and is much slower.
        jacobian.as_mut_slice().fill(0.0);
        let problem = self.instance.problem;
        for (index, task, task_rows) in problem.tasks_of(self.subset) {
            self.add_rows(x, (index, task), task_rows.start, jacobian);
        }
    }

    /// Adds the rows of one task, starting at `first_row`; the last forward pass must have been at x.
    pub(super) fn add_rows(
        &mut self,
        x: &[f64],
        (index, task): (usize, &CompiledTask),
        first_row: usize,
        jacobian: &mut DMatrix<f64>,
    ) {
        Self::differentiate(self.scratch, task, self.instance.residual(index));
        self.add_local(x, task, first_row, jacobian);
    }

    /// Adds the rows of one task from its local derivatives.
    #[inline]
    pub(super) fn add_local(
        &mut self,
        x: &[f64],
        task: &CompiledTask,
        first_row: usize,
        jacobian: &mut DMatrix<f64>,
    ) {
        let (problem, tree) = (self.instance.problem, self.instance.tree());
        let rows = jacobian.nrows();
        if task.uses_sweeps {
            Self::add_by_sweeps(tree, self.scratch, task, first_row, jacobian);
        }
        let Scratch { state, local, .. } = &*self.scratch;
        let frames = if task.uses_sweeps {
            &[][..]
        } else {
            &task.frames
        };
        for (k, &frame) in frames.iter().enumerate() {
            let partials = Partials {
                frame,
                first_row,
                linear: local.linear(k),
                angular: local.angular(k),
            };
            tree.add_geometric_jacobian(state, &partials, jacobian);
        }
        // Column-major.
        let entries = jacobian.as_mut_slice();
        for (k, &coordinate) in task.coordinates.iter().enumerate() {
            for (variable, slope) in problem.map.slopes(coordinate, x) {
                for (row, entry) in local.joint(k) {
                    entries[variable * rows + first_row + row] += slope * entry;
                }
            }
        }
    }

    /// Adds the rows one at a time, as gradients of scalars.
    ///
    /// For tasks whose frames share most joints, such as a centre of mass. The cost is O(rows · (joints + frames))
    /// instead of O(rows · joints · frames).
    fn add_by_sweeps(
        tree: &Tree,
        scratch: &mut Scratch,
        task: &CompiledTask,
        first_row: usize,
        jacobian: &mut DMatrix<f64>,
    ) {
        let (local, wrenches) = (&scratch.local, &mut scratch.wrenches);
        let rows = jacobian.nrows();
        let entries = jacobian.as_mut_slice();
        for row in 0..local.rows() {
            wrenches.clear();
            let part = |parts: &[Vector3<f64>]| parts.get(row).copied();
            let nothing = |parts| part(parts).is_none_or(|v| v.to_array() == [0.0; 3]);
            // Skip rows without derivative, such as those of a balanced body.
            if (0..task.frames.len()).all(|k| nothing(local.linear(k)) && nothing(local.angular(k)))
            {
                continue;
            }
            for (k, &frame) in task.frames.iter().enumerate() {
                let wrench = Wrench {
                    force: part(local.linear(k)).unwrap_or(Vector3::zero()),
                    moment: part(local.angular(k)).unwrap_or(Vector3::zero()),
                };
                tree.push(&scratch.state, frame, wrench, wrenches);
            }
            tree.sweep_by(&scratch.state, wrenches, |variable, contribution| {
                entries[variable * rows + first_row + row] += contribution;
            });
        }
    }

    /// Jᵀ r by one sweep over the tree from the frames to the root.
    ///
    /// Derivatives are by the variables themselves, not by the components of a step.
    pub(crate) fn reverse_gradient(&mut self, x: &[f64], r: &[f64], gradient: &mut [f64]) {
        self.start_sweep(x, gradient);
        self.push_residual(x, r, gradient);
        self.end_sweep(gradient);
    }

    pub(super) fn start_sweep(&mut self, x: &[f64], gradient: &mut [f64]) {
        self.forward(x);
        gradient.fill(0.0);
        self.scratch.wrenches.clear();
    }

    /// Adds the wrenches of a subset's rows on the frames, and the gradient by the joints that they read.
    pub(super) fn push_residual(&mut self, x: &[f64], r: &[f64], gradient: &mut [f64]) {
        let problem = self.instance.problem;
        for (index, task, rows) in problem.tasks_of(self.subset) {
            Self::differentiate(self.scratch, task, self.instance.residual(index));
            self.push_local(x, task, &r[rows], gradient);
        }
    }

    /// Adds the wrenches and joint gradient of the task that was differentiated last.
    #[inline]
    pub(super) fn push_local(
        &mut self,
        x: &[f64],
        task: &CompiledTask,
        r: &[f64],
        gradient: &mut [f64],
    ) {
        let (problem, tree) = (self.instance.problem, self.instance.tree());
        let scratch = &mut *self.scratch;
        let local = &scratch.local;
        for (k, &frame) in task.frames.iter().enumerate() {
            let sum = |parts: &[Vector3<f64>]| {
                let weighted = parts.iter().zip(r).map(|(&part, &value)| part * value);
                weighted.fold(Vector3::zero(), |sum, part| sum + part)
            };
            let wrench = Wrench {
                force: sum(local.linear(k)),
                moment: sum(local.angular(k)),
            };
            tree.push(&scratch.state, frame, wrench, &mut scratch.wrenches);
        }
        for (k, &coordinate) in task.coordinates.iter().enumerate() {
            for (variable, slope) in problem.map.slopes(coordinate, x) {
                let sum: f64 = local.joint(k).map(|(row, entry)| entry * r[row]).sum();
                gradient[variable] += slope * sum;
            }
        }
    }

    /// Adds the gradient of all wrenches on the frames.
    pub(super) fn end_sweep(&mut self, gradient: &mut [f64]) {
        let (tree, scratch) = (self.instance.tree(), &mut *self.scratch);
        tree.sweep(&scratch.state, &mut scratch.wrenches, gradient);
    }
}

impl LeastSquares for Evaluation<'_> {
    fn variables(&self) -> usize {
        self.instance.problem.variables()
    }

    fn rows(&self) -> usize {
        self.instance.problem.rows_of(self.subset)
    }

    fn lower(&self) -> &[f64] {
        self.instance.lower()
    }

    fn upper(&self) -> &[f64] {
        self.instance.upper()
    }

    fn step_scale(&self) -> &[f64] {
        self.instance.problem.step_scale()
    }

    fn space(&self) -> ConfigurationSpace<'_> {
        self.instance.space()
    }

    fn stops_when_reached(&self) -> bool {
        !self.instance.problem.has_soft_tasks(self.subset)
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        if !self.fits(x, residual.len()) {
            return residual.fill(f64::NAN);
        }
        self.forward(x);
        for (index, task, rows) in self.instance.problem.tasks_of(self.subset) {
            Self::gather(self.scratch, task);
            let rows = &mut residual[rows];
            let residual_function = self.instance.residual(index);
            residual_function.evaluate(&self.scratch.frames, &self.scratch.joints, rows);
            for (row, weight) in rows.iter_mut().zip(&task.weights) {
                *row *= weight;
            }
        }
    }

    fn jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        if !self.fits(x, jacobian.nrows()) || jacobian.ncols() != x.len() {
            return jacobian.fill(f64::NAN);
        }
        match self.instance.problem.derivatives {
            Derivatives::Analytic => self.analytic_jacobian(x, jacobian),
            Derivatives::Dual => self.dual_jacobian(x, jacobian),
            Derivatives::ForwardDifference => self.difference_jacobian(x, false, jacobian),
            Derivatives::CentralDifference => self.difference_jacobian(x, true, jacobian),
        }
        let rows = jacobian.nrows();
        let space = self.instance.space();
        space.by_steps(x, rows, jacobian.as_mut_slice());
    }

    fn gradient(
        &mut self,
        x: &[f64],
        residual: &[f64],
        gradient: &mut [f64],
        jacobian: &mut DMatrix<f64>,
    ) {
        if !self.fits(x, residual.len()) || gradient.len() != x.len() {
            return gradient.fill(f64::NAN);
        }
        if self.instance.problem.derivatives == Derivatives::Analytic {
            self.reverse_gradient(x, residual, gradient);
            self.instance.space().by_steps(x, 1, gradient);
        } else {
            if jacobian.shape() != (residual.len(), x.len()) {
                return gradient.fill(f64::NAN);
            }
            self.jacobian(x, jacobian);
            for (k, entry) in gradient.iter_mut().enumerate() {
                let column = jacobian.column(k);
                *entry = column.iter().zip(residual).map(|(j, r)| j * r).sum();
            }
        }
    }

    fn is_reached(&self, residual: &[f64]) -> bool {
        self.instance.problem.is_reached_by(self.subset, residual)
    }
}
