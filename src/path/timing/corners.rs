//! Detection of corners in a sequence of configurations.
//!
//! A corner is a bend that stays when rows get denser. One-sided parabolas through the rows before and after a row give
//! two tangents. The angle between them vanishes with the square of the row distance on a smooth curve, but not at a
//! corner.

use crate::scalar::elementary::acos;

/// Smallest distances from a row to the rows that define its tangents, radians or metres of joint length. A row is a
/// corner if it is one at both distances.
///
/// Closer rows would amplify the tolerance of their solver, about 1e-6. The first distance is safe from that. The
/// second distinguishes tight bends of dense rows from corners.
const TANGENT_DISTANCES: [f64; 2] = [MIN_TANGENT_DISTANCE, 3e-4];
pub(super) const MIN_TANGENT_DISTANCE: f64 = 2e-3;
/// Smallest angle between two one-sided tangents that counts as a corner, radians.
const MIN_CORNER_ANGLE: f64 = 0.05;
/// Cosine of [`MIN_CORNER_ANGLE`], rounded up.
const MIN_CORNER_ANGLE_COSINE: f64 = 0.99876;
/// Smallest ratio of the angle between tangents to the angle between chords at a corner.
const MIN_ANGLE_RATIO: f64 = 0.6;
/// As `MIN_ANGLE_RATIO`, if one tangent is a chord because a corner or an end is near.
const MIN_ANGLE_RATIO_NEAR_END: f64 = 0.9;

/// Smallest ratio of the angle between tangents to the angle between chords at neighbouring rows that bend to the same
/// side. A tight bend of a smooth curve spreads over several rows.
const MIN_NEIGHBOUR_ANGLE_RATIO: f64 = 2.0;

/// Consecutive rows, with their joint lengths from the first row.
#[derive(Clone, Copy)]
pub(super) struct Rows<'a> {
    pub(super) rows: &'a [&'a [f64]],
    pub(super) lengths: &'a [f64],
    /// Smallest distance from a row to the rows that define its direction.
    pub(super) reach: f64,
}

