//! Curves through rotations at key times, with any spacing.

use glam::{Quat, Vec3, Vec4};

use super::{RotationHermite, mean_rates, nearer, slerp, squad, squad_control};
use kinopt_kinematics::curve::easing::Easing;
use kinopt_kinematics::curve::{Hermite, KeyError, check_count, check_times};

/// Curve through unit quaternions at key times. It is constant before the first and after the last key.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "super::serialised::RotationCurveKeys")
)]
pub struct RotationCurve {
    times: Vec<f32>,
    rotations: Vec<Quat>,
    between: BetweenRotations,
}

/// Interpolation between keys.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum BetweenRotations {
    Step,
    Slerp,
    /// Slerp with an easing for each segment.
    Eased(Vec<Easing>),
    /// Squad, with a control quaternion for each key.
    Squad(Vec<Quat>),
    /// Cubic; (arriving, leaving) rates of the components at each key.
    Cubic(Vec<[Vec4; 2]>),
    /// Hermite, with the angular velocities at the keys.
    Hermite(Vec<Vec3>),
}

impl RotationCurve {
    /// Checks and normalises keys; flips each to the hemisphere of the previous key.
    pub(super) fn checked(
        times: Vec<f32>,
        mut rotations: Vec<Quat>,
        between: BetweenRotations,
    ) -> Result<Self, KeyError> {
        check_times(&times)?;
        check_count("values", rotations.len(), times.len())?;
        let mut previous = None;
        for (key, rotation) in rotations.iter_mut().enumerate() {
            *rotation = unit(key, *rotation)?.0;
            *rotation = nearer(*rotation, previous.unwrap_or(*rotation));
            previous = Some(*rotation);
        }
        Ok(Self {
            times,
            rotations,
            between,
        })
    }

    /// Curve that holds each key's rotation until the next key (glTF's `STEP`). The constructors of this type normalise
    /// the quaternions.
    ///
    /// # Errors
    /// A [`KeyError`]: no keys, differing counts, a number that is not finite, a zero quaternion, or times that do not
    /// strictly increase.
    pub fn step(times: Vec<f32>, rotations: Vec<Quat>) -> Result<Self, KeyError> {
        Self::checked(times, rotations, BetweenRotations::Step)
    }

    /// Slerp with constant angular speed along the shorter arc between keys (glTF's `LINEAR`).
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn slerp(times: Vec<f32>, rotations: Vec<Quat>) -> Result<Self, KeyError> {
        Self::checked(times, rotations, BetweenRotations::Slerp)
    }

