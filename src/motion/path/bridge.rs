//! Bridges over steps at which a branch is left: for an arm with joints to spare both branches are often of one self-motion, and what
//! was a leap in one step is a move that the knots around it share.

use super::PathError;
use super::knot_configurations::Way;
use super::layers::Growth;
use crate::arm::Ends;

/// A bridge begins and ends so many knots from the leap at most; the shortest that stands is taken.
const LONGEST: usize = 128;

/// Bridges every leap that it can. Neither a knot that is reached nor a step that is joined is lost by it.
pub(super) fn bridge(growth: &Growth<'_>, way: &mut Way) -> Result<(), PathError> {
    let mut ends = Ends::default();
    for knot in 1..way.joined.len() {
        if way.joined[knot] || !is_led(growth, way, knot) {
            continue;
        }
        let (mut half, mut tried) = (1, None);
        while half <= LONGEST && !way.joined[knot] {
            half *= 2;
            let (first, last) = piers(growth, way, knot, half);
            // A longer one finds no room.
            if tried.replace((first, last)) == Some((first, last)) {
                break;
            }
            if let Some(rows) = span(growth, way, (first, last), &mut ends)? {
                let n = growth.width();
                way.q[(first + 1) * n..last * n].copy_from_slice(&rows);
                way.joined[knot] = true;
            }
        }
    }
    Ok(())
}

/// Whether the path leads to a knot from the one before, and both are reached.
fn is_led(growth: &Growth<'_>, way: &Way, knot: usize) -> bool {
    way.reached[knot - 1] && way.reached[knot] && growth.knots.is_led_to(knot)
}

/// The knots that a bridge stands on: as far from the leap as asked, where nothing else is left or missed on the way.
fn piers(growth: &Growth<'_>, way: &Way, knot: usize, half: usize) -> (usize, usize) {
    let goes_on = |at: &usize| way.joined[*at] && is_led(growth, way, *at);
    let before = (1..knot).rev().take_while(goes_on).take(half - 1).count();
    let after = knot + 1..way.joined.len();
    let after = after.take_while(goes_on).take(half - 1).count();
    (knot - 1 - before, knot + after)
}

/// The configurations between two knots that go evenly from the one's to the other's; none where one of them misses, touches something or a
/// joint would have to move too far.
fn span(
    growth: &Growth<'_>,
    way: &Way,
    (first, last): (usize, usize),
    ends: &mut Ends,
) -> Result<Option<Vec<f64>>, PathError> {
    let (knots, n) = (growth.knots, growth.width());
    let (from, to) = (way.row(first, n), way.row(last, n));
    let inner = first + 1..last;
    let steps = (last - first) as f64;
    let shares = inner.clone().map(|knot| (knot - first) as f64 / steps);
    let guesses: Vec<f64> = shares
        .flat_map(|share| (from.iter().zip(to)).map(move |(a, b)| a + share * (b - a)))
        .collect();
    let tool = knots.tool(last);
    let targets = &knots.targets[inner.clone()];
    growth
        .arms
        .continue_all(|_| tool, targets, &guesses, ends)?;
    if ends.outcomes.iter().any(|outcome| !outcome.reached) {
        return Ok(None);
    }
    let rows = [from, &ends.q, to].concat();
    let mut steps = rows.windows(2 * n).step_by(n).zip(first + 1..);
    let short = |(pair, knot): (&[f64], usize)| {
        growth.bounds.excess(knots, knot, &pair[..n], &pair[n..]) <= way.allowance[knot] + 1e-9
    };
    if !steps.all(short) {
        return Ok(None);
    }
    let mut free = Vec::new();
    growth.note_free(last, &ends.q, true, &mut free)?;
    Ok(free.iter().all(|free| *free).then(|| ends.q.clone()))
}
