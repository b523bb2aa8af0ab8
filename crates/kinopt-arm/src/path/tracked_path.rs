//! Joint path that [`Arm::track`](crate::Arm::track) finds from a start.

use super::PathError;
use super::knot_configurations::KnotPath;
use super::layers::LayerGenerator;

/// Tracks all knots from a start, which stays the first configuration.
///
/// Also returns the required end: `end` if given, or for a cyclic path the start plus the whole revolutions of
/// unlimited joints.
pub(super) fn track(
    generator: &LayerGenerator<'_>,
    start: &[f64],
    end: Option<&[f64]>,
) -> Result<(KnotPath, Option<Vec<f64>>), PathError> {
    let (knots, n) = (generator.knots, generator.width());
    let mut q: Vec<f64> = Vec::with_capacity(knots.len() * n);
    let mut reached = Vec::with_capacity(knots.len());
    while reached.len() < knots.len() {
        let first = reached.len();
        let same_tool = (first + 1..knots.len()).take_while(|knot| knots.has_segment_to(*knot));
        let targets = &knots.targets[first..first + 1 + same_tool.count()];
        let from = match first {
            0 => start,
            _ => &q[(first - 1) * n..],
        };
        let arm = generator.arms.arm(knots.tool(first));
        let track = arm.track(targets, from)?;
        q.extend_from_slice(&track.q);
        reached.extend(track.report.iter().map(|solution| solution.reached));
    }
    q[..n].copy_from_slice(start);
    reached[0] = true;
    let last = (knots.len() - 1) * n;
    let end = match end {
        Some(end) => Some(end.to_vec()),
        None if knots.closed => {
            let moves = q[last..].iter().zip(start).enumerate();
            let end = moves
                .map(|(joint, (q, start))| start + generator.whole_revolutions(joint, q - start));
            Some(end.collect())
        }
        None => None,
    };
    if let Some(end) = &end {
        q[last..].copy_from_slice(end);
        reached[knots.len() - 1] = true;
    }
    let mut joint_path = KnotPath {
        joined: vec![true; knots.len()],
        allowance: vec![1.0; knots.len()],
        q,
        reached,
    };
    for knot in 1..knots.len() {
        let (from, to) = (joint_path.row(knot - 1, n), joint_path.row(knot, n));
        joint_path.joined[knot] = generator.bounds.allows(knots, knot, from, to);
    }
    Ok((joint_path, end))
}
