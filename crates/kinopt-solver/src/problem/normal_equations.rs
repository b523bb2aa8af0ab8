//! Sparse JᵀJ and Jᵀr of a whole problem, by the structure of its tree.

use std::collections::BTreeSet;

use nalgebra::DMatrix;

use super::compiled_task::CompiledTask;
use super::{Evaluation, Problem, ProblemInstance, Scratch};
use crate::solver::BranchedMatrix;
use kinopt_kinematics::kinematics::{Composites, Partials};

/// Workspace for a problem's normal equations.
///
/// Rows that depend on one frame are added by [`Composites`]. All other rows are added row by row, from the variables
/// that each depends on. These rows add coupling to a factorisation, next to the paths of joints to the root.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct NormalEquations {
    /// Indices of tasks whose rows depend on one frame.
    on_frames: Vec<usize>,
    /// Indices of all other tasks, with the variables that each row depends on.
    others: Vec<(usize, Vec<Vec<usize>>)>,
    composites: Composites,
    /// J of the rows of the other tasks.
    rows: DMatrix<f64>,
    matrix: BranchedMatrix,
    gradient: Vec<f64>,
}

impl NormalEquations {
    /// Normal equations of all tasks of a problem with analytic derivatives.
    #[doc(hidden)]
    pub fn new(problem: &Problem) -> Self {
        let (tree, n) = (problem.tree(), problem.variables());
        let has_own_variables = tree.has_own_variables();
        let is_of_a_frame = |task: &CompiledTask| {
            has_own_variables
                && task.frames.len() == 1
                && task.coordinates.is_empty()
                && !task.uses_sweeps
        };
        let tasks = problem.compiled_tasks().iter().enumerate();
        let (on_frames, others): (Vec<_>, Vec<_>) = tasks.partition(|entry| is_of_a_frame(entry.1));
        let mut scratch = problem.scratch();
        let others = others.into_iter().map(|(index, task)| {
            let variables = match task.frames.is_empty() {
                true => variables_of_joints(problem, index, task, &mut scratch),
                false => vec![variables_of_task(problem, task); task.rows.len()],
            };
            (index, variables)
        });
        let others: Vec<_> = others.collect();
        let frames = on_frames.iter().flat_map(|(_, task)| &task.frames);
        let frame_variables = frames.map(|&slot| tree.variables_moving(slot).collect());
        let rows = others.iter().flat_map(|(_, rows)| rows.iter().cloned());
        let coupled: BTreeSet<Vec<usize>> = frame_variables.chain(rows).collect();
        let coupled: Vec<_> = coupled.into_iter().collect();
        let row_count = others.iter().map(|(_, rows)| rows.len()).sum();
        Self {
            on_frames: on_frames.into_iter().map(|(index, _)| index).collect(),
            others,
            composites: Composites::new(tree),
            rows: DMatrix::zeros(row_count, n),
            matrix: BranchedMatrix::new(n, &coupled),
            gradient: vec![0.0; n],
        }
    }

    /// JᵀJ.
    #[must_use]
    #[doc(hidden)]
    pub fn matrix(&self) -> &BranchedMatrix {
        &self.matrix
    }

    /// Jᵀr.
    #[must_use]
    #[doc(hidden)]
    pub fn gradient(&self) -> &[f64] {
        &self.gradient
    }
}

/// The variables that a task's rows may depend on.
fn variables_of_task(problem: &Problem, task: &CompiledTask) -> Vec<usize> {
    let frames = task.frames.iter();
    let moving = frames.flat_map(|&slot| problem.tree().variables_moving(slot));
    let joint_variables = task.coordinates.iter();
    let joint_variables =
        joint_variables.flat_map(|&coordinate| problem.parameters().variables_of(coordinate));
    let all: BTreeSet<usize> = moving.chain(joint_variables).collect();
    all.into_iter().collect()
}

