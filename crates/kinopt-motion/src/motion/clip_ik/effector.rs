//! Targets of a bone over a clip.

use std::ops::RangeInclusive;

use glam::DVec3;

use super::ClipIkError;
use crate::motion::contact::smooth;
use kinopt_kinematics::curve::KeyedCurve;
use kinopt_kinematics::skeleton::BoneId;
use kinopt_kinematics::spatial::Vector3;

/// Target of a bone over a span of a clip: a point or a curve. The bone's origin reaches it; with a skeleton, the
/// bone's tip.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    pub(super) bone: BoneId,
    target: KeyedCurve<DVec3>,
    span: Option<[f64; 2]>,
    fade_s: Option<f64>,
}

/// Default fade duration, seconds.
const FADE_S: f64 = 0.2;

impl Reach {
    /// Creates a reach to a point in the model, over the whole clip.
    ///
    /// # Errors
    /// Returns an error if the point is not finite.
    pub fn to(bone: BoneId, point: impl Into<Vector3<f64>>) -> Result<Self, ClipIkError> {
        let curve = KeyedCurve::step(vec![0.0], vec![DVec3::from(point.into())])?;
        Ok(Self::along(bone, curve))
    }

    /// Creates a reach along a curve in the model over the clip's time in seconds, over the whole clip.
    #[must_use]
    pub fn along(bone: BoneId, curve: KeyedCurve<DVec3>) -> Self {
        Self {
            bone,
            target: curve,
            span: None,
            fade_s: None,
        }
    }

    /// Limits the reach to an interval of the clip, seconds.
    #[must_use]
    pub fn with_span(mut self, seconds: RangeInclusive<f64>) -> Self {
        self.span = Some([*seconds.start(), *seconds.end()]);
        self
    }

    /// Sets the duration of the blend at the start and at the end of the span, seconds. Default: 0.2, or half of a
    /// shorter span. There is no blend at the start or end of the clip itself.
    #[must_use]
    pub fn with_fade(mut self, seconds: f64) -> Self {
        self.fade_s = Some(seconds);
        self
    }

    /// Returns the span within a clip, seconds.
    pub(super) fn span(&self, clip: [f64; 2]) -> [f64; 2] {
        self.span.unwrap_or(clip)
    }

    fn fade_s(&self, clip: [f64; 2]) -> f64 {
        let [from, to] = self.span(clip);
        self.fade_s.unwrap_or(FADE_S.min(0.5 * (to - from)))
    }

    /// Returns the target at a time, in the model.
    pub(super) fn target(&self, time: f64) -> DVec3 {
        self.target.at(time)
    }

    /// Returns the weight of the target at a time, from 0 (pose of the clip) to 1 (target).
    pub(super) fn weight(&self, time: f64, clip: [f64; 2]) -> f64 {
        let [from, to] = self.span(clip);
        if time < from || time > to {
            return 0.0;
        }
        let fade = self.fade_s(clip);
        let side = |since: f64, at_end_of_clip: bool| match at_end_of_clip || since >= fade {
            true => 1.0,
            false => smooth(since / fade),
        };
        side(time - from, from <= clip[0]) * side(to - time, to >= clip[1])
    }

    /// Checks that the span overlaps a clip and is not shorter than its two fades.
    pub(super) fn check(&self, clip: [f64; 2]) -> Result<(), ClipIkError> {
        let [from, to] = self.span(clip);
        let fade = self.fade_s(clip);
        let within = from < to && from < clip[1] && to > clip[0] || self.span.is_none();
        match within && fade >= 0.0 && (2.0 * fade <= to - from || fade == 0.0) {
            true => Ok(()),
            false => Err(ClipIkError::BadSpan {
                from,
                to,
                fade,
                clip,
            }),
        }
    }

    /// Returns whether two reaches of one bone overlap in time.
    pub(super) fn clashes(&self, other: &Self, clip: [f64; 2]) -> bool {
        let ([a, b], [c, d]) = (self.span(clip), other.span(clip));
        self.bone == other.bone && a < d && c < b
    }
}
