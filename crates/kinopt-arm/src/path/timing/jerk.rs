//! Speed profile along a curve under velocity, acceleration and jerk limits.
//!
//! The curve parameter is eased at both ends ([`SmoothstepEasing`]). The squared speed z = σ̇² of the eased parameter σ is a
//! quadratic spline over σ, so accelerations are continuous. With w = z′ / 2, joints move with velocity q′ √z and
//! acceleration q′ w + q″ z. Their jerk is √z (q‴ z + 3 q″ w + q′ w′). Minimising the time is convex except for the
//! jerk limits.
//!
//! A primal interior-point method minimises τ · time − Σ log(slack) for increasing τ by Gauss-Newton steps (Nocedal &
//! Wright 2006, "Numerical optimization", ch. 19.6). The Hessian has five diagonals. Limits are sampled in every cell.
//! A denser check then slows the whole curve by the remaining excess. The result may be some thousandths slower than a
//! local optimum.

use super::cell::GridCell;
use super::cubic_curve::CubicCurve;
use super::easing::SmoothstepEasing;
use super::tool_motion::{ToolLimits, rates};
use crate::arm::{Arm, QueryError};
use kinopt_kinematics::scalar::elementary::{cbrt, ln};

/// Limits of joints and tool.
#[derive(Clone, Copy)]
pub(super) struct JerkLimits<'a> {
    pub(super) velocity: &'a [f64],
    pub(super) acceleration: &'a [f64],
    pub(super) jerk: &'a [f64],
    pub(super) tool: Option<(&'a Arm, ToolLimits)>,
}

/// Minimum number of cells per interval between knots.
const MIN_CELLS: usize = 4;
/// Points within a cell at which limits are imposed, with the weights of Simpson's rule.
const CONSTRAINT_POINTS: [(f64, f64); 3] = [(0.0, 1.0 / 6.0), (0.5, 4.0 / 6.0), (1.0, 1.0 / 6.0)];
/// Number of parts of a cell at whose ends the result is checked.
const CHECK_PARTS: usize = 6;
/// First and last weight τ of the time, in units of the reciprocal time, and the factor between successive weights.
const FIRST_WEIGHT: f64 = 3.0;
const LAST_WEIGHT: f64 = 1e4;
const WEIGHT_FACTOR: f64 = 6.0;
/// Maximum number of Newton steps for each weight, and the predicted decrease at which they end.
const MAX_STEPS: usize = 60;
const MIN_DECREASE: f64 = 1e-3;
/// Maximum number of halvings of a step.
const MAX_HALVINGS: usize = 40;
/// Fraction of the limits that the initial profile uses.
const START_LIMIT_FRACTION: f64 = 0.5;
/// Relative margin of the last check.
const CHECK_MARGIN: f64 = 1e-5;
/// Product of slacks below which its logarithm is taken, to avoid underflow.
const SMALL_PRODUCT: f64 = 1e-200;

/// Joint derivatives by σ at one point, and the spline basis there.
struct SplineSample {
    /// Curve parameter, and its first two derivatives by σ.
    eased: [f64; 3],
    /// Weight of the point in integrals over σ.
    weight: f64,
    cell: usize,
    /// z, w and w′ as linear functions of the cell's three coefficients.
    basis: [[f64; 3]; 3],
    /// First, second and third derivatives of each joint by σ.
    joints: Vec<[f64; 3]>,
    /// Half-planes a w + b z ≤ c of the tool's acceleration limits.
    half_planes: Vec<[f64; 3]>,
    /// Largest z by the velocity limits.
    largest: f64,
}

/// Curve over the eased parameter, divided into cells.
struct Cells<'a> {
    curve: &'a CubicCurve,
    easing: &'a SmoothstepEasing,
    nodes: Vec<f64>,
    limits: JerkLimits<'a>,
}

