//! Promise: no file makes a reader panic, hang or use memory out of proportion to its size.
//!
//! Thousands of valid files are damaged by a fixed pseudo-random sequence: bits are flipped, bytes removed, inserted or
//! repeated, numbers replaced by extreme ones. Whatever can still be read fulfils the promises of its type.

use crate::counting_allocator::peak;
use kinopt::io::bvh;
use kinopt::io::dmat::{self, DmatEncoding};
use kinopt::io::ply::{self, PlyEncoding};
use kinopt::kinematics::ForwardKinematics;
use kinopt::mesh::TriangleMesh;
use kinopt::robot::{Robot, Srdf};
use support::random::{Random, case_count};
use support::small_rig::SmallRig;

/// Memory allowed for a file of a few hundred bytes. The parser reserves up to 65 536 entries for a list before it
/// notices that the file is too short.
const MEMORY_LIMIT: isize = 4 << 20;

#[test]
fn memory_is_counted() {
    let (length, memory) = peak(|| vec![1_u8; 1 << 20].len());
    assert!(
        length == 1 << 20 && (1 << 20..1 << 21).contains(&memory),
        "{memory}"
    );
}

/// Replacements of numbers.
const ABSURD_VALUES: &str = "-1 0 1 2 255 65536 2147483647 2147483648 4294967295 4000000000 \
    9223372036854775807 18446744073709551615 1e308 -1e999 0.5 NaN";

fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len().max(1));
        match random.below(7) {
            0 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
            1 if !bytes.is_empty() => bytes[at] = random.bits() as u8,
            2 => bytes.truncate(at),
            3 => bytes.insert(at, random.bits() as u8),
            4 => {
                let end = (at + random.below(40)).min(bytes.len());
                bytes.drain(at..end);
            }
            5 => {
                let end = (at + random.below(80)).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                let to = random.below(bytes.len().max(1));
                bytes.splice(to..to, piece);
            }
            _ => swap_a_number(bytes, at, random),
        }
    }
}

/// Replaces the first number at or after `at` by an extreme one.
fn swap_a_number(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    let digit = |b: &u8| b.is_ascii_digit();
    if let Some(start) = bytes[at..].iter().position(digit).map(|i| at + i) {
        let length = bytes[start..].iter().position(|b| !digit(b));
        let end = length.map_or(bytes.len(), |length| start + length);
        let numbers: Vec<&str> = ABSURD_VALUES.split(' ').collect();
        let number = random.pick(&numbers);
        bytes.splice(start..end, number.bytes());
    }
}

/// Reads many damaged copies of `good`. `read` returns whether a copy could be read.
fn check_damaged(seed: u64, rounds: usize, good: &[u8], read: impl Fn(&[u8]) -> bool) {
    assert!(read(good));
    let mut random = Random::split_mix(seed);
    let mut refused = 0;
    for round in 0..rounds {
        let mut bytes = good.to_vec();
        damage(&mut bytes, &mut random);
        let (whole, memory) = peak(|| read(&bytes));
        let shown = || String::from_utf8_lossy(&bytes).into_owned();
        assert!(
            memory < MEMORY_LIMIT,
            "round {round}: {memory} bytes for {}",
            shown()
        );
        refused += usize::from(!whole);
    }
    // Otherwise the damage does not reach the relevant parts.
    assert!(
        refused > rounds / 4 && refused < rounds,
        "{refused} of {rounds} refused"
    );
}

fn check_mesh(mesh: &TriangleMesh) {
    let vertices = mesh.positions().len();
    assert!(
        mesh.triangles()
            .iter()
            .flatten()
            .all(|&i| (i as usize) < vertices)
    );
    assert!(mesh.vertex_normals().iter().all(|n| n.is_finite()));
}

fn reads_ply(bytes: &[u8]) -> bool {
    let mesh = ply::from_bytes(bytes, "damaged.ply");
    mesh.inspect(check_mesh).is_ok()
}

#[test]
fn damaged_ply_is_an_error_or_a_valid_mesh() {
    let triangle = ply::from_bytes(support::small_rig::PLY.as_bytes(), "good").unwrap();
    let mesh = triangle.with_computed_normals();
    check_damaged(1, 4000, support::small_rig::PLY.as_bytes(), reads_ply);
    for (seed, encoding) in [
        (2, PlyEncoding::Ascii),
        (3, PlyEncoding::BinaryLittleEndian),
        (4, PlyEncoding::BinaryBigEndian),
    ] {
        check_damaged(seed, 4000, &ply::to_bytes(&mesh, encoding), reads_ply);
    }
}

