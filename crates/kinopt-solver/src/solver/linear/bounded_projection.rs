//! Projection of a point onto a polytope that is given by bounds on linear functions.

use super::dense::{add_scaled, dot};
use super::row_span::RowSpan;
use kinopt_kinematics::buffer::{refill, vacate};

/// Relative rate below which a direction does not change a product.
const NEGLIGIBLE_RATE: f64 = 1e-12;
/// Length of a direction, and size of a multiplier, that count as zero, relative to the length of e.
const NEGLIGIBLE_LENGTH: f64 = 1e-13;

/// Minimises ½‖u + e‖² subject to lower ≤ bᵢ·u ≤ upper for rows bᵢ, from u = 0, which must be feasible.
///
/// The method is a primal active set (Nocedal & Wright 2006, algorithm 16.3), for few numbers and few active bounds.
#[derive(Clone, Debug, Default)]
pub(crate) struct BoundedProjection {
    active: Vec<(usize, f64)>,
    span: RowSpan,
    /// Minimiser u.
    pub(crate) minimiser: Vec<f64>,
    /// Products bᵢ·u at the minimiser.
    pub(crate) products: Vec<f64>,
    direction: Vec<f64>,
    residual: Vec<f64>,
}

impl BoundedProjection {
    /// Reserves memory for this many numbers and rows.
    pub(crate) fn reserve(&mut self, numbers: usize, rows: usize) {
        for (vector, capacity) in [
            (&mut self.minimiser, numbers),
            (&mut self.direction, numbers),
            (&mut self.residual, numbers),
            (&mut self.products, rows),
        ] {
            vacate(vector, capacity);
        }
        vacate(&mut self.active, rows);
        self.span.reserve(numbers, numbers);
    }

    /// Computes the minimiser and returns the decrease of ½‖u + e‖².
    ///
    /// `rows` holds `count` rows of the length of e, in sequence. The last argument returns the largest decrease and
    /// increase of each product.
    pub(crate) fn project(
        &mut self,
        e: &[f64],
        rows: &[f64],
        count: usize,
        max_changes: impl Fn(usize) -> (f64, f64),
    ) -> f64 {
        let k = e.len();
        refill(&mut self.minimiser, k, 0.0);
        refill(&mut self.products, count, 0.0);
        self.active.clear();
        self.span.clear();
        let target_length = dot(e, e).sqrt();
        for _ in 0..4 * (k + count) {
            self.residual.clear();
            let sums = self.minimiser.iter().zip(e).map(|(u, e)| u + e);
            self.residual.extend(sums);
            self.direction.clear();
            self.direction.extend(self.residual.iter().map(|sum| -sum));
            self.span.project_out(&mut self.direction);
            let length = dot(&self.direction, &self.direction).sqrt();
            if length <= NEGLIGIBLE_LENGTH * target_length {
                if !self.release(rows, NEGLIGIBLE_LENGTH * target_length) {
                    break;
                }
                continue;
            }
            let mut fraction = 1.0;
            let mut blocking = None;
            for (i, row) in rows.chunks_exact(k.max(1)).enumerate() {
                let rate = dot(row, &self.direction);
                if rate.abs() <= NEGLIGIBLE_RATE * length * dot(row, row).sqrt()
                    || self.active.iter().any(|active| active.0 == i)
                {
                    continue;
                }
                let (max_decrease, max_increase) = max_changes(i);
                let (remaining, side) = match rate > 0.0 {
                    true => (max_increase - self.products[i], 1.0),
                    false => (max_decrease + self.products[i], -1.0),
                };
                let max_fraction = remaining.max(0.0) / rate.abs();
                if max_fraction < fraction {
                    (fraction, blocking) = (max_fraction, Some((i, side)));
                }
            }
            add_scaled(&mut self.minimiser, fraction, &self.direction);
            for (product, row) in self.products.iter_mut().zip(rows.chunks_exact(k.max(1))) {
                *product = dot(row, &self.minimiser);
            }
            if let Some((i, side)) = blocking {
                let row = &rows[i * k..(i + 1) * k];
                let min_length = NEGLIGIBLE_RATE * dot(row, row).sqrt();
                self.span.add(i, row.iter().copied(), min_length);
                self.active.push((i, side));
            }
        }
        // Products of active rows are exactly at their bounds.
        for &(i, side) in &self.active {
            let (max_decrease, max_increase) = max_changes(i);
            self.products[i] = if side > 0.0 {
                max_increase
            } else {
                -max_decrease
            };
        }
        let squared_distances = self.minimiser.iter().zip(e).map(|(u, e)| (u + e) * (u + e));
        0.5 * (target_length * target_length - squared_distances.sum::<f64>())
    }

