//! Corner blends of joint curves: three cubic pieces that replace a corner, within a tolerance of every joint.

use super::corners::angle;
use super::cubic_curve::{CubicCurve, Jet};

/// Angle beyond which a corner is a reversal, radians. The path stops there, as a blend would save no time and not
/// reach the corner.
const MIN_REVERSAL_ANGLE: f64 = 2.8;
/// Largest fraction of an adjacent curve that a blend replaces.
const MAX_CURVE_FRACTION: f64 = 0.45;
/// Distance from a corner between straight lines to its blend, per half length and per change of the tangent.
const CORNER_DISTANCE_FACTOR: f64 = 13.0 / 72.0;
/// Fraction of the tolerance that a first blend uses, to allow for rounding.
const TOLERANCE_FRACTION: f64 = 0.999;
/// Factor that shortens a blend that is too far from the corner, and maximum number of shortenings.
const SHRINK_FACTOR: f64 = 0.85;
const MAX_SHRINKS: usize = 48;
/// Number of samples on each side of a corner at which the distance is checked.
const CHECK_SAMPLES: usize = 8;

/// Three cubic pieces of equal length around a corner.
struct Blend {
    /// Half of the length of all three pieces, in the curve parameter.
    half: f64,
    /// Second derivatives and values at the two inner knots, one row each.
    second_derivatives: [Vec<f64>; 2],
    values: [Vec<f64>; 2],
}

/// Joins consecutive curves whose ends meet in corners, and returns curves at whose ends the path stops.
///
/// `tolerance` is in radians or metres of each joint. If all corners can be blended within it, the result is one curve.
/// A tolerance of 0 blends none.
pub(super) fn joined(stretches: Vec<CubicCurve>, tolerance: f64) -> Vec<CubicCurve> {
    let blends: Vec<Option<Blend>> = stretches
        .windows(2)
        .map(|pair| Blend::new(&pair[0], &pair[1], tolerance))
        .collect();
    let mut curves = Vec::new();
    let mut joined = CubicCurve::default();
    for (index, stretch) in stretches.into_iter().enumerate() {
        let half_length = |blend: Option<&Option<Blend>>| {
            let half = blend.and_then(Option::as_ref).map(|blend| blend.half);
            half.unwrap_or(0.0)
        };
        let before = index.checked_sub(1).and_then(|index| blends.get(index));
        let (from, to) = (
            stretch.start() + half_length(before),
            stretch.end() - half_length(blends.get(index)),
        );
        joined.joints = stretch.joints;
        append(&mut joined, &stretch, from, to);
        match blends.get(index).and_then(Option::as_ref) {
            Some(blend) => blend.append(&mut joined, stretch.end()),
            None => curves.push(std::mem::take(&mut joined)),
        }
    }
    curves
}

/// Appends the part of a curve between two parameters.
fn append(joined: &mut CubicCurve, curve: &CubicCurve, from: f64, to: f64) {
    let n = curve.joints;
    let margin = 1e-9 * (to - from);
    push_point(joined, curve, from);
    let inner = curve.knots.iter().enumerate();
    for (k, s) in inner.filter(|(_, s)| **s > from + margin && **s < to - margin) {
        let row = k * n..(k + 1) * n;
        joined.push(
            *s,
            curve.values[row.clone()].iter().copied(),
            curve.second_derivatives[row].iter().copied(),
        );
    }
    push_point(joined, curve, to);
}

/// Appends the point of a curve at `s` as a knot.
fn push_point(joined: &mut CubicCurve, curve: &CubicCurve, s: f64) {
    let jets: Vec<Jet> = curve.jets(curve.piece(s), s).collect();
    joined.push(
        s,
        jets.iter().map(|jet| jet.value),
        jets.iter().map(|jet| jet.second),
    );
}

impl Blend {
    /// Returns the largest blend of the corner between two curves; `None` for a reversal or without a tolerance.
    fn new(before: &CubicCurve, after: &CubicCurve, tolerance: f64) -> Option<Self> {
        let corner = before.end();
        let first = |curve: &CubicCurve, piece: usize, s: f64| -> Vec<f64> {
            curve.jets(piece, s).map(|jet| jet.first).collect()
        };
        let arriving = first(before, before.piece(corner), corner);
        let leaving = first(after, 0, corner);
        if tolerance <= 0.0 || angle(&arriving, &leaving) > MIN_REVERSAL_ANGLE {
            return None;
        }
        let changes = arriving.iter().zip(&leaving).map(|(a, b)| (b - a).abs());
        let change = changes.fold(0.0, f64::max);
        let longest = MAX_CURVE_FRACTION * (corner - before.start()).min(after.end() - corner);
        let widest = TOLERANCE_FRACTION * tolerance / (CORNER_DISTANCE_FACTOR * change);
        let mut half = widest.min(longest);
        for _ in 0..MAX_SHRINKS {
            let blend = Self::of_half_length(before, after, half);
            if blend.is_within(before, after, tolerance) {
                return Some(blend);
            }
            half *= SHRINK_FACTOR;
        }
        None
    }

    /// Creates cubic pieces that continue both curves with continuous first and second derivatives.
    fn of_half_length(before: &CubicCurve, after: &CubicCurve, half: f64) -> Self {
        let corner = before.end();
        let (start, end) = (corner - half, corner + half);
        let step = 2.0 * half / 3.0;
        let mut blend = Self {
            half,
            second_derivatives: Default::default(),
            values: Default::default(),
        };
        let ends = before
            .jets(before.piece(start), start)
            .zip(after.jets(after.piece(end), end));
        for (from, to) in ends {
            let sum = (to.first - from.first) / step - 0.5 * (from.second + to.second);
            let moved = to.value - from.value - 3.0 * step * from.first;
            let twice = moved / (step * step) - 4.0 / 3.0 * from.second - to.second / 6.0;
            let [first, second] = [twice - sum, 2.0 * sum - twice];
            blend.second_derivatives[0].push(first);
            blend.second_derivatives[1].push(second);
            blend.values[0]
                .push(from.value + step * (from.first + step * (from.second / 3.0 + first / 6.0)));
            blend.values[1]
                .push(to.value - step * (to.first - step * (to.second / 3.0 + second / 6.0)));
        }
        blend
    }

    /// Appends the two inner knots of the blend.
    fn append(&self, curve: &mut CubicCurve, corner: f64) {
        for (side, (values, second_derivatives)) in
            self.values.iter().zip(&self.second_derivatives).enumerate()
        {
            let s = corner + (2.0 * side as f64 - 1.0) * self.half / 3.0;
            curve.push(
                s,
                values.iter().copied(),
                second_derivatives.iter().copied(),
            );
        }
    }

    /// Returns whether every joint is within `tolerance` of the original curves.
    fn is_within(&self, before: &CubicCurve, after: &CubicCurve, tolerance: f64) -> bool {
        let corner = before.end();
        let mut blended = CubicCurve {
            joints: before.joints,
            ..CubicCurve::default()
        };
        push_point(&mut blended, before, corner - self.half);
        self.append(&mut blended, corner);
        push_point(&mut blended, after, corner + self.half);
        let is_near = |curve: &CubicCurve, s: f64| {
            let jets = blended.jets(blended.piece(s), s);
            let mut pairs = jets.zip(curve.jets(curve.piece(s), s));
            pairs.all(|(a, b)| (a.value - b.value).abs() <= tolerance)
        };
        (0..=CHECK_SAMPLES).all(|k| {
            let offset = self.half * k as f64 / CHECK_SAMPLES as f64;
            is_near(before, corner - offset) && is_near(after, corner + offset)
        })
    }
}
