//! Points at fixed distances from their parents, and FABRIK's passes over them.

use crate::spatial::Vector3;

/// Whether a target is within the reach of a chain, by its lengths alone: its tip gets everywhere
/// between |longest − rest| (or 0, where the rest is longer) and the sum of the lengths from its
/// root. What is said of a chain here, joint limits may narrow further.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Span {
    /// Somewhere between stretched and folded.
    Within,
    /// Farther than the stretched chain, by so much (the unit of the lengths).
    TooFar(f64),
    /// Nearer than the chain can be folded, because one link is longer than all others together; by
    /// so much.
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

/// A point that should be somewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pin {
    pub(super) point: usize,
    pub(super) target: Vector3<f64>,
}

/// A tree of points, parents before children. Roots stay where they are.
#[derive(Clone, Debug)]
pub(super) struct Linkage {
    parents: Vec<Option<usize>>,
    /// To the parent; 0 for roots.
    lengths: Vec<f64>,
    roots: Vec<bool>,
    /// Where each point was before the pass.
    before: Vec<Vector3<f64>>,
    /// What the children of each point ask of it: the sum of the places, and how many.
    targets: Vec<(Vector3<f64>, f64)>,
}

impl Linkage {
    /// Takes the distances from where the points are.
    pub(super) fn new(parents: Vec<Option<usize>>, points: &[Vector3<f64>]) -> Self {
        let length = |(&point, parent): (&Vector3<f64>, &Option<usize>)| {
            parent.map_or(0.0, |parent| (point - points[parent]).norm())
        };
        Self {
            lengths: points.iter().zip(&parents).map(length).collect(),
            roots: parents.iter().map(Option::is_none).collect(),
            before: points.to_vec(),
            targets: vec![(Vector3::zero(), 0.0); points.len()],
            parents,
        }
    }

    /// A chain of points, the first of which is the root.
    pub(super) fn chain(points: &[Vector3<f64>]) -> Self {
        let parents = (0..points.len()).map(|k| k.checked_sub(1)).collect();
        Self::new(parents, points)
    }

    pub(super) fn parent(&self, point: usize) -> Option<usize> {
        self.parents[point]
    }

    /// The lengths of the links if the points are one chain, root first.
    pub(super) fn as_chain(&self) -> Option<&[f64]> {
        let follows = |(k, parent): (usize, &Option<usize>)| *parent == k.checked_sub(1);
        let is_chain = self.parents.iter().enumerate().all(follows);
        (is_chain && self.parents.len() > 1).then(|| &self.lengths[1..])
    }

    /// One pass over all points but the roots.
    pub(super) fn pass(&mut self, points: &mut [Vector3<f64>], pins: &[Pin]) {
        let roots = std::mem::take(&mut self.roots);
        self.pass_beyond(&roots, points, pins);
        self.roots = roots;
    }

    /// One pass forward from the pins to the points that are `fixed`, and one back (Aristidou & Lasenby 2011, "FABRIK: a
    /// fast, iterative solver for the inverse kinematics problem", algorithm 1; where several
    /// children meet, the centroid of what they ask, section 5). Roots are fixed.
    pub(super) fn pass_beyond(
        &mut self,
        fixed: &[bool],
        points: &mut [Vector3<f64>],
        pins: &[Pin],
    ) {
        self.before.copy_from_slice(points);
        self.targets.fill((Vector3::zero(), 0.0));
        for pin in pins {
            self.targets[pin.point] = (pin.target, f64::INFINITY);
        }
        for k in (0..points.len()).rev().filter(|&k| !fixed[k]) {
            let (sum, count) = self.targets[k];
            if count > 0.0 {
                // A pinned point is where it should be, whatever its children ask.
                points[k] = if count.is_finite() {
                    sum * (1.0 / count)
                } else {
                    sum
                };
            }
            if let (Some(parent), true) = (self.parents[k], count > 0.0) {
                let (own, base) = (self.before[k], self.before[parent]);
                let towards = direction(base - points[k], base - own);
                let (sum, count) = &mut self.targets[parent];
                if count.is_finite() {
                    *sum += towards.mul_add(self.lengths[k], points[k]);
                    *count += 1.0;
                }
            }
        }
        for k in (0..points.len()).filter(|&k| !fixed[k]) {
            if let Some(parent) = self.parents[k] {
                let base = points[parent];
                let along = direction(points[k] - base, self.before[k] - self.before[parent]);
                points[k] = along.mul_add(self.lengths[k], base);
            }
        }
    }
}

/// The best pose of a chain whose target is out of reach: stretched towards it, or the longest link
/// towards it and all others back. The tip is then as near as it gets.
pub(super) fn lay_straight(
    points: &mut [Vector3<f64>],
    lengths: &[f64],
    target: Vector3<f64>,
    span: Span,
) {
    let (Some(&root), Some(&tip)) = (points.first(), points.last()) else {
        return;
    };
    let along = direction(target - root, tip - root);
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let mut at = root;
    for (point, &length) in points.iter_mut().skip(1).zip(lengths) {
        let sign = match span {
            // Of several longest links none is longer than the rest, so there is one.
            Span::TooNear(_) if length != longest => -1.0,
            _ => 1.0,
        };
        at = along.mul_add(sign * length, at);
        *point = at;
    }
}

/// The unit vector along the first of two that has a direction; x where neither has.
pub(super) fn direction(first: Vector3<f64>, second: Vector3<f64>) -> Vector3<f64> {
    for vector in [first, second] {
        let length = vector.norm();
        if length > 0.0 {
            return vector * (1.0 / length);
        }
    }
    Vector3::new(1.0, 0.0, 0.0)
}
