//! Self-motions of seven revolute joints: curves of configurations that keep the tool at its target.
//!
//! Slices lock one joint at equidistant values and solve the six others completely; then another joint. From every
//! solution the curve is traced along the null space, through the turning points of the locked joint, until it closes.
//! Joint limits then cut the curves.

use super::seven_revolute::{Q, SevenRevolute, dot};
use super::six_revolute::SolutionSet;
use kinopt_kinematics::model::Limits;
use kinopt_kinematics::spatial::Placement;
use std::f64::consts::TAU;

/// Largest step of a joint between two samples, radians.
pub(super) const MAX_JOINT_STEP: f64 = 0.05;
/// Step that tracing aims at, radians: the correction lengthens it.
const STEP: f64 = 0.045;
/// Smallest step, radians, at which tracing ends.
const MIN_STEP: f64 = 1e-5;
/// Smallest cosine of the angle between successive tangents.
const MIN_TANGENT_COSINE: f64 = 0.9;
/// Number of slices in a full turn of the locked joint.
const SLICES: usize = 128;
/// Distance of a slice's solution from a traced curve that counts as on it, radians.
const ON_CURVE: f64 = 0.01;
/// Largest number of samples of a curve.
const MAX_SAMPLES: usize = 100_000;

/// A traced curve, without limits.
struct TracedCurve {
    samples: Vec<Q>,
    /// True if the last sample is followed by the first, up to whole turns.
    closed: bool,
}

/// An arc within limits.
pub(super) struct LimitedCurve {
    pub(super) samples: Vec<Q>,
    pub(super) closed: bool,
}

/// All self-motions of a target within limits. `target` is in metres.
pub(super) fn self_motions(
    chain: &SevenRevolute,
    target: &Placement<f64>,
    tolerances: (f64, f64),
    limits: &[Limits; 7],
) -> Vec<LimitedCurve> {
    let mut scaled = *target;
    scaled.translation = scaled.translation * chain.length.recip();
    let mut curves: Vec<TracedCurve> = Vec::new();
    let mut set = SolutionSet::default();
    for sweep in &chain.sweeps {
        let locked = sweep.joint;
        for slice in 0..SLICES {
            // Off the multiples of simple fractions of a turn, at which arms are often singular.
            let value = TAU * (slice as f64 + 0.372) / SLICES as f64 - std::f64::consts::PI;
            let solver = chain.slice(sweep, value);
            solver.solve(target, tolerances, &mut set);
            for member in &set.solutions {
                let mut q: Q = std::array::from_fn(|i| match i.cmp(&locked) {
                    std::cmp::Ordering::Less => member.q[i],
                    std::cmp::Ordering::Equal => value,
                    std::cmp::Ordering::Greater => member.q[i - 1],
                });
                if curves.iter().any(|curve| is_on(curve, &q)) {
                    continue;
                }
                let mut row = [0.0; 7];
                row[locked] = 1.0;
                if chain.correct(&mut q, &scaled, &row, value) {
                    curves.extend(trace(chain, &scaled, &q));
                }
            }
        }
    }
    let mut arcs = Vec::new();
    for curve in &curves {
        cut(chain, &scaled, curve, limits, &mut arcs);
    }
    arcs
}

/// Difference of two angles, in [−π, π].
fn difference(a: f64, b: f64) -> f64 {
    let d = a - b;
    d - TAU * (d / TAU).round()
}

fn largest_difference(a: &Q, b: &Q) -> f64 {
    a.iter().zip(b).fold(0.0, |largest: f64, (a, b)| {
        largest.max(difference(*a, *b).abs())
    })
}

/// True if a configuration lies on a curve, up to whole turns.
fn is_on(curve: &TracedCurve, q: &Q) -> bool {
    let wraps = curve
        .closed
        .then(|| [curve.samples.last(), curve.samples.first()]);
    let last = wraps.and_then(|[a, b]| Some([*a?, *b?]));
    let pairs = curve.samples.windows(2).map(|pair| [pair[0], pair[1]]);
    pairs.chain(last).any(|[a, b]| {
        // Ends at the first joint that is far, as for most pairs.
        if (0..7).any(|i| difference(a[i], q[i]).abs() > 2.0 * MAX_JOINT_STEP) {
            return false;
        }
        let along: Q = std::array::from_fn(|i| difference(b[i], a[i]));
        let to: Q = std::array::from_fn(|i| difference(q[i], a[i]));
        let square = dot(&along, &along).max(f64::MIN_POSITIVE);
        let t = (dot(&along, &to) / square).clamp(0.0, 1.0);
        (0..7).all(|i| (to[i] - t * along[i]).abs() <= ON_CURVE)
    })
}

/// Traces the curve through a configuration, forwards, and backwards as well unless it closes.
fn trace(chain: &SevenRevolute, target: &Placement<f64>, start: &Q) -> Option<TracedCurve> {
    let tangent = chain.tangent(start, target, None)?;
    let (mut samples, closed) = trace_along(chain, target, start, tangent);
    if !closed {
        let (mut back, _) = trace_along(chain, target, start, tangent.map(|v| -v));
        back.reverse();
        back.pop();
        back.append(&mut samples);
        samples = back;
    }
    Some(TracedCurve { samples, closed })
}

