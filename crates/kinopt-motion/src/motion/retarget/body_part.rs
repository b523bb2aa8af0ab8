//! Body parts that relate captures and models.

use serde::{Deserialize, Serialize};

/// Part of a humanoid body: a captured joint or a frame of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum BodyPart {
    /// Pelvis, the root of the body.
    Pelvis,
    /// Upper end of the spine.
    Chest,
    /// Head, or its joint.
    Head,
    /// Left hip joint.
    LeftHip,
    /// Left knee joint.
    LeftKnee,
    /// Left ankle joint.
    LeftAnkle,
    /// Tip of the left foot, or its toe joint.
    LeftToe,
    /// Left shoulder joint.
    LeftShoulder,
    /// Left elbow joint.
    LeftElbow,
    /// Left wrist or hand.
    LeftHand,
    /// Right hip joint.
    RightHip,
    /// Right knee joint.
    RightKnee,
    /// Right ankle joint.
    RightAnkle,
    /// Tip of the right foot, or its toe joint.
    RightToe,
    /// Right shoulder joint.
    RightShoulder,
    /// Right elbow joint.
    RightElbow,
    /// Right wrist or hand.
    RightHand,
}

impl BodyPart {
    /// All parts with their names in files.
    pub const ALL: [(Self, &'static str); 17] = [
        (Self::Pelvis, "pelvis"),
        (Self::Chest, "chest"),
        (Self::Head, "head"),
        (Self::LeftHip, "left_hip"),
        (Self::LeftKnee, "left_knee"),
        (Self::LeftAnkle, "left_ankle"),
        (Self::LeftToe, "left_toe"),
        (Self::LeftShoulder, "left_shoulder"),
        (Self::LeftElbow, "left_elbow"),
        (Self::LeftHand, "left_hand"),
        (Self::RightHip, "right_hip"),
        (Self::RightKnee, "right_knee"),
        (Self::RightAnkle, "right_ankle"),
        (Self::RightToe, "right_toe"),
        (Self::RightShoulder, "right_shoulder"),
        (Self::RightElbow, "right_elbow"),
        (Self::RightHand, "right_hand"),
    ];

    /// Name in files, such as `left_knee`.
    #[must_use]
    pub fn name(self) -> &'static str {
        let entry = Self::ALL.iter().find(|(part, _)| *part == self);
        entry.map_or("", |(_, name)| name)
    }

    /// Returns whether the part makes contact: ankles and toes.
    #[must_use]
    pub fn stands(self) -> bool {
        matches!(
            self,
            Self::LeftAnkle | Self::LeftToe | Self::RightAnkle | Self::RightToe
        )
    }
}