/// Returns the cells of the fastest motion along a curve over the eased parameter, from rest to rest.
pub(super) fn cells(
    curve: &CubicCurve,
    easing: &SmoothstepEasing,
    count: usize,
    limits: JerkLimits<'_>,
) -> Result<Vec<GridCell>, QueryError> {
    let cells = Cells {
        curve,
        easing,
        nodes: nodes(curve, easing, count),
        limits,
    };
    let samples = cells.samples(&CONSTRAINT_POINTS)?;
    let mut barrier = JerkBarrier {
        samples: &samples,
        limits,
        whole: easing.end(),
        weight: 0.0,
    };
    let start = START_LIMIT_FRACTION * cells.max_constant_z(&samples);
    let mut z = vec![start; cells.count() + 2];
    let mut newton = Newton::default();
    let mut weight = FIRST_WEIGHT;
    loop {
        barrier.weight = weight / barrier.time(&z);
        for _ in 0..MAX_STEPS {
            if newton.step(&barrier, &mut z) < MIN_DECREASE {
                break;
            }
        }
        if weight >= LAST_WEIGHT {
            break;
        }
        weight = (WEIGHT_FACTOR * weight).min(LAST_WEIGHT);
    }
    let fractions: Vec<(f64, f64)> = (0..=CHECK_PARTS)
        .map(|k| (k as f64 / CHECK_PARTS as f64, 0.0))
        .collect();
    let slowdown = cells.required_slowdown(&cells.samples(&fractions)?, &z);
    z.iter_mut().for_each(|z| *z /= slowdown * slowdown);
    Ok(cells.timed(&z))
}

/// Returns the bounds of the cells in the eased parameter: the curve's knots, the ends of the ramps, and points in
/// between.
fn nodes(curve: &CubicCurve, easing: &SmoothstepEasing, count: usize) -> Vec<f64> {
    let knots = curve.knots.iter().map(|s| easing.parameter(*s));
    let mut bounds: Vec<f64> = knots.chain(easing.ramp_ends()).collect();
    bounds.sort_by(f64::total_cmp);
    let margin = 1e-9 * easing.end();
    bounds.dedup_by(|later, earlier| *later - *earlier <= margin);
    if let Some(last) = bounds.last_mut() {
        *last = easing.end();
    }
    let longest = easing.end() / count as f64;
    let mut nodes = Vec::new();
    for pair in bounds.windows(2) {
        let length = pair[1] - pair[0];
        let parts = ((length / longest).ceil() as usize).max(MIN_CELLS);
        nodes.extend((0..parts).map(|k| pair[0] + length * (k as f64 / parts as f64)));
    }
    nodes.push(easing.end());
    nodes
}

/// Returns z, w and w′ for three coefficients.
fn spline_values(basis: &[[f64; 3]; 3], z: &[f64]) -> [f64; 3] {
    basis.map(|row| row[0] * z[0] + row[1] * z[1] + row[2] * z[2])
}

