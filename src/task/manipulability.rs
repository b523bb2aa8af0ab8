//! Manipulability task: a frame keeps a distance from singularities.

use super::bounded::beyond;
use super::residual::refuse;
use super::{Inequality, Quantity, Residual, Role, RowBlock};
use crate::model::{FrameId, JointId, JointKind, Model};
use crate::scalar::Scalar;
use crate::spatial::{Matrix3, Placement, Quaternion, Vector3};

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
    ways: [Vec<Hinge>; 2],
    /// The moving joints, in the order of the chains.
    joints: Vec<JointId>,
    values: usize,
    frame: Placement<f64>,
    of: Motions,
    least: f64,
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
struct Hinge {
    parent_from_joint: Placement<f64>,
    kind: JointKind,
    axis: Vector3<f64>,
}

impl Manipulability {
    /// A task for a measure of at least `least`, above 0, of `frame` relative to `base` (`None`: the world).
    ///
    /// The unit is metres³ for all six motions, the default. A frame id that is not in the model is an error when the
    /// problem is built, because no joint moves it.
    #[must_use]
    pub fn new(model: &Model, base: Option<FrameId>, frame: FrameId, least: f64) -> Self {
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
        let own = |id: &JointId| &model.joints()[id.index()];
        let hinge = |id: &JointId| Hinge {
            parent_from_joint: own(id).parent_from_joint,
            kind: own(id).kind,
            axis: own(id).axis,
        };
        let values = joints.iter().map(|id| own(id).kind.coordinates()).sum();
        let placed = model.frames().get(frame.index());
        let mut ways: [Vec<Hinge>; 2] = [up, path.down].map(|way| way.iter().map(hinge).collect());
        if let [[], [first, ..]] | [[first, ..], []] = ways.each_mut().map(Vec::as_mut_slice) {
            // The measure does not depend on the start of a single chain; near the origin fewer digits are lost.
            first.parent_from_joint = Placement::identity();
        }
        Self {
            ways,
            joints,
            values,
            frame: placed.map_or_else(Placement::identity, |frame| frame.joint_from_frame),
            of: Motions::All,
            least,
        }
    }

    setters! {
        /// Counts only the linear velocity of the frame's origin: 3 rows of J, metres³ for arms.
        pub fn of_position(mut self) { self.of = Motions::Linear }
        /// Counts only the angular velocity of the frame: 3 rows of J, without unit.
        pub fn of_orientation(mut self) { self.of = Motions::Angular }
    }

    /// Sets the smallest measure with residual zero.
    pub fn set_least(&mut self, least: f64) {
        self.least = least;
    }

    /// The measure at the values of the joints that the residual reads.
    fn measure<S: Scalar>(&self, values: &[S]) -> S {
        let mut sums = Sums::zero();
        let mut rest = values;
        let mut end = Placement::identity();
        for way in &self.ways {
            end = Placement::identity();
            for hinge in way {
                let (own, others) = rest.split_at(hinge.kind.coordinates());
                end = sums.pass(
                    end * Placement::constant(&hinge.parent_from_joint),
                    hinge,
                    own,
                );
                rest = others;
            }
        }
        let at = (end * Placement::constant(&self.frame)).translation;
        let squared = match self.of {
            Motions::All => sums.determinant_of_all(),
            Motions::Linear => determinant(&sums.linear_at(at)),
            Motions::Angular => determinant(&sums.angular),
        };
        let singular = squared.less_than(S::constant(f64::MIN_POSITIVE));
        let root = S::select(singular, S::one(), squared).sqrt();
        S::select(singular, S::zero(), root)
    }
}

/// Sums over the joints of (ω, v)(ω, v)ᵀ.
///
/// ω is the angular velocity of the joint's motion; v is the velocity of the moved body's point at the origin.
struct Sums<S> {
    angular: Matrix3<S>,
    /// v ωᵀ.
    mixed: Matrix3<S>,
    linear: Matrix3<S>,
}

