//! A skeleton of any number of bones, built in code, without files.

use kinopt::Problem;
use kinopt::model::Limits;
use kinopt::problem::ProblemError;
use kinopt::skeleton::{Bone, BoneId, Skeleton, SkeletonBuilder};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::Point;

use crate::{Sequence, at_ease};

/// A skeleton with a spine and five limbs of `per_limb` bones: 22 bones for (2, 4), 62 for (12, 10).
#[must_use]
pub fn figure(spine: usize, per_limb: usize) -> (Skeleton, Vec<BoneId>) {
    let mut builder = Skeleton::builder("figure");
    let mut last: Vec<BoneId> = Vec::new();
    let total = 1.75;
    let spine_length = 0.35 * total / spine as f64;
    for k in 0..spine {
        let placement = Placement::new(
            along(Vector3::new(0.0, 1.0, 0.0)),
            Vector3::new(0.0, 1.0 + spine_length * k as f64, 0.0),
        );
        let parent = last.last().copied();
        last.push(push(
            &mut builder,
            parent,
            placement,
            spine_length,
            [40.0, 40.0, 30.0],
            k,
        ));
    }
    let (hips, chest) = (last[0], last[spine - 1]);
    let top = builder.bones()[chest.index()].rest_tip();
    let low = builder.bones()[hips.index()].rest_tail();
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
            parent = push(
                &mut builder,
                Some(parent),
                placement,
                bone_length,
                ranges,
                k,
            );
        }
        tips.push(parent);
    }
    (builder.build().expect("its bones are valid"), tips)
}

fn push(
    builder: &mut SkeletonBuilder,
    parent: Option<BoneId>,
    model_from_rest: Placement<f64>,
    length: f64,
    [twist, bend, second]: [f64; 3],
    k: usize,
) -> BoneId {
    let symmetric = |degrees: f64| Limits::new(-degrees.to_radians(), degrees.to_radians());
    let lower_bend = if twist == 0.0 { 0.0 } else { -bend / 4.0 };
    builder.add(Bone {
        name: format!("b{}-{k}", builder.bones().len()),
        parent,
        length,
        model_from_rest,
        limits: [
            symmetric(twist),
            Limits::new(lower_bend.to_radians(), bend.to_radians()),
            symmetric(second),
        ],
    })
}

/// Axes whose first column is `unit`.
fn along(unit: Vector3<f64>) -> Matrix3<f64> {
    let z = Vector3::new(0.0, 0.0, 1.0);
    let y = z.cross(unit);
    Matrix3::from_columns(unit, y, z)
}

/// The skeleton without limits, so that every angle is a variable.
#[must_use]
pub fn every_angle_free(skeleton: &Skeleton) -> Skeleton {
    let mut bones = skeleton.bones().to_vec();
    for bone in &mut bones {
        bone.limits = [Limits::UNBOUNDED; 3];
    }
    Skeleton::new("free figure", bones).expect("its bones are valid")
}

/// Tip positions in random poses within the full limits: one list of targets for each pose.
#[must_use]
pub fn random_targets(
    skeleton: &Skeleton,
    tips: &[BoneId],
    poses: usize,
    random: &mut Sequence,
) -> Vec<Vec<Vector3<f64>>> {
    let limits: Vec<Limits> = skeleton.model().limits().collect();
    let mut target = || {
        let interpolate = |l: &Limits, share: f64| l.lower + (l.upper - l.lower) * share;
        let q: Vec<f64> = limits
            .iter()
            .map(|l| interpolate(l, random.unit()))
            .collect();
        let pose = skeleton.pose(&q).expect("a pose of its own bones");
        tips.iter()
            .map(|&tip| pose.tip(skeleton, tip).expect("a pose of its own bones"))
            .collect()
    };
    (0..poses).map(|_| target()).collect()
}

/// Problem with the tips of a skeleton of 22 bones at their positions in a random pose, and a relaxed start.
pub(crate) fn five_tips() -> Result<(Problem, Vec<f64>), ProblemError> {
    let (skeleton, tips) = figure(2, 4);
    let targets = random_targets(&skeleton, &tips, 1, &mut Sequence::new(0.5));
    let mut builder = Problem::builder(skeleton.model());
    for (&tip, &target) in tips.iter().zip(targets.iter().flatten()) {
        builder.add(Point::new(skeleton.tip(tip), target));
    }
    Ok((builder.build()?, at_ease(&skeleton)))
}
