//! Promise: handwritten derivatives of a residual are weighted row by row, in any storage form.

use kinopt::model::{JointId, Limits, Model};
use kinopt::problem::Evaluation;
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Inputs, LocalJacobian, Quantity, Residual, RowBlock, Task};
use kinopt::{Problem, Scalar};
use nalgebra::DMatrix;

/// Two rows of different quantities, each of one joint: 2 a and 3 b.
#[derive(Clone)]
struct TwoSorts {
    joints: [JointId; 2],
    diagonal: bool,
}

impl Residual for TwoSorts {
    fn inputs(&self) -> Inputs {
        Inputs::joints(self.joints)
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![
            RowBlock::new(Quantity::JointUnits, 1),
            RowBlock::new(Quantity::Ratio, 1),
        ]
    }

    fn evaluate<S: Scalar>(&self, _: &[Placement<S>], joints: &[S], r: &mut [S]) {
        r[0] = joints[0] * S::constant(2.0);
        r[1] = joints[1] * S::constant(3.0);
    }

    fn differentiate(&self, _: &[Placement<f64>], _: &[f64], to: &mut LocalJacobian) -> bool {
        match self.diagonal {
            true => to.set_diagonal([2.0, 3.0]),
            false => {
                to.joint_mut(0).copy_from_slice(&[2.0, 0.0]);
                to.joint_mut(1).copy_from_slice(&[0.0, 3.0]);
            }
        }
        true
    }
}

fn hinges() -> (Model, [JointId; 2]) {
    let mut builder = Model::builder("hinges");
    let (at, z) = (Placement::identity(), Vector3::UNITS[2]);
    let limits = Limits::new(-1.0, 1.0);
    let a = builder.revolute("a", None, at, z, limits);
    let b = builder.revolute("b", Some(a), at, z, limits);
    (builder.build().unwrap(), [a, b])
}

#[test]
fn each_row_has_its_weight() {
    let (model, joints) = hinges();
    for diagonal in [true, false] {
        let mut tasks = Problem::builder(&model);
        let task = Task::new(TwoSorts { joints, diagonal });
        let task = task.weight(Quantity::JointUnits, 10.0);
        tasks.add(task.weight(Quantity::Ratio, 100.0));
        let problem = tasks.build().unwrap();
        let mut scratch = problem.scratch();
        let mut evaluation = Evaluation::new(&problem, &mut scratch);
        let mut jacobian = DMatrix::zeros(2, 2);
        evaluation.jacobian(&[0.1, 0.2], &mut jacobian);
        let expected = DMatrix::from_row_slice(2, 2, &[20.0, 0.0, 0.0, 300.0]);
        assert_eq!(jacobian, expected, "{diagonal}");
    }
}

/// Twice a joint for each row, plus five times the second joint in the first row.
#[derive(Clone)]
struct DiagonalAndMore {
    joints: [JointId; 2],
    rows: usize,
}

impl Residual for DiagonalAndMore {
    fn inputs(&self) -> Inputs {
        Inputs::joints(self.joints)
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::JointUnits, self.rows)]
    }

    fn evaluate<S: Scalar>(&self, _: &[Placement<S>], joints: &[S], r: &mut [S]) {
        for (row, &joint) in r.iter_mut().zip(joints) {
            *row = joint * S::constant(2.0);
        }
        r[0] += joints[1] * S::constant(5.0);
    }

    fn differentiate(&self, _: &[Placement<f64>], _: &[f64], to: &mut LocalJacobian) -> bool {
        // There are at most as many entries as rows and joints.
        to.set_diagonal([2.0; 5]);
        to.joint_mut(1)[0] = 5.0;
        true
    }
}

#[test]
fn entries_next_to_a_diagonal_are_added() {
    let (model, joints) = hinges();
    for (rows, expected) in [(1, vec![2.0, 5.0]), (2, vec![2.0, 5.0, 0.0, 2.0])] {
        let mut tasks = Problem::builder(&model);
        let task = Task::new(DiagonalAndMore { joints, rows });
        tasks.add(task.weight(Quantity::JointUnits, 1.0));
        let problem = tasks.build().unwrap();
        let mut scratch = problem.scratch();
        let mut evaluation = Evaluation::new(&problem, &mut scratch);
        let mut jacobian = DMatrix::zeros(rows, 2);
        evaluation.jacobian(&[0.1, 0.2], &mut jacobian);
        assert_eq!(jacobian, DMatrix::from_row_slice(rows, 2, &expected));
    }
}
