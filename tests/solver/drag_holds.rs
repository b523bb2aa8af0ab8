//! Promise: a character that is dragged by one limb stays in place. Its root chain and the ends of its other limbs are
//! pinned, for any skeleton.

use kinopt::ik::hold_postures;
use kinopt::model::Limits;
use kinopt::problem::{Evaluation, Problem};
use kinopt::skeleton::{Bone, BoneId, Skeleton};
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3};

const FREE: [Limits; 3] = [Limits::UNBOUNDED; 3];
const LOCKED: [Limits; 3] = [Limits::new(0.0, 0.0); 3];

/// Bones: name, parent, rest position and limits.
type Plan = (&'static str, Option<usize>, [f64; 2], [Limits; 3]);

fn skeleton(bones: &[Plan]) -> Skeleton {
    let mut builder = Skeleton::builder("character");
    let mut ids: Vec<BoneId> = Vec::new();
    for &(name, parent, [x, y], limits) in bones {
        ids.push(builder.add(Bone {
            name: name.into(),
            parent: parent.map(|parent| ids[parent]),
            length: 0.0,
            model_from_rest: Placement::translation(Vector3::new(x, y, 0.0)),
            limits,
        }));
    }
    builder.build().unwrap()
}

/// Two legs, a spine of two bones with two arms, a head with a nose, three fingers on each hand, and an immobile prop.
const CHARACTER: [Plan; 25] = [
    ("scene", None, [0.0, 0.0], LOCKED),
    ("root", Some(0), [0.0, 0.0], FREE),
    ("hips", Some(1), [0.0, 1.0], FREE),
    ("left leg", Some(2), [0.1, 0.9], FREE),
    ("left knee", Some(3), [0.1, 0.5], FREE),
    ("left foot", Some(4), [0.1, 0.1], FREE),
    ("right leg", Some(2), [-0.1, 0.9], FREE),
    ("right knee", Some(6), [-0.1, 0.5], FREE),
    ("right foot", Some(7), [-0.1, 0.1], FREE),
    ("spine", Some(2), [0.0, 1.1], FREE),
    ("chest", Some(9), [0.0, 1.4], FREE),
    ("neck", Some(10), [0.0, 1.5], FREE),
    ("head", Some(11), [0.0, 1.6], FREE),
    ("nose", Some(12), [0.0, 1.7], FREE),
    ("left arm", Some(10), [0.2, 1.4], FREE),
    ("left elbow", Some(14), [0.5, 1.4], FREE),
    ("left hand", Some(15), [0.8, 1.4], FREE),
    ("left finger", Some(16), [0.9, 1.4], FREE),
    ("left ring", Some(17), [0.95, 1.4], LOCKED),
    ("right arm", Some(10), [-0.2, 1.4], FREE),
    ("right elbow", Some(19), [-0.5, 1.4], FREE),
    ("right hand", Some(20), [-0.8, 1.4], FREE),
    ("right thumb", Some(21), [-0.84, 1.4], FREE),
    ("right finger", Some(21), [-0.9, 1.4], FREE),
    ("prop", Some(0), [0.0, 0.0], LOCKED),
];

fn character() -> Skeleton {
    skeleton(&CHARACTER)
}

fn held_frames(skeleton: &Skeleton, dragged: &[&str]) -> (Vec<String>, Vec<String>) {
    let dragged: Vec<BoneId> = dragged
        .iter()
        .map(|name| skeleton.bone(name).unwrap())
        .collect();
    let holds = skeleton.holds(&dragged);
    let names = |ids: &[BoneId]| {
        let names = ids
            .iter()
            .map(|id| skeleton.bones()[id.index()].name.clone());
        names.collect::<Vec<_>>()
    };
    (names(&holds.trunk), names(&holds.ends))
}

#[test]
fn root_chain_and_other_limbs_are_pinned() {
    let character = character();
    let trunk = ["scene", "root", "hips"];
    for dragged in ["left hand", "left arm", "left ring"] {
        let (still, ends) = held_frames(&character, &[dragged]);
        assert_eq!(still, trunk, "{dragged}");
        // One finger for each hand; the head moves along.
        let others = ["left foot", "right foot", "right finger"];
        assert_eq!(ends, others, "{dragged}");
    }
    // Descendants of the dragged bone move along.
    let (still, ends) = held_frames(&character, &["chest"]);
    assert_eq!(
        (still.len(), ends),
        (3, vec!["left foot".into(), "right foot".into()])
    );
    let (_, ends) = held_frames(&character, &["left hand", "right foot"]);
    assert_eq!(ends, ["left foot", "right finger"]);
}

#[test]
fn dragged_root_chain_leaves_limbs_pinned() {
    let (still, ends) = held_frames(&character(), &["hips"]);
    assert_eq!(still, ["scene", "root"]);
    let all = ["left foot", "right foot", "left finger", "right finger"];
    assert_eq!(ends, all);
}

#[test]
fn spine_range_is_narrowed() {
    let character = character();
    let back = |dragged: &[&str]| {
        let ids: Vec<BoneId> = dragged.iter().map(|d| character.bone(d).unwrap()).collect();
        let back = character.holds(&ids).back.into_iter();
        back.map(|id| character.bones()[id.index()].name.clone())
            .collect::<Vec<_>>()
    };
    for dragged in [
        &["left hand"][..],
        &["right thumb"],
        &["left hand", "right hand"],
    ] {
        assert_eq!(back(dragged), ["spine", "chest"], "{dragged:?}");
    }
    // The spine is dragged itself, or is not involved.
    for dragged in ["chest", "hips", "left foot"] {
        assert!(back(&[dragged]).is_empty(), "{dragged}");
    }

    let holds = character.holds(&[character.bone("left hand").unwrap()]);
    let at = |k: usize| if k < 3 { 0.0 } else { 0.001 * k as f64 };
    let q: Vec<f64> = (0..character.angles()).map(at).collect();
    let map = holds.parameters(&character, &q).unwrap();
    let mut x = vec![0.0; map.variables()];
    map.reduce(&q, &mut x).unwrap();
    for (variable, &coordinate) in map.leaders().iter().enumerate() {
        let bone = &character.bones()[coordinate / 3].name;
        let [below, above] = [
            x[variable] - map.lower()[variable],
            map.upper()[variable] - x[variable],
        ];
        // Two bones that bend by 0.7 rad together, and twist by as much.
        let expected = match (bone.as_str(), coordinate % 3) {
            ("spine" | "chest", 1) => 0.35,
            ("spine" | "chest", _) => 0.175,
            _ => f64::INFINITY,
        };
        for bound in [below, above] {
            assert!(
                bound == expected || (bound - expected).abs() < 1e-12,
                "{bone}: {bound}"
            );
        }
    }
}

#[test]
fn single_chain_pins_nothing() {
    let arm = skeleton(&[
        ("a", None, [0.0, 0.0], FREE),
        ("b", Some(0), [1.0, 0.0], FREE),
        ("c", Some(1), [2.0, 0.0], FREE),
    ]);
    assert_eq!(held_frames(&arm, &["c"]), (Vec::new(), Vec::new()));
}

#[test]
fn root_chain_angles_are_kept() {
    let character = character();
    let hand = character.bone("left hand").unwrap();
    let holds = character.holds(&[hand]);
    let q: Vec<f64> = (0..character.angles())
        .map(|k| if k < 3 { 0.0 } else { 0.01 * k as f64 })
        .collect();
    let map = holds.parameters(&character, &q).unwrap();
    // Of 25 bones three are the root chain and two more are immobile.
    assert_eq!(map.variables(), 60);
    let mut expanded = vec![0.0; q.len()];
    map.expand(&vec![0.0; map.variables()], &mut expanded)
        .unwrap();
    assert_eq!(expanded[3..9], q[3..9]);
}

/// Limb lengths are relative to the skeleton's size.
#[test]
fn holds_are_unit_invariant() {
    for seed in 0..6 {
        let holds = [1e-3, 1.0, 1e3].map(|unit| {
            let rig = support::bones::RandomRig::scaled(seed, unit);
            let held = rig.skeleton.holds(&rig.tips[..1]);
            assert!(!held.ends.is_empty());
            format!("{held:?}")
        });
        assert!(holds.iter().all(|held| *held == holds[1]), "{holds:?}");
    }
}

/// A tail with its own root has no partner and moves along, before or after the body's bones.
#[test]
fn tail_with_its_own_root_moves_along() {
    let tail = |first: usize| {
        [
            ("tail", None, 1.0),
            ("tail's middle", Some(first), 0.7),
            ("tail's end", Some(first + 1), 0.4),
        ]
        .map(|(name, parent, y)| (name, parent, [0.0, y], FREE))
    };
    let mut behind = CHARACTER.to_vec();
    behind.extend(tail(CHARACTER.len()));
    let mut before = tail(0).to_vec();
    before.extend(
        CHARACTER
            .map(|(name, parent, at, limits)| (name, parent.map(|parent| parent + 3), at, limits)),
    );
    for bones in [behind, before] {
        let (still, mut ends) = held_frames(&skeleton(&bones), &["left hand"]);
        assert_eq!(still, ["scene", "root", "hips"]);
        ends.sort_unstable();
        let others = ["left foot", "right finger", "right foot"];
        assert_eq!(ends, others);
    }
}

/// A limb is as long as its longest branch, whatever short bones branch off.
#[test]
fn short_side_bone_does_not_end_a_limb() {
    let mut bones: Vec<Plan> = CHARACTER[..4].to_vec();
    bones.push(("left pocket", Some(3), [0.11, 0.89], FREE));
    let rest = CHARACTER[4..].iter().map(|&(name, parent, at, limits)| {
        let parent = parent.map(|parent| parent + usize::from(parent > 3));
        (name, parent, at, limits)
    });
    bones.extend(rest);
    for dragged in ["left hand", "right foot", "hips"] {
        let [one, other] = [character(), skeleton(&bones)].map(|s| held_frames(&s, &[dragged]));
        assert_eq!(one, other, "{dragged}");
    }
}

/// It would be pinned although nothing can move it.
#[test]
fn immobile_limb_is_not_pinned() {
    let pole = [
        ("pole", Some(2), [0.0, 1.0], LOCKED),
        ("pole's top", Some(CHARACTER.len()), [-1.0, 1.8], LOCKED),
    ];
    let mut bones = CHARACTER.to_vec();
    bones.extend(pole);
    for dragged in ["left hand", "right foot", "hips"] {
        let [one, other] = [character(), skeleton(&bones)].map(|s| held_frames(&s, &[dragged]));
        assert_eq!(one, other, "{dragged}");
    }
}

/// The spine has five times the posture weight of limbs.
#[test]
fn spine_is_stiffer_than_limbs() {
    let character = character();
    let holds = character.holds(&[character.bone("left hand").unwrap()]);
    let n = character.model().degrees_of_freedom();
    let mut builder = Problem::builder(character.model());
    for posture in hold_postures(&holds, &character, &vec![0.25; n]).unwrap() {
        builder.add(posture);
    }
    let problem = builder.build().unwrap();
    assert_eq!(
        [0, 1].map(|task| problem.task_name(task).unwrap()),
        ["posture", "posture of the back"]
    );
    let mut scratch = problem.scratch();
    let mut residual = vec![0.0; problem.rows()];
    let x = vec![1.25; problem.variables()];
    Evaluation::new(&problem, &mut scratch).residual(&x, &mut residual);
    let back: usize = holds.back.iter().map(|&b| character.joints(b).len()).sum();
    let count_of = |weight: f64| residual.iter().filter(|r| **r == weight).count();
    assert!(back > 0 && count_of(5.0) == back, "{residual:?}");
    // Locked joints are at 0.
    let limbs = residual.len() - back;
    assert_eq!(count_of(1.0) + count_of(-0.25), limbs, "{residual:?}");
}
