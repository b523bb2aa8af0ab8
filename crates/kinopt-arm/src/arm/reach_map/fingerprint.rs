//! Properties of an arm that a reach map depends on.

use super::super::QueryError;
use super::super::arm::Arm;
use super::error::ReachMapError;

/// Configurations at which the kinematics of two arms are compared.
const PROBES: u64 = 4;
/// Largest difference of a number of two equal arms.
const TOLERANCE: f64 = 1e-9;

/// Joints, limits, goal and kinematics of the arm that a map was built for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmFingerprint {
    /// Names of the free joints, base to tip.
    pub joints: Vec<String>,
    /// Lower limits of the joints, radians or metres; −∞ for none.
    pub lower: Vec<f64>,
    /// Upper limits of the joints, radians or metres; +∞ for none.
    pub upper: Vec<f64>,
    /// Half widths of the goal bounds: along x, y and z in metres, then about them in radians.
    pub goal: Vec<f64>,
    /// Tolerances of position and orientation, metres and radians.
    pub tolerances: Vec<f64>,
    /// Placements of the tool at four configurations: columns of the rotation, then the translation in metres.
    pub placements: Vec<f64>,
}

impl ArmFingerprint {
    pub(super) fn of(arm: &Arm) -> Result<Self, QueryError> {
        let mut placements = Vec::new();
        for seed in 0..PROBES {
            let tool = arm.base_from_tool(&arm.random_configuration(seed))?;
            let columns = [tool.rotation.x, tool.rotation.y, tool.rotation.z];
            let columns = columns.into_iter().chain([tool.translation]);
            placements.extend(columns.flat_map(|column| column.to_array()));
        }
        let options = &arm.options;
        Ok(Self {
            joints: arm.joints().map(str::to_owned).collect(),
            lower: arm.limits().map(|limits| limits.lower).collect(),
            upper: arm.limits().map(|limits| limits.upper).collect(),
            goal: options.goal.half_widths().to_vec(),
            tolerances: vec![options.position_tolerance, options.orientation_tolerance],
            placements,
        })
    }

    /// Returns an error that names the first difference from another arm.
    pub(super) fn check(&self, given: &Self) -> Result<(), ReachMapError> {
        if self.joints != given.joints {
            return Err(ReachMapError::OtherJoints {
                expected: self.joints.clone(),
                given: given.joints.clone(),
            });
        }
        let pairs = [
            ("lower joint limits", &self.lower, &given.lower),
            ("upper joint limits", &self.upper, &given.upper),
            ("goal bounds", &self.goal, &given.goal),
            ("tolerances", &self.tolerances, &given.tolerances),
            ("placement of the tool", &self.placements, &given.placements),
        ];
        let is_equal = |(a, b): (&f64, &f64)| a == b || (a - b).abs() <= TOLERANCE;
        for (property, expected, given) in pairs {
            if expected.len() != given.len() || !expected.iter().zip(given).all(is_equal) {
                return Err(ReachMapError::OtherArm { property });
            }
        }
        Ok(())
    }
}
