//! Manipulability task: a frame keeps a distance from singularities.

use super::bounded::beyond;
use super::residual::error_if;
use super::{
    Description, Extensions, Inequality, InequalityResidual, Inputs, Quantity, Residual, Role,
    RowBlock,
};
use kinopt_kinematics::model::{FrameId, JointId, JointKind, Model};
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Matrix3, Placement, Quaternion, Vector3};

/// r = max(0, 1 − w/w₀), with w = √det(J Jᵀ): Yoshikawa's measure (1985, "Manipulability of robotic mechanisms").
///
/// J is the Jacobian of a frame relative to a base, by the joints between them. One row, a ratio: 0 if the measure is
/// at least w₀, 1 at a singularity. A soft task by default; a required task needs a tolerance.
///
/// Every joint between base and frame counts separately, mimic joints included. The derivatives are exact. At a
/// singularity w has a kink, and the derivatives are set to 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Manipulability {
    /// The chain from the common ancestor to the base, then the chain to the frame.
    chains: [Vec<ChainJoint>; 2],
    /// The moving joints, in the order of the chains.
    joints: Vec<JointId>,
    values: usize,
    frame: Placement<f64>,
    motions: Motions,
    min_measure: f64,
}

/// The motions of the frame that count.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motions {
    All,
    Linear,
    Angular,
}

/// A joint of a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ChainJoint {
    parent_from_joint: Placement<f64>,
    kind: JointKind,
    axis: Vector3<f64>,
}

impl Manipulability {
    /// A task for a measure of at least `min_measure`, above 0, of `frame` relative to `base` (`None`: the world).
    ///
    /// The unit is metres³ for all six motions, the default. A frame id that is not in the model is an error when the
    /// problem is built, because no joint moves it.
    #[must_use]
    pub fn new(model: &Model, base: Option<FrameId>, frame: FrameId, min_measure: f64) -> Self {
        let path = model.path(base, frame);
        let mut up = path.up;
        up.reverse();
        let is_moving = |id: &&JointId| model.joints()[id.index()].kind.moves();
        let joints: Vec<JointId> = up
            .iter()
            .chain(&path.down)
            .filter(is_moving)
            .copied()
            .collect();
        let joint = |id: &JointId| &model.joints()[id.index()];
        let chain_joint = |id: &JointId| ChainJoint {
            parent_from_joint: joint(id).parent_from_joint,
            kind: joint(id).kind,
            axis: joint(id).axis,
        };
        let values = joints.iter().map(|id| joint(id).kind.coordinates()).sum();
        let frame_data = model.frames().get(frame.index());
        let mut chains: [Vec<ChainJoint>; 2] =
            [up, path.down].map(|ids| ids.iter().map(chain_joint).collect());
        if let [[], [first, ..]] | [[first, ..], []] = chains.each_mut().map(Vec::as_mut_slice) {
            // The measure does not depend on the start of a single chain; near the origin fewer digits are lost.
            first.parent_from_joint = Placement::identity();
        }
        Self {
            chains,
            joints,
            values,
            frame: frame_data.map_or_else(Placement::identity, |frame| frame.joint_from_frame),
            motions: Motions::All,
            min_measure,
        }
    }

    /// Counts only the linear velocity of the frame's origin: 3 rows of J, metres³ for arms.
    #[must_use]
    pub fn of_position(mut self) -> Self {
        self.motions = Motions::Linear;
        self
    }

    /// Counts only the angular velocity of the frame: 3 rows of J, without unit.
    #[must_use]
    pub fn of_orientation(mut self) -> Self {
        self.motions = Motions::Angular;
        self
    }

    /// Sets the smallest measure with residual zero.
    pub fn set_least(&mut self, min_measure: f64) {
        self.min_measure = min_measure;
    }

