//! Arrays of a motion, as in a file.

use super::SmplError;
use super::joints::Family;

/// Arrays of a motion of the SMPL family.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SmplArrays {
    /// Axis-angle vectors of all joints, radians, shape (frames, 3 × joints).
    pub poses: Vec<f64>,
    /// Translations of the root, metres, shape (frames, 3).
    pub translations: Vec<f64>,
    /// Shape parameters; may be empty.
    pub betas: Vec<f64>,
    /// Frames per second.
    pub frame_rate: f64,
    /// Joint positions, metres: shape (joints, 3) at rest, or (frames, joints, 3) posed. `None` if the file has none.
    pub joints: Option<Vec<f64>>,
}

impl SmplArrays {
    /// Number of frames.
    pub(super) fn frames(&self) -> usize {
        self.translations.len() / 3
    }

    /// Checks lengths and numbers, and returns the family.
    pub(super) fn check(&self) -> Result<Family, SmplError> {
        if !(self.frame_rate > 0.0 && self.frame_rate.is_finite()) {
            return Err(SmplError::BadFrameRate(self.frame_rate));
        }
        let frames = self.frames();
        if frames == 0 {
            return Err(SmplError::NoFrames);
        }
        let numbers = self.poses.len() / frames;
        let family = Family::of_joints(numbers / 3).filter(|_| numbers.is_multiple_of(3));
        let family = family.ok_or(SmplError::OtherJoints { numbers })?;
        check_length("poses", self.poses.len(), numbers * frames)?;
        check_length("trans", self.translations.len(), 3 * frames)?;
        let joints = self.joints.as_deref().unwrap_or_default();
        let all = [
            ("poses", &*self.poses),
            ("trans", &*self.translations),
            ("betas", &*self.betas),
            ("jtr", joints),
        ];
        for (array, numbers) in all {
            if let Some(index) = numbers.iter().position(|number| !number.is_finite()) {
                return Err(SmplError::NotFinite { array, index });
            }
        }
        Ok(family)
    }
}

pub(super) fn check_length(
    array: &'static str,
    given: usize,
    expected: usize,
) -> Result<(), SmplError> {
    match given == expected {
        true => Ok(()),
        false => Err(SmplError::OtherLength {
            array,
            given,
            expected,
        }),
    }
}
