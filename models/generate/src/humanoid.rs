//! Bones of the humanoid: an adult of 1.75 m in an A-pose, x forward, y to its left, z up.
//!
//! Ranges of motion: American Academy of Orthopaedic Surgeons, "Joint Motion: Method of Measuring and Recording"
//! (1965); equal numbers in Greene & Heckman (1994). A box of twist, bend and twist cannot represent the range of a
//! ball joint. Shoulders and hips are cut at the published end values.

use glam::DVec3;
use kinopt::io::rig::Rig;

use crate::Failure;
use crate::figure::{BoneSpec, Figure};
use crate::landmarks::Landmarks;
use crate::{humanoid_body, humanoid_wave};

/// Names of the bones with pinned tips.
const PINNED: [&str; 5] = ["head", "left_hand", "right_hand", "left_foot", "right_foot"];

const FORWARD: DVec3 = DVec3::X;
const LEFT: DVec3 = DVec3::Y;
const UP: DVec3 = DVec3::Z;
const FIXED: [f64; 2] = [0.0, 0.0];

/// Humanoid with its skin and keyframes.
pub(crate) fn rig() -> Result<Rig, Failure> {
    let mut figure = Figure {
        bones: bones(),
        ..Figure::default()
    };
    figure.surface = humanoid_body::surface(&figure, &Landmarks::new())?;
    let skeleton = figure.skeleton("humanoid")?;
    let clip = humanoid_wave::clip(&skeleton)?;
    figure.rig(skeleton, clip, &PINNED, 0.006)
}

fn bones() -> Vec<BoneSpec> {
    let at = Landmarks::new();
    let mut list = Tree { bones: Vec::new() };
    let [hips, waist, ribs, breast, neck, skull, crown] = at.spine;
    // Hinges across and along alternate up the spine: 80° forward, 30° back, 35° to either side and 45° of twist in
    // total. The pelvis rotates the whole figure as far as its pinned tips allow.
    list.add(
        "pelvis",
        None,
        [hips, waist],
        FORWARD,
        [[-45.0, 45.0], [-30.0, 60.0], FIXED],
    );
    list.add(
        "spine",
        Some("pelvis"),
        [waist, ribs],
        FORWARD,
        [[-15.0, 15.0], [-15.0, 40.0], FIXED],
    );
    list.add(
        "chest",
        Some("spine"),
        [ribs, breast],
        LEFT,
        [[-15.0, 15.0], [-35.0, 35.0], FIXED],
    );
    list.add(
        "upper_chest",
        Some("chest"),
        [breast, neck],
        FORWARD,
        [[-15.0, 15.0], [-15.0, 40.0], FIXED],
    );
    list.add(
        "neck",
        Some("upper_chest"),
        [neck, skull],
        FORWARD,
        [[-30.0, 30.0], [-45.0, 45.0], FIXED],
    );
    list.add(
        "head",
        Some("neck"),
        [skull, crown],
        LEFT,
        [[-30.0, 30.0], [-45.0, 45.0], FIXED],
    );

    let palm = (at.wrist - at.elbow).cross(FORWARD);
    list.pair(
        "clavicle",
        "upper_chest",
        [neck, at.shoulder],
        UP,
        [FIXED, [-10.0, 35.0], FIXED],
    );
    // Ball joint. The second twist tilts the plane of the swing from forward (0°) to upward (−90°) or inward. The
    // first twist rotates the arm about itself.
    list.pair(
        "upper_arm",
        "clavicle",
        [at.shoulder, at.elbow],
        FORWARD,
        [[-45.0, 75.0], [-50.0, 130.0], [-90.0, 60.0]],
    );
    list.pair(
        "forearm",
        "upper_arm",
        [at.elbow, at.wrist],
        FORWARD,
        [FIXED, [0.0, 150.0], FIXED],
    );
    // Pronation and supination (80° each) rotate the hand before it flexes (80°) or extends (70°).
    list.pair(
        "hand",
        "forearm",
        [at.wrist, at.fingertips],
        palm,
        [FIXED, [-70.0, 80.0], [-80.0, 80.0]],
    );

    // Ball joint: 120° forward, 30° back, outward at a second twist of −60°.
    list.pair(
        "thigh",
        "pelvis",
        [at.hip, at.knee],
        FORWARD,
        [[-45.0, 75.0], [-30.0, 120.0], [-60.0, 30.0]],
    );
    list.pair(
        "shin",
        "thigh",
        [at.knee, at.ankle],
        -FORWARD,
        [FIXED, [0.0, 135.0], FIXED],
    );
    // Inversion 35°, eversion 15°; up 20°, down 50°.
    list.pair(
        "foot",
        "shin",
        [at.ankle, at.ball],
        UP,
        [[-35.0, 15.0], [-50.0, 20.0], FIXED],
    );
    list.pair(
        "toes",
        "foot",
        [at.ball, at.toes],
        UP,
        [FIXED, [-45.0, 70.0], FIXED],
    );
    list.bones
}

/// Bones in the order of addition, parents first.
struct Tree {
    bones: Vec<BoneSpec>,
}

impl Tree {
    fn add(
        &mut self,
        name: &str,
        parent: Option<&str>,
        ends: [DVec3; 2],
        towards: DVec3,
        limits: [[f64; 2]; 3],
    ) {
        let number = |name: &str| self.bones.iter().position(|bone| bone.name == name);
        self.bones.push(BoneSpec {
            name: name.into(),
            parent: parent.and_then(number),
            tail: ends[0],
            tip: ends[1],
            towards,
            limits,
        });
    }

    /// Adds a bone of the left side and its mirror image. A parent with sides has the side of its child.
    fn pair(
        &mut self,
        name: &str,
        parent: &str,
        ends: [DVec3; 2],
        towards: DVec3,
        limits: [[f64; 2]; 3],
    ) {
        let flip = DVec3::new(1.0, -1.0, 1.0);
        let [twist1, bend, twist2] = limits;
        // Mirroring reverses a twist and keeps a bend.
        let mirrored = |[low, high]: [f64; 2]| [0.0 - high, 0.0 - low];
        let sides = [
            ("left", ends, towards, limits),
            (
                "right",
                ends.map(|p| p * flip),
                towards * flip,
                [mirrored(twist1), bend, mirrored(twist2)],
            ),
        ];
        for (side, ends, towards, limits) in sides {
            let sided_parent = format!("{side}_{parent}");
            let sided = self.bones.iter().any(|bone| bone.name == sided_parent);
            let parent = if sided { sided_parent.as_str() } else { parent };
            self.add(
                &format!("{side}_{name}"),
                Some(parent),
                ends,
                towards,
                limits,
            );
        }
    }
}
