//! Tests of an affine form of the distances between arm and target: exclusion of a box, and smaller bounds of its
//! joints.

use kinopt_kinematics::spatial::Vector3;

use super::affine_form::{AffineForm, MAX_POINTS, PointVectors};
use super::joint_box::MAX_JOINTS;

/// Sweeps of coordinate descent for the smallest distance of the linear part.
const SWEEPS: usize = 6;
/// Sweep after which exclusion is tested for the first time; most boxes need no more.
const FIRST_TEST: usize = 2;
/// Regularisation of the inverse, relative to the squares of the remainders: factor by which a box should shrink at
/// least for a joint to be determined by the linear part.
const REGULARISATION: f64 = 0.05;
/// Smallest regularisation, relative to the mean of the diagonal.
const MIN_REGULARISATION: f64 = 1e-9;

type JointRow = [f64; MAX_JOINTS];

/// Intervals of the factors δ of all joints, within −1 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factors {
    pub(super) lower: JointRow,
    pub(super) upper: JointRow,
}

/// Linear part of a form with the products that the tests share.
pub(super) struct LinearTest<'a> {
    form: &'a AffineForm,
    joints: usize,
    /// `gram[i][j]`: products of the linear terms of joints i and j.
    gram: [JointRow; MAX_JOINTS],
    /// Products of the linear terms with the centre.
    gradient: JointRow,
}

fn product(a: &PointVectors, b: &PointVectors) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

impl<'a> LinearTest<'a> {
    #[allow(clippy::needless_range_loop, reason = "both triangles of a matrix")]
    pub(super) fn new(form: &'a AffineForm, joints: usize) -> Self {
        let mut gram = [[0.0; MAX_JOINTS]; MAX_JOINTS];
        let mut gradient = [0.0; MAX_JOINTS];
        for i in 0..joints {
            for j in 0..=i {
                gram[i][j] = product(&form.linear[i], &form.linear[j]);
                gram[j][i] = gram[i][j];
            }
            gradient[i] = product(&form.linear[i], &form.centre);
        }
        Self {
            form,
            joints,
            gram,
            gradient,
        }
    }

    /// Returns true if the form is nowhere zero: a direction exists in which its centre exceeds all other terms.
    ///
    /// The direction is the smallest value of the linear part over the box, by coordinate descent. Any direction is
    /// a proof, so that the descent need not converge.
    pub(super) fn excludes(&self) -> bool {
        let mut factors = [0.0; MAX_JOINTS];
        let mut gradient = self.gradient;
        for sweep in 1..=SWEEPS {
            for joint in 0..self.joints {
                let curvature = self.gram[joint][joint];
                if curvature > 0.0 {
                    let factor = factors[joint] - gradient[joint] / curvature;
                    let step = factor.clamp(-1.0, 1.0) - factors[joint];
                    factors[joint] += step;
                    for (gradient, gram) in gradient.iter_mut().zip(&self.gram[joint]) {
                        *gradient += step * gram;
                    }
                }
            }
            if (sweep == FIRST_TEST || sweep == SWEEPS) && self.is_away(&factors) {
                return true;
            }
        }
        false
    }

    /// Returns true if the form is positive along its linear part's value at `factors`.
    fn is_away(&self, factors: &JointRow) -> bool {
        let mut direction = self.form.centre;
        self.add_linear(factors, &mut direction);
        let linear = &self.form.linear[..self.joints];
        let reach: f64 = linear
            .iter()
            .map(|terms| product(&direction, terms).abs())
            .sum();
        let distance = product(&direction, &self.form.centre) - reach;
        distance > 0.0 && distance > self.form.spread_along(&direction)
    }

    fn add_linear(&self, factors: &JointRow, sum: &mut PointVectors) {
        for (factor, terms) in factors[..self.joints].iter().zip(&self.form.linear) {
            for (sum, term) in sum.iter_mut().zip(terms) {
                *sum += *term * *factor;
            }
        }
    }

    /// Bounds of each joint at which the form may be zero; `None` if there are none.
    ///
    /// Multiplied by a row of a regularised pseudo-inverse, the form bounds one joint by the others (interval Newton
    /// step; Neumaier, "Interval Methods for Systems of Equations", 1990).
    pub(super) fn narrowed(&self) -> Option<Factors> {
        let factor = self.factorise();
        let mut bounds = Factors {
            lower: [-1.0; MAX_JOINTS],
            upper: [1.0; MAX_JOINTS],
        };
        for joint in 0..self.joints {
            let row = self.inverse_row(&factor, joint);
            let mut direction = [Vector3::zero(); MAX_POINTS];
            self.add_linear(&row, &mut direction);
            let spread = self.form.spread_along(&direction);
            let mut centre = 0.0;
            let mut coefficient = 0.0;
            let (mut others_lower, mut others_upper) = (0.0, 0.0);
            for other in 0..self.joints {
                centre += row[other] * self.gradient[other];
                let along: f64 = self.gram[other].iter().zip(&row).map(|(g, r)| g * r).sum();
                if other == joint {
                    coefficient = along;
                    continue;
                }
                let ends = [along * bounds.lower[other], along * bounds.upper[other]];
                others_lower += ends[0].min(ends[1]);
                others_upper += ends[0].max(ends[1]);
            }
            // Joints without an effect stay unbounded.
            if coefficient > 1e-12 {
                let lower = (-centre - spread - others_upper) / coefficient;
                let upper = (-centre + spread - others_lower) / coefficient;
                bounds.lower[joint] = bounds.lower[joint].max(lower);
                bounds.upper[joint] = bounds.upper[joint].min(upper);
                if bounds.lower[joint] > bounds.upper[joint] {
                    return None;
                }
            }
        }
        Some(bounds)
    }

    /// Cholesky factor of the regularised Gram matrix.
    fn factorise(&self) -> [JointRow; MAX_JOINTS] {
        let trace: f64 = (0..self.joints).map(|joint| self.gram[joint][joint]).sum();
        let remainders = &self.form.remainder[..self.form.points];
        let squares: f64 = remainders
            .iter()
            .map(|remainder| remainder * remainder)
            .sum();
        let smallest = MIN_REGULARISATION * trace / self.joints as f64;
        let regularisation = smallest
            .max(REGULARISATION * squares)
            .max(f64::MIN_POSITIVE);
        let mut factor = self.gram;
        for i in 0..self.joints {
            factor[i][i] += regularisation;
            for j in 0..=i {
                let dot: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
                let rest = factor[i][j] - dot;
                factor[i][j] = match i == j {
                    true => rest.max(f64::MIN_POSITIVE).sqrt(),
                    false => rest / factor[j][j],
                };
            }
        }
        factor
    }

    /// Row of the inverse of the regularised Gram matrix.
    fn inverse_row(&self, factor: &[JointRow; MAX_JOINTS], joint: usize) -> JointRow {
        let mut row = [0.0; MAX_JOINTS];
        row[joint] = 1.0;
        for i in joint..self.joints {
            let dot: f64 = (joint..i).map(|k| factor[i][k] * row[k]).sum();
            row[i] = (row[i] - dot) / factor[i][i];
        }
        for i in (0..self.joints).rev() {
            let dot: f64 = (i + 1..self.joints).map(|k| factor[k][i] * row[k]).sum();
            row[i] = (row[i] - dot) / factor[i][i];
        }
        row
    }
}
