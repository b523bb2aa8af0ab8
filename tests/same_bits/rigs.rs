//! Promise: so it is for rigs: read with what they may leave out, posed, weighed, written, and refused.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use glam::Vec3;
use kinopt::animation::Armature;
use kinopt::io::ReadError;
use kinopt::io::rig::{Rig, RigPosing};
use kinopt::skinning::{PosedVertices, SkinningMethod};
use support::random::Random;
use support::small_rig::{JSON, SmallRig};

use crate::animated::{changed, check_single, mesh};
use crate::digest::{Digest, Value};

/// The small rig with names, every interpolation and a root beside it.
pub(crate) fn text() -> String {
    let names = JSON.replacen(
        "{\"parent_id\":-1,",
        "{\"name\":\"hip\",\"parent_id\":-1,",
        1,
    );
    let more = r#"{"bone_id": 2, "interpolation": "kochanek-bartels", "keys": [{"t": 0, "xzx": [1, 2, 3]}, {"t": 2, "xzx": [3, 2, 1], "tcb": [0.5, -0.25, 0.125]}]},
        {"bone_id": 0, "interpolation": "linear", "keys": [{"t": -1, "xzx": [10, 20, 30]}, {"t": 0.5, "xzx": [0, 0, 7]}]}, {"bone_id": 1"#;
    names.replacen("{\"bone_id\": 1", more, 1)
}

pub(crate) fn add(digest: &mut Digest, rig: &Rig) {
    digest.json(&rig.skeleton);
    digest.json(&rig.clip);
    digest.debug((&rig.constrained, &rig.notes));
    rig.notes
        .iter()
        .for_each(|note| digest.text(note.to_string()));
    if let Some(own) = &rig.mesh {
        mesh(digest, own);
    }
    digest.debug(&rig.weights);
    digest.bytes(rig.to_json("m.ply", "w.dmat"));
    digest.debug(rig.weights_table());
}

fn read() -> Value {
    let mut digest = Digest::new();
    let text = text();
    let read = |text: &str| SmallRig::with_json(text).parse();
    changed(
        &mut digest,
        &text,
        &[
            ("\"hip\"", "\"HIP\""),
            ("\"hip\"", "\"\""),
            ("\"hip\"", "\"bone/0\""),
            ("\"hip\"", "\"bone/1\""),
            ("\"hip\"", "null"),
            ("{\"parent_id\":0", "{\"name\":\"hip\",\"parent_id\":0"),
            ("{\"parent_id\":0", "{\"parent_id\":1"),
            ("{\"parent_id\":0", "{\"parent_id\":-2"),
            ("{\"parent_id\":0", "{\"parent_id\":-1"),
            ("\"weight_id\":1", "\"weight_id\":0"),
            ("\"weight_id\":1", "\"weight_id\":2"),
            ("\"weight_id\":1", "\"weight_id\":-2"),
            ("\"weight_id\":1", "\"weight_id\":-1"),
            ("\"length\":0.5", "\"length\":-0.5"),
            ("\"length\":0.5", "\"length\":1e999"),
            ("[-10,-20,-1e10]", "[-10,-20]"),
            ("[-10,-20,-1e10]", "[-10,100,-1e10]"),
            ("[-10,-20,-1e10]", "[-10,-20,1e10]"),
            ("[-10,-20,-1e10]", "[-10,-20,-2e10]"),
            ("[10,90,1e10]", "[10,90,-1e10]"),
            ("[10,90,1e10]", "[1e10,90,1e10]"),
            ("[[0,-1,0,0.625],", "["),
            ("[0,-1,0,0.625]", "[0,-1,0]"),
            ("[0,-1,0,0.625]", "[0,-1.1,0,0.625]"),
            ("[0,-1,0,0.625]", "[0,1,0,0.625]"),
            ("[0,0,1,0.1],[0,0,0,1]", "[0,0,1,0.1],[0,0,0,2]"),
            ("\"ik_constraints\": [2]", "\"ik_constraints\": [2, 0, 2]"),
            ("\"ik_constraints\": [2]", "\"ik_constraints\": 1"),
            ("\"ik_constraints\": [2]", "\"ik_constraints\": 3"),
            ("\"ik_constraints\": [2]", "\"ik_constraints\": [0, -1]"),
            ("\"ik_constraints\": [2]", "\"ik_constraints\": \"2\""),
            (
                "\"ik_constraints\": [2]",
                "\"ik_constraints\": 18446744073709551615",
            ),
            ("\"ik_constraints\": [2],", ""),
            ("\"bone_id\": 1", "\"bone_id\": 7"),
            ("\"bone_id\": 1", "\"bone_id\": 2"),
            ("\"t\": 1.75", "\"t\": 0.75"),
            ("\"t\": 1.75", "\"t\": 1e999"),
            ("[5, -20.25, 7]", "[5, -20.25]"),
            ("[5, -20.25, 7]", "[5, -20.25, 1e309]"),
            ("[5, -20.25, 7]", "[5, -20.25, 7], \"tcb\": [0, 0, 0]"),
            ("[0.5, -0.25, 0.125]", "[0.5, -0.25]"),
            ("[0.5, -0.25, 0.125]", "[0.5, -0.25, 1e39]"),
            ("\"linear\"", "\"cubic\""),
            ("\"linear\"", "\"catmull-rom\""),
            ("small.ply", "other.ply"),
            ("small.dmat", "other.dmat"),
            ("small.dmat", "small.ply"),
            ("\"model\": {\"file\": \"small.ply\"}, ", ""),
            ("\"weights\": {\"file\": \"small.dmat\"}, ", ""),
            ("\"bones\": [", "\"bones\": [],\"legs\": ["),
            ("\"bones\": [", "\"legs\": ["),
        ],
        read,
        add,
    );
    for change in [
        |rig: &mut SmallRig| rig.dmat = Some(b"1 3\n1\n1\n1\n".to_vec()),
        |rig: &mut SmallRig| rig.dmat = Some(b"2 4\n1 1 1 1 0 0 0 0\n".to_vec()),
        |rig: &mut SmallRig| rig.dmat = Some(b"3 3\n1 0 0 0 1 0 0 0 1\n".to_vec()),
        |rig: &mut SmallRig| rig.dmat = Some(b"3 3\n1 0 0 0 1 1 0 0 0\n".to_vec()),
        |rig: &mut SmallRig| rig.dmat = Some(b"2 3\n1 0 0 0 1 0.5\n".to_vec()),
        |rig: &mut SmallRig| rig.dmat = Some(b"2 3\n1 0 0 0 1\n".to_vec()),
        |rig: &mut SmallRig| rig.dmat = None,
        |rig: &mut SmallRig| rig.ply = None,
        |rig: &mut SmallRig| rig.ply = Some(b"ply".to_vec()),
    ] as [fn(&mut SmallRig); 9]
    {
        let mut rig = SmallRig::with_json(&text);
        change(&mut rig);
        match rig.parse() {
            Ok(rig) => add(&mut digest, &rig),
            Err(error) => digest.text(without_io(&error)),
        }
    }
    for name in ["robot-arm/robot-arm", "humanoid/humanoid"] {
        let rig = Rig::read(format!("../models/{name}.json")).unwrap();
        digest.bytes(rig.to_json("m.ply", "w.dmat"));
        digest.debug(&rig.notes);
    }
    digest.value()
}

/// The words of an error but those of the operating system, which are each system's own.
pub(crate) fn without_io(error: &ReadError) -> String {
    let words = error.to_string();
    words.split("cannot be read").next().unwrap().to_owned()
}

fn buffers(positions: &mut [Vec3]) -> PosedVertices<'_> {
    PosedVertices {
        positions,
        ..PosedVertices::default()
    }
}

