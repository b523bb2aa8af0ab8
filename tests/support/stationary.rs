//! Solutions to rounding precision by Newton's method on the optimality conditions. All derivatives are finite
//! differences; the only library code is the residuals themselves.

use kinopt::Problem;
use kinopt::model::{JointKind, Limits, Model};
use kinopt::problem::Evaluation;
use kinopt::solver::LeastSquares;
use nalgebra as na;

/// Cone of a ball, in the joint's frame.
#[derive(Clone, Debug)]
pub struct Cone {
    pub axis: na::Vector3<f64>,
    pub about: na::Vector3<f64>,
    pub swing: [f64; 2],
    pub twist: Limits,
}

/// Active limit as a function that is zero on the limit and positive outside.
#[derive(Clone, Debug)]
pub enum Limit {
    Value(usize, f64, f64),
    Edge(usize, Cone),
    Twist(usize, Cone, f64, f64),
}

/// Swing about the two axes and twist of a quaternion w, x, y, z, radians.
fn swing_and_twist(q: &[f64], cone: &Cone) -> [f64; 3] {
    let rotation = na::UnitQuaternion::from_quaternion(na::Quaternion::new(q[0], q[1], q[2], q[3]));
    let (w, along) = (rotation.w, rotation.imag().dot(&cone.axis));
    let twist = 2.0 * along.atan2(w);
    let twist =
        (twist + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
    let axis = na::Unit::new_unchecked(cone.axis);
    let swing = rotation * na::UnitQuaternion::from_axis_angle(&axis, -twist);
    let swing = swing.scaled_axis();
    [
        swing.dot(&cone.about),
        swing.dot(&cone.axis.cross(&cone.about)),
        twist,
    ]
}

impl Limit {
    fn outward(&self, q: &[f64]) -> f64 {
        match self {
            Self::Value(at, end, sign) => sign * (q[*at] - end),
            Self::Edge(at, cone) => {
                let [u, v, _] = swing_and_twist(&q[*at..], cone);
                0.5 * ((u / cone.swing[0]).powi(2) + (v / cone.swing[1]).powi(2) - 1.0)
            }
            Self::Twist(at, cone, end, sign) => sign * (swing_and_twist(&q[*at..], cone)[2] - end),
        }
    }
}

/// Limits at which a configuration is.
pub fn limits_at(model: &Model, q: &[f64], cones: &[(usize, Cone)]) -> Vec<Limit> {
    let mut found = Vec::new();
    for (at, limits) in model.limits().enumerate() {
        let joint = &model.joints()[model.moving_joints()[at].index()];
        if joint.kind == JointKind::Ball {
            continue;
        }
        for (end, sign) in [(limits.lower, -1.0), (limits.upper, 1.0)] {
            if (q[at] - end).abs() < 1e-12 {
                found.push(Limit::Value(at, end, sign));
            }
        }
    }
    for (at, cone) in cones {
        let edge = Limit::Edge(*at, cone.clone());
        if edge.outward(q).abs() < 1e-11 {
            found.push(edge);
        }
        for (end, sign) in [(cone.twist.lower, -1.0), (cone.twist.upper, 1.0)] {
            let twist = Limit::Twist(*at, cone.clone(), end, sign);
            if twist.outward(q).abs() < 1e-11 {
                found.push(twist);
            }
        }
    }
    found
}

/// Optimality conditions of a solution. Some rows are zero and some limits are active. Half the squared sum of the
/// remaining rows is stationary within them.
pub struct Conditions<'a> {
    pub model: &'a Model,
    /// Problem with an identity map, so that its variables are the configuration.
    pub problem: &'a Problem,
    pub constraint_rows: Vec<usize>,
    pub cost_rows: Vec<usize>,
    pub limits: Vec<Limit>,
}

/// Step of fourth-order differences of residuals.
const RESIDUAL_STEP: f64 = 2e-3;
/// Step of second-order differences of the conditions, for an approximate matrix.
const CONDITION_STEP: f64 = 1e-4;

