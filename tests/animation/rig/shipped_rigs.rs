//! Promise: the rigs under `models/` are sound. Skins are closed, smooth weights sum to 1, keyframes are within limits,
//! tips are finite, and files are small.

use std::path::{Path, PathBuf};

use kinopt::io::rig::Rig;
use support::random::Random;

const NAMES: [&str; 2] = ["robot-arm", "humanoid"];

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../models")
        .join(name)
}

fn read(name: &str) -> Rig {
    Rig::read(folder(name).join(format!("{name}.json"))).unwrap()
}

/// Random angles within the limits, which must be finite.
fn random_angles(rig: &Rig, random: &mut Random) -> Vec<f64> {
    let limits = rig.skeleton.bones().iter().flat_map(|bone| bone.limits);
    let draw = limits.map(|limits| {
        assert!(limits.lower.is_finite() && limits.upper.is_finite());
        random.within(limits.lower, limits.upper)
    });
    draw.collect()
}

#[test]
fn each_rig_is_smaller_than_a_megabyte() {
    for name in NAMES {
        let parts = ["json", "ply", "dmat"].map(|extension| {
            let path = folder(name).join(format!("{name}.{extension}"));
            std::fs::metadata(path).unwrap().len()
        });
        assert!(parts.iter().sum::<u64>() < 1_000_000, "{name}: {parts:?}");
    }
}

#[test]
fn skins_are_closed_and_face_outward() {
    // Litres: an adult of 1.75 m has about 70, and this one is slim.
    for (name, litres) in [("robot-arm", 5.0..25.0), ("humanoid", 45.0..85.0)] {
        let mesh = read(name).mesh.unwrap();
        assert!(mesh.is_closed(), "{name}");
        let volume = 1000.0 * mesh.signed_volume();
        assert!(litres.contains(&volume), "{name}: {volume} litres");
        // One connected piece.
        let mut root: Vec<usize> = (0..mesh.positions().len()).collect();
        fn top(root: &mut [usize], mut v: usize) -> usize {
            while root[v] != v {
                root[v] = root[root[v]];
                v = root[v];
            }
            v
        }
        for &[a, b, c] in mesh.triangles() {
            for (v, w) in [(a, b), (b, c)] {
                let (v, w) = (top(&mut root, v as usize), top(&mut root, w as usize));
                root[v] = w;
            }
        }
        let pieces = (0..root.len()).filter(|&v| root[v] == v).count();
        assert_eq!(pieces, 1, "{name}");
    }
}

#[test]
fn weights_are_smooth_and_sum_to_one() {
    for name in NAMES {
        let rig = read(name);
        let (mesh, weights) = (rig.mesh.unwrap(), rig.weights.unwrap());
        assert!(weights.max_influences() <= 6, "{name}");
        for row in weights.iter() {
            let sum: f64 = row.iter().map(|influence| influence.weight).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{name}: {sum}");
            assert!(row.iter().all(|influence| influence.weight > 0.0));
        }
        // Every bone moves some vertex, and no weight jumps from zero to one.
        let table = weights.to_table();
        for (bone, column) in table.column_iter().enumerate() {
            assert!(column.max() > 0.5, "{name}: bone {bone}");
        }
        let jumps = mesh
            .triangles()
            .iter()
            .flat_map(|t| [(t[0], t[1]), (t[1], t[2])]);
        let jump = jumps.map(|(v, w)| (table.row(v as usize) - table.row(w as usize)).amax());
        let largest = jump.fold(0.0, f64::max);
        assert!(largest < 0.7, "{name}: {largest}");
    }
}

#[test]
fn keyframes_stay_within_the_limits() {
    for rig in ["robot-arm", "humanoid"].map(read) {
        let [start, end] = rig.clip.time_span().unwrap();
        assert!(end - start > 2.0);
        for track in rig.clip.tracks() {
            let bone = &rig.skeleton.bones()[track.bone.index()];
            for key in &track.keys {
                for (limits, angle) in bone.limits.iter().zip(key.angles) {
                    assert!(
                        limits.lower <= angle && angle <= limits.upper,
                        "{}",
                        bone.name
                    );
                }
            }
            let gaps: Vec<f64> = track
                .keys
                .windows(2)
                .map(|k| k[1].time - k[0].time)
                .collect();
            assert!(
                gaps.iter().any(|gap| (gap - gaps[0]).abs() > 0.1),
                "uneven times"
            );
        }
    }
}