fn posed() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(191));
    let small = SmallRig::with_json(&text()).parse().unwrap();
    let mut bare = small.clone();
    bare.weights = None;
    let humanoid = Rig::read("../models/humanoid/humanoid.json").unwrap();
    for rig in [&small, &bare, &humanoid] {
        for method in SkinningMethod::ALL {
            let mut posing = rig.posing(method).unwrap();
            digest.word(posing.has_automatic_weights().into());
            let mut owned = RigPosing::new(Arc::new(rig.clone()), method).unwrap();
            for _ in 0..2 {
                let count = rig.skeleton.angles();
                let q: Vec<f64> = (0..count).map(|_| random.within(-1.0, 1.0)).collect();
                let by_angles = posing.mesh(&q).unwrap();
                mesh(&mut digest, &by_angles);
                assert_eq!(rig.posed_mesh(&q, method).unwrap(), by_angles);
                let mut room = vec![Vec3::ZERO; by_angles.positions().len()];
                owned.deform(&q, buffers(&mut room)).unwrap();
                assert_eq!(room, by_angles.positions());
                let mut pose = Armature::of_skeleton(&rig.skeleton).rest().clone();
                kinopt::animation::EulerPoseMap::new(&rig.skeleton)
                    .pose_of(&q, &mut pose)
                    .unwrap();
                let by_pose = posing.mesh_of_pose(&pose).unwrap();
                mesh(&mut digest, &by_pose);
                owned.deform_to_pose(&pose, buffers(&mut room)).unwrap();
                assert_eq!(room, by_pose.positions());
                digest.refused(owned.deform(&q, buffers(&mut room[1..])));
                digest.refused(posing.mesh(&q[1..]));
            }
            let other = Armature::new(Vec::new(), Vec::new()).unwrap();
            digest.refused(posing.mesh_of_pose(other.rest()));
        }
    }
    bare.mesh = None;
    digest.refused(bare.posing(SkinningMethod::LinearBlend).map(|_| ()));
    digest.value()
}