impl Conditions<'_> {
    fn variables(&self, q: &[f64]) -> Vec<f64> {
        let mut x = Vec::new();
        let mut at = 0;
        while at < q.len() {
            let joint = &self.model.joints()[self.model.moving_joints()[at].index()];
            if joint.kind == JointKind::Ball {
                let quaternion = na::Quaternion::new(q[at], q[at + 1], q[at + 2], q[at + 3]);
                let rotation = na::UnitQuaternion::from_quaternion(quaternion);
                x.extend(rotation.scaled_axis().iter());
                at += 4;
            } else {
                x.push(q[at]);
                at += 1;
            }
        }
        x
    }

    /// Rows of the cost, then constraint rows and limits.
    fn values(&self, q: &[f64]) -> (na::DVector<f64>, na::DVector<f64>) {
        let mut scratch = self.problem.scratch();
        let mut r = vec![0.0; self.problem.rows()];
        Evaluation::new(self.problem, &mut scratch).residual(&self.variables(q), &mut r);
        let pulled = self.cost_rows.iter().map(|&row| r[row]);
        let held = self.constraint_rows.iter().map(|&row| r[row]);
        let held = held.chain(self.limits.iter().map(|limit| limit.outward(q)));
        (
            na::DVector::from_iterator(self.cost_rows.len(), pulled),
            na::DVector::from_iterator(self.constraint_rows.len() + self.limits.len(), held),
        )
    }

    pub fn moved(&self, q: &[f64], v: &na::DVector<f64>) -> Vec<f64> {
        let mut to = vec![0.0; q.len()];
        self.model.integrate(q, v.as_slice(), &mut to).unwrap();
        to
    }

    /// Values and their derivatives by the velocity.
    fn values_and_slopes(
        &self,
        q: &[f64],
    ) -> (
        na::DVector<f64>,
        na::DVector<f64>,
        na::DMatrix<f64>,
        na::DMatrix<f64>,
    ) {
        let dof = self.model.degrees_of_freedom();
        let (pulled, held) = self.values(q);
        let mut by_pulled = na::DMatrix::zeros(pulled.len(), dof);
        let mut by_held = na::DMatrix::zeros(held.len(), dof);
        for k in 0..dof {
            for (share, weight) in [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)] {
                let mut v = na::DVector::zeros(dof);
                v[k] = share * RESIDUAL_STEP;
                let (p, h) = self.values(&self.moved(q, &v));
                let weight = weight / (12.0 * RESIDUAL_STEP);
                by_pulled.column_mut(k).axpy(weight, &p, 1.0);
                by_held.column_mut(k).axpy(weight, &h, 1.0);
            }
        }
        (pulled, held, by_pulled, by_held)
    }

    /// Conditions that should be zero for multipliers λ.
    fn conditions(&self, q: &[f64], lambda: &na::DVector<f64>) -> na::DVector<f64> {
        let (pulled, held, by_pulled, by_held) = self.values_and_slopes(q);
        let slope = by_pulled.transpose() * pulled + by_held.transpose() * lambda;
        na::DVector::from_iterator(
            slope.len() + held.len(),
            slope.iter().chain(held.iter()).copied(),
        )
    }

    /// Multipliers of the least residual.
    pub fn multipliers(&self, q: &[f64]) -> na::DVector<f64> {
        let (pulled, held, by_pulled, by_held) = self.values_and_slopes(q);
        if held.is_empty() {
            return held;
        }
        let slope = -(by_pulled.transpose() * pulled);
        by_held
            .transpose()
            .svd(true, true)
            .solve(&slope, 1e-9)
            .unwrap()
    }

    /// Inverse of the conditions' derivative by differences, or a pseudoinverse if constraint rows depend on each
    /// other. None if it is singular beyond that, because several directions are undetermined.
    pub fn newton(&self, q: &[f64], lambda: &na::DVector<f64>) -> na::DMatrix<f64> {
        let dof = self.model.degrees_of_freedom();
        let (_, _, _, by_held) = self.values_and_slopes(q);
        let order = dof + by_held.nrows();
        let mut matrix = na::DMatrix::zeros(order, order);
        for k in 0..dof {
            let mut v = na::DVector::zeros(dof);
            v[k] = CONDITION_STEP;
            let ahead = self.conditions(&self.moved(q, &v), lambda);
            v[k] = -CONDITION_STEP;
            let behind = self.conditions(&self.moved(q, &v), lambda);
            matrix
                .column_mut(k)
                .copy_from(&((ahead - behind) / (2.0 * CONDITION_STEP)));
        }
        matrix
            .view_mut((0, dof), (dof, by_held.nrows()))
            .copy_from(&by_held.transpose());
        matrix.pseudo_inverse(1e-7).unwrap()
    }

    /// Newton iteration with a fixed inverse until all conditions hold. Returns the length of the last step.
    pub fn converge(
        &self,
        q: &mut Vec<f64>,
        lambda: &mut na::DVector<f64>,
        inverse: &na::DMatrix<f64>,
        steps: usize,
    ) -> f64 {
        let dof = self.model.degrees_of_freedom();
        let mut last = f64::INFINITY;
        for _ in 0..steps {
            let step = -(inverse * self.conditions(q, lambda));
            let v = step.rows(0, dof).into_owned();
            *q = self.moved(q, &v);
            *lambda += step.rows(dof, lambda.len());
            last = v.amax();
            if last < 1e-14 {
                break;
            }
        }
        last
    }
}