    /// The measure at the values of the joints that the residual reads.
    fn measure<S: Scalar>(&self, values: &[S]) -> S {
        let mut sums = MotionSums::zero();
        let mut values_left = values;
        let mut end = Placement::identity();
        for chain in &self.chains {
            end = Placement::identity();
            for chain_joint in chain {
                let (joint_values, remaining) =
                    values_left.split_at(chain_joint.kind.coordinates());
                end = sums.add_joint(
                    end * Placement::constant(&chain_joint.parent_from_joint),
                    chain_joint,
                    joint_values,
                );
                values_left = remaining;
            }
        }
        let point = (end * Placement::constant(&self.frame)).translation;
        let squared = match self.motions {
            Motions::All => sums.determinant_of_all(),
            Motions::Linear => determinant(&sums.linear_at(point)),
            Motions::Angular => determinant(&sums.angular),
        };
        let is_singular = squared.less_than(S::constant(f64::MIN_POSITIVE));
        let root = S::select(is_singular, S::one(), squared).sqrt();
        S::select(is_singular, S::zero(), root)
    }
}

/// Sums over the joints of (ω, v)(ω, v)ᵀ.
///
/// ω is the angular velocity of the joint's motion; v is the velocity of the moved body's point at the origin.
struct MotionSums<S> {
    angular: Matrix3<S>,
    /// v ωᵀ.
    mixed: Matrix3<S>,
    linear: Matrix3<S>,
}

impl<S: Scalar> MotionSums<S> {
    fn zero() -> Self {
        let zero = || {
            Matrix3::constant(Matrix3::from_columns(
                Vector3::zero(),
                Vector3::zero(),
                Vector3::zero(),
            ))
        };
        Self {
            angular: zero(),
            mixed: zero(),
            linear: zero(),
        }
    }

    fn add(&mut self, linear: Vector3<S>, angular: Vector3<S>) {
        add_product(&mut self.angular, angular, angular);
        add_product(&mut self.mixed, linear, angular);
        add_product(&mut self.linear, linear, linear);
    }

    /// Adds a joint with the placement `joint` at value zero; returns its placement after its motion.
    fn add_joint(
        &mut self,
        joint: Placement<S>,
        chain_joint: &ChainJoint,
        values: &[S],
    ) -> Placement<S> {
        let Placement {
            rotation,
            translation,
        } = joint;
        let axis = rotation * Vector3::constant(chain_joint.axis);
        match *values {
            [value] if chain_joint.kind.slides() => {
                self.add(axis, Vector3::zero());
                Placement::new(rotation, axis.mul_add(value, translation))
            }
            [value] => {
                self.add(translation.cross(axis), axis);
                let joint_rotation =
                    Matrix3::rotation(Vector3::constant(chain_joint.axis), value.sin_cos());
                Placement::new(rotation * joint_rotation, translation)
            }
            [w, x, y, z] => {
                for axis in [rotation.x, rotation.y, rotation.z] {
                    self.add(translation.cross(axis), axis);
                }
                let v = Vector3::new(x, y, z);
                let moved_rotation = rotation * Quaternion { w, v }.to_matrix();
                Placement::new(moved_rotation, translation)
            }
            // A fixed joint.
            _ => joint,
        }
    }

    /// The sum for the velocities of a point: v + ω × point for each joint.
    fn linear_at(&self, point: Vector3<S>) -> Matrix3<S> {
        // Σ (v + K ω)(v + K ω)ᵀ with K ω = ω × x.
        let cross_point = |v: Vector3<S>| v.cross(point);
        let columns = |m: Matrix3<S>| [m.x, m.y, m.z];
        let cross_columns = |m: Matrix3<S>| {
            let [x, y, z] = columns(m).map(cross_point);
            Matrix3::from_columns(x, y, z)
        };
        // K ω vᵀ, and K (ω ωᵀ) Kᵀ.
        let mixed_term = cross_columns(self.mixed.transpose());
        let angular_term = cross_columns(cross_columns(self.angular).transpose());
        let mut sum = self.linear;
        for other in [mixed_term, mixed_term.transpose(), angular_term] {
            sum = Matrix3::from_columns(sum.x + other.x, sum.y + other.y, sum.z + other.z);
        }
        sum
    }

