//! Convex polygons in the plane whose corners may carry derivatives.

use crate::scalar::Scalar;

/// Sine of the exterior angle below which a corner counts as straight.
const STRAIGHT: f64 = 1e-7;

/// A point of the plane.
pub(super) type Point2<S> = [S; 2];

/// A convex polygon by its corners, counter-clockwise. Two corners are a segment, one is a point.
///
/// Values alone select the corners; positions of the corners carry derivatives.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ConvexPolygon<S> {
    corners: Vec<Point2<S>>,
    /// For each corner, the index of its input point; empty after [`shrunk`](Self::shrunk).
    sources: Vec<usize>,
    /// The mean of the input points.
    middle: Point2<S>,
}

/// An input point with its value and its index.
#[derive(Clone, Copy)]
struct Seen<S> {
    point: Point2<S>,
    at: [f64; 2],
    source: usize,
}

fn minus<S: Scalar>(a: Point2<S>, b: Point2<S>) -> Point2<S> {
    [a[0] - b[0], a[1] - b[1]]
}

fn along<S: Scalar>(a: Point2<S>, way: Point2<S>, share: S) -> Point2<S> {
    [way[0].mul_add(share, a[0]), way[1].mul_add(share, a[1])]
}

fn dot<S: Scalar>(a: Point2<S>, b: Point2<S>) -> S {
    a[0] * b[0] + a[1] * b[1]
}

/// Twice the area of a triangle, positive if its corners are counter-clockwise.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let (ab, ac) = (minus(b, a), minus(c, a));
    ab[0] * ac[1] - ab[1] * ac[0]
}

/// The value of a number; NaN for SIMD lanes.
fn value<S: Scalar>(number: S) -> f64 {
    number.as_f64().unwrap_or(f64::NAN)
}

impl<S: Scalar> ConvexPolygon<S> {
    /// The convex hull of at least one point.
    ///
    /// Monotone chain of Andrew (1979, "Another efficient algorithm for convex hulls in two dimensions").
    pub(super) fn around(points: impl Iterator<Item = Point2<S>>) -> Self {
        let points = points.enumerate();
        let mut points: Vec<Seen<S>> = points
            .map(|(source, point)| Seen {
                point,
                at: point.map(value),
                source,
            })
            .collect();
        let share = S::constant(1.0 / points.len() as f64);
        let zero = [S::zero(); 2];
        let middle = (points.iter()).fold(zero, |sum, seen| along(sum, seen.point, share));
        points.sort_by(|Seen { at: a, .. }, Seen { at: b, .. }| {
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
        });
        points.dedup_by(|a, b| a.at == b.at);
        let mut hull: Vec<Seen<S>> = Vec::with_capacity(2 * points.len());
        let mut walk = |way: &mut dyn Iterator<Item = &Seen<S>>| {
            let first = hull.len();
            for &seen in way {
                while let [.., a, b] = &hull[first..] {
                    if turn(a.at, b.at, seen.at) > 0.0 {
                        break;
                    }
                    hull.pop();
                }
                hull.push(seen);
            }
            // The next chain starts with this point.
            hull.pop();
        };
        if points.len() > 1 {
            walk(&mut points.iter());
            walk(&mut points.iter().rev());
        } else {
            hull = points;
        }
        Self {
            corners: hull.iter().map(|seen| seen.point).collect(),
            sources: hull.iter().map(|seen| seen.source).collect(),
            middle,
        }
    }

