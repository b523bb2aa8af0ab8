//! How a bone's angles go from key to key: straight, or by which spline.

use glam::DVec3;

use super::{ClipError, EulerClip, EulerTrack};
use crate::animation::curve::{CurveValue, KeyError, KeyedCurve, TensionContinuityBias};
use crate::skeleton::BoneId;

/// How the angles of one bone go from key to key. Each angle goes by itself.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum EulerInterpolation {
    /// Straight from key to key: what to try first, but the speed jumps at every key.
    Linear,
    /// A Catmull-Rom spline over the keys' own times: the speed does not jump.
    #[default]
    CatmullRom,
    /// A Kochanek-Bartels spline: one set of controls for each key says how it is passed.
    KochanekBartels(Vec<TensionContinuityBias>),
}

/// Where a bone has no keys.
static DEFAULT: EulerInterpolation = EulerInterpolation::CatmullRom;

impl EulerInterpolation {
    pub(crate) const LINEAR: &str = "linear";
    pub(crate) const CATMULL_ROM: &str = "catmull-rom";
    pub(crate) const KOCHANEK_BARTELS: &str = "kochanek-bartels";

    /// What files and the command line call it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Linear => Self::LINEAR,
            Self::CatmullRom => Self::CATMULL_ROM,
            Self::KochanekBartels(_) => Self::KOCHANEK_BARTELS,
        }
    }

    /// A Kochanek-Bartels spline that passes all of a track's keys alike.
    #[must_use]
    pub fn kochanek_bartels(track: &EulerTrack, controls: TensionContinuityBias) -> Self {
        Self::KochanekBartels(vec![controls; track.keys.len()])
    }

    /// The curve through these values (vectors of a bone's angles, say) at these times in seconds.
    ///
    /// # Errors
    /// As [`KeyedCurve`]'s own makers.
    pub fn curve<V: CurveValue>(
        &self,
        times: Vec<V::Real>,
        values: Vec<V>,
    ) -> Result<KeyedCurve<V>, KeyError> {
        match self {
            Self::Linear => KeyedCurve::linear(times, values),
            Self::CatmullRom => KeyedCurve::catmull_rom(times, values),
            Self::KochanekBartels(controls) => {
                KeyedCurve::kochanek_bartels(times, values, controls)
            }
        }
    }

    /// The curves of tracks by what runs between the keys of each.
    pub(super) fn curves(
        tracks: &[EulerTrack],
        between: &[Self],
    ) -> Result<Vec<KeyedCurve<DVec3>>, ClipError> {
        let curve = |(track, between): (&EulerTrack, &Self)| {
            between.check(track)?;
            let times = track.keys.iter().map(|key| key.time);
            let angles = track.keys.iter().map(|key| DVec3::from(key.angles));
            let curve = between.curve(times.collect(), angles.collect());
            let bone = track.bone.index();
            curve.map_err(|problem| ClipError::Curve { bone, problem })
        };
        tracks.iter().zip(between).map(curve).collect()
    }

    /// Checks that there is a set of finite controls for each key where there are any.
    fn check(&self, track: &EulerTrack) -> Result<(), ClipError> {
        let Self::KochanekBartels(controls) = self else {
            return Ok(());
        };
        let (bone, given, keys) = (track.bone.index(), controls.len(), track.keys.len());
        if given != keys {
            return Err(ClipError::ControlCount { bone, given, keys });
        }
        let odd = |c: &TensionContinuityBias| {
            let [t, c, b] = [c.tension, c.continuity, c.bias];
            !(t.is_finite() && c.is_finite() && b.is_finite())
        };
        match controls.iter().position(odd) {
            Some(key) => Err(ClipError::NonFiniteControls { bone, key }),
            None => Ok(()),
        }
    }
}

impl EulerClip {
    /// The same keys with what `choose` says between them, for each track. A new clip has Catmull-Rom
    /// splines throughout.
    ///
    /// # Errors
    /// A [`ClipError`]: there is not one set of controls for each of a track's keys, or one is not
    /// finite.
    pub fn interpolated(
        mut self,
        choose: impl Fn(&EulerTrack) -> EulerInterpolation,
    ) -> Result<Self, ClipError> {
        self.between = self.tracks.iter().map(choose).collect();
        self.curves = EulerInterpolation::curves(&self.tracks, &self.between)?;
        Ok(self)
    }

    /// What runs between a bone's keys.
    #[must_use]
    pub fn interpolation(&self, bone: BoneId) -> &EulerInterpolation {
        let track = self.tracks.binary_search_by_key(&bone, |track| track.bone);
        let found = track.ok().and_then(|index| self.between.get(index));
        found.unwrap_or(&DEFAULT)
    }
}
