//! Channels of BVH joints.

/// Channel of a joint: a coordinate of its position in its parent, or a rotation in degrees about one of its axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are those in files")]
pub enum BvhChannel {
    Xposition,
    Yposition,
    Zposition,
    Xrotation,
    Yrotation,
    Zrotation,
}

impl BvhChannel {
    /// All six channels.
    pub const ALL: [Self; 6] = [
        Self::Xposition,
        Self::Yposition,
        Self::Zposition,
        Self::Xrotation,
        Self::Yrotation,
        Self::Zrotation,
    ];

    /// Name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Xposition => "Xposition",
            Self::Yposition => "Yposition",
            Self::Zposition => "Zposition",
            Self::Xrotation => "Xrotation",
            Self::Yrotation => "Yrotation",
            Self::Zrotation => "Zrotation",
        }
    }

    /// The channel of a position along an axis or of a rotation about it; x is 0, y 1, z 2.
    pub(super) fn of_axis(axis: usize, is_rotation: bool) -> Self {
        let first = if is_rotation { 3 } else { 0 };
        Self::ALL[first + axis.min(2)]
    }

    /// Axis of the position or rotation: x is 0, y 1, z 2.
    #[must_use]
    pub fn axis(self) -> usize {
        match self {
            Self::Xposition | Self::Xrotation => 0,
            Self::Yposition | Self::Yrotation => 1,
            Self::Zposition | Self::Zrotation => 2,
        }
    }

    /// Returns true for a rotation, false for a position.
    #[must_use]
    pub fn is_rotation(self) -> bool {
        matches!(self, Self::Xrotation | Self::Yrotation | Self::Zrotation)
    }

    /// Channel of a name, in upper or lower case.
    pub(super) fn of_name(name: &str) -> Option<Self> {
        let mut all = Self::ALL.into_iter();
        all.find(|channel| channel.name().eq_ignore_ascii_case(name))
    }
}

/// First fault of a joint's channels: a repeated channel, or more than three rotations. A rotation axis may be repeated
/// with another one between, as in proper Euler angles.
pub(super) fn channel_error(channels: &[BvhChannel]) -> Option<String> {
    let mut rotations: Vec<BvhChannel> = Vec::new();
    for (index, channel) in channels.iter().enumerate() {
        let is_duplicate = if channel.is_rotation() {
            let is_repeated = rotations.last() == Some(channel);
            rotations.push(*channel);
            is_repeated
        } else {
            channels[..index].contains(channel)
        };
        if is_duplicate {
            return Some(format!("{} twice", channel.name()));
        }
    }
    (rotations.len() > 3).then(|| "more than three rotations".to_owned())
}