    /// The edges: a corner, the vector to the next corner, and its length.
    fn edges(&self) -> impl Iterator<Item = (Point2<S>, Point2<S>, S)> + '_ {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).filter_map(|(&from, &to)| {
            let way = minus(to, from);
            let squared = dot(way, way);
            (value(squared) > 0.0).then(|| (from, way, squared.sqrt()))
        })
    }

    /// The points inside by at least `margin`; the mean of the input points if there are none.
    pub(super) fn shrunk(self, margin: f64) -> Self {
        if margin == 0.0 {
            return self;
        }
        let mut left = self.corners.clone();
        for (from, way, length) in self.edges() {
            // Positive inside.
            let scale = S::one() / length;
            let slack = |at: &Point2<S>| {
                let away = minus(*at, from);
                (way[0] * away[1] - way[1] * away[0]) * scale - S::constant(margin)
            };
            let slacks: Vec<S> = left.iter().map(slack).collect();
            let mut kept = Vec::with_capacity(left.len() + 1);
            for k in 0..left.len() {
                let next = (k + 1) % left.len();
                let (here, there) = (slacks[k], slacks[next]);
                if value(here) >= 0.0 {
                    kept.push(left[k]);
                }
                if (value(here) >= 0.0) != (value(there) >= 0.0) {
                    let share = here / (here - there);
                    kept.push(along(left[k], minus(left[next], left[k]), share));
                }
            }
            left = kept;
        }
        if left.is_empty() || self.corners.len() < 3 {
            left = vec![self.middle];
        }
        Self {
            corners: left,
            sources: Vec::new(),
            ..self
        }
    }

    /// Writes the slack of `at` in each edge: its distance inside the edge minus `margin`.
    ///
    /// The slack of an edge has the index of the point that starts it. Points that start no edge get infinity. Almost
    /// straight corners start no edge, because rounding would create and remove it. A degenerate polygon gives minus
    /// infinity everywhere.
    pub(super) fn slacks(&self, at: Point2<S>, margin: f64, slacks: &mut [S]) {
        slacks.fill(S::constant(f64::INFINITY));
        let turns = self.turning_corners();
        if turns.len() < 3 {
            return slacks.fill(S::constant(f64::NEG_INFINITY));
        }
        let next = turns.iter().cycle().skip(1);
        for (&from, &to) in turns.iter().zip(next) {
            let way = minus(self.corners[to], self.corners[from]);
            let away = minus(at, self.corners[from]);
            let slack = (way[0] * away[1] - way[1] * away[0]) / dot(way, way).sqrt();
            slacks[self.sources[from]] = slack - S::constant(margin);
        }
    }

    /// The corners whose exterior angle exceeds rounding.
    fn turning_corners(&self) -> Vec<usize> {
        let at = |corner: usize| self.corners[corner].map(value);
        let mut kept: Vec<usize> = (0..self.corners.len()).collect();
        let mut k = 0;
        while k < kept.len() && kept.len() > 2 {
            let last = at(kept[(k + kept.len() - 1) % kept.len()]);
            let (own, next) = (at(kept[k]), at(kept[(k + 1) % kept.len()]));
            let squared = |a, b| -> f64 {
                let way: Point2<f64> = minus(b, a);
                dot(way, way)
            };
            let lengths = squared(last, own) * squared(own, next);
            match turn(last, own, next) > STRAIGHT * lengths.sqrt() {
                true => k += 1,
                false => drop(kept.remove(k)),
            }
        }
        kept
    }

    /// The vector from the closest point of the polygon to `at`; zero inside.
    pub(super) fn outside(&self, at: Point2<S>) -> Point2<S> {
        self.outside_as(at, |number| number)
    }

    /// [`outside`](Self::outside) for a point whose scalar carries more derivatives than the corners.
    fn outside_as<T: Scalar>(&self, at: Point2<T>, number: impl Fn(S) -> T) -> Point2<T> {
        let mut inside = self.corners.len() > 2;
        let mut nearest = match self.corners.first() {
            Some(&corner) => minus(at, corner.map(&number)),
            None => [T::constant(f64::NAN); 2],
        };
        let mut shortest = value(dot(nearest, nearest));
        for (from, way, length) in self.edges() {
            let (from, way, length) = (from.map(&number), way.map(&number), number(length));
            let away = minus(at, from);
            inside &= value(way[0] * away[1] - way[1] * away[0]) >= 0.0;
            let share = dot(away, way) / (length * length);
            let share = share.max(T::zero()).min(T::one());
            let miss = minus(away, [way[0] * share, way[1] * share]);
            let squared = value(dot(miss, miss));
            if squared < shortest {
                (nearest, shortest) = (miss, squared);
            }
        }
        match inside {
            true => [T::zero(); 2],
            false => nearest,
        }
    }
}

impl ConvexPolygon<f64> {
    /// [`outside`](Self::outside) for constant corners and a moving point.
    pub(super) fn outside_of<T: Scalar>(&self, at: Point2<T>) -> Point2<T> {
        self.outside_as(at, T::constant)
    }

    /// True if some point is inside by at least `margin`.
    pub(super) fn has_room_for(&self, margin: f64) -> bool {
        let left = self.clone().shrunk(margin);
        margin == 0.0 || (self.corners.len() > 2 && left.corners != [self.middle])
    }
}
