//! When feet stand, and where.

use std::ops::Range;

use super::limbs::Limbs;
use crate::spatial::Vector3;

/// When something that may stand does: by its speed, and how high it is, on a body of the model's size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactDetection {
    /// It moves no faster than this, m/s.
    pub speed: f64,
    /// It is no higher over the ground than this, metres; infinity where people climb.
    pub height: f64,
    /// It does so for at least this long, seconds.
    pub shortest_s: f64,
    /// So long before and after, what stands is led to its place and let go, seconds.
    pub lead_s: f64,
}

/// What stands so near to the ground stands on it, metres.
const ON_GROUND: f64 = 0.04;

impl Default for ContactDetection {
    /// 0.25 m/s at any height, for a tenth of a second, led for 0.15 seconds.
    fn default() -> Self {
        Self {
            speed: 0.25,
            height: f64::INFINITY,
            shortest_s: 0.1,
            lead_s: 0.15,
        }
    }
}

/// A limb that stands over a span of frames.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Standing {
    pub(super) limb: usize,
    pub(super) span: Range<usize>,
}

impl ContactDetection {
    /// Finds what stands, and puts targets (frame after frame) where it does: one place over each span, on the ground or
    /// above it, with a smooth way there and back.
    pub(super) fn plant(
        &self,
        limbs: &Limbs,
        rate: f64,
        targets: &mut [Vector3<f64>],
    ) -> Vec<Standing> {
        let n = limbs.all.len();
        let frames = targets.len() / n;
        let mut found = Vec::new();
        for (limb, own) in limbs.all.iter().enumerate().filter(|(_, own)| own.stands) {
            let way: Vec<Vector3<f64>> =
                (0..frames).map(|frame| targets[frame * n + limb]).collect();
            let spans = self.spans(&way, own.clearance, rate);
            // Nothing is below the ground.
            let lift = |at: Vector3<f64>| Vector3::new(at.x, at.y, at.z.max(own.clearance));
            let lead = self.lead_frames(rate);
            for (frame, at) in way.iter().enumerate() {
                targets[frame * n + limb] = lift(*at);
            }
            for (k, span) in spans.iter().enumerate() {
                let sum = way[span.clone()]
                    .iter()
                    .fold(Vector3::zero(), |sum, at| sum + *at);
                let mut place = lift(sum * (1.0 / span.len() as f64));
                if place.z - own.clearance < ON_GROUND {
                    place.z = own.clearance;
                }
                let before = k.checked_sub(1).map_or(0, |last| spans[last].end);
                let after = spans.get(k + 1).map_or(frames, |next| next.start);
                for frame in
                    span.start.saturating_sub(lead).max(before)..(span.end + lead).min(after)
                {
                    let off = if frame < span.start {
                        span.start - frame
                    } else {
                        (frame + 1).saturating_sub(span.end)
                    };
                    let share = 1.0 - smooth(off as f64 / (lead + 1) as f64);
                    let at = &mut targets[frame * n + limb];
                    *at = *at + (place - *at) * share;
                }
            }
            found.extend(spans.into_iter().map(|span| Standing { limb, span }));
        }
        found
    }

    /// Over how many frames what stands is led there, and let go.
    pub(super) fn lead_frames(&self, rate: f64) -> usize {
        (self.lead_s * rate).ceil() as usize
    }

    /// The spans over which a place hardly moves.
    fn spans(&self, way: &[Vector3<f64>], clearance: f64, rate: f64) -> Vec<Range<usize>> {
        let last = way.len() - 1;
        // Over five frames, as captures tremble.
        let is_still = |frame: usize| {
            let (from, to) = (frame.saturating_sub(2), (frame + 2).min(last));
            let moved = (way[to] - way[from]).norm() * rate / (to - from).max(1) as f64;
            moved <= self.speed && way[frame].z - clearance <= self.height
        };
        let shortest = ((self.shortest_s * rate).ceil() as usize).max(2);
        let mut spans: Vec<Range<usize>> = Vec::new();
        for frame in (0..way.len()).filter(|&frame| is_still(frame)) {
            match spans.last_mut() {
                Some(span) if span.end == frame => span.end += 1,
                _ => spans.push(frame..frame + 1),
            }
        }
        spans.retain(|span| span.len() >= shortest);
        spans
    }
}

/// From 0 to 1, level at both ends.
fn smooth(share: f64) -> f64 {
    share * share * (3.0 - 2.0 * share)
}