impl Cells<'_> {
    fn count(&self) -> usize {
        self.nodes.len() - 1
    }

    fn step(&self, cell: usize) -> f64 {
        self.nodes[cell + 1] - self.nodes[cell]
    }

    /// Returns the basis of z, w and w′ at a fraction of a cell, for its three coefficients.
    fn basis(&self, cell: usize, fraction: f64) -> [[f64; 3]; 3] {
        let step = self.step(cell);
        let before = cell.checked_sub(1).map_or(0.0, |cell| self.step(cell));
        let after = match cell + 1 < self.count() {
            true => self.step(cell + 1),
            false => 0.0,
        };
        let (first, last) = (step / (before + step), step / (step + after));
        let remaining = 1.0 - fraction;
        let values = [first * remaining * remaining, last * fraction * fraction];
        let slopes = [
            -2.0 * first * remaining / step,
            2.0 * last * fraction / step,
        ];
        let bends = [2.0 * first / (step * step), 2.0 * last / (step * step)];
        [
            [values[0], 1.0 - values[0] - values[1], values[1]],
            [slopes[0], -slopes[0] - slopes[1], slopes[1]].map(|entry| 0.5 * entry),
            [bends[0], -bends[0] - bends[1], bends[1]].map(|entry| 0.5 * entry),
        ]
    }

    /// Returns points at fractions of every cell, with their weights.
    fn samples(&self, fractions: &[(f64, f64)]) -> Result<Vec<SplineSample>, QueryError> {
        let mut samples = Vec::with_capacity(fractions.len() * self.count());
        for cell in 0..self.count() {
            samples.extend(fractions.iter().map(|(fraction, weight)| SplineSample {
                weight: weight * self.step(cell),
                ..self.sample(cell, *fraction)
            }));
        }
        if let Some((arm, limits)) = self.limits.tool {
            let points = samples.iter().map(|sample| sample.eased[0]);
            let rates = rates(arm, self.curve, points)?;
            for (sample, rate) in samples.iter_mut().zip(rates) {
                let [_, first, second] = sample.eased;
                let rate = rate.eased(first, second);
                sample.largest = sample.largest.min(rate.largest_squared_speed(limits));
                let push = |half_plane| sample.half_planes.push(half_plane);
                rate.half_planes(limits, 0.0, push);
            }
        }
        Ok(samples)
    }

    fn sample(&self, cell: usize, fraction: f64) -> SplineSample {
        let parameter = |fraction: f64| self.nodes[cell] + self.step(cell) * fraction;
        // The third derivative is one-sided, so it is evaluated inside the cell.
        let [inside, .., third] = self
            .easing
            .derivatives(parameter(fraction.clamp(1e-6, 1.0 - 1e-6)));
        let [s, first, second, _] = self.easing.derivatives(parameter(fraction));
        let jets = self.curve.jets(self.curve.piece(inside), s);
        let joints: Vec<[f64; 3]> = jets
            .map(|jet| {
                let square = first * first;
                [
                    jet.first * first,
                    jet.second * square + jet.first * second,
                    jet.third * square * first
                        + 3.0 * jet.second * first * second
                        + jet.first * third,
                ]
            })
            .collect();
        let ratios = joints.iter().zip(self.limits.velocity);
        let ratios = ratios.map(|(joint, limit)| limit / joint[0].abs());
        let fastest = ratios.fold(f64::INFINITY, f64::min);
        SplineSample {
            eased: [s, first, second],
            weight: 0.0,
            cell,
            basis: self.basis(cell, fraction),
            joints,
            half_planes: Vec::new(),
            largest: fastest * fastest,
        }
    }

    /// Returns the largest constant z within all limits.
    fn max_constant_z(&self, samples: &[SplineSample]) -> f64 {
        let limits = self.limits;
        let mut max_z = f64::MAX;
        for sample in samples {
            max_z = max_z.min(sample.largest);
            for (joint, [_, second, third]) in sample.joints.iter().enumerate() {
                max_z = max_z.min(limits.acceleration[joint] / second.abs());
                let root = cbrt(limits.jerk[joint] / third.abs());
                max_z = max_z.min(root * root);
            }
            for [_, b, c] in &sample.half_planes {
                if *b > 0.0 {
                    max_z = max_z.min(c / b);
                }
            }
        }
        max_z
    }

    /// Returns the factor, at least 1, by which time must be stretched to satisfy all limits. `samples` are those of
    /// the last check.
    fn required_slowdown(&self, samples: &[SplineSample], z: &[f64]) -> f64 {
        let limits = self.limits;
        let mut max_factor = 1.0_f64;
        for cell in samples.chunks_exact(CHECK_PARTS + 1) {
            let motion = |sample: &SplineSample| {
                spline_values(&sample.basis, &z[sample.cell..sample.cell + 3])
            };
            let mut include = |ratio: &dyn Fn(&SplineSample) -> f64, root: fn(f64) -> f64| {
                max_factor = max_factor.max(root(largest(cell.iter().map(ratio))));
            };
            include(&|sample| motion(sample)[0] / sample.largest, f64::sqrt);
            for joint in 0..limits.velocity.len() {
                let acceleration = |sample: &SplineSample| {
                    let ([z, w, _], [first, second, _]) = (motion(sample), sample.joints[joint]);
                    (first * w + second * z) / limits.acceleration[joint]
                };
                include(&acceleration, f64::sqrt);
                let jerk = |sample: &SplineSample| {
                    let ([z, w, bend], [first, second, third]) =
                        (motion(sample), sample.joints[joint]);
                    let part = third * z + 3.0 * second * w + first * bend;
                    z.max(0.0).sqrt() * part / limits.jerk[joint]
                };
                include(&jerk, cbrt);
            }
            for k in 0..cell[0].half_planes.len() {
                let acceleration = |sample: &SplineSample| {
                    let ([z, w, _], [a, b, c]) = (motion(sample), sample.half_planes[k]);
                    ((a * w + b * z) / c).max(0.0)
                };
                include(&acceleration, f64::sqrt);
            }
        }
        max_factor * (1.0 + CHECK_MARGIN)
    }

    /// Returns the cells with their start times.
    fn timed(&self, z: &[f64]) -> Vec<GridCell> {
        let mut time = 0.0;
        let cells = (0..self.count()).map(|index| {
            let [z, acceleration, slope] =
                spline_values(&self.basis(index, 0.0), &z[index..index + 3]);
            let cell = GridCell {
                start: self.nodes[index],
                length: self.step(index),
                speed: z.max(0.0).sqrt(),
                acceleration,
                slope,
                time,
            };
            time += cell.time_to(cell.length);
            cell
        });
        cells.collect()
    }
}

