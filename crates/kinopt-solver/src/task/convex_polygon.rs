//! Convex polygons in the plane whose corners may carry derivatives.

use kinopt_kinematics::scalar::Scalar;

/// Sine of the exterior angle below which a corner counts as straight.
const MIN_CORNER_SINE: f64 = 1e-7;

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
struct HullPoint<S> {
    point: Point2<S>,
    values: [f64; 2],
    source: usize,
}

fn minus<S: Scalar>(a: Point2<S>, b: Point2<S>) -> Point2<S> {
    [a[0] - b[0], a[1] - b[1]]
}

fn point_along<S: Scalar>(a: Point2<S>, direction: Point2<S>, fraction: S) -> Point2<S> {
    [
        direction[0].mul_add(fraction, a[0]),
        direction[1].mul_add(fraction, a[1]),
    ]
}

fn dot<S: Scalar>(a: Point2<S>, b: Point2<S>) -> S {
    a[0] * b[0] + a[1] * b[1]
}

/// Twice the area of a triangle, positive if its corners are counter-clockwise.
fn turn_direction(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
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
        let mut points: Vec<HullPoint<S>> = points
            .map(|(source, point)| HullPoint {
                point,
                values: point.map(value),
                source,
            })
            .collect();
        let weight = S::constant(1.0 / points.len() as f64);
        let zero = [S::zero(); 2];
        let middle = (points.iter()).fold(zero, |sum, hull_point| {
            point_along(sum, hull_point.point, weight)
        });
        points.sort_by(|HullPoint { values: a, .. }, HullPoint { values: b, .. }| {
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
        });
        points.dedup_by(|a, b| a.values == b.values);
        let mut hull: Vec<HullPoint<S>> = Vec::with_capacity(2 * points.len());
        let mut add_chain = |chain: &mut dyn Iterator<Item = &HullPoint<S>>| {
            let first = hull.len();
            for &hull_point in chain {
                while let [.., a, b] = &hull[first..] {
                    if turn_direction(a.values, b.values, hull_point.values) > 0.0 {
                        break;
                    }
                    hull.pop();
                }
                hull.push(hull_point);
            }
            // The next chain starts with this point.
            hull.pop();
        };
        if points.len() > 1 {
            add_chain(&mut points.iter());
            add_chain(&mut points.iter().rev());
        } else {
            hull = points;
        }
        Self {
            corners: hull.iter().map(|hull_point| hull_point.point).collect(),
            sources: hull.iter().map(|hull_point| hull_point.source).collect(),
            middle,
        }
    }

    /// The edges: a corner, the vector to the next corner, and its length.
    fn edges(&self) -> impl Iterator<Item = (Point2<S>, Point2<S>, S)> + '_ {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).filter_map(|(&from, &to)| {
            let direction = minus(to, from);
            let squared = dot(direction, direction);
            (value(squared) > 0.0).then(|| (from, direction, squared.sqrt()))
        })
    }

    /// The points inside by at least `margin`; the mean of the input points if there are none.
    pub(super) fn shrunk(self, margin: f64) -> Self {
        if margin == 0.0 {
            return self;
        }
        let mut remaining = self.corners.clone();
        for (from, direction, length) in self.edges() {
            // Positive inside.
            let scale = S::one() / length;
            let slack = |point: &Point2<S>| {
                let offset = minus(*point, from);
                (direction[0] * offset[1] - direction[1] * offset[0]) * scale - S::constant(margin)
            };
            let slacks: Vec<S> = remaining.iter().map(slack).collect();
            let mut clipped = Vec::with_capacity(remaining.len() + 1);
            for k in 0..remaining.len() {
                let next = (k + 1) % remaining.len();
                let (slack_here, slack_next) = (slacks[k], slacks[next]);
                if value(slack_here) >= 0.0 {
                    clipped.push(remaining[k]);
                }
                if (value(slack_here) >= 0.0) != (value(slack_next) >= 0.0) {
                    let fraction = slack_here / (slack_here - slack_next);
                    clipped.push(point_along(
                        remaining[k],
                        minus(remaining[next], remaining[k]),
                        fraction,
                    ));
                }
            }
            remaining = clipped;
        }
        if remaining.is_empty() || self.corners.len() < 3 {
            remaining = vec![self.middle];
        }
        Self {
            corners: remaining,
            sources: Vec::new(),
            ..self
        }
    }

    /// Writes the slack of `point` in each edge: its distance inside the edge minus `margin`.
    ///
    /// The slack of an edge has the index of the point that starts it. Points that start no edge get infinity. Almost
    /// straight corners start no edge, because rounding would create and remove it. A degenerate polygon gives minus
    /// infinity everywhere.
    pub(super) fn slacks(&self, point: Point2<S>, margin: f64, slacks: &mut [S]) {
        slacks.fill(S::constant(f64::INFINITY));
        let corners = self.strict_corners();
        if corners.len() < 3 {
            return slacks.fill(S::constant(f64::NEG_INFINITY));
        }
        let next = corners.iter().cycle().skip(1);
        for (&from, &to) in corners.iter().zip(next) {
            let direction = minus(self.corners[to], self.corners[from]);
            let offset = minus(point, self.corners[from]);
            let slack = (direction[0] * offset[1] - direction[1] * offset[0])
                / dot(direction, direction).sqrt();
            slacks[self.sources[from]] = slack - S::constant(margin);
        }
    }

    /// The corners whose exterior angle exceeds rounding.
    fn strict_corners(&self) -> Vec<usize> {
        let corner_values = |corner: usize| self.corners[corner].map(value);
        let mut remaining: Vec<usize> = (0..self.corners.len()).collect();
        let mut k = 0;
        while k < remaining.len() && remaining.len() > 2 {
            let previous = corner_values(remaining[(k + remaining.len() - 1) % remaining.len()]);
            let (current, next) = (
                corner_values(remaining[k]),
                corner_values(remaining[(k + 1) % remaining.len()]),
            );
            let squared = |a, b| -> f64 {
                let edge: Point2<f64> = minus(b, a);
                dot(edge, edge)
            };
            let lengths = squared(previous, current) * squared(current, next);
            match turn_direction(previous, current, next) > MIN_CORNER_SINE * lengths.sqrt() {
                true => k += 1,
                false => drop(remaining.remove(k)),
            }
        }
        remaining
    }

    /// The vector from the closest point of the polygon to `point`; zero inside.
    pub(super) fn offset_outside(&self, point: Point2<S>) -> Point2<S> {
        self.offset_outside_as(point, |number| number)
    }

    /// [`offset_outside`](Self::offset_outside) for a point whose scalar carries more derivatives than the corners.
    fn offset_outside_as<T: Scalar>(
        &self,
        point: Point2<T>,
        convert: impl Fn(S) -> T,
    ) -> Point2<T> {
        let mut inside = self.corners.len() > 2;
        let mut nearest = match self.corners.first() {
            Some(&corner) => minus(point, corner.map(&convert)),
            None => [T::constant(f64::NAN); 2],
        };
        let mut min_squared = value(dot(nearest, nearest));
        for (from, direction, length) in self.edges() {
            let (from, direction, length) =
                (from.map(&convert), direction.map(&convert), convert(length));
            let offset = minus(point, from);
            inside &= value(direction[0] * offset[1] - direction[1] * offset[0]) >= 0.0;
            let fraction = dot(offset, direction) / (length * length);
            let fraction = fraction.max(T::zero()).min(T::one());
            let edge_offset = minus(offset, [direction[0] * fraction, direction[1] * fraction]);
            let squared = value(dot(edge_offset, edge_offset));
            if squared < min_squared {
                (nearest, min_squared) = (edge_offset, squared);
            }
        }
        match inside {
            true => [T::zero(); 2],
            false => nearest,
        }
    }
}

impl ConvexPolygon<f64> {
    /// [`offset_outside`](Self::offset_outside) for constant corners and a moving point.
    pub(super) fn constant_offset_outside<T: Scalar>(&self, point: Point2<T>) -> Point2<T> {
        self.offset_outside_as(point, T::constant)
    }

    /// True if some point is inside by at least `margin`.
    pub(super) fn contains_margin(&self, margin: f64) -> bool {
        let shrunk_polygon = self.clone().shrunk(margin);
        margin == 0.0 || (self.corners.len() > 2 && shrunk_polygon.corners != [self.middle])
    }
}
