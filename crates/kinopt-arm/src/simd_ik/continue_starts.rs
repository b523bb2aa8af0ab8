//! Continuation of many starts to one target, each by one attempt.
//!
//! An attempt ends within about 1e-4 of the chain's length from the target, close enough to continue from there. The
//! linear model of a step predicts its end, so most attempts take one or two evaluations without a final error check.

use super::batch::Work;
use super::chain::MAX_JOINTS;
use super::group::LaneGroup;
use super::lane::LaneScalar;
use super::lm_step::EndMasks;
use super::prepared::Prepared;
use super::revolutions::unwrap_towards;
use super::seeds::fill_start;
use super::settings::Settings;
use super::stages::Stages;

/// Runs one attempt from each start to the single target.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn continue_starts<V: LaneScalar, const L: usize, const N: usize>(
    stages: &Stages<V, N>,
    prepared: &Prepared,
    work: Work<'_>,
) {
    let Some(target) = work.targets.first() else {
        return;
    };
    let (links, n) = (&prepared.links, prepared.joints());
    let settings = Settings {
        is_continuation: true,
        ..prepared.settings
    };
    let goal_from_first = links.goal_from_first(target, settings.weighted);
    let mut group = LaneGroup::<V, N>::new(n);
    for lane in 0..L {
        group.aim(lane, &goal_from_first);
    }
    let (mut next, mut active) = (0, 0_u32);
    let (mut indices, mut ages) = ([0; L], [0_u32; L]);
    let mut q = [0.0; MAX_JOINTS];
    // Initially every lane counts as finished, without a start.
    let (mut finished, mut ended) = ((1_u32 << L) - 1, EndMasks::none());
    loop {
        while finished != 0 {
            let lane = finished.trailing_zeros() as usize;
            finished &= finished - 1;
            let is_in = |bits: u32| bits >> lane & 1 != 0;
            if is_in(active) {
                let index = indices[lane];
                let end = &mut work.q[index * n..(index + 1) * n];
                match is_in(ended.closing) && !is_in(ended.reached) {
                    true => group.next_point(lane, end),
                    false => group.point(lane, end),
                }
                let start = &work.starts[index * n..(index + 1) * n];
                // Within half a revolution of the start there is no revolution to add.
                let is_near = |(a, b): (&f64, &f64)| (a - b).abs() < 3.0;
                if !end.iter().zip(start).all(is_near) {
                    unwrap_towards(prepared, start, end);
                }
                links.to_metres(end);
                work.outcomes[index].reached = is_in(ended.closing | ended.reached);
            }
            if next < work.outcomes.len() {
                fill_start(links, &work.starts[next * n..(next + 1) * n], &mut q);
                group.begin(lane, &q, &settings);
                (indices[lane], ages[lane]) = (next, 0);
                active |= 1 << lane;
                next += 1;
            } else {
                active &= !(1 << lane);
            }
        }
        if active == 0 {
            return;
        }
        ended = (stages.step)(&mut group, links, &settings);
        finished = ended.reached | ended.stalled | ended.closing;
        for (lane, age) in ages.iter_mut().enumerate() {
            *age += 1;
            finished |= u32::from(*age >= prepared.options.iterations) << lane;
        }
        finished &= active;
    }
}