fn weighed() -> Value {
    let mut digest = Digest::new();
    let mut rig = Rig::read("../models/humanoid/humanoid.json").unwrap();
    let q: Vec<f64> = (0..rig.skeleton.angles())
        .map(|k| 0.1 * (k % 7) as f64 - 0.3)
        .collect();
    for density in [1000.0, 1.5] {
        let masses = rig.masses(density).unwrap();
        digest.doubles([masses.total()]);
        for point in masses.points() {
            digest.word(point.frame.index() as u64);
            digest.doubles(point.at.to_array());
            digest.doubles([point.mass]);
        }
    }
    digest.doubles(rig.centre_of_mass(&q).unwrap().to_array());
    digest.refused(rig.centre_of_mass(&q[1..]));
    for density in [-1.0, 0.0, f64::NAN] {
        digest.refused(rig.masses(density));
    }
    let small = SmallRig::with_json(&text()).parse().unwrap();
    digest.refused(small.masses(1.0));
    rig.mesh = None;
    digest.refused(rig.masses(1.0));
    digest.value()
}

fn written() -> Value {
    let mut digest = Digest::new();
    let folder = std::env::temp_dir().join(format!("kinopt-same-rigs-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = |file: &str| folder.join(file);
    let small = SmallRig::with_json(&text()).parse().unwrap();
    let mut bones = small.clone();
    (bones.mesh, bones.weights) = (None, None);
    for (rig, name) in [(&small, "whole.json"), (&bones, "bones.rig")] {
        rig.write(path(name)).unwrap();
        digest.bytes(std::fs::read(path(name)).unwrap());
        add(&mut digest, &Rig::read(path(name)).unwrap());
    }
    digest.bytes(std::fs::read(path("whole.ply")).unwrap());
    digest.bytes(std::fs::read(path("whole.dmat")).unwrap());
    let mut odd = small.clone();
    odd.mesh = Some(
        odd.mesh
            .unwrap()
            .with_vertices(vec![Vec3::ONE; 3], vec![])
            .unwrap(),
    );
    odd.weights = Some(
        kinopt::skinning::SkinWeights::builder(0, 3)
            .build()
            .unwrap(),
    );
    for (rig, name) in [(&small, "a.ply"), (&small, "a.dmat"), (&odd, "a.json")] {
        let error = rig.write(path(name)).unwrap_err();
        digest.text(error.problem.to_string());
    }
    let (name, mut listed) = (
        small.skeleton.model().name(),
        small.skeleton.bones().to_vec(),
    );
    listed[1].name = "a/b".into();
    odd = small.clone();
    odd.skeleton = kinopt::Skeleton::new(name, listed).unwrap();
    digest.bytes(odd.write(path("a.json")).unwrap_err().problem.to_string());
    std::fs::remove_dir_all(folder).unwrap();
    digest.value()
}

#[test]
fn of_rigs() {
    check_single(&[
        ("rigs, read", read()),
        ("rigs, posed", posed()),
        ("rigs, weighed", weighed()),
        ("rigs, written", written()),
    ]);
}