/// Traces from a configuration along a tangent until the curve closes, or ends at a singular configuration.
fn trace_along(
    chain: &SevenRevolute,
    target: &Placement<f64>,
    start: &Q,
    mut tangent: Q,
) -> (Vec<Q>, bool) {
    let mut samples = vec![*start];
    let first_tangent = tangent;
    let (mut q, mut step) = (*start, STEP);
    while samples.len() < MAX_SAMPLES {
        let longest = tangent
            .iter()
            .fold(0.0, |longest: f64, v| longest.max(v.abs()));
        let length = step / longest;
        let mut next: Q = std::array::from_fn(|i| q[i] + length * tangent[i]);
        let value = dot(&tangent, &next);
        let advanced = chain
            .correct(&mut next, target, &tangent, value)
            .then_some(next);
        let advanced = advanced.filter(|next| largest_difference(next, &q) <= MAX_JOINT_STEP);
        let turned = advanced.and_then(|next| {
            let tangent_there = chain.tangent(&next, target, Some(&tangent))?;
            (dot(&tangent_there, &tangent) >= MIN_TANGENT_COSINE).then_some((next, tangent_there))
        });
        let Some((next, tangent_there)) = turned else {
            step *= 0.5;
            if step < MIN_STEP {
                return (samples, false);
            }
            continue;
        };
        if samples.len() > 3 {
            // The start lies between the last two samples.
            let to: Q = std::array::from_fn(|i| difference(start[i], q[i]));
            let along: Q = std::array::from_fn(|i| next[i] - q[i]);
            let t = dot(&to, &along) / dot(&along, &along);
            let is_beside = (0..7).all(|i| (to[i] - t * along[i]).abs() <= ON_CURVE);
            if (0.0..=1.0).contains(&t) && is_beside && dot(&first_tangent, &tangent_there) > 0.5 {
                return (samples, true);
            }
        }
        (q, tangent) = (next, tangent_there);
        samples.push(q);
        step = (1.5 * step).min(STEP);
    }
    (samples, false)
}

/// Appends the arcs of a curve within limits, for all whole turns.
fn cut(
    chain: &SevenRevolute,
    target: &Placement<f64>,
    curve: &TracedCurve,
    limits: &[Limits; 7],
    arcs: &mut Vec<LimitedCurve>,
) {
    // One turn of a joint without limits represents all.
    let is_bounded = limits.map(|limits| limits.lower.is_finite() && limits.upper.is_finite());
    let winding: [f64; 7] = match (curve.samples.first(), curve.samples.last()) {
        (Some(first), Some(last)) if curve.closed => std::array::from_fn(|i| {
            let end = last[i] + difference(first[i], last[i]);
            TAU * ((end - first[i]) / TAU).round()
        }),
        _ => [0.0; 7],
    };
    let closes_in_space = (0..7).all(|i| winding[i] == 0.0 || !is_bounded[i]);
    // A curve with winding is laid out over as many rounds as a joint's range can hold.
    let rounds = (0..7).filter(|&i| winding[i] != 0.0 && is_bounded[i]);
    let rounds =
        rounds.map(|i| ((limits[i].upper - limits[i].lower) / winding[i].abs()).ceil() as usize);
    let rounds = rounds.max().map_or(1, |rounds| rounds.max(1) + 1);
    let mut samples: Vec<Q> = Vec::new();
    for round in 0..rounds {
        let shift = winding.map(|w| w * round as f64);
        samples.extend(
            curve
                .samples
                .iter()
                .map(|q| -> Q { std::array::from_fn(|i| q[i] + shift[i]) }),
        );
    }
    if curve.closed
        && let Some(first) = samples.first().copied()
    {
        let shift = winding.map(|w| w * rounds as f64);
        samples.push(std::array::from_fn(|i| first[i] + shift[i]));
    }
    // Whole turns of every joint that bring some sample within its limits.
    let turns: [Vec<f64>; 7] = std::array::from_fn(|i| {
        let (low, high) = samples
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| {
                (low.min(q[i]), high.max(q[i]))
            });
        if !is_bounded[i] {
            return vec![0.0];
        }
        let first = ((limits[i].lower - high) / TAU).ceil() as i64;
        let last = ((limits[i].upper - low) / TAU).floor() as i64;
        (first..=last).map(|k| k as f64 * TAU).collect()
    });
    let mut index = [0; 7];
    if turns.iter().any(Vec::is_empty) {
        return;
    }
    loop {
        let shift: Q = std::array::from_fn(|i| turns[i][index[i]]);
        cut_at_limits(
            chain,
            target,
            &samples,
            &shift,
            limits,
            curve.closed && closes_in_space,
            arcs,
        );
        let advanced = (0..7).any(|i| {
            index[i] += 1;
            let carries = index[i] == turns[i].len();
            if carries {
                index[i] = 0;
            }
            !carries
        });
        if !advanced {
            break;
        }
    }
}

