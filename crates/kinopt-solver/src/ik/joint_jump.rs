//! Joint jump: a step in which a joint exceeds its bound.

/// Step of a path, follower or drag in which a joint moves farther than its bound.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JointJump {
    /// Index, from 0, of the row, target or frame at the end of the step. It is 0 for the step that closes a cyclic
    /// path.
    pub index: usize,
    /// Coordinate of q of the joint that moves farthest, relative to its bound. For an arm it is the index of the joint.
    pub joint: usize,
    /// Displacement of that joint, radians. For a prismatic joint, an arm reports the equivalent angle, and a drag
    /// reports metres.
    pub distance: f64,
    /// True if the step leads to another branch. False for a fast motion or a coarse path: small steps lead there too.
    pub reconfiguration: bool,
}
