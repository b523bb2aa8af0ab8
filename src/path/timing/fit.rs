//! Cubic spline through rows, on as few knots as their tolerance allows.
//!
//! Second differences of dense rows amplify the error of each row: 1e-6 rad at rows 1e-3 rad apart are a curvature of 1
//! per radian. Knots are therefore [`KNOT_DISTANCE`] apart. They are closer where the direction changes by more than
//! [`MAX_DIRECTION_CHANGE`]. They are also closer where a row would be farther than [`ROW_TOLERANCE`] from the curve.
//! Sparser rows are all knots.

use super::corners::{MIN_TANGENT_DISTANCE, Rows};
use super::cubic_curve::CubicCurve;

/// Largest distance of a joint from a row that is not a knot, radians or metres.
pub(super) const ROW_TOLERANCE: f64 = 1e-5;
/// Distance of knots along the path, radians or metres of joint length.
const KNOT_DISTANCE: f64 = 0.03;
/// Largest change of direction between knots, radians.
const MAX_DIRECTION_CHANGE: f64 = 0.1;
/// Smallest distance between a knot inserted for a row and its neighbours, radians or metres of joint length.
const MIN_KNOT_DISTANCE: f64 = 2e-4;
/// Maximum number of rounds that insert knots. Each splits the pieces that are too far off.
const MAX_ROUNDS: usize = 16;

/// Fits a curve through rows. Consecutive rows must differ.
pub(super) fn fit(rows: Rows<'_>, joints: usize) -> CubicCurve {
    let mut knots = first_knots(rows);
    let mut curve = interpolated(rows, &knots, joints);
    for _ in 0..MAX_ROUNDS {
        let added = rows_off_curve(rows, &knots, &curve);
        if added.is_empty() {
            break;
        }
        knots.extend(added);
        knots.sort_unstable();
        curve = interpolated(rows, &knots, joints);
    }
    curve
}

fn interpolated(rows: Rows<'_>, knots: &[usize], joints: usize) -> CubicCurve {
    let parameters = knots.iter().map(|row| rows.lengths[*row]).collect();
    let values = knots.iter().flat_map(|row| rows.rows[*row]);
    CubicCurve::through(parameters, values.copied().collect(), joints)
}

/// Returns both ends, and rows between them that are at least [`KNOT_DISTANCE`] or [`MAX_DIRECTION_CHANGE`] apart.
fn first_knots(rows: Rows<'_>) -> Vec<usize> {
    let lengths = rows.lengths;
    let last = lengths.len() - 1;
    let mut knots = vec![0];
    let mut knot = 0;
    for row in 1..last {
        let distance = lengths[row] - lengths[knot];
        if distance >= KNOT_DISTANCE
            || (distance >= MIN_TANGENT_DISTANCE
                && rows.direction_change(knot, row) > MAX_DIRECTION_CHANGE)
        {
            knots.push(row);
            knot = row;
        }
    }
    // Avoids a short last piece.
    let remaining = lengths[last] - lengths[knot];
    if knots.len() > 1
        && remaining < 0.5 * KNOT_DISTANCE
        && rows.direction_change(knot, last) < MAX_DIRECTION_CHANGE
    {
        knots.pop();
    }
    knots.push(last);
    knots
}

/// Returns the row farthest from the curve in each piece, if it is too far.
fn rows_off_curve(rows: Rows<'_>, knots: &[usize], curve: &CubicCurve) -> Vec<usize> {
    let lengths = rows.lengths;
    let mut added = Vec::new();
    for (piece, pair) in knots.windows(2).enumerate() {
        let mut farthest = (ROW_TOLERANCE, None);
        for row in pair[0] + 1..pair[1] {
            let jets = curve.jets(piece, lengths[row]);
            let distance = jets
                .zip(rows.rows[row])
                .map(|(jet, q)| (jet.value - q).abs());
            let distance = distance.fold(0.0, f64::max);
            let nearest = (lengths[row] - lengths[pair[0]]).min(lengths[pair[1]] - lengths[row]);
            if distance > farthest.0 && nearest >= MIN_KNOT_DISTANCE {
                farthest = (distance, Some(row));
            }
        }
        added.extend(farthest.1);
    }
    added
}