    /// Slerp with an easing for each segment, stored at the key where the segment starts. The easing of the last key is
    /// unused.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn eased(
        times: Vec<f32>,
        rotations: Vec<Quat>,
        easings: Vec<Easing>,
    ) -> Result<Self, KeyError> {
        check_count("easings", easings.len(), times.len())?;
        Self::checked(times, rotations, BetweenRotations::Eased(easings))
    }

    /// [`squad`] curve: smooth if the keys are evenly spaced.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn squad(times: Vec<f32>, rotations: Vec<Quat>) -> Result<Self, KeyError> {
        let mut curve = Self::slerp(times, rotations)?;
        let keys = &curve.rotations;
        let neighbour = |key: Option<usize>, rotation: Quat| {
            key.and_then(|key| keys.get(key))
                .copied()
                .unwrap_or(rotation)
        };
        let controls = keys.iter().enumerate().map(|(key, &rotation)| {
            let before = neighbour(key.checked_sub(1), rotation);
            squad_control(before, rotation, neighbour(Some(key + 1), rotation))
        });
        curve.between = BetweenRotations::Squad(controls.collect());
        Ok(curve)
    }

    /// [`RotationHermite`] segments with [`mean_rates`]: smooth at uneven times.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn smooth(times: Vec<f32>, rotations: Vec<Quat>) -> Result<Self, KeyError> {
        let mut curve = Self::slerp(times, rotations)?;
        let rates = mean_rates(&curve.times, &curve.rotations);
        curve.between = BetweenRotations::Hermite(rates);
        Ok(curve)
    }

    /// Normalised cubic of the quaternion components, with `[arriving, leaving]` tangents per second at each key
    /// (glTF's `CUBICSPLINE`). Signs of the quaternions are preserved, because the tangents depend on them.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn cubic(
        times: Vec<f32>,
        mut rotations: Vec<Quat>,
        mut tangents: Vec<[Vec4; 2]>,
    ) -> Result<Self, KeyError> {
        check_times(&times)?;
        check_count("values", rotations.len(), times.len())?;
        check_count("tangents", tangents.len(), times.len())?;
        for (key, (rotation, rates)) in rotations.iter_mut().zip(&mut tangents).enumerate() {
            let (unit_rotation, scale) = unit(key, *rotation)?;
            *rotation = unit_rotation;
            *rates = rates.map(|rate| rate * scale);
            if !rates.iter().all(|rate| rate.is_finite()) {
                let what = "tangent";
                return Err(KeyError::NonFiniteValue { key, what });
            }
        }
        Ok(Self {
            times,
            rotations,
            between: BetweenRotations::Cubic(tangents),
        })
    }

    /// Key times in seconds, strictly increasing; at least one.
    #[must_use]
    pub fn times(&self) -> &[f32] {
        &self.times
    }

    /// Rotations at the keys, unit quaternions.
    #[must_use]
    pub fn rotations(&self) -> &[Quat] {
        &self.rotations
    }

    /// Interpolation between keys.
    #[cfg(feature = "gltf")]
    #[must_use]
    pub(crate) fn between(&self) -> &BetweenRotations {
        &self.between
    }

    /// True if the interpolation is slerp without easing.
    #[must_use]
    #[doc(hidden)]
    pub fn is_slerp(&self) -> bool {
        self.between == BetweenRotations::Slerp
    }

    /// Rotation at a time in seconds; NaN counts as before the first key.
    #[must_use]
    pub fn at(&self, time: f32) -> Quat {
        let after = self.times.partition_point(|&key| key <= time);
        let key = after.saturating_sub(1);
        let u = match (self.times.get(key), self.times.get(after)) {
            (Some(&start), Some(&end)) if after > 0 => (time - start) / (end - start),
            _ => 0.0,
        };
        self.within(key, u)
    }

    /// Rotation at u in [0, 1] between a key and the next.
    pub(crate) fn within(&self, key: usize, u: f32) -> Quat {
        let Some(&start) = self.rotations.get(key) else {
            return Quat::IDENTITY;
        };
        let Some(&end) = self.rotations.get(key + 1) else {
            return start;
        };
        if u <= 0.0 || u >= 1.0 {
            return if u <= 0.0 { start } else { end };
        }
        let length = self.times[key + 1] - self.times[key];
        match &self.between {
            BetweenRotations::Step => start,
            BetweenRotations::Slerp => slerp(start, end, u),
            BetweenRotations::Eased(easings) => slerp(start, end, easings[key].at(u)),
            BetweenRotations::Squad(controls) => {
                squad(start, [controls[key], controls[key + 1]], end, u)
            }
            BetweenRotations::Hermite(rates) => {
                let [leaving, arriving] = [rates[key], rates[key + 1]].map(|rate| rate * length);
                RotationHermite::new(start, leaving, end, arriving).at(u)
            }
            BetweenRotations::Cubic(rates) => {
                let segment = Hermite {
                    start: Vec4::from(start),
                    leaving: rates[key][1] * length,
                    end: Vec4::from(end),
                    arriving: rates[key + 1][0] * length,
                };
                // A cubic between opposite keys may pass through zero, where no rotation is defined.
                let unit = segment.position(u).try_normalize();
                unit.map_or(start, Quat::from_vec4)
            }
        }
    }
}

/// The normalised quaternion, and its scale factor.
fn unit(key: usize, q: Quat) -> Result<(Quat, f32), KeyError> {
    if !q.is_finite() {
        let what = "value";
        return Err(KeyError::NonFiniteValue { key, what });
    }
    let q = q.as_dquat();
    let length = q.length();
    // Double precision, because the square of a small single-precision number underflows.
    if length == 0.0 {
        return Err(KeyError::ZeroRotation { key });
    }
    // A quaternion that is normalised up to rounding keeps its exact bits.
    const UNIT_TOLERANCE: f64 = 0.5 * f32::EPSILON as f64;
    if (length - 1.0).abs() <= UNIT_TOLERANCE {
        return Ok((q.as_quat(), 1.0));
    }
    Ok(((q / length).as_quat(), (1.0 / length) as f32))
}