const BVH: &str = "HIERARCHY
ROOT Hips
{
  OFFSET 0 9.5 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Leg
  {
    OFFSET 1 -4 0
    CHANNELS 1 Xrotation
    End Site
    {
      OFFSET 0 -4 0
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.04
0 9.25 0 10 20 30 40
0.125 9 1 -350 21 31 41
0.25 8.5 2 12 22 32 -170
";

#[test]
fn damaged_bvh_is_an_error_or_can_be_rewritten() {
    check_damaged(10, 8000, BVH.as_bytes(), |bytes| {
        let Ok(capture) = bvh::from_bytes(bytes, "damaged.bvh") else {
            return false;
        };
        // A capture can be written, and has the same bones when read again.
        if (1..100).contains(&capture.frames) {
            let (armature, rate) = (&capture.armature, 1.0 / capture.frame_time);
            let text = bvh::to_text(armature, &capture.clip, rate).unwrap();
            let again = bvh::from_bytes(text.as_bytes(), "again.bvh").unwrap();
            assert_eq!(again.frames, capture.frames);
            for (name, translation) in armature.names().iter().zip(armature.rest().translations()) {
                let bone = again.armature.bone(name).unwrap();
                assert_eq!(
                    again.armature.rest().local(bone).unwrap().translation,
                    *translation
                );
            }
        }
        true
    });
}

#[test]
fn damaged_dmat_is_an_error_or_finite() {
    let table = dmat::from_bytes(support::small_rig::DMAT.as_bytes(), "good").unwrap();
    for (seed, encoding) in [(5, DmatEncoding::Text), (6, DmatEncoding::Binary)] {
        check_damaged(
            seed,
            4000,
            &dmat::to_bytes(&table, encoding),
            |bytes| match dmat::from_bytes(bytes, "damaged.dmat") {
                Ok(table) => {
                    assert!(table.iter().all(|value| value.is_finite()));
                    true
                }
                Err(_) => false,
            },
        );
    }
}

fn reads_rig(rig: &SmallRig) -> bool {
    let Ok(rig) = rig.parse() else {
        return false;
    };
    let bones = rig.skeleton.bones();
    for (index, bone) in bones.iter().enumerate() {
        assert!(bone.parent.is_none_or(|parent| parent.index() < index));
        assert!(bone.length >= 0.0 && bone.limits.iter().all(|limits| limits.is_valid()));
    }
    for weights in rig.weights.iter().flat_map(|weights| weights.iter()) {
        assert!(weights.iter().all(|w| (w.bone as usize) < bones.len()));
    }
    for track in rig.clip.tracks() {
        assert!(
            track
                .keys
                .windows(2)
                .all(|pair| pair[0].time < pair[1].time)
        );
    }
    // A rig can be written and read again.
    let json = rig.to_json("small.ply", "small.dmat").into_bytes();
    let again = SmallRig {
        json,
        ..SmallRig::with_json("")
    };
    if rig.mesh.is_some() && rig.weights.is_some() {
        assert_eq!(again.parse().unwrap().skeleton.bones().len(), bones.len());
    }
    true
}

#[test]
fn damaged_rig_is_an_error_or_can_be_rewritten() {
    check_damaged(7, 8000, support::small_rig::JSON.as_bytes(), |json| {
        reads_rig(&SmallRig {
            json: json.to_vec(),
            ..SmallRig::with_json("")
        })
    });
    check_damaged(8, 3000, support::small_rig::DMAT.as_bytes(), |dmat| {
        reads_rig(&SmallRig {
            dmat: Some(dmat.to_vec()),
            ..SmallRig::with_json(support::small_rig::JSON)
        })
    });
    check_damaged(9, 3000, support::small_rig::PLY.as_bytes(), |ply| {
        reads_rig(&SmallRig {
            ply: Some(ply.to_vec()),
            ..SmallRig::with_json(support::small_rig::JSON)
        })
    });
}

/// Reads a scene, poses it in several ways and writes it. Every failure must be an error.
fn reads_gltf(bytes: &[u8]) -> bool {
    use kinopt::animation::{Cursor, Playback};
    use kinopt::io::gltf::{self, ScenePosing, WriteOptions};
    use kinopt::skinning::SkinningMethod;

    let Ok(scene) = support::gltf_text::read(bytes) else {
        return false;
    };
    let mut pose = scene.armature.rest().clone();
    for method in SkinningMethod::ALL {
        let mut posing = ScenePosing::new(&scene, method).unwrap();
        for clip in &scene.clips {
            for share in [-1.0, 0.0, 0.3, 1.0, 2.0] {
                let time = share * clip.duration();
                clip.sample(time, Playback::Loop, &mut Cursor::new(), &mut pose)
                    .unwrap();
                let _ = posing.mesh(&pose);
            }
        }
    }
    for mesh in &scene.meshes {
        check_mesh(&mesh.mesh);
        let _ = gltf::mesh_to_bytes(&mesh.mesh);
    }
    // A scene can be written and read again, except for content that the format does not allow.
    if let Ok(bytes) = gltf::to_bytes(&scene, &WriteOptions::default()) {
        let again = support::gltf_text::read(&bytes).unwrap();
        assert_eq!(again.armature, scene.armature);
        assert_eq!(again.clips.len(), scene.clips.len());
    }
    true
}

#[test]
fn damaged_gltf_is_an_error_or_can_be_rewritten() {
    let (numbers, rest) = support::gltf_text::small();
    let rounds = case_count(12_000, 4_000);
    check_damaged(10, rounds, numbers.document(&rest).as_bytes(), reads_gltf);
    check_damaged(11, rounds, &numbers.glb(&rest), reads_gltf);
}

#[test]
fn truncated_gltf_is_an_error() {
    let (numbers, rest) = support::gltf_text::small();
    for file in [numbers.document(&rest).into_bytes(), numbers.glb(&rest)] {
        for length in 0..file.len() {
            assert!(!reads_gltf(&file[..length]), "{length}");
        }
    }
}

/// Asserts that a robot is consistent: placements are rigid and finite in every configuration.
fn check_robot(robot: &Robot) {
    let model = robot.model();
    let mut kinematics = ForwardKinematics::new(model);
    for seed in 0..2 {
        let q = model.random_configuration(seed);
        assert!(model.is_within_limits(&q), "{q:?}");
        for placement in kinematics.place(&q).unwrap() {
            assert!(placement.translation.to_array().iter().all(|c| !c.is_nan()));
        }
    }
    for closed in model.loops() {
        for frame in closed.frames {
            assert!(frame.index() < model.frames().len());
        }
    }
}

#[test]
fn damaged_mjcf_is_an_error_or_a_valid_robot() {
    // Included files are absent: all damage is in one document.
    let walker = include_str!("../../robot/mjcf/files/walker.xml");
    let gripper = Robot::mjcf_reader().text_with_includes(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/robot/mjcf/files/gripper.xml"
    ));
    for (seed, good) in [(11, walker), (12, &gripper.unwrap())] {
        check_damaged(seed, 3000, good.as_bytes(), |bytes| {
            let Ok(text) = std::str::from_utf8(bytes) else {
                return false;
            };
            let read = Robot::parse_mjcf(text, "damaged.xml");
            if let Err(error) = &read {
                assert!(error.to_string().starts_with("damaged.xml"), "{error}");
            }
            read.inspect(check_robot).is_ok()
        });
    }
}

#[test]
fn damaged_urdf_is_an_error_or_a_valid_robot() {
    for (seed, name) in [(14, "universal_ur5e"), (15, "kuka_iiwa14")] {
        let text = std::fs::read(format!("../models/{name}.urdf")).unwrap();
        check_damaged(seed, case_count(2_000, 600), &text, |bytes| {
            let Ok(text) = std::str::from_utf8(bytes) else {
                return false;
            };
            let read = Robot::parse(text, "damaged.urdf");
            if let Err(error) = &read {
                assert!(error.to_string().starts_with("damaged.urdf:"), "{error}");
            }
            read.inspect(check_robot).is_ok()
        });
    }
}

const SRDF: &str = r#"<robot name="ur5e">
<virtual_joint name="fix" type="fixed" parent_frame="world" child_link="base"/>
<group name="arm"><chain base_link="base" tip_link="flange"/></group>
<group name="wrist"><joint name="joint5"/><link name="flange"/></group>
<group name="all"><group name="arm"/><group name="wrist"/></group>
<group_state name="up" group="all"><joint name="joint2" value="-1.5"/><joint name="joint4" value="0.25"/></group_state>
<end_effector name="hand" group="wrist" parent_link="flange" parent_group="arm"/>
<passive_joint name="joint6"/>
<disable_collisions link1="base" link2="flange" reason="Never"/>
</robot>"#;

#[test]
fn damaged_srdf_is_an_error_or_finite() {
    let robot = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/universal_ur5e.urdf");
    let robot = Robot::read(robot).unwrap();
    let q = robot.model().neutral();
    check_damaged(13, 4000, SRDF.as_bytes(), |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else {
            return false;
        };
        let read = Srdf::parse(text, "damaged.srdf", &robot);
        if let Err(error) = &read {
            assert!(error.to_string().starts_with("damaged.srdf"), "{error}");
        }
        read.inspect(|srdf| {
            for state in &srdf.states {
                let configuration = srdf.state(&state.name, &q).unwrap();
                assert!(configuration.iter().all(|value| value.is_finite()));
            }
            for group in &srdf.groups {
                srdf.only(&robot, &group.name, &q).unwrap().build().unwrap();
            }
            srdf.driven(&robot, &q).build().unwrap();
        })
        .is_ok()
    });
}
