//! Interpolation of Euler keyframes.

use glam::DVec3;

use super::{EulerClip, EulerTrack};
use crate::animation::ClipError;
use kinopt_kinematics::curve::{CurveValue, KeyError, KeyedCurve, TensionContinuityBias};
use kinopt_kinematics::skeleton::BoneId;

/// Interpolation of one bone's angles between keys. Each angle is interpolated independently.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum EulerInterpolation {
    /// Linear; the velocity is discontinuous at keys.
    Linear,
    /// Catmull-Rom spline over the times of the keys; the velocity is continuous.
    #[default]
    CatmullRom,
    /// Kochanek-Bartels spline with a set of controls for each key.
    KochanekBartels(Vec<TensionContinuityBias>),
}

/// Interpolation of bones without keys.
static DEFAULT: EulerInterpolation = EulerInterpolation::CatmullRom;

impl EulerInterpolation {
    pub(crate) const LINEAR: &str = "linear";
    pub(crate) const CATMULL_ROM: &str = "catmull-rom";
    pub(crate) const KOCHANEK_BARTELS: &str = "kochanek-bartels";

    /// Name in files and on the command line.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Linear => Self::LINEAR,
            Self::CatmullRom => Self::CATMULL_ROM,
            Self::KochanekBartels(_) => Self::KOCHANEK_BARTELS,
        }
    }

    /// Kochanek-Bartels spline with equal controls at all keys of a track.
    #[must_use]
    pub fn kochanek_bartels(track: &EulerTrack, controls: TensionContinuityBias) -> Self {
        Self::KochanekBartels(vec![controls; track.keys.len()])
    }

    /// Curve through values, such as vectors of a bone's angles, at times in seconds.
    ///
    /// # Errors
    /// A [`KeyError`] of the [`KeyedCurve`] constructor.
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

    /// Curves of tracks, by the interpolation of each.
    pub(super) fn curves(
        tracks: &[EulerTrack],
        interpolations: &[Self],
    ) -> Result<Vec<KeyedCurve<DVec3>>, ClipError> {
        let curve = |(track, interpolation): (&EulerTrack, &Self)| {
            interpolation.check(track)?;
            let times = track.keys.iter().map(|key| key.time);
            let angles = track.keys.iter().map(|key| DVec3::from(key.angles));
            let curve = interpolation.curve(times.collect(), angles.collect());
            let bone = track.bone.index();
            curve.map_err(|problem| ClipError::Curve { bone, problem })
        };
        tracks.iter().zip(interpolations).map(curve).collect()
    }

    /// Checks that Kochanek-Bartels controls are finite, with one set for each key.
    fn check(&self, track: &EulerTrack) -> Result<(), ClipError> {
        let Self::KochanekBartels(controls) = self else {
            return Ok(());
        };
        let (bone, given, keys) = (track.bone.index(), controls.len(), track.keys.len());
        if given != keys {
            return Err(ClipError::ControlCount { bone, given, keys });
        }
        let is_not_finite = |c: &TensionContinuityBias| {
            let [t, c, b] = [c.tension, c.continuity, c.bias];
            !(t.is_finite() && c.is_finite() && b.is_finite())
        };
        match controls.iter().position(is_not_finite) {
            Some(key) => Err(ClipError::NonFiniteControls { bone, key }),
            None => Ok(()),
        }
    }
}

impl EulerClip {
    /// The clip with the interpolation that `choose` returns for each track. A new clip has Catmull-Rom splines.
    ///
    /// # Errors
    /// A [`ClipError`]: the number of control sets is not the number of keys, or a control is not finite.
    pub fn interpolated(
        mut self,
        choose: impl Fn(&EulerTrack) -> EulerInterpolation,
    ) -> Result<Self, ClipError> {
        self.interpolations = self.tracks.iter().map(choose).collect();
        self.curves = EulerInterpolation::curves(&self.tracks, &self.interpolations)?;
        Ok(self)
    }

    /// Interpolation of a bone's keys.
    #[must_use]
    pub fn interpolation(&self, bone: BoneId) -> &EulerInterpolation {
        let track = self.tracks.binary_search_by_key(&bone, |track| track.bone);
        let interpolation = track.ok().and_then(|index| self.interpolations.get(index));
        interpolation.unwrap_or(&DEFAULT)
    }
}
