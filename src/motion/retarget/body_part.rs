//! The parts of a body by which captures and models are matched.

use serde::{Deserialize, Serialize};

/// A part of a person's body, which a captured joint and a model's frame may both be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum BodyPart {
    /// What everything hangs on.
    Pelvis,
    /// The upper end of the spine.
    Chest,
    /// The skull, or where it turns.
    Head,
    /// Where the left thigh turns.
    LeftHip,
    /// Where the left shin turns.
    LeftKnee,
    /// Where the left foot turns.
    LeftAnkle,
    /// The left foot's tip, or where its toes turn.
    LeftToe,
    /// Where the left upper arm turns.
    LeftShoulder,
    /// Where the left forearm turns.
    LeftElbow,
    /// The left wrist or hand.
    LeftHand,
    /// Where the right thigh turns.
    RightHip,
    /// Where the right shin turns.
    RightKnee,
    /// Where the right foot turns.
    RightAnkle,
    /// The right foot's tip, or where its toes turn.
    RightToe,
    /// Where the right upper arm turns.
    RightShoulder,
    /// Where the right forearm turns.
    RightElbow,
    /// The right wrist or hand.
    RightHand,
}

impl BodyPart {
    /// All of them, with the names that files call them by.
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

    /// Its name in files, such as `left_knee`.
    #[must_use]
    pub fn name(self) -> &'static str {
        let own = Self::ALL.iter().find(|(part, _)| *part == self);
        own.map_or("", |(_, name)| name)
    }

    /// Whether it stands on something at times: ankles and toes.
    #[must_use]
    pub fn stands(self) -> bool {
        matches!(
            self,
            Self::LeftAnkle | Self::LeftToe | Self::RightAnkle | Self::RightToe
        )
    }
}
