//! What a number of a frame moves.

/// One of the six channels that a joint may have: a coordinate of its place in its parent, or a turn
/// in degrees about one of its axes.
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
    /// All six.
    pub const ALL: [Self; 6] = [
        Self::Xposition,
        Self::Yposition,
        Self::Zposition,
        Self::Xrotation,
        Self::Yrotation,
        Self::Zrotation,
    ];

    /// Its name in files.
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

    /// Which axis it moves along or turns about: x is 0, y 1, z 2.
    #[must_use]
    pub fn axis(self) -> usize {
        match self {
            Self::Xposition | Self::Xrotation => 0,
            Self::Yposition | Self::Yrotation => 1,
            Self::Zposition | Self::Zrotation => 2,
        }
    }

    /// Whether it turns the joint rather than moving it.
    #[must_use]
    pub fn is_rotation(self) -> bool {
        matches!(self, Self::Xrotation | Self::Yrotation | Self::Zrotation)
    }

    /// The channel of a name, in capitals or not.
    pub(super) fn of_name(name: &str) -> Option<Self> {
        let mut all = Self::ALL.into_iter();
        all.find(|channel| channel.name().eq_ignore_ascii_case(name))
    }
}

/// The first fault of a joint's channels: a channel twice, or more than three rotations. A rotation axis may come twice with
/// another one between, as in proper Euler angles.
pub(super) fn fault(channels: &[BvhChannel]) -> Option<String> {
    let mut turns: Vec<BvhChannel> = Vec::new();
    for (index, channel) in channels.iter().enumerate() {
        let is_taken = if channel.is_rotation() {
            let follows_itself = turns.last() == Some(channel);
            turns.push(*channel);
            follows_itself
        } else {
            channels[..index].contains(channel)
        };
        if is_taken {
            return Some(format!("{} twice", channel.name()));
        }
    }
    (turns.len() > 3).then(|| "more than three rotations".to_owned())
}
