//! Serde form of a rotation curve: keys and interpolation, checked when read.

use glam::Quat;
use serde::Deserialize;

use super::RotationCurve;
use super::keyed::BetweenRotations;
use kinopt_kinematics::curve::{KeyError, check_count};

#[derive(Deserialize)]
pub(super) struct RotationCurveKeys {
    times: Vec<f32>,
    rotations: Vec<Quat>,
    between: BetweenRotations,
}

impl TryFrom<RotationCurveKeys> for RotationCurve {
    type Error = KeyError;

    fn try_from(keys: RotationCurveKeys) -> Result<Self, KeyError> {
        let RotationCurveKeys {
            times,
            rotations,
            between,
        } = keys;
        let check = |given: usize, invalid_key: Option<usize>| {
            check_count("tangents", given, times.len())?;
            let what = "tangent";
            invalid_key.map_or(Ok(()), |key| Err(KeyError::NonFiniteValue { key, what }))
        };
        match &between {
            // A cubic preserves the signs of its quaternions.
            BetweenRotations::Cubic(rates) => return Self::cubic(times, rotations, rates.clone()),
            BetweenRotations::Eased(easings) => check_count("easings", easings.len(), times.len())?,
            BetweenRotations::Squad(controls) => {
                let invalid_key = controls.iter().position(|q| !q.is_finite());
                check(controls.len(), invalid_key)?;
            }
            BetweenRotations::Hermite(rates) => {
                let invalid_key = rates.iter().position(|rate| !rate.is_finite());
                check(rates.len(), invalid_key)?;
            }
            BetweenRotations::Step | BetweenRotations::Slerp => {}
        }
        Self::checked(times, rotations, between)
    }
}
