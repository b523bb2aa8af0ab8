//! Limbs and ends of a humanoid body, by the names of its points.

/// Points whose mean is one end of a limb. The first alternative whose points all exist counts.
type Alternatives = &'static [&'static [&'static str]];

/// Limb between two points of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct LimbDefinition {
    pub(super) name: &'static str,
    pub(super) from: Alternatives,
    pub(super) to: Alternatives,
    /// Point whose presence replaces this limb by its parts.
    pub(super) unless: Option<&'static str>,
}

const fn limb(name: &'static str, from: Alternatives, to: Alternatives) -> LimbDefinition {
    LimbDefinition {
        name,
        from,
        to,
        unless: None,
    }
}

const fn whole_limb(
    name: &'static str,
    from: Alternatives,
    to: Alternatives,
    unless: &'static str,
) -> LimbDefinition {
    LimbDefinition {
        name,
        from,
        to,
        unless: Some(unless),
    }
}

const HIPS: Alternatives = &[&["left_hip", "right_hip"], &["pelvis"]];
const SHOULDERS: Alternatives = &[&["left_shoulder", "right_shoulder"], &["chest"]];

/// Limbs whose directions are compared.
pub(super) const LIMBS: [LimbDefinition; 20] = [
    limb("pelvis", &[&["right_hip"]], &[&["left_hip"]]),
    limb("spine", HIPS, SHOULDERS),
    limb("shoulders", &[&["right_shoulder"]], &[&["left_shoulder"]]),
    limb("head", SHOULDERS, &[&["head"]]),
    limb("left_upper_arm", &[&["left_shoulder"]], &[&["left_elbow"]]),
    limb("left_forearm", &[&["left_elbow"]], &[&["left_hand"]]),
    limb("left_hand", &[&["left_hand"]], &[&["left_finger"]]),
    limb(
        "right_upper_arm",
        &[&["right_shoulder"]],
        &[&["right_elbow"]],
    ),
    limb("right_forearm", &[&["right_elbow"]], &[&["right_hand"]]),
    limb("right_hand", &[&["right_hand"]], &[&["right_finger"]]),
    limb("left_thigh", &[&["left_hip"]], &[&["left_knee"]]),
    limb("left_shin", &[&["left_knee"]], &[&["left_ankle"]]),
    limb("left_foot", &[&["left_ankle"]], &[&["left_toe"]]),
    limb("right_thigh", &[&["right_hip"]], &[&["right_knee"]]),
    limb("right_shin", &[&["right_knee"]], &[&["right_ankle"]]),
    limb("right_foot", &[&["right_ankle"]], &[&["right_toe"]]),
    whole_limb("left_arm", LEFT_ARM_BASE, &[&["left_hand"]], "left_elbow"),
    whole_limb(
        "right_arm",
        RIGHT_ARM_BASE,
        &[&["right_hand"]],
        "right_elbow",
    ),
    whole_limb("left_leg", LEFT_LEG_BASE, &[&["left_ankle"]], "left_knee"),
    whole_limb(
        "right_leg",
        RIGHT_LEG_BASE,
        &[&["right_ankle"]],
        "right_knee",
    ),
];

const LEFT_ARM_BASE: Alternatives = &[&["left_shoulder"], &["chest"], &["pelvis"]];
const RIGHT_ARM_BASE: Alternatives = &[&["right_shoulder"], &["chest"], &["pelvis"]];
const LEFT_LEG_BASE: Alternatives = &[&["left_hip"], &["pelvis"]];
const RIGHT_LEG_BASE: Alternatives = &[&["right_hip"], &["pelvis"]];

/// End of an arm or a leg, with its base and the joint between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct EndDefinition {
    pub(super) name: &'static str,
    pub(super) base: Alternatives,
    pub(super) middle: &'static str,
    pub(super) end: &'static str,
    pub(super) is_leg: bool,
}

const fn end(
    name: &'static str,
    base: Alternatives,
    middle: &'static str,
    end: &'static str,
    is_leg: bool,
) -> EndDefinition {
    EndDefinition {
        name,
        base,
        middle,
        end,
        is_leg,
    }
}

/// Ends whose positions relative to their bases are compared.
pub(super) const ENDS: [EndDefinition; 4] = [
    end("left_hand", LEFT_ARM_BASE, "left_elbow", "left_hand", false),
    end(
        "right_hand",
        RIGHT_ARM_BASE,
        "right_elbow",
        "right_hand",
        false,
    ),
    end("left_foot", LEFT_LEG_BASE, "left_knee", "left_ankle", true),
    end(
        "right_foot",
        RIGHT_LEG_BASE,
        "right_knee",
        "right_ankle",
        true,
    ),
];

/// Points whose jerk is measured, if they exist.
pub(super) const JERK_POINTS: [&str; 5] = [
    "head",
    "left_hand",
    "right_hand",
    "left_ankle",
    "right_ankle",
];