    /// det(J Jᵀ) of all six rows; independent of the point, because a shift of the point shears J.
    fn determinant_of_all(&self) -> S {
        let Self {
            angular,
            mixed,
            linear,
        } = self;
        let (angular_columns, linear_columns) = (
            [angular.x, angular.y, angular.z],
            [linear.x, linear.y, linear.z],
        );
        let mixed_columns = [mixed.x, mixed.y, mixed.z];
        let transposed = mixed.transpose();
        let mixed_transposed = [transposed.x, transposed.y, transposed.z];
        let mut columns = [[S::zero(); 6]; 6];
        for k in 0..3 {
            columns[k][..3].copy_from_slice(&angular_columns[k].to_array());
            columns[k][3..].copy_from_slice(&mixed_columns[k].to_array());
            columns[3 + k][..3].copy_from_slice(&mixed_transposed[k].to_array());
            columns[3 + k][3..].copy_from_slice(&linear_columns[k].to_array());
        }
        determinant_by_pivots(columns)
    }
}

fn add_product<S: Scalar>(sum: &mut Matrix3<S>, a: Vector3<S>, b: Vector3<S>) {
    sum.x = a.mul_add(b.x, sum.x);
    sum.y = a.mul_add(b.y, sum.y);
    sum.z = a.mul_add(b.z, sum.z);
}

fn determinant<S: Scalar>(m: &Matrix3<S>) -> S {
    m.x.dot(m.y.cross(m.z))
}

/// Determinant of a positive semidefinite matrix by its pivots, largest first; zero if a pivot is not positive.
///
/// Source: Golub & Van Loan 2013, "Matrix Computations", section 4.2.8.
fn determinant_by_pivots<S: Scalar>(mut m: [[S; 6]; 6]) -> S {
    let mut product = S::one();
    for k in 0..6 {
        let value = |i: usize| m[i][i].as_f64().unwrap_or(f64::NAN);
        let largest = (k..6).fold(k, |best, i| if value(i) > value(best) { i } else { best });
        m.swap(k, largest);
        for row in &mut m {
            row.swap(k, largest);
        }
        let pivot = m[k][k];
        // NaN for SIMD lanes, which no problem uses.
        match pivot.as_f64() {
            Some(value) if value <= 0.0 => return S::zero(),
            None => return S::constant(f64::NAN),
            Some(_) => {}
        }
        product *= pivot;
        let (pivot_rows, below) = m.split_at_mut(k + 1);
        for row in below {
            let factor = row[k] / pivot;
            for (entry, &pivot_entry) in row.iter_mut().zip(&pivot_rows[k]).skip(k + 1) {
                *entry -= factor * pivot_entry;
            }
        }
    }
    product
}

impl Residual for Manipulability {
    const ROLE: Role = Role::Preference;

    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_inequalities();

    fn inputs(&self) -> Inputs {
        Inputs::joints(self.joints.clone()).with_joint_values(self.values)
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Ratio, 1)]
    }

    fn evaluate<S: Scalar>(&self, _frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        let missing = S::one() - self.measure(joints) * S::constant(1.0 / self.min_measure);
        residual[0] = beyond(missing, f64::NEG_INFINITY, 0.0);
    }

    fn description(&self) -> Description {
        Description::new("manipulability").with_validity(self.validate())
    }
}

impl Manipulability {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        let required = if self.motions == Motions::All { 6 } else { 3 };
        let chain_joints = self.chains.iter().flatten();
        let freedom: usize = chain_joints
            .map(|chain_joint| chain_joint.kind.degrees_of_freedom())
            .sum();
        error_if(freedom < required, || {
            format!(
                "its {freedom} degrees of freedom cannot move the frame along all {required} directions"
            )
        })?;
        let min_measure = self.min_measure;
        error_if(!(min_measure > 0.0 && min_measure.is_finite()), || {
            format!("its least measure {min_measure} is not a number above 0")
        })
    }
}

impl InequalityResidual for Manipulability {
    fn inequalities(&self) -> Vec<Inequality> {
        vec![Inequality::new(0..1, 1)]
    }

    fn slacks<S: Scalar>(&self, _frames: &[Placement<S>], joints: &[S], slacks: &mut [S]) {
        slacks[0] = self.measure(joints) * S::constant(1.0 / self.min_measure) - S::one();
    }
}