impl<S: Scalar> Sums<S> {
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
    fn pass(&mut self, joint: Placement<S>, hinge: &Hinge, values: &[S]) -> Placement<S> {
        let Placement {
            rotation,
            translation,
        } = joint;
        let axis = rotation * Vector3::constant(hinge.axis);
        match *values {
            [value] if hinge.kind.slides() => {
                self.add(axis, Vector3::zero());
                Placement::new(rotation, axis.mul_add(value, translation))
            }
            [value] => {
                self.add(translation.cross(axis), axis);
                let turn = Matrix3::rotation(Vector3::constant(hinge.axis), value.sin_cos());
                Placement::new(rotation * turn, translation)
            }
            [w, x, y, z] => {
                for axis in [rotation.x, rotation.y, rotation.z] {
                    self.add(translation.cross(axis), axis);
                }
                let v = Vector3::new(x, y, z);
                let turned = rotation * Quaternion { w, v }.to_matrix();
                Placement::new(turned, translation)
            }
            // A fixed joint.
            _ => joint,
        }
    }

    /// The sum for the velocities of a point at `at`: v + ω × at for each joint.
    fn linear_at(&self, at: Vector3<S>) -> Matrix3<S> {
        // Σ (v + K ω)(v + K ω)ᵀ with K ω = ω × x.
        let across = |v: Vector3<S>| v.cross(at);
        let columns = |m: Matrix3<S>| [m.x, m.y, m.z];
        let crossed = |m: Matrix3<S>| {
            let [x, y, z] = columns(m).map(across);
            Matrix3::from_columns(x, y, z)
        };
        // K ω vᵀ, and K (ω ωᵀ) Kᵀ.
        let turned = crossed(self.mixed.transpose());
        let twice = crossed(crossed(self.angular).transpose());
        let mut sum = self.linear;
        for other in [turned, turned.transpose(), twice] {
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
        let (top, left) = (
            [angular.x, angular.y, angular.z],
            [linear.x, linear.y, linear.z],
        );
        let across = [mixed.x, mixed.y, mixed.z];
        let transposed = mixed.transpose();
        let across_transposed = [transposed.x, transposed.y, transposed.z];
        let mut columns = [[S::zero(); 6]; 6];
        for k in 0..3 {
            columns[k][..3].copy_from_slice(&top[k].to_array());
            columns[k][3..].copy_from_slice(&across[k].to_array());
            columns[3 + k][..3].copy_from_slice(&across_transposed[k].to_array());
            columns[3 + k][3..].copy_from_slice(&left[k].to_array());
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
        let largest = (k..6).fold(k, |most, i| if value(i) > value(most) { i } else { most });
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
        let (above, below) = m.split_at_mut(k + 1);
        for row in below {
            let factor = row[k] / pivot;
            for (entry, &own) in row.iter_mut().zip(&above[k]).skip(k + 1) {
                *entry -= factor * own;
            }
        }
    }
    product
}

impl Residual for Manipulability {
    const ROLE: Role = Role::Preference;

    answers! {
        fn kind(&self) -> &'static str = "manipulability";
        fn frames(&self) -> Vec<FrameId> = Vec::new();
        fn joints(&self) -> Vec<JointId> = self.joints.clone();
        fn joint_values(&self) -> Option<usize> = Some(self.values);
        fn rows(&self) -> Vec<RowBlock> = vec![RowBlock::new(Quantity::Ratio, 1)];
        fn inequalities(&self) -> Vec<Inequality> = vec![Inequality::new(0..1, 1)];
    }

    fn evaluate<S: Scalar>(&self, _frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        let missing = S::one() - self.measure(joints) * S::constant(1.0 / self.least);
        residual[0] = beyond(missing, f64::NEG_INFINITY, 0.0);
    }

    fn slacks<S: Scalar>(&self, _frames: &[Placement<S>], joints: &[S], slacks: &mut [S]) {
        slacks[0] = self.measure(joints) * S::constant(1.0 / self.least) - S::one();
    }

    fn validate(&self) -> Result<(), String> {
        let needed = if self.of == Motions::All { 6 } else { 3 };
        let hinges = self.ways.iter().flatten();
        let freedom: usize = hinges.map(|hinge| hinge.kind.degrees_of_freedom()).sum();
        refuse(freedom < needed, || {
            format!(
                "its {freedom} degrees of freedom cannot move the frame along all {needed} directions"
            )
        })?;
        let least = self.least;
        refuse(!(least > 0.0 && least.is_finite()), || {
            format!("its least measure {least} is not a number above 0")
        })
    }
}
