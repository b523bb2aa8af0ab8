//! Branches of a solution: the signs of the factors of the Jacobian's determinant.

use super::angle::Angle;
use super::screw::Screw;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Side of the first axis on which the arm reaches its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ShoulderBranch {
    /// The factor of the shoulder is positive.
    Left,
    /// The factor of the shoulder is negative.
    Right,
}

/// Side to which the elbow bends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ElbowBranch {
    /// The factor of the elbow is positive.
    Up,
    /// The factor of the elbow is negative.
    Down,
}

/// One of the two postures of a wrist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum WristBranch {
    /// The factor of the wrist is positive.
    NoFlip,
    /// The factor of the wrist is negative.
    Flip,
}

/// Branch of a solution, where the structure of the arm defines it.
///
/// The determinant of the Jacobian of an arm with a spherical wrist, or with three parallel axes, is a product of
/// three factors. A branch is the sign of a factor: two configurations with different signs are connected only through
/// a singularity. With the axes' directions hᵢ and points rᵢ at the configuration:
///
/// | structure | shoulder | elbow | wrist |
/// |---|---|---|---|
/// | spherical wrist with centre w, axes 2 ∥ 3 | h₂ · (h₁ × (w − r₁)) | h₂ · ((r₃ − r₂) × (w − r₃)) | h₄ · (h₅ × h₆) |
/// | spherical wrist with centre w, axes 1 and 2 meet in o | (h₁ × h₂) · (w − o) | (w − o) · (h₃ × (w − r₃)) | h₄ · (h₅ × h₆) |
/// | axes 2 ∥ 3 ∥ 4, axes 5 and 6 meet in p | h₂ · (h₁ × (p − r₁)) | h₂ · ((r₃ − r₂) × (r₄ − r₃)) | h₂ · (h₅ × h₆) |
///
/// The signs depend on the directions of the axes in the robot's file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ArmBranch {
    /// Branch of the shoulder.
    pub shoulder: Option<ShoulderBranch>,
    /// Branch of the elbow.
    pub elbow: Option<ElbowBranch>,
    /// Branch of the wrist.
    pub wrist: Option<WristBranch>,
}

/// Factors of the Jacobian's determinant of a structure. Points are those at zero joint values.
#[derive(Clone, Copy, Debug)]
pub(super) enum BranchSigns {
    /// A spherical wrist behind two parallel axes 2 and 3.
    ParallelArm { centre: Vector3<f64> },
    /// A spherical wrist behind axes 1 and 2 that meet.
    MeetingShoulder {
        centre: Vector3<f64>,
        shoulder: Vector3<f64>,
    },
    /// A spherical wrist behind three other axes: only the wrist has a branch.
    Wrist,
    /// Three parallel axes. `meeting` is the point of the axes 5 and 6, if they meet.
    ThreeParallel { meeting: Option<Vector3<f64>> },
}

impl BranchSigns {
    /// Branch of a configuration.
    pub(super) fn branch(&self, axes: &[Screw; 6], q: &[Angle; 6]) -> ArmBranch {
        let mut current = *axes;
        let mut displacement = Placement::identity();
        let mut before_last = displacement;
        let mut after_third = displacement;
        for (i, (axis, q)) in axes.iter().zip(q).enumerate() {
            current[i] = axis.displaced(&displacement);
            before_last = displacement;
            displacement = displacement * axis.displacement(*q);
            if i == 2 {
                after_third = displacement;
            }
        }
        let h = current.map(|axis| axis.direction);
        let r = current.map(|axis| axis.point);
        let wrist = h[3].dot(h[4].cross(h[5]));
        match *self {
            Self::ParallelArm { centre } => {
                let w = after_third.apply(centre);
                let shoulder = h[1].dot(h[0].cross(w - r[0]));
                let elbow = h[1].dot((r[2] - r[1]).cross(w - r[2]));
                branch_of(Some(shoulder), Some(elbow), Some(wrist))
            }
            Self::MeetingShoulder { centre, shoulder } => {
                let w = after_third.apply(centre);
                let reach = w - shoulder;
                let shoulder = h[0].cross(h[1]).dot(reach);
                let elbow = reach.dot(h[2].cross(w - r[2]));
                branch_of(Some(shoulder), Some(elbow), Some(wrist))
            }
            Self::Wrist => branch_of(None, None, Some(wrist)),
            Self::ThreeParallel { meeting } => {
                let shoulder = meeting.map(|point| {
                    let p = before_last.apply(point);
                    h[1].dot(h[0].cross(p - r[0]))
                });
                let elbow = h[1].dot((r[2] - r[1]).cross(r[3] - r[2]));
                branch_of(shoulder, Some(elbow), Some(h[1].dot(h[4].cross(h[5]))))
            }
        }
    }
}

fn branch_of(shoulder: Option<f64>, elbow: Option<f64>, wrist: Option<f64>) -> ArmBranch {
    let by_sign = |value: f64| value > 0.0;
    ArmBranch {
        shoulder: shoulder.map(|value| match by_sign(value) {
            true => ShoulderBranch::Left,
            false => ShoulderBranch::Right,
        }),
        elbow: elbow.map(|value| match by_sign(value) {
            true => ElbowBranch::Up,
            false => ElbowBranch::Down,
        }),
        wrist: wrist.map(|value| match by_sign(value) {
            true => WristBranch::NoFlip,
            false => WristBranch::Flip,
        }),
    }
}
