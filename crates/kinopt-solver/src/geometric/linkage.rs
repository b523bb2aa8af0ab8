//! Points at fixed distances from their parents, and FABRIK passes over them.

use kinopt_kinematics::spatial::Vector3;

/// The position of a target relative to the reach of a chain, by its lengths alone.
///
/// The reach is a spherical shell about the root. Its outer radius is the sum of the lengths. Its inner radius is the
/// longest length minus the others, or 0. Joint limits may reduce the reach further.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Span {
    /// Between stretched and folded.
    Within,
    /// Farther than the stretched chain, by this distance in the unit of the lengths.
    TooFar(f64),
    /// Nearer than the folded chain, by this distance; one link is longer than all others together.
    TooNear(f64),
}

impl Span {
    /// The span of links of the given lengths for a target at `distance`.
    #[must_use]
    pub fn of(lengths: &[f64], distance: f64) -> Self {
        let total: f64 = lengths.iter().sum();
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let nearest = longest - (total - longest);
        if distance > total {
            Self::TooFar(distance - total)
        } else if distance < nearest {
            Self::TooNear(nearest - distance)
        } else {
            Self::Within
        }
    }
}

/// A point with a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pin {
    pub(super) point: usize,
    pub(super) target: Vector3<f64>,
}

/// A tree of points, parents before children. Roots do not move.
#[derive(Clone, Debug)]
pub(super) struct Linkage {
    parents: Vec<Option<usize>>,
    /// Distance to the parent; 0 for roots.
    lengths: Vec<f64>,
    is_root: Vec<bool>,
    /// Positions before the pass.
    previous: Vec<Vector3<f64>>,
    /// Sum and number of the positions that the children of each point require of it.
    child_targets: Vec<(Vector3<f64>, f64)>,
}

impl Linkage {
    /// A linkage with the present distances of the points.
    pub(super) fn new(parents: Vec<Option<usize>>, points: &[Vector3<f64>]) -> Self {
        let length = |(&point, parent): (&Vector3<f64>, &Option<usize>)| {
            parent.map_or(0.0, |parent| (point - points[parent]).norm())
        };
        Self {
            lengths: points.iter().zip(&parents).map(length).collect(),
            is_root: parents.iter().map(Option::is_none).collect(),
            previous: points.to_vec(),
            child_targets: vec![(Vector3::zero(), 0.0); points.len()],
            parents,
        }
    }

    /// A chain of points; the first is the root.
    pub(super) fn chain(points: &[Vector3<f64>]) -> Self {
        let parents = (0..points.len()).map(|k| k.checked_sub(1)).collect();
        Self::new(parents, points)
    }

    pub(super) fn parent(&self, point: usize) -> Option<usize> {
        self.parents[point]
    }

    /// The lengths of the links if the points are one chain, root first.
    pub(super) fn as_chain(&self) -> Option<&[f64]> {
        let follows_previous = |(k, parent): (usize, &Option<usize>)| *parent == k.checked_sub(1);
        let is_chain = self.parents.iter().enumerate().all(follows_previous);
        (is_chain && self.parents.len() > 1).then(|| &self.lengths[1..])
    }

    /// One pass over all points except the roots.
    pub(super) fn pass(&mut self, points: &mut [Vector3<f64>], pins: &[Pin]) {
        let roots = std::mem::take(&mut self.is_root);
        self.pass_beyond(&roots, points, pins);
        self.is_root = roots;
    }

    /// One pass forward from the pins to the `fixed` points, which include the roots, and one pass back.
    ///
    /// Source: Aristidou & Lasenby 2011, "FABRIK: a fast, iterative solver for the inverse kinematics problem",
    /// algorithm 1. At a branching point the target is the centroid of the children's targets (section 5).
    pub(super) fn pass_beyond(
        &mut self,
        fixed: &[bool],
        points: &mut [Vector3<f64>],
        pins: &[Pin],
    ) {
        self.previous.copy_from_slice(points);
        self.child_targets.fill((Vector3::zero(), 0.0));
        for pin in pins {
            self.child_targets[pin.point] = (pin.target, f64::INFINITY);
        }
        for k in (0..points.len()).rev().filter(|&k| !fixed[k]) {
            let (sum, count) = self.child_targets[k];
            if count > 0.0 {
                // A pinned point is at its target, regardless of its children.
                points[k] = if count.is_finite() {
                    sum * (1.0 / count)
                } else {
                    sum
                };
            }
            if let (Some(parent), true) = (self.parents[k], count > 0.0) {
                let (position, base) = (self.previous[k], self.previous[parent]);
                let back_direction = direction(base - points[k], base - position);
                let (sum, count) = &mut self.child_targets[parent];
                if count.is_finite() {
                    *sum += back_direction.mul_add(self.lengths[k], points[k]);
                    *count += 1.0;
                }
            }
        }
        for k in (0..points.len()).filter(|&k| !fixed[k]) {
            if let Some(parent) = self.parents[k] {
                let base = points[parent];
                let direction_from_parent =
                    direction(points[k] - base, self.previous[k] - self.previous[parent]);
                points[k] = direction_from_parent.mul_add(self.lengths[k], base);
            }
        }
    }
}

/// Lays a chain with an unreachable target straight, so that its tip is as close as possible.
///
/// It points towards a far target. For a near target the longest link points towards it and all others point back.
pub(super) fn straighten(
    points: &mut [Vector3<f64>],
    lengths: &[f64],
    target: Vector3<f64>,
    span: Span,
) {
    let (Some(&root), Some(&tip)) = (points.first(), points.last()) else {
        return;
    };
    let axis = direction(target - root, tip - root);
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let mut position = root;
    for (point, &length) in points.iter_mut().skip(1).zip(lengths) {
        let sign = match span {
            // `TooNear` requires a longest link above the sum of the others, so it is unique.
            Span::TooNear(_) if length != longest => -1.0,
            _ => 1.0,
        };
        position = axis.mul_add(sign * length, position);
        *point = position;
    }
}

/// The unit vector along the first of two vectors that is not zero; x if both are zero.
pub(super) fn direction(first: Vector3<f64>, second: Vector3<f64>) -> Vector3<f64> {
    for vector in [first, second] {
        let length = vector.norm();
        if length > 0.0 {
            return vector * (1.0 / length);
        }
    }
    Vector3::new(1.0, 0.0, 0.0)
}
