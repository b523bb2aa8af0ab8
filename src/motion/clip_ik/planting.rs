//! Positions of planted feet in contact, and their paths between contacts.

use std::ops::Range;

use crate::motion::ContactDetection;
use crate::motion::contact_detection::{mean_position, smooth};
use crate::spatial::Vector3;

/// Height of the ground at a position, relative to the ground of the clip.
pub(super) type Ground<'a> = &'a dyn Fn(Vector3<f64>) -> f64;

/// Largest extra height of a swinging foot above the straight path, in heights of the step.
const HIGHEST_ARC: f64 = 1.5;

/// Fraction of a swing over which a foot moves up or down a step.
const STEPPING: f64 = 0.7;

/// Motion of a planted foot over a clip.
#[derive(Clone, Debug)]
pub(super) struct Planted {
    /// Frames and position of each contact.
    pub(super) stances: Vec<(Range<usize>, Vector3<f64>)>,
    /// Position by frame.
    pub(super) way: Vec<Vector3<f64>>,
    /// Height of the ground by frame: at the contact position, and interpolated between contacts.
    pub(super) ground: Vec<f64>,
}

impl Planted {
    /// Returns the contact position if the foot is in contact in `frame` and in the next frame.
    pub(super) fn stands_from(&self, frame: usize) -> Option<Vector3<f64>> {
        let mut stances = self.stances.iter();
        let own = stances.find(|(span, _)| span.contains(&frame) && span.contains(&(frame + 1)));
        own.map(|(_, place)| *place)
    }
}

/// Plants a foot that moves along `way` in the clip. Its position in each contact is the mean of its positions in the
/// clip, raised to the ground.
///
/// Between contacts the foot blends to and from the clip over `detection.lead_s`. If the ground rises or falls, the
/// change of height covers the whole swing. The swing is raised above edges of the ground.
pub(super) fn plant(
    detection: &ContactDetection,
    way: &[Vector3<f64>],
    up: Vector3<f64>,
    ground: Option<Ground<'_>>,
    rate: f64,
) -> Planted {
    let lowest = way
        .iter()
        .map(|at| at.dot(up))
        .fold(f64::INFINITY, f64::min);
    let spans = detection.spans(way, |frame| way[frame].dot(up) - lowest, rate);
    let height = |at: Vector3<f64>| ground.map_or(0.0, |ground| ground(at));
    let stands: Vec<(Vector3<f64>, f64)> = spans
        .iter()
        .map(|span| {
            let place = mean_position(&way[span.clone()]);
            (place, height(place))
        })
        .collect();
    let (mut planted, mut lifts) = (way.to_vec(), vec![0.0; way.len()]);
    for (span, (place, lift)) in spans.iter().zip(&stands) {
        planted[span.clone()].fill(*place);
        lifts[span.clone()].fill(*lift);
    }
    let mut ground_of = lifts.clone();
    let lead = detection.lead_frames(rate).max(1);
    for gap in gaps(&spans, way.len()) {
        let stand = |k: Option<usize>, frame: usize| {
            let (place, lift) = k.and_then(|k| stands.get(k))?;
            Some((*place - *way.get(frame)?, *lift))
        };
        let from = stand(gap.after, gap.frames.start.wrapping_sub(1));
        let to = stand(gap.before, gap.frames.end);
        // If the clip starts or ends without contact, the ground below the foot counts.
        let below = |frame: usize| way.get(frame).map_or(0.0, |at| height(*at));
        let first = from.map_or_else(|| below(gap.frames.start), |(_, lift)| lift);
        let last = to.map_or_else(|| below(gap.frames.end - 1), |(_, lift)| lift);
        let steps = (gap.frames.len() + 1) as f64;
        let since = |frame: usize| (frame + 1 - gap.frames.start) as f64;
        for frame in gap.frames.clone() {
            let left = |frames: f64| 1.0 - smooth((frames / steps.min(lead as f64)).min(1.0));
            let slip = |end: Option<(Vector3<f64>, f64)>, frames: f64| {
                end.map_or(Vector3::zero(), |(slip, _)| slip * left(frames))
            };
            planted[frame] = way[frame] + slip(from, since(frame)) + slip(to, steps - since(frame));
            lifts[frame] = first + (last - first) * risen(since(frame) / steps, last > first);
        }
        ground_of[gap.frames.clone()].copy_from_slice(&lifts[gap.frames.clone()]);
        let stood = [gap.after, gap.before].into_iter().flatten();
        let sole = stood.map(|k| stands[k].0.dot(up)).reduce(f64::min);
        let sole = sole.unwrap_or(lowest);
        // 1 in the middle of the swing, with zero slope at both ends.
        let arc = |frame: usize| {
            let share = since(frame) / steps;
            16.0 * share * share * (1.0 - share) * (1.0 - share)
        };
        let lacks = |frame: usize| {
            let at = planted[frame];
            (height(at) + sole - at.dot(up) - lifts[frame]) / arc(frame)
        };
        let highest = HIGHEST_ARC * (last - first).abs();
        let arched = gap
            .frames
            .clone()
            .map(lacks)
            .fold(0.0, f64::max)
            .min(highest);
        for frame in gap.frames.clone() {
            lifts[frame] += arched * arc(frame);
        }
    }
    for (at, lift) in planted.iter_mut().zip(&lifts) {
        *at += up * *lift;
    }
    let places = stands.iter().map(|(place, lift)| *place + up * *lift);
    Planted {
        stances: spans.into_iter().zip(places).collect(),
        way: planted,
        ground: ground_of,
    }
}

/// Returns the fraction of a step's height change after a fraction of the swing. A foot rises early and descends late.
fn risen(share: f64, up: bool) -> f64 {
    let begun = if up { 0.0 } else { 1.0 - STEPPING };
    smooth(((share - begun) / STEPPING).clamp(0.0, 1.0))
}

/// Frames between two contacts, before the first or after the last.
struct Gap {
    frames: Range<usize>,
    after: Option<usize>,
    before: Option<usize>,
}

fn gaps(spans: &[Range<usize>], frames: usize) -> impl Iterator<Item = Gap> + '_ {
    (0..=spans.len()).filter_map(move |k| {
        let after = k.checked_sub(1);
        let before = (k < spans.len()).then_some(k);
        let start = after.map_or(0, |k| spans[k].end);
        let end = before.map_or(frames, |k| spans[k].start);
        (start < end).then_some(Gap {
            frames: start..end,
            after,
            before,
        })
    })
}