/// Appends the arcs of shifted samples within limits. The first sample is repeated at the end of a closed curve.
fn cut_at_limits(
    chain: &SevenRevolute,
    target: &Placement<f64>,
    samples: &[Q],
    shift: &Q,
    limits: &[Limits; 7],
    closed: bool,
    arcs: &mut Vec<LimitedCurve>,
) {
    let shifted = samples
        .iter()
        .map(|q| -> Q { std::array::from_fn(|i| q[i] + shift[i]) });
    let is_within = |q: &Q| (0..7).all(|i| limits[i].lower <= q[i] && q[i] <= limits[i].upper);
    let first_arc = arcs.len();
    let (mut run, mut last): (Vec<Q>, Option<Q>) = (Vec::new(), None);
    let begins_within = samples.first().is_some_and(|q| {
        let q: Q = std::array::from_fn(|i| q[i] + shift[i]);
        is_within(&q)
    });
    for q in shifted {
        match (is_within(&q), last.as_ref()) {
            (true, Some(last)) if run.is_empty() => {
                run.extend(at_limit(chain, target, &q, last, limits));
                run.push(q);
            }
            (true, _) => run.push(q),
            (false, Some(last)) if !run.is_empty() => {
                run.extend(at_limit(chain, target, last, &q, limits));
                arcs.push(LimitedCurve {
                    samples: std::mem::take(&mut run),
                    closed: false,
                });
            }
            (false, Some(last)) => {
                if let Some(middle) = within_between(chain, target, last, &q, limits) {
                    let mut samples: Vec<Q> = at_limit(chain, target, &middle, last, limits)
                        .into_iter()
                        .collect();
                    samples.push(middle);
                    samples.extend(at_limit(chain, target, &middle, &q, limits));
                    arcs.push(LimitedCurve {
                        samples,
                        closed: false,
                    });
                }
            }
            (false, None) => {}
        }
        last = Some(q);
    }
    if run.is_empty() {
        return;
    }
    if closed && begins_within {
        if arcs.len() == first_arc {
            run.pop();
            arcs.push(LimitedCurve {
                samples: run,
                closed: true,
            });
            return;
        }
        // The last run continues in the first.
        run.pop();
        let unwound: Q = match (run.last(), arcs[first_arc].samples.first()) {
            (Some(end), Some(begin)) => {
                std::array::from_fn(|i| TAU * ((end[i] - begin[i]) / TAU).round())
            }
            _ => [0.0; 7],
        };
        run.iter_mut()
            .for_each(|q| q.iter_mut().zip(&unwound).for_each(|(q, w)| *q -= w));
        run.append(&mut arcs[first_arc].samples);
        arcs[first_arc].samples = run;
        return;
    }
    arcs.push(LimitedCurve {
        samples: run,
        closed: false,
    });
}

/// A configuration within limits between two samples that are not; `None` if the segment misses the limits.
fn within_between(
    chain: &SevenRevolute,
    target: &Placement<f64>,
    a: &Q,
    b: &Q,
    limits: &[Limits; 7],
) -> Option<Q> {
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for i in 0..7 {
        let d = b[i] - a[i];
        let (low, high) = ((limits[i].lower - a[i]) / d, (limits[i].upper - a[i]) / d);
        // NaN of a joint that rests on a limit leaves the bounds as they are.
        first = first.max(low.min(high));
        last = last.min(low.max(high));
    }
    if first > last {
        return None;
    }
    let t = 0.5 * (first + last);
    let mut q: Q = std::array::from_fn(|i| a[i] + t * (b[i] - a[i]));
    let along: Q = std::array::from_fn(|i| b[i] - a[i]);
    let length = dot(&along, &along).sqrt();
    let row = along.map(|v| v / length);
    let value = dot(&row, &q);
    let is_found = chain.correct(&mut q, target, &row, value);
    let is_within = (0..7).all(|i| limits[i].lower <= q[i] && q[i] <= limits[i].upper);
    (is_found && is_within).then_some(q)
}

/// The configuration at the limit that is passed first from `inside` to `outside`.
fn at_limit(
    chain: &SevenRevolute,
    target: &Placement<f64>,
    inside: &Q,
    outside: &Q,
    limits: &[Limits; 7],
) -> Option<Q> {
    let crossing = |i: usize| {
        let limit = limits[i].clamp(outside[i]);
        let t = (limit - inside[i]) / (outside[i] - inside[i]);
        (limit != outside[i]).then_some((t, i, limit))
    };
    let (t, joint, limit) = (0..7)
        .filter_map(crossing)
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let mut q: Q = std::array::from_fn(|i| inside[i] + t * (outside[i] - inside[i]));
    let mut row = [0.0; 7];
    row[joint] = 1.0;
    let is_found = chain.correct(&mut q, target, &row, limit)
        && largest_difference(&q, inside) <= MAX_JOINT_STEP;
    q[joint] = limit;
    let is_within = (0..7).all(|i| limits[i].lower <= q[i] && q[i] <= limits[i].upper);
    (is_found && is_within).then_some(q)
}
