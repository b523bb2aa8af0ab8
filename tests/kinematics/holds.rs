//! Promise: a character that is dragged by one limb stays where it stands: its trunk and the ends of its
//! other limbs are held, whatever else hangs on the skeleton.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use kinopt::model::Limits;
use kinopt::skeleton::{Bone, BoneId, Skeleton};
use kinopt::spatial::{Placement, Vector3};

const FREE: [Limits; 3] = [Limits::UNBOUNDED; 3];
const LOCKED: [Limits; 3] = [Limits::new(0.0, 0.0); 3];

/// Bones by name, parent and limits.
fn skeleton(bones: &[(&str, Option<usize>, [Limits; 3])]) -> Skeleton {
    let mut builder = Skeleton::builder("character");
    let mut ids: Vec<BoneId> = Vec::new();
    for (k, &(name, parent, limits)) in bones.iter().enumerate() {
        ids.push(builder.add(Bone {
            name: name.into(),
            parent: parent.map(|parent| ids[parent]),
            length: 0.0,
            model_from_rest: Placement::translation(Vector3::new(k as f64, 0.0, 0.0)),
            limits,
        }));
    }
    builder.build().unwrap()
}

/// Two legs, a chest with two arms, a nose on the head, and a prop that does not move.
fn character() -> Skeleton {
    skeleton(&[
        ("scene", None, LOCKED),
        ("root", Some(0), FREE),
        ("hips", Some(1), FREE),
        ("left leg", Some(2), FREE),
        ("left foot", Some(3), FREE),
        ("right leg", Some(2), FREE),
        ("right foot", Some(5), FREE),
        ("chest", Some(2), FREE),
        ("left arm", Some(7), FREE),
        ("left hand", Some(8), FREE),
        ("left ring", Some(9), LOCKED),
        ("right arm", Some(7), FREE),
        ("right hand", Some(11), FREE),
        ("prop", Some(0), LOCKED),
    ])
}

fn held(skeleton: &Skeleton, dragged: &[&str]) -> (Vec<String>, Vec<String>) {
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
fn the_trunk_and_the_other_limbs_stay() {
    let character = character();
    let trunk = ["scene", "root", "hips"];
    for dragged in ["left hand", "left arm", "left ring"] {
        let (still, ends) = held(&character, &[dragged]);
        assert_eq!(still, trunk, "{dragged}");
        assert_eq!(ends, ["left foot", "right foot", "right hand"], "{dragged}");
    }
    // What hangs on what is dragged comes along.
    let (still, ends) = held(&character, &["chest"]);
    assert_eq!(
        (still.len(), ends),
        (3, vec!["left foot".into(), "right foot".into()])
    );
    let (_, ends) = held(&character, &["left hand", "right foot"]);
    assert_eq!(ends, ["left foot", "right hand"]);
}

#[test]
fn a_dragged_trunk_leaves_its_limbs_behind() {
    let (still, ends) = held(&character(), &["hips"]);
    assert_eq!(still, ["scene", "root"]);
    assert_eq!(ends, ["left foot", "right foot", "left hand", "right hand"]);
}

#[test]
fn one_chain_holds_nothing() {
    let arm = skeleton(&[
        ("a", None, FREE),
        ("b", Some(0), FREE),
        ("c", Some(1), FREE),
    ]);
    assert_eq!(held(&arm, &["c"]), (Vec::new(), Vec::new()));
}

#[test]
fn the_trunk_s_angles_stay_as_they_are() {
    let character = character();
    let hand = character.bone("left hand").unwrap();
    let holds = character.holds(&[hand]);
    let q: Vec<f64> = (0..character.angles())
        .map(|k| if k < 3 { 0.0 } else { 0.01 * k as f64 })
        .collect();
    let map = holds.parameters(&character, &q).unwrap();
    // Nine bones turn freely.
    assert_eq!(map.variables(), 27);
    let mut expanded = vec![0.0; q.len()];
    map.expand(&vec![0.0; map.variables()], &mut expanded);
    assert_eq!(expanded[3..9], q[3..9]);
}
