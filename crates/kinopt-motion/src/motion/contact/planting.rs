//! Positions of planted feet in contact, and their paths between contacts.

use std::ops::Range;

use super::detection::{ContactDetection, smooth};
use kinopt_kinematics::spatial::Vector3;

/// Height of the ground at a position, relative to the ground of the clip.
pub(in crate::motion) type Ground<'a> = &'a dyn Fn(Vector3<f64>) -> f64;

/// Largest extra height of a swinging foot above the straight path, in heights of the step.
const MAX_ARC_RATIO: f64 = 1.5;

/// Fraction of a swing over which a foot moves up or down a step.
const STEP_FRACTION: f64 = 0.7;

/// Contact of a foot before its plant: frames, position on level ground, and height of the ground there.
#[derive(Clone, Debug)]
pub(in crate::motion) struct FootContact {
    pub(in crate::motion) span: Range<usize>,
    pub(in crate::motion) position: Vector3<f64>,
    pub(in crate::motion) ground: f64,
}

/// Motion of a planted foot.
#[derive(Clone, Debug)]
pub(in crate::motion) struct PlantedFoot {
    /// Frames and position of each contact.
    pub(in crate::motion) stances: Vec<(Range<usize>, Vector3<f64>)>,
    /// Position by frame.
    pub(in crate::motion) positions: Vec<Vector3<f64>>,
    /// Height of the ground by frame: at the contact position, and interpolated between contacts.
    pub(in crate::motion) ground: Vec<f64>,
}

impl PlantedFoot {
    /// Returns the contact position if the foot is in contact in `frame` and in the next frame.
    pub(in crate::motion) fn contact_position_from(&self, frame: usize) -> Option<Vector3<f64>> {
        let mut stances = self.stances.iter();
        let contact =
            stances.find(|(span, _)| span.contains(&frame) && span.contains(&(frame + 1)));
        contact.map(|(_, position)| *position)
    }
}

/// Plants a foot that moves along `positions` in a clip. Its position in each contact is the mean of its positions in
/// the clip, raised to the ground.
pub(in crate::motion) fn plant(
    detection: &ContactDetection,
    positions: &[Vector3<f64>],
    up: Vector3<f64>,
    ground: Option<Ground<'_>>,
    rate: f64,
) -> PlantedFoot {
    let lowest = lowest_height(positions, up);
    let spans = detection.spans(positions, |frame| positions[frame].dot(up) - lowest, rate);
    let contacts = spans.into_iter().map(|span| {
        let position = mean_position(&positions[span.clone()]);
        FootContact {
            ground: ground.map_or(0.0, |ground| ground(position)),
            position,
            span,
        }
    });
    let contacts: Vec<FootContact> = contacts.collect();
    plant_at(
        &contacts,
        positions,
        up,
        ground,
        detection.lead_frames(rate),
    )
}