/// The variables that each row of a task on joints depends on; the same at every configuration.
fn variables_of_joints(
    problem: &Problem,
    index: usize,
    task: &CompiledTask,
    scratch: &mut Scratch,
) -> Vec<Vec<usize>> {
    let bounds = problem.lower().iter().zip(problem.upper());
    let x: Vec<f64> = bounds
        .map(|(low, high)| 0.0_f64.max(*low).min(*high))
        .collect();
    let instance = ProblemInstance::from(problem);
    Evaluation::new(instance, scratch).forward(&x);
    Evaluation::differentiate(scratch, task, instance.residual(index));
    let mut variables = vec![BTreeSet::new(); task.rows.len()];
    for (joint, &coordinate) in task.coordinates.iter().enumerate() {
        for (row, _) in scratch.local().joint(joint) {
            variables[row].extend(problem.parameters().variables_of(coordinate));
        }
    }
    let rows = variables.into_iter();
    rows.map(|row| row.into_iter().collect()).collect()
}

impl Evaluation<'_> {
    /// Writes JᵀJ and Jᵀr at x, by the components of a step; `residual` is r(x) of all tasks.
    #[doc(hidden)]
    pub fn normal_equations(
        &mut self,
        x: &[f64],
        residual: &[f64],
        equations: &mut NormalEquations,
    ) {
        self.forward(x);
        equations.matrix.clear();
        equations.gradient.fill(0.0);
        self.add_rows_of_frames(x, residual, equations);
        self.add_other_rows(x, residual, equations);
    }

    fn add_rows_of_frames(&mut self, x: &[f64], residual: &[f64], equations: &mut NormalEquations) {
        let (problem, tree) = (self.instance.problem, self.instance.tree());
        equations.composites.clear();
        for &index in &equations.on_frames {
            let task = &problem.compiled_tasks()[index];
            Self::differentiate(self.scratch, task, self.instance.residual(index));
            let (state, local) = (self.scratch.state(), self.scratch.local());
            let partials = Partials {
                frame: task.frames[0],
                first_row: 0,
                linear: local.linear(0),
                angular: local.angular(0),
            };
            let task_residual = &residual[task.rows.clone()];
            tree.add_to_composites(state, &partials, task_residual, &mut equations.composites);
        }
        tree.write_motions(self.scratch.state(), &mut equations.composites);
        self.instance
            .space()
            .by_steps(x, 6, equations.composites.motions_mut());
        let matrix = &mut equations.matrix;
        tree.sweep_composites(
            &mut equations.composites,
            &mut equations.gradient,
            |a, b, entry| {
                matrix.add(a, b, entry);
            },
        );
    }

    fn add_other_rows(&mut self, x: &[f64], residual: &[f64], equations: &mut NormalEquations) {
        let problem = self.instance.problem;
        equations.rows.as_mut_slice().fill(0.0);
        let mut first = 0;
        for (index, rows) in &equations.others {
            let task = &problem.compiled_tasks()[*index];
            self.add_rows(x, (*index, task), first, &mut equations.rows);
            first += rows.len();
        }
        let height = equations.rows.nrows();
        self.instance
            .space()
            .by_steps(x, height, equations.rows.as_mut_slice());
        let mut first = 0;
        for (index, rows) in &equations.others {
            let residual = &residual[problem.compiled_tasks()[*index].rows.clone()];
            for (row, (variables, r)) in (first..).zip(rows.iter().zip(residual)) {
                for (k, &a) in variables.iter().enumerate() {
                    let slope = equations.rows[(row, a)];
                    if slope == 0.0 {
                        continue;
                    }
                    equations.gradient[a] += slope * r;
                    for &b in &variables[..=k] {
                        equations.matrix.add(a, b, slope * equations.rows[(row, b)]);
                    }
                }
            }
            first += rows.len();
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::NormalEquations;
    use crate::problem::{Evaluation, Problem, ProblemInstance};
    use crate::solver::LeastSquares;
    use crate::task::{Distance, FramePose, JointCoupling, Point, Posture};
    use kinopt_kinematics::model::{BallLimits, JointId, Limits, Model, ParameterMap};
    use kinopt_kinematics::random::RandomStream;
    use kinopt_kinematics::spatial::{Placement, Vector3};

    /// A body on a free base with two limbs, each with a ball joint in a cone and two hinges; returns both knees.
    fn body() -> (Model, [JointId; 2]) {
        let mut builder = Model::builder("body");
        let at = |x, y, z| Placement::translation(Vector3::new(x, y, z));
        let anywhere = [Limits::UNBOUNDED; 3];
        let base = builder.free("base", None, at(0.0, 0.0, 1.0), anywhere);
        builder.frame("trunk", Some(base), at(0.1, 0.0, 0.2));
        let knees = [1.0, -1.0].map(|side| {
            let name = |what| format!("{what} {side}");
            let cone = Some(BallLimits::cone(0.5, Limits::new(-0.4, 0.4)));
            let here = at(0.0, 0.1 * side, 0.0);
            let hip = builder.ball(name("hip"), Some(base), here, -Vector3::UNITS[2], cone);
            let bent = Limits::new(-1.0, 2.0);
            let [x, y, _] = Vector3::UNITS;
            let knee = builder.revolute(name("knee"), Some(hip), at(0.0, 0.0, -0.4), y, bent);
            let ankle = builder.revolute(name("ankle"), Some(knee), at(0.0, 0.0, -0.4), x, bent);
            builder.frame(name("foot"), Some(ankle), at(0.05, 0.0, -0.1));
            knee
        });
        (builder.build().unwrap(), knees)
    }

    fn problem(model: &Model, knees: [JointId; 2], map: ParameterMap, ties: bool) -> Problem {
        let mut tasks = Problem::builder(model);
        tasks.parameters(map);
        let [trunk, left, right] =
            ["trunk", "foot 1", "foot -1"].map(|name| model.frame(name).unwrap());
        tasks.add(FramePose::new(trunk, Placement::identity()));
        tasks.add(Point::new(left, [0.2, 0.3, 0.1]).at([0.0, 0.1, 0.2]));
        tasks.add(Point::new(right, [0.1, -0.2, 0.3]));
        tasks.add(Posture::new(model, &model.neutral()));
        if ties {
            tasks.add(Distance::new(left, right, 0.3));
            tasks.add(JointCoupling::new(
                model,
                knees.map(|knee| (knee, 0.7)),
                0.1,
            ));
        }
        tasks.build().unwrap()
    }

    /// Compares with the dense Jacobian.
    ///
    /// Covers limbs with and without a coupling task, and knees with separate variables and with a mimic joint. Points
    /// are between bounds and at the edges of cones.
    #[test]
    fn normal_equations_match_dense_jacobian() {
        let mut random = RandomStream::new(7, 0);
        let (model, knees) = body();
        let all_free = ParameterMap::free(&model);
        let coupled = ParameterMap::builder(&model).with_coupled(knees[1], knees[0], -0.8, 0.1);
        let coupled = coupled.build().unwrap();
        for (map, ties) in [
            (&all_free, false),
            (&all_free, true),
            (&coupled, false),
            (&coupled, true),
        ] {
            let problem = problem(&model, knees, map.clone(), ties);
            let mut equations = NormalEquations::new(&problem);
            let (mut scratch, n) = (problem.scratch(), problem.variables());
            let mut evaluation = Evaluation::new(ProblemInstance::from(&problem), &mut scratch);
            for _ in 0..20 {
                let mut x: Vec<f64> = (0..n).map(|_| 4.0 * random.unit() - 2.0).collect();
                evaluation.space().project(&mut x);
                let mut residual = vec![0.0; problem.rows()];
                evaluation.residual(&x, &mut residual);
                let mut jacobian = DMatrix::zeros(problem.rows(), n);
                evaluation.jacobian(&x, &mut jacobian);
                evaluation.normal_equations(&x, &residual, &mut equations);

                let along = DVector::from_fn(n, |_, _| random.unit());
                let expected = jacobian.tr_mul(&(&jacobian * &along));
                let mut product = vec![0.0; n];
                equations.matrix().multiply(along.as_slice(), &mut product);
                let off = (&expected - DVector::from_vec(product)).amax();
                assert!(off < 1e-12 * expected.amax(), "{off}");

                let expected = jacobian.tr_mul(&DVector::from_vec(residual));
                let gradient = DVector::from_column_slice(equations.gradient());
                let off = (&expected - gradient).amax();
                assert!(off < 1e-12 * expected.amax(), "{off}");
            }
        }
    }
}
