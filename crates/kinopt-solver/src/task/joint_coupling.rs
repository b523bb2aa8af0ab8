//! Linear relation between joints.

use super::residual::{check_finite, error_if, moved_by};
use super::{
    Description, DifferentiableTarget, Extensions, Inputs, LocalJacobian, Quantity, Residual,
    RowBlock,
};
use kinopt_kinematics::model::{JointId, Model};
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::Placement;

/// r = Σ cₖ qₖ − offset: one row, in radians, or in metres if the first joint is prismatic.
///
/// A mimic joint belongs in the [`ParameterMap`](kinopt_kinematics::model::ParameterMap), which holds exactly and saves a variable.
/// This task may be weighted or bounded, and it couples any number of joints.
///
/// ```
/// # use kinopt::model::{Limits, Model};
/// # use kinopt::spatial::{Placement, Vector3};
/// # use kinopt::task::{JointCoupling, Point};
/// # use kinopt::{Problem, Solver};
/// # let mut builder = Model::builder("finger");
/// # let link = Placement::translation([1.0, 0.0, 0.0].into());
/// # let z = Vector3::UNITS[2];
/// # let turns = Limits::new(-2.0, 2.0);
/// # let one = builder.revolute("one", None, Placement::identity(), z, turns);
/// # let two = builder.revolute("two", Some(one), link, z, turns);
/// # let three = builder.revolute("three", Some(two), link, z, turns);
/// # let tip = builder.frame("tip", Some(three), link);
/// # let model = builder.build()?;
/// let mut tasks = Problem::builder(&model);
/// tasks.add(Point::new(tip, [1.0, 1.5, 0.0]));
/// // The last joint bends two thirds as far as the one before it.
/// tasks.add(JointCoupling::new(&model, [(three, 3.0), (two, -2.0)], 0.0));
/// let solution = Solver::default().solve_once(&tasks.build()?, &[0.3; 3])?;
/// assert!(solution.reached, "{}", solution.explain());
/// assert!((3.0 * solution.q[2] - 2.0 * solution.q[1]).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct JointCoupling {
    joints: Vec<JointId>,
    coefficients: Vec<f64>,
    offset: f64,
    quantity: Quantity,
}

impl JointCoupling {
    /// A task that keeps the weighted sum of joints of `model` at `offset`, radians or metres.
    ///
    /// Each joint has a coefficient, in the first joint's unit per unit of the joint. Ball joints are an error when the
    /// problem is built.
    #[must_use]
    pub fn new(
        model: &Model,
        joints: impl IntoIterator<Item = (JointId, f64)>,
        offset: f64,
    ) -> Self {
        let (joints, coefficients): (Vec<_>, Vec<_>) = joints.into_iter().unzip();
        let first = joints.first().and_then(|id| model.joints().get(id.index()));
        let quantity = match first.is_some_and(|joint| joint.kind.slides()) {
            true => Quantity::Metres,
            false => Quantity::Radians,
        };
        Self {
            joints,
            coefficients,
            offset,
            quantity,
        }
    }

    /// Sets the target of the sum, radians or metres.
    pub fn set_offset(&mut self, offset: f64) {
        self.offset = offset;
    }
}

impl Residual for JointCoupling {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_target();

    fn inputs(&self) -> Inputs {
        Inputs::joints(self.joints.clone()).with_joint_values(self.coefficients.len())
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(self.quantity, 1)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.evaluate_moved(frames, joints, &[], residual);
    }

    fn differentiate(&self, _: &[Placement<f64>], _: &[f64], jacobian: &mut LocalJacobian) -> bool {
        for (joint, &coefficient) in self.coefficients.iter().enumerate() {
            jacobian.joint_mut(joint).fill(coefficient);
        }
        true
    }

    fn description(&self) -> Description {
        Description::new("joint coupling").with_validity(self.validate())
    }
}

impl JointCoupling {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        check_finite("its coefficients", self.coefficients.iter().copied())?;
        check_finite("its offset", [self.offset])?;
        let is_zero = self.coefficients.iter().all(|c| *c == 0.0);
        error_if(is_zero, || "it couples no joints".to_owned())
    }
}

impl DifferentiableTarget for JointCoupling {
    fn target_len(&self) -> usize {
        1
    }

    fn evaluate_moved<S: Scalar>(
        &self,
        _frames: &[Placement<S>],
        joints: &[S],
        step: &[S],
        residual: &mut [S],
    ) {
        let terms = joints.iter().zip(&self.coefficients);
        residual[0] = terms.fold(
            -moved_by(self.offset, step),
            |sum, (&value, &coefficient)| value.mul_add(S::constant(coefficient), sum),
        );
    }

    fn has_edges(&self) -> bool {
        false
    }
}