    /// Active rows, with +1 for the upper and −1 for the lower bound.
    pub(crate) fn active(&self) -> &[(usize, f64)] {
        &self.active
    }

    /// Releases the active bound with the most negative multiplier. Returns false if there is none.
    fn release(&mut self, rows: &[f64], negligible: f64) -> bool {
        let k = self.minimiser.len();
        let row = |i: usize| &rows[i * k..(i + 1) * k];
        let (mut most_negative, mut worst) = (-negligible, None);
        for (i, multiplier) in self.span.multipliers(&self.residual) {
            let position = self.active.iter().position(|active| active.0 == i);
            let Some((index, side)) = position.map(|index| (index, self.active[index].1)) else {
                continue;
            };
            let push = side * multiplier * dot(row(i), row(i)).sqrt();
            if push < most_negative {
                (most_negative, worst) = (push, Some(index));
            }
        }
        let Some(worst) = worst else { return false };
        self.active.remove(worst);
        self.span.clear();
        for &(i, _) in &self.active {
            let min_length = NEGLIGIBLE_RATE * dot(row(i), row(i)).sqrt();
            self.span.add(i, row(i).iter().copied(), min_length);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::BoundedProjection;
    use kinopt_kinematics::random::RandomStream;

    /// No sampled point within the bounds is nearer: the slope from the minimiser towards each is not negative.
    #[test]
    fn minimiser_is_nearest_within_bounds() {
        let (k, count) = (4, 9);
        let mut random = RandomStream::new(3, 0);
        let mut number = || 2.0 * random.unit() - 1.0;
        let mut projection = BoundedProjection::default();
        for _ in 0..300 {
            let rows: Vec<f64> = (0..k * count).map(|_| number()).collect();
            let e: Vec<f64> = (0..k).map(|_| 3.0 * number()).collect();
            // One bound in three is active at the start.
            let max_changes: Vec<(f64, f64)> = (0..count)
                .map(|i| match i % 3 {
                    0 => (0.0, number().abs()),
                    _ => (number().abs(), number().abs()),
                })
                .collect();
            let decrease = projection.project(&e, &rows, count, |i| max_changes[i]);
            let products = |u: &[f64]| -> Vec<f64> {
                let rows = rows.chunks_exact(k);
                rows.map(|row| row.iter().zip(u).map(|(a, b)| a * b).sum())
                    .collect()
            };
            let is_within = |u: &[f64], slack: f64| {
                let bounded = products(u).into_iter().zip(&max_changes);
                bounded
                    .into_iter()
                    .all(|(p, (down, up))| p >= -down - slack && p <= up + slack)
            };
            let minimiser = projection.minimiser.clone();
            assert!(is_within(&minimiser, 1e-12));
            for (product, expected) in projection.products.iter().zip(products(&minimiser)) {
                assert!((product - expected).abs() < 1e-12);
            }
            let half = |u: &[f64]| -> f64 {
                0.5 * u
                    .iter()
                    .zip(&e)
                    .map(|(u, e)| (u + e) * (u + e))
                    .sum::<f64>()
            };
            assert!((half(&[0.0; 4]) - half(&minimiser) - decrease).abs() < 1e-12);
            for _ in 0..200 {
                let mut other: Vec<f64> = (0..k).map(|_| number()).collect();
                while !is_within(&other, 0.0) && other.iter().any(|u| u.abs() > 1e-9) {
                    other.iter_mut().for_each(|u| *u *= 0.7);
                }
                if is_within(&other, 0.0) {
                    let towards = other.iter().zip(&minimiser).zip(&e);
                    let slope: f64 = towards.map(|((o, u), e)| (o - u) * (u + e)).sum();
                    assert!(slope > -1e-11, "{slope}");
                }
            }
        }
    }
}