/// Returns a bound on the magnitude of a smooth function from uniform samples.
///
/// It is the largest sample plus an eighth of the largest second difference, which bounds the excess between two
/// samples.
fn largest(samples: impl Iterator<Item = f64>) -> f64 {
    let (mut max, mut bend) = (0.0_f64, 0.0_f64);
    let mut last = [f64::NAN; 2];
    for sample in samples {
        max = max.max(sample.abs());
        // The first two differences are NaN, which `max` ignores.
        bend = bend.max((last[0] - 2.0 * last[1] + sample).abs());
        last = [last[1], sample];
    }
    max + bend / 8.0
}

/// Objective τ · time − Σ log(slack) over the coefficients of z.
struct JerkBarrier<'a> {
    samples: &'a [SplineSample],
    limits: JerkLimits<'a>,
    /// Length of the eased parameter.
    whole: f64,
    /// τ.
    weight: f64,
}

/// Value of the objective at one point, with gradient and Gauss-Newton Hessian by (z, w, w′).
struct Terms {
    value: f64,
    /// Product of slacks whose logarithm is still missing in the value.
    product: f64,
    gradient: [f64; 3],
    hessian: [[f64; 3]; 3],
}

impl Terms {
    /// Adds a term with given derivatives along one direction.
    fn add(&mut self, direction: [f64; 3], first: f64, second: f64) {
        for (row, a) in direction.iter().enumerate() {
            self.gradient[row] += first * a;
            for (column, b) in direction.iter().enumerate() {
                self.hessian[row][column] += second * a * b;
            }
        }
    }

    /// Moves the logarithm of the product into the value.
    fn take_logarithm(&mut self, weight: f64) {
        self.value -= weight * ln(self.product);
        self.product = 1.0;
    }

    /// Adds −weight · log(limit − value), given the value's gradient.
    fn add_barrier(&mut self, value: f64, limit: f64, gradient: [f64; 3], weight: f64) {
        let slack = limit - value;
        if slack <= 0.0 || slack.is_nan() {
            self.value = f64::INFINITY;
            return;
        }
        self.product *= slack / limit;
        if self.product < SMALL_PRODUCT {
            self.take_logarithm(weight);
        }
        self.add(gradient, weight / slack, weight / (slack * slack));
    }
}

impl JerkBarrier<'_> {
    /// Returns the duration of the motion, seconds; infinity if z is not positive.
    fn time(&self, z: &[f64]) -> f64 {
        let times = self.samples.iter().map(|sample| {
            let [z, ..] = spline_values(&sample.basis, &z[sample.cell..sample.cell + 3]);
            match z > 0.0 {
                true => sample.weight / z.sqrt(),
                false => f64::INFINITY,
            }
        });
        times.sum()
    }

    fn value(&self, z: &[f64]) -> f64 {
        // Positive coefficients make the spline positive everywhere, also between the points.
        let mut sum = match z.iter().all(|z| *z > 0.0) {
            true => -z.iter().map(|z| ln(*z)).sum::<f64>() / z.len() as f64,
            false => return f64::INFINITY,
        };
        for sample in self.samples {
            sum += self.terms(sample, z).value;
            if !sum.is_finite() {
                return f64::INFINITY;
            }
        }
        sum
    }

    fn terms(&self, sample: &SplineSample, z: &[f64]) -> Terms {
        let [z, w, bend] = spline_values(&sample.basis, &z[sample.cell..sample.cell + 3]);
        let mut terms = Terms {
            value: 0.0,
            product: 1.0,
            gradient: [0.0; 3],
            hessian: [[0.0; 3]; 3],
        };
        if z <= 0.0 || z.is_nan() {
            terms.value = f64::INFINITY;
            return terms;
        }
        let root = z.sqrt();
        let time = self.weight * sample.weight / root;
        terms.value = time;
        terms.add([1.0, 0.0, 0.0], -0.5 * time / z, 0.75 * time / (z * z));
        let weight = sample.weight / self.whole;
        if sample.largest.is_finite() {
            terms.add_barrier(z, sample.largest, [1.0, 0.0, 0.0], weight);
        }
        for [a, b, c] in &sample.half_planes {
            terms.add_barrier(a * w + b * z, *c, [*b, *a, 0.0], weight);
        }
        let rates = self.limits.acceleration.iter().zip(self.limits.jerk);
        for ([first, second, third], (acceleration, jerk)) in sample.joints.iter().zip(rates) {
            if acceleration.is_finite() {
                let value = first * w + second * z;
                terms.add_barrier(value, *acceleration, [*second, *first, 0.0], weight);
                terms.add_barrier(-value, *acceleration, [-second, -first, 0.0], weight);
            }
            if jerk.is_finite() {
                let part = third * z + 3.0 * second * w + first * bend;
                let gradient = [
                    root * third + 0.5 * part / root,
                    3.0 * root * second,
                    root * first,
                ];
                terms.add_barrier(root * part, *jerk, gradient, weight);
                terms.add_barrier(-root * part, *jerk, gradient.map(|entry| -entry), weight);
            }
        }
        terms.take_logarithm(weight);
        terms
    }
}

