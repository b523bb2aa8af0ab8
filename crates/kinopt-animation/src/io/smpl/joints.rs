//! Joints of the SMPL family, in the order of their poses.

/// Joints of the body, common to SMPL, SMPL-H and SMPL-X, with the index of each parent.
const BODY: [(&str, usize); 22] = [
    ("pelvis", 0),
    ("left_hip", 0),
    ("right_hip", 0),
    ("spine1", 0),
    ("left_knee", 1),
    ("right_knee", 2),
    ("spine2", 3),
    ("left_ankle", 4),
    ("right_ankle", 5),
    ("spine3", 6),
    ("left_foot", 7),
    ("right_foot", 8),
    ("neck", 9),
    ("left_collar", 9),
    ("right_collar", 9),
    ("head", 12),
    ("left_shoulder", 13),
    ("right_shoulder", 14),
    ("left_elbow", 16),
    ("right_elbow", 17),
    ("left_wrist", 18),
    ("right_wrist", 19),
];
const HEAD: usize = 15;
const WRISTS: [(&str, usize); 2] = [("left", 20), ("right", 21)];
const FINGERS: [&str; 5] = ["index", "middle", "pinky", "ring", "thumb"];
const FACE: [&str; 3] = ["jaw", "left_eye_smplhf", "right_eye_smplhf"];

/// Body model of the SMPL family, by the number of its joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    /// SMPL: 24 joints.
    Smpl,
    /// SMPL-H: 52 joints, with fingers.
    SmplH,
    /// SMPL-X: 55 joints, with jaw, eyes and fingers.
    SmplX,
}

impl Family {
    const ALL: [Self; 3] = [Self::Smpl, Self::SmplH, Self::SmplX];

    /// Model with a number of joints.
    pub(super) fn of_joints(count: usize) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|family| family.joints().len() == count)
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Smpl => "SMPL",
            Self::SmplH => "SMPL-H",
            Self::SmplX => "SMPL-X",
        }
    }

    /// Names of the joints, each with the index of its parent; the root has none.
    pub(super) fn joints(self) -> Vec<(String, Option<usize>)> {
        let mut joints: Vec<(String, Option<usize>)> = BODY
            .iter()
            .enumerate()
            .map(|(joint, (name, parent))| ((*name).to_owned(), (joint > 0).then_some(*parent)))
            .collect();
        match self {
            Self::Smpl => {
                joints.extend(WRISTS.map(|(side, wrist)| (format!("{side}_hand"), Some(wrist))));
            }
            Self::SmplH => joints.extend(fingers(joints.len())),
            Self::SmplX => {
                joints.extend(FACE.map(|name| (name.to_owned(), Some(HEAD))));
                joints.extend(fingers(joints.len()));
            }
        }
        joints
    }
}

/// Three joints for each finger of both hands. `first` is the index of the first one.
fn fingers(first: usize) -> Vec<(String, Option<usize>)> {
    let mut joints = Vec::new();
    for (side, wrist) in WRISTS {
        for finger in FINGERS {
            for phalanx in 1..=3 {
                let parent = match phalanx {
                    1 => wrist,
                    _ => first + joints.len() - 1,
                };
                joints.push((format!("{side}_{finger}{phalanx}"), Some(parent)));
            }
        }
    }
    joints
}
