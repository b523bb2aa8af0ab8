//! Promise: a rig is read as its format specifies, and round trips through files.

use std::f64::consts::{FRAC_PI_2, PI};

use kinopt::io::rig::Rig;
use kinopt::io::{dmat, ply};
use kinopt::skeleton::Skeleton;
use kinopt::skinning::Influence;
use support::fault_tables::ExpectedError;
use support::random::Random;
use support::small_rig::SmallRig;

fn assert_same(a: &Rig, b: &Rig) {
    assert_eq!(a.skeleton.bones(), b.skeleton.bones());
    assert_eq!(a.mesh, b.mesh);
    assert_eq!(a.weights, b.weights);
    assert_eq!(a.clip, b.clip);
    assert_eq!(a.constrained, b.constrained);
}

fn indices(rig: &Rig) -> Vec<usize> {
    rig.constrained.iter().map(|bone| bone.index()).collect()
}

#[test]
fn numbers_are_read_as_specified() {
    let rig = SmallRig::with_json(support::small_rig::JSON)
        .parse()
        .unwrap();
    let [root, middle, end] = rig.skeleton.bones() else {
        panic!("three bones");
    };
    assert_eq!(root.name, "bone/0");
    assert_eq!(root.parent, None);
    assert!(root.limits.iter().all(|limits| limits.is_locked()));
    assert_eq!(middle.parent.unwrap().index(), 0);
    assert_eq!(middle.limits[1].upper, FRAC_PI_2);
    assert!((middle.limits[0].lower + PI / 18.0).abs() < 1e-16);
    // ±1e10 and missing limits mean unlimited.
    assert_eq!(middle.limits[2].lower, f64::NEG_INFINITY);
    assert_eq!(middle.limits[2].upper, f64::INFINITY);
    assert!(
        end.limits
            .iter()
            .all(|limits| limits.lower == f64::NEG_INFINITY)
    );
    assert!(
        end.limits
            .iter()
            .all(|limits| limits.upper == f64::INFINITY)
    );
    // Row-major: canonical x maps to model y, from (0.625, 0, 0.1).
    assert_eq!(end.rest_tail().to_array(), [0.625, 0.0, 0.1]);
    assert_eq!(end.rest_tip().to_array(), [0.625, 0.25, 0.1]);
    assert_eq!(indices(&rig), [2]);

    let [bone_1] = rig.clip.tracks() else {
        panic!("one track");
    };
    assert_eq!(bone_1.bone.index(), 1);
    assert_eq!(bone_1.keys[1].time, 1.75);
    assert!((bone_1.keys[1].angles[1] + 20.25 * PI / 180.0).abs() < 1e-16);
    assert_eq!(rig.clip.time_span(), Some([0.75, 1.75]));
    assert_eq!(rig.clip.keys(bone_1.bone), bone_1.keys);
    assert!(rig.clip.keys(rig.skeleton.bone_at(2).unwrap()).is_empty());

    // Column 0 belongs to bone 1 and column 1 to bone 2.
    let weights = rig.weights.unwrap();
    let half = |bone| Influence { bone, weight: 0.5 };
    assert_eq!(weights.influences(1), [half(1), half(2)]);
    assert_eq!(
        weights.influences(2),
        [Influence {
            bone: 2,
            weight: 1.0
        }]
    );
    // The default interpolation of a track is a Catmull-Rom spline.
    let turned = rig.clip.tracks()[0].bone;
    let between = rig.clip.interpolation(turned).name();
    assert_eq!(between, "catmull-rom");
}

#[test]
fn constrained_tips_may_be_list_number_or_absent() {
    let with = |text: &str| {
        let json = support::small_rig::JSON.replace("\"ik_constraints\": [2],", text);
        indices(&SmallRig::with_json(&json).parse().unwrap())
    };
    assert_eq!(with("\"ik_constraints\": [1, 0, 1],"), [1, 0]);
    assert_eq!(with("\"ik_constraints\": 0,"), [0]);
    assert_eq!(with("\"ik_constraints\": [],"), [0_usize; 0]);
    assert_eq!(with(""), [2]);
}