impl Rows<'_> {
    /// Returns the nearest row before `row` that is at least `reach` away, but not before `bound`.
    fn before(&self, row: usize, bound: usize) -> usize {
        let limit = self.lengths[row] - self.reach;
        (bound..row)
            .rev()
            .find(|k| self.lengths[*k] <= limit)
            .unwrap_or(bound)
    }

    /// Returns the nearest row after `row` that is at least `reach` away, but not after `bound`.
    fn after(&self, row: usize, bound: usize) -> usize {
        let limit = self.lengths[row] + self.reach;
        (row + 1..=bound)
            .find(|k| self.lengths[*k] >= limit)
            .unwrap_or(bound)
    }

    /// Returns the unit direction of the chord between two rows; zero if they are equal.
    fn chord(&self, from: usize, to: usize) -> Vec<f64> {
        let moves = self.rows[to].iter().zip(self.rows[from]);
        let mut chord: Vec<f64> = moves.map(|(b, a)| b - a).collect();
        let length = chord
            .iter()
            .map(|component| component * component)
            .sum::<f64>()
            .sqrt();
        if length > 0.0 {
            chord.iter_mut().for_each(|component| *component /= length);
        }
        chord
    }

    /// Returns the tangent at `row` of the parabola through it, `near` and `far`; the chord if `near` and `far` are one
    /// row.
    fn tangent(&self, row: usize, near: usize, far: usize) -> Vec<f64> {
        let (from, to) = (row.min(near), row.max(near));
        let mut tangent = self.chord(from, to);
        if near != far {
            let outer = self.chord(far.min(near), far.max(near));
            let reach = |a: usize, b: usize| (self.lengths[a] - self.lengths[b]).abs();
            let ratio = reach(row, near) / (reach(row, near) + reach(near, far));
            for (entry, outer) in tangent.iter_mut().zip(outer) {
                *entry += ratio * (*entry - outer);
            }
        }
        tangent
    }

    /// Returns the angle between the chords to the rows before and after, radians.
    fn chord_angle(&self, row: usize, first: usize, last: usize) -> f64 {
        let (before, after) = (self.before(row, first), self.after(row, last));
        self.angle_of_chords([before, row], [row, after])
    }

    /// Returns the change of direction from one row to a later one, radians.
    pub(super) fn direction_change(&self, from: usize, to: usize) -> f64 {
        let (after, before) = (self.after(from, to), self.before(to, from));
        self.angle_of_chords([from, after], [before, to])
    }

    /// Returns the angle between two chords, radians; 0 if it is less than [`MIN_CORNER_ANGLE`] or a chord is zero.
    fn angle_of_chords(&self, first: [usize; 2], second: [usize; 2]) -> f64 {
        let ends = |[from, to]: [usize; 2]| self.rows[from].iter().zip(self.rows[to]);
        let (mut product, mut squares) = (0.0, [0.0; 2]);
        for ((a, b), (c, d)) in ends(first).zip(ends(second)) {
            let (u, v) = (b - a, d - c);
            product += u * v;
            squares[0] += u * u;
            squares[1] += v * v;
        }
        let sizes = (squares[0] * squares[1]).sqrt();
        match product < MIN_CORNER_ANGLE_COSINE * sizes {
            true => acos((product / sizes).clamp(-1.0, 1.0)),
            false => 0.0,
        }
    }

    /// Returns the largest angle between chords at the neighbouring rows that bend to the same side, radians.
    fn max_neighbour_angle(&self, row: usize, first: usize, last: usize) -> f64 {
        let change = |row: usize| {
            let (before, after) = (self.before(row, first), self.after(row, last));
            let (arriving, leaving) = (self.chord(before, row), self.chord(row, after));
            arriving.into_iter().zip(leaving).map(|(a, b)| b - a)
        };
        let neighbours = [self.before(row, first), self.after(row, last)];
        let inner = neighbours
            .into_iter()
            .filter(|neighbour| *neighbour != first && *neighbour != last);
        let chord_angles = inner.map(|neighbour| {
            let product: f64 = change(row).zip(change(neighbour)).map(|(a, b)| a * b).sum();
            match product > 0.0 {
                true => self.chord_angle(neighbour, first, last),
                false => 0.0,
            }
        });
        chord_angles.fold(0.0, f64::max)
    }

    /// Returns whether a row is a corner between two bounds, which are known corners or ends.
    fn has_corner(&self, row: usize, first: usize, last: usize) -> bool {
        let (before, after) = (self.before(row, first), self.after(row, last));
        let far_before = self.before(before, first);
        let far_after = self.after(after, last);
        let arriving = self.tangent(row, before, far_before);
        let leaving = self.tangent(row, after, far_after);
        let corner_angle = angle(&arriving, &leaving);
        let min_ratio = match before == far_before || after == far_after {
            true => MIN_ANGLE_RATIO_NEAR_END,
            false => MIN_ANGLE_RATIO,
        };
        corner_angle > MIN_CORNER_ANGLE
            && corner_angle > min_ratio * self.chord_angle(row, first, last)
            && corner_angle > MIN_NEIGHBOUR_ANGLE_RATIO * self.max_neighbour_angle(row, first, last)
    }
}

/// Returns the angle between two vectors, radians; 0 if one is zero.
pub(super) fn angle(a: &[f64], b: &[f64]) -> f64 {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let sizes = (product(a, a) * product(b, b)).sqrt();
    match sizes > 0.0 {
        // False for NaN, so its angle is 0 too.
        true => acos((product(a, b) / sizes).clamp(-1.0, 1.0)),
        false => 0.0,
    }
}

/// Returns the rows at which the path has a corner, ascending. Consecutive rows must differ.
pub(super) fn corners(rows: Rows<'_>) -> Vec<usize> {
    let Some(last) = rows.rows.len().checked_sub(1) else {
        return Vec::new();
    };
    let chord_angles = (1..last).map(|row| (rows.chord_angle(row, 0, last), row));
    let mut candidates: Vec<(f64, usize)> = chord_angles
        .filter(|(angle, _)| *angle > MIN_CORNER_ANGLE)
        .collect();
    // The sharpest first, because a corner distorts the chords of its neighbours.
    candidates.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut corners = vec![0, last];
    for (_, row) in candidates {
        let index = corners.partition_point(|corner| *corner < row);
        let (first, last) = (corners[index - 1], corners[index]);
        let clearance = |corner: usize| (rows.lengths[corner] - rows.lengths[row]).abs();
        if first == row
            || last == row
            || clearance(first).min(clearance(last)) < MIN_TANGENT_DISTANCE
        {
            continue;
        }
        let is_corner = |reach: &f64| {
            let rows = Rows {
                reach: *reach,
                ..rows
            };
            rows.has_corner(row, first, last)
        };
        if TANGENT_DISTANCES.iter().all(is_corner) {
            corners.insert(index, row);
        }
    }
    corners.pop();
    corners.remove(0);
    corners
}
