//! Skeletons that the benches share.
#![allow(clippy::expect_used)]

use kinopt::model::Limits;
use kinopt::skeleton::{Bone, BoneId, Skeleton};
use kinopt::spatial::{Matrix3, Placement, Vector3};

/// Numbers within [0, 1) that never change (an additive recurrence of the golden ratio).
pub(crate) struct Sequence(f64);

impl Sequence {
    /// Starts the sequence anywhere.
    pub(crate) fn new(seed: f64) -> Self {
        Self(seed)
    }

    /// The next number.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = (self.0 + 0.618_033_988_749_894_9) * 1.000_000_1;
        let mixed = (self.0 * 12.9898).sin() * 43_758.545_3;
        mixed - mixed.floor()
    }
}

/// A figure with a spine and five limbs of `per_limb` bones: 22 bones for (2, 4), 62 for (12, 10).
///
pub(crate) fn figure(spine: usize, per_limb: usize) -> (Skeleton, Vec<BoneId>) {
    let mut bones: Vec<Bone> = Vec::new();
    let mut last: Vec<usize> = Vec::new();
    let total = 1.75;
    let spine_length = 0.35 * total / spine as f64;
    for k in 0..spine {
        let placement = Placement::new(
            along(Vector3::new(0.0, 1.0, 0.0)),
            Vector3::new(0.0, 1.0 + spine_length * k as f64, 0.0),
        );
        let parent = last.last().copied();
        last.push(push(
            &mut bones,
            parent,
            placement,
            spine_length,
            [40.0, 40.0, 30.0],
            k,
        ));
    }
    let (hips, chest) = (last[0], last[spine - 1]);
    let top = bones[chest].rest_tip();
    let low = bones[hips].rest_tail();
    let limbs = [
        (chest, top, Vector3::new(0.0, 1.0, 0.0), 0.3),
        (chest, top, Vector3::new(1.0, 0.0, 0.0), 0.7),
        (chest, top, Vector3::new(-1.0, 0.0, 0.0), 0.7),
        (hips, low, Vector3::new(0.15, -0.95, 0.0), 0.95),
        (hips, low, Vector3::new(-0.15, -0.95, 0.0), 0.95),
    ];
    let mut tips = Vec::new();
    for (root, from, direction, length) in limbs {
        let unit = direction * (1.0 / direction.norm());
        let bone_length = length / per_limb as f64;
        let mut parent = root;
        for k in 0..per_limb {
            let tail = unit.mul_add(bone_length * k as f64, from);
            // Every second bone is a hinge, like an elbow or a knee.
            let ranges = if k % 2 == 1 {
                [0.0, 140.0, 0.0]
            } else {
                [90.0, 110.0, 90.0]
            };
            let placement = Placement::new(along(unit), tail);
            parent = push(&mut bones, Some(parent), placement, bone_length, ranges, k);
        }
        tips.push(parent);
    }
    let skeleton = Skeleton::new("figure", bones).expect("its bones are valid");
    let ids = tips
        .into_iter()
        .map(|t| skeleton.bone_at(t).expect("it is there"))
        .collect();
    (skeleton, ids)
}

fn push(
    bones: &mut Vec<Bone>,
    parent: Option<usize>,
    model_from_rest: Placement<f64>,
    length: f64,
    [twist, bend, second]: [f64; 3],
    k: usize,
) -> usize {
    let symmetric = |degrees: f64| Limits::new(-degrees.to_radians(), degrees.to_radians());
    let lower_bend = if twist == 0.0 { 0.0 } else { -bend / 4.0 };
    let parent = parent.map(|p| {
        // Ids exist only inside a skeleton; a skeleton of the bones so far lends one.
        let so_far = Skeleton::new("so far", bones.clone()).expect("its bones are valid");
        so_far.bone_at(p).expect("it is there")
    });
    bones.push(Bone {
        name: format!("b{}-{k}", bones.len()),
        parent,
        length,
        model_from_rest,
        limits: [
            symmetric(twist),
            Limits::new(lower_bend.to_radians(), bend.to_radians()),
            symmetric(second),
        ],
    });
    bones.len() - 1
}

/// Axes whose first column is `unit`.
fn along(unit: Vector3<f64>) -> Matrix3<f64> {
    let z = Vector3::new(0.0, 0.0, 1.0);
    let y = z.cross(unit);
    Matrix3::from_columns(unit, y, z)
}