/// Moves a foot along `positions` into its contacts.
///
/// Between contacts the foot blends to and from `positions` over `lead` frames. If the ground rises or falls, the
/// change of height covers the whole swing. The swing is raised above edges of the ground.
pub(in crate::motion) fn plant_at(
    contacts: &[FootContact],
    positions: &[Vector3<f64>],
    up: Vector3<f64>,
    ground: Option<Ground<'_>>,
    lead: usize,
) -> PlantedFoot {
    let lead = lead.max(1);
    let lowest = lowest_height(positions, up);
    let height = |position: Vector3<f64>| ground.map_or(0.0, |ground| ground(position));
    let (mut planted, mut lifts) = (positions.to_vec(), vec![0.0; positions.len()]);
    for contact in contacts {
        planted[contact.span.clone()].fill(contact.position);
        lifts[contact.span.clone()].fill(contact.ground);
    }
    let mut ground_heights = lifts.clone();
    for swing in swings(contacts, positions.len()) {
        let offset_at = |k: Option<usize>, frame: usize| {
            let contact = k.and_then(|k| contacts.get(k))?;
            Some((contact.position - *positions.get(frame)?, contact.ground))
        };
        let from = offset_at(swing.after, swing.frames.start.wrapping_sub(1));
        let to = offset_at(swing.before, swing.frames.end);
        // If the clip starts or ends without contact, the ground below the foot counts.
        let ground_below = |frame: usize| {
            positions
                .get(frame)
                .map_or(0.0, |position| height(*position))
        };
        let first = from.map_or_else(|| ground_below(swing.frames.start), |(_, lift)| lift);
        let last = to.map_or_else(|| ground_below(swing.frames.end - 1), |(_, lift)| lift);
        let steps = (swing.frames.len() + 1) as f64;
        let elapsed = |frame: usize| (frame + 1 - swing.frames.start) as f64;
        for frame in swing.frames.clone() {
            let weight = |frames: f64| 1.0 - smooth((frames / steps.min(lead as f64)).min(1.0));
            let slip = |end: Option<(Vector3<f64>, f64)>, frames: f64| {
                end.map_or(Vector3::zero(), |(slip, _)| slip * weight(frames))
            };
            planted[frame] =
                positions[frame] + slip(from, elapsed(frame)) + slip(to, steps - elapsed(frame));
            lifts[frame] =
                first + (last - first) * step_fraction(elapsed(frame) / steps, last > first);
        }
        ground_heights[swing.frames.clone()].copy_from_slice(&lifts[swing.frames.clone()]);
        let neighbours = [swing.after, swing.before].into_iter().flatten();
        let foot_height = neighbours
            .map(|k| contacts[k].position.dot(up))
            .reduce(f64::min);
        let foot_height = foot_height.unwrap_or(lowest);
        // 1 in the middle of the swing, with zero slope at both ends.
        let arc = |frame: usize| {
            let fraction = elapsed(frame) / steps;
            16.0 * fraction * fraction * (1.0 - fraction) * (1.0 - fraction)
        };
        let missing_arc = |frame: usize| {
            let position = planted[frame];
            (height(position) + foot_height - position.dot(up) - lifts[frame]) / arc(frame)
        };
        let max_arc = MAX_ARC_RATIO * (last - first).abs();
        let arc_height = swing
            .frames
            .clone()
            .map(missing_arc)
            .fold(0.0, f64::max)
            .min(max_arc);
        for frame in swing.frames.clone() {
            lifts[frame] += arc_height * arc(frame);
        }
    }
    for (position, lift) in planted.iter_mut().zip(&lifts) {
        *position += up * *lift;
    }
    let stances = contacts.iter().map(|contact| {
        let position = contact.position + up * contact.ground;
        (contact.span.clone(), position)
    });
    PlantedFoot {
        stances: stances.collect(),
        positions: planted,
        ground: ground_heights,
    }
}

/// Returns the smallest height of some positions.
fn lowest_height(positions: &[Vector3<f64>], up: Vector3<f64>) -> f64 {
    let heights = positions.iter().map(|position| position.dot(up));
    heights.fold(f64::INFINITY, f64::min)
}

/// Returns the mean position over some capture frames. Needs at least one.
pub(in crate::motion) fn mean_position(positions: &[Vector3<f64>]) -> Vector3<f64> {
    let sum = positions
        .iter()
        .fold(Vector3::zero(), |sum, position| sum + *position);
    sum * (1.0 / positions.len().max(1) as f64)
}

/// Returns the fraction of a step's height change after a fraction of the swing. A foot rises early and descends late.
fn step_fraction(fraction: f64, up: bool) -> f64 {
    let onset = if up { 0.0 } else { 1.0 - STEP_FRACTION };
    smooth(((fraction - onset) / STEP_FRACTION).clamp(0.0, 1.0))
}

/// Frames between two contacts, before the first or after the last.
struct SwingPhase {
    frames: Range<usize>,
    after: Option<usize>,
    before: Option<usize>,
}

fn swings(contacts: &[FootContact], frames: usize) -> impl Iterator<Item = SwingPhase> + '_ {
    (0..=contacts.len()).filter_map(move |k| {
        let after = k.checked_sub(1);
        let before = (k < contacts.len()).then_some(k);
        let start = after.map_or(0, |k| contacts[k].span.end);
        let end = before.map_or(frames, |k| contacts[k].span.start);
        (start < end).then_some(SwingPhase {
            frames: start..end,
            after,
            before,
        })
    })
}