#[test]
fn rigs_have_the_documented_tips() {
    let names = |rig: &Rig| -> Vec<String> {
        let bones = rig.constrained.iter().map(|bone| bone.index());
        bones
            .map(|index| rig.skeleton.bones()[index].name.clone())
            .collect()
    };
    let humanoid = read("humanoid");
    assert!(humanoid.skeleton.bones().len() >= 20);
    let five = ["head", "left_hand", "right_hand", "left_foot", "right_foot"];
    assert_eq!(names(&humanoid), five);
    assert_eq!(names(&read("robot-arm")), ["gripper"]);
}

#[test]
fn tails_coincide_with_parent_tips() {
    for name in NAMES {
        let rig = read(name);
        for bone in rig.skeleton.bones() {
            let Some(parent) = bone.parent else { continue };
            let parent = &rig.skeleton.bones()[parent.index()];
            let gap = (bone.rest_tail() - parent.rest_tip()).norm();
            if bone.name.ends_with("_thigh") {
                let (tail, hips) = (bone.rest_tail(), parent.rest_tail());
                assert_eq!((tail.x, tail.z), (hips.x, hips.z), "{}", bone.name);
            } else {
                assert!(gap < 1e-12, "{name}: {}: {gap}", bone.name);
            }
        }
    }
}

#[test]
fn hinge_bones_have_one_variable() {
    let moving = |name: &str| {
        let rig = read(name);
        let limits =
            |bone: &kinopt::skeleton::Bone| bone.limits.iter().filter(|l| !l.is_locked()).count();
        let each = rig
            .skeleton
            .bones()
            .iter()
            .map(|bone| (bone.name.clone(), limits(bone)));
        each.collect::<std::collections::BTreeMap<_, _>>()
    };
    let humanoid = moving("humanoid");
    for hinge in ["left_forearm", "right_forearm", "left_shin", "right_shin"] {
        assert_eq!(humanoid[hinge], 1, "{hinge}");
    }
    assert_eq!(humanoid["left_thigh"], 3);
    assert_eq!(moving("robot-arm").values().sum::<usize>(), 6);
}

#[test]
fn right_side_mirrors_the_left() {
    let rig = read("humanoid");
    let bones = rig.skeleton.bones();
    let mirror = |p: kinopt::spatial::Vector3<f64>| [p.x, -p.y, p.z];
    // Equal angles with opposite twists give the mirror image of any pose.
    let mut random = Random::split_mix(7);
    for _ in 0..20 {
        let q = random_angles(&rig, &mut random);
        let mut mirrored = q.clone();
        for (index, bone) in bones.iter().enumerate() {
            if let Some(side) = bone.name.strip_prefix("left_") {
                let right = rig.skeleton.bone(&format!("right_{side}")).unwrap().index();
                let angles: [f64; 3] = q[3 * index..3 * index + 3].try_into().unwrap();
                for (k, sign) in [-1.0, 1.0, -1.0].into_iter().enumerate() {
                    let angle = sign * angles[k];
                    let limits = bones[right].limits[k];
                    assert!(limits.lower <= angle && angle <= limits.upper);
                    mirrored[3 * right + k] = angle;
                }
            } else if !bone.name.starts_with("right_") {
                // Middle bones stay at rest, which is symmetric.
                mirrored[3 * index..3 * index + 3].fill(0.0);
            }
        }
        let placements = rig.skeleton.pose(&mirrored).unwrap();
        for id in rig.skeleton.bone_ids() {
            let name = &bones[id.index()].name;
            if let Some(side) = name.strip_prefix("left_") {
                let right = rig.skeleton.bone(&format!("right_{side}")).unwrap();
                let left = mirror(placements.tip(&rig.skeleton, id).unwrap());
                let right = placements.tip(&rig.skeleton, right).unwrap().to_array();
                let apart = left.iter().zip(right).map(|(l, r)| (l - r).abs());
                assert!(apart.fold(0.0, f64::max) < 1e-12, "{name}");
            }
        }
    }
}

#[test]
fn tips_are_finite_at_any_pose() {
    for name in NAMES {
        let rig = read(name);
        let mut random = Random::split_mix(1);
        let size = rig.skeleton.size();
        for _ in 0..1000 {
            let q = random_angles(&rig, &mut random);
            let placements = rig.skeleton.pose(&q).unwrap();
            for &bone in &rig.constrained {
                let tip = placements.tip(&rig.skeleton, bone).unwrap().to_array();
                assert!(tip.iter().all(|x| x.abs() < 2.0 * size), "{name}: {tip:?}");
            }
        }
    }
}