#[test]
fn names_are_optional_and_round_trip() {
    // "bone/1" on bone 1 is its explicit default name.
    let json = support::small_rig::JSON
        .replace("\"length\":0.5,", "\"length\":0.5,\"name\":\"bone/1\",")
        .replace(
            "\"length\":0.25,",
            "\"length\":0.25,\"name\":\"Hand \\\"é\\\"\",",
        );
    let rig = SmallRig::with_json(&json).parse().unwrap();
    let names: Vec<&str> = rig
        .skeleton
        .bones()
        .iter()
        .map(|b| b.name.as_str())
        .collect();
    assert_eq!(names, ["bone/0", "bone/1", "Hand \"é\""]);
    assert_eq!(rig.skeleton.bone("Hand \"é\"").unwrap().index(), 2);
    assert!(rig.skeleton.model().frame("Hand \"é\"/tip").is_ok());

    let written = rig.to_json("small.ply", "small.dmat");
    // Default names are not written.
    assert_eq!(written.matches("\"name\"").count(), 1);
    assert_same(&rig, &SmallRig::with_json(&written).parse().unwrap());
}

#[test]
fn unreadable_names_are_not_written() {
    let mut rig = SmallRig::with_json(support::small_rig::JSON)
        .parse()
        .unwrap();
    let mut bones = rig.skeleton.bones().to_vec();
    bones[2].name = "arm/hand".into();
    rig.skeleton = Skeleton::new("renamed", bones).unwrap();
    let path = std::env::temp_dir().join(format!("kinopt-names-{}.json", std::process::id()));
    rig.write(&path).says("arm/hand | bone 2");
    assert!(!path.exists());
}

#[test]
fn mesh_weights_and_keyframes_may_be_absent() {
    let json = r#"{"bones": [{"parent_id":-1,"weight_id":-1,"length":1,
        "rest_T":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]}"#;
    let rig = SmallRig::with_json(json).parse().unwrap();
    assert!(rig.mesh.is_none() && rig.weights.is_none() && rig.clip.is_empty());
    let again = SmallRig::with_json(&rig.to_json("unused", "unused"))
        .parse()
        .unwrap();
    assert_same(&rig, &again);
}

#[test]
fn rig_round_trips_through_the_disk() {
    let rig = SmallRig::with_json(support::small_rig::JSON)
        .parse()
        .unwrap();
    let folder = std::env::temp_dir().join(format!("kinopt-round-trip-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("arm.json");
    let bare = Rig {
        mesh: None,
        ..rig.clone()
    };
    let without_mesh = bare.write(&path).map(|()| Rig::read(&path));
    let written = rig.write(&path);
    let again = Rig::read(&path);
    let parts = (
        ply::read(folder.join("arm.ply")),
        dmat::read(folder.join("arm.dmat")),
    );
    let clash = rig.write(folder.join("arm.ply"));
    std::fs::remove_dir_all(&folder).unwrap();
    assert_same(&bare, &without_mesh.unwrap().unwrap());
    written.unwrap();
    assert_same(&rig, &again.unwrap());
    assert_eq!(&parts.0.unwrap(), rig.mesh.as_ref().unwrap());
    assert_eq!(parts.1.unwrap(), rig.weights_table().unwrap());
    clash.says("arm.ply");
}

#[test]
fn angles_in_degrees_round_trip_exactly() {
    // Whole degrees, awkward fractions, and thousands of pseudo-random ones over many magnitudes.
    let mut random = Random::new(5);
    let mut angles: Vec<f64> = (-720..=720).map(f64::from).collect();
    for _ in 0..20_000 {
        let scale = 10.0_f64.powi(random.below(8) as i32 - 3);
        angles.push(random.within(-0.5, 0.5) * scale);
    }
    let keys: Vec<String> = angles
        .iter()
        .enumerate()
        .map(|(k, a)| format!(r#"{{"t":{},"xzx":[{a},{},{a:e}]}}"#, k as f64 * 0.1, -a))
        .collect();
    let json = support::small_rig::JSON.replace(
        r#"{"t": 0.75, "xzx": [0, 10, 0]}, {"t": 1.75, "xzx": [5, -20.25, 7]}"#,
        &keys.join(","),
    );
    let rig = SmallRig::with_json(&json).parse().unwrap();
    let keys = &rig.clip.tracks()[0].keys;
    for (key, angle) in keys.iter().zip(&angles) {
        assert_eq!(key.angles[0].to_bits(), angle.to_radians().to_bits());
    }
    let again = SmallRig::with_json(&rig.to_json("small.ply", "small.dmat"))
        .parse()
        .unwrap();
    for (a, b) in keys.iter().zip(&again.clip.tracks()[0].keys) {
        assert_eq!(a.time.to_bits(), b.time.to_bits());
        assert_eq!(a.angles.map(f64::to_bits), b.angles.map(f64::to_bits));
    }
    assert_same(&rig, &again);
}