/// Newton's method on a Hessian with five diagonals.
#[derive(Default)]
struct Newton {
    /// Diagonal of the Hessian and the two upper diagonals.
    band: Vec<[f64; 3]>,
    gradient: Vec<f64>,
    trial: Vec<f64>,
}

impl Newton {
    /// Moves z to a lower value. Returns the predicted decrease, or 0 if no lower value was found.
    fn step(&mut self, barrier: &JerkBarrier<'_>, z: &mut [f64]) -> f64 {
        self.band.clear();
        self.band.resize(z.len(), [0.0; 3]);
        self.gradient.clear();
        self.gradient.resize(z.len(), 0.0);
        let mut value = 0.0;
        for sample in barrier.samples {
            let terms = barrier.terms(sample, z);
            value += terms.value;
            // Sum over z, w and w′ of a derivative times the basis of one coefficient.
            let project = |row: &[f64; 3], coefficient: usize| {
                let each = row.iter().zip(&sample.basis);
                each.map(|(derivative, basis)| derivative * basis[coefficient])
                    .sum::<f64>()
            };
            for first in 0..3 {
                let index = sample.cell + first;
                self.gradient[index] += project(&terms.gradient, first);
                let column = terms.hessian.each_ref().map(|row| project(row, first));
                let entries = self.band[index].iter_mut().zip(first..3);
                entries.for_each(|(entry, second)| *entry += project(&column, second));
            }
        }
        let weight = (z.len() as f64).recip();
        for ((z, gradient), band) in z.iter().zip(&mut self.gradient).zip(&mut self.band) {
            value -= weight * ln(*z);
            *gradient -= weight / z;
            band[0] += weight / (z * z);
        }
        let gradient = self.gradient.clone();
        self.solve();
        let decrease: f64 = self
            .gradient
            .iter()
            .zip(&gradient)
            .map(|(step, g)| step * g)
            .sum();
        let mut step_scale = 1.0;
        for _ in 0..MAX_HALVINGS {
            self.trial.clear();
            let moved = z
                .iter()
                .zip(&self.gradient)
                .map(|(z, step)| z - step_scale * step);
            self.trial.extend(moved);
            if barrier.value(&self.trial) <= value - 0.1 * step_scale * decrease {
                z.copy_from_slice(&self.trial);
                return decrease;
            }
            step_scale *= 0.5;
        }
        0.0
    }

    /// Solves the banded system for the gradient, in place.
    fn solve(&mut self) {
        let count = self.band.len();
        for k in 0..count {
            let [pivot, next, after] = self.band[k];
            let inverse = (pivot + 1e-12 * pivot + f64::MIN_POSITIVE).recip();
            let [one, two] = [next * inverse, after * inverse];
            if k + 1 < count {
                self.band[k + 1][0] -= one * next;
                self.band[k + 1][1] -= one * after;
                self.gradient[k + 1] -= one * self.gradient[k];
            }
            if k + 2 < count {
                self.band[k + 2][0] -= two * after;
                self.gradient[k + 2] -= two * self.gradient[k];
            }
            self.band[k] = [inverse, one, two];
        }
        for k in (0..count).rev() {
            let [inverse, one, two] = self.band[k];
            let gradient_at = |k: usize| self.gradient.get(k).copied().unwrap_or(0.0);
            self.gradient[k] =
                self.gradient[k] * inverse - one * gradient_at(k + 1) - two * gradient_at(k + 2);
        }
    }
}
