//! Projection of a point onto a polytope that is given by bounds on linear functions.

use super::dense::{add_scaled, dot};
use super::row_span::RowSpan;
use crate::buffer::{refill, vacate};

/// Relative rate below which a direction does not change a product.
const ALONG: f64 = 1e-12;
/// Length of a direction, and size of a multiplier, that count as zero, relative to the length of e.
const NONE: f64 = 1e-13;

/// Minimises ½‖u + e‖² subject to least ≤ bᵢ·u ≤ most for rows bᵢ, from u = 0, which must be feasible.
///
/// The method is a primal active set (Nocedal & Wright 2006, algorithm 16.3), for few numbers and few active bounds.
#[derive(Clone, Debug, Default)]
pub(crate) struct BoundedProjection {
    standing: Vec<(usize, f64)>,
    span: RowSpan,
    /// Minimiser u.
    pub(crate) nearest: Vec<f64>,
    /// Products bᵢ·u at the minimiser.
    pub(crate) products: Vec<f64>,
    way: Vec<f64>,
    residual: Vec<f64>,
}

impl BoundedProjection {
    /// Reserves memory for this many numbers and rows.
    pub(crate) fn reserve(&mut self, numbers: usize, rows: usize) {
        for (vector, room) in [
            (&mut self.nearest, numbers),
            (&mut self.way, numbers),
            (&mut self.residual, numbers),
            (&mut self.products, rows),
        ] {
            vacate(vector, room);
        }
        vacate(&mut self.standing, rows);
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
        room: impl Fn(usize) -> (f64, f64),
    ) -> f64 {
        let k = e.len();
        refill(&mut self.nearest, k, 0.0);
        refill(&mut self.products, count, 0.0);
        self.standing.clear();
        self.span.clear();
        let whole = dot(e, e).sqrt();
        for _ in 0..4 * (k + count) {
            self.residual.clear();
            let sums = self.nearest.iter().zip(e).map(|(u, e)| u + e);
            self.residual.extend(sums);
            self.way.clear();
            self.way.extend(self.residual.iter().map(|sum| -sum));
            self.span.project_out(&mut self.way);
            let length = dot(&self.way, &self.way).sqrt();
            if length <= NONE * whole {
                if !self.release(rows, NONE * whole) {
                    break;
                }
                continue;
            }
            let mut share = 1.0;
            let mut blocks = None;
            for (i, row) in rows.chunks_exact(k.max(1)).enumerate() {
                let rate = dot(row, &self.way);
                if rate.abs() <= ALONG * length * dot(row, row).sqrt()
                    || self.standing.iter().any(|own| own.0 == i)
                {
                    continue;
                }
                let (down, up) = room(i);
                let (left, side) = match rate > 0.0 {
                    true => (up - self.products[i], 1.0),
                    false => (down + self.products[i], -1.0),
                };
                let until = left.max(0.0) / rate.abs();
                if until < share {
                    (share, blocks) = (until, Some((i, side)));
                }
            }
            add_scaled(&mut self.nearest, share, &self.way);
            for (product, row) in self.products.iter_mut().zip(rows.chunks_exact(k.max(1))) {
                *product = dot(row, &self.nearest);
            }
            if let Some((i, side)) = blocks {
                let row = &rows[i * k..(i + 1) * k];
                let least = ALONG * dot(row, row).sqrt();
                self.span.add(i, row.iter().copied(), least);
                self.standing.push((i, side));
            }
        }
        // Products of active rows are exactly at their bounds.
        for &(i, side) in &self.standing {
            let (down, up) = room(i);
            self.products[i] = if side > 0.0 { up } else { -down };
        }
        let left = self.nearest.iter().zip(e).map(|(u, e)| (u + e) * (u + e));
        0.5 * (whole * whole - left.sum::<f64>())
    }

    /// Active rows, with +1 for the upper and −1 for the lower bound.
    pub(crate) fn standing(&self) -> &[(usize, f64)] {
        &self.standing
    }

    /// Releases the active bound with the most negative multiplier. Returns false if there is none.
    fn release(&mut self, rows: &[f64], negligible: f64) -> bool {
        let k = self.nearest.len();
        let row = |i: usize| &rows[i * k..(i + 1) * k];
        let (mut least, mut worst) = (-negligible, None);
        for (i, multiplier) in self.span.multipliers(&self.residual) {
            let own = self.standing.iter().position(|own| own.0 == i);
            let Some((at, side)) = own.map(|at| (at, self.standing[at].1)) else {
                continue;
            };
            let push = side * multiplier * dot(row(i), row(i)).sqrt();
            if push < least {
                (least, worst) = (push, Some(at));
            }
        }
        let Some(worst) = worst else { return false };
        self.standing.remove(worst);
        self.span.clear();
        for &(i, _) in &self.standing {
            let least = ALONG * dot(row(i), row(i)).sqrt();
            self.span.add(i, row(i).iter().copied(), least);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::BoundedProjection;
    use crate::random::RandomStream;

    /// No sampled point within the bounds is nearer: the slope from the minimiser towards each is not negative.
    #[test]
    fn nothing_within_the_bounds_is_nearer() {
        let (k, count) = (4, 9);
        let mut random = RandomStream::new(3, 0);
        let mut number = || 2.0 * random.unit() - 1.0;
        let mut projection = BoundedProjection::default();
        for _ in 0..300 {
            let rows: Vec<f64> = (0..k * count).map(|_| number()).collect();
            let e: Vec<f64> = (0..k).map(|_| 3.0 * number()).collect();
            // One bound in three is active at the start.
            let room: Vec<(f64, f64)> = (0..count)
                .map(|i| match i % 3 {
                    0 => (0.0, number().abs()),
                    _ => (number().abs(), number().abs()),
                })
                .collect();
            let fallen = projection.project(&e, &rows, count, |i| room[i]);
            let products = |u: &[f64]| -> Vec<f64> {
                let rows = rows.chunks_exact(k);
                rows.map(|row| row.iter().zip(u).map(|(a, b)| a * b).sum())
                    .collect()
            };
            let within = |u: &[f64], slack: f64| {
                let own = products(u).into_iter().zip(&room);
                own.into_iter()
                    .all(|(p, (down, up))| p >= -down - slack && p <= up + slack)
            };
            let nearest = projection.nearest.clone();
            assert!(within(&nearest, 1e-12));
            for (own, product) in projection.products.iter().zip(products(&nearest)) {
                assert!((own - product).abs() < 1e-12);
            }
            let half = |u: &[f64]| -> f64 {
                0.5 * u
                    .iter()
                    .zip(&e)
                    .map(|(u, e)| (u + e) * (u + e))
                    .sum::<f64>()
            };
            assert!((half(&[0.0; 4]) - half(&nearest) - fallen).abs() < 1e-12);
            for _ in 0..200 {
                let mut other: Vec<f64> = (0..k).map(|_| number()).collect();
                while !within(&other, 0.0) && other.iter().any(|u| u.abs() > 1e-9) {
                    other.iter_mut().for_each(|u| *u *= 0.7);
                }
                if within(&other, 0.0) {
                    let towards = other.iter().zip(&nearest).zip(&e);
                    let slope: f64 = towards.map(|((o, u), e)| (o - u) * (u + e)).sum();
                    assert!(slope > -1e-11, "{slope}");
                }
            }
        }
    }
}
