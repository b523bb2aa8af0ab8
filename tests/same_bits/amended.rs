//! Promise: so it is for scenes that are amended in the files that they come from.
#![allow(clippy::unwrap_used)]

use kinopt::animation::{Clip, Pose};
use kinopt::io::gltf::{Scene, SceneFile, UnwritableScene, WriteOptions};
use support::gltf_text::{Numbers, small};
use support::random::Random;

use crate::animated::{armature, bone, check_single, pose};
use crate::digest::{Digest, Value};
use crate::gltf::add;
use crate::scenes::file;

fn read(bytes: &[u8]) -> Scene {
    support::gltf_text::read(bytes).unwrap()
}

/// A file of either kind, with things that are not understood, amended twice.
fn amended() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(204));
    let (numbers, rest) = small();
    let unknown = r#""materials":[{"name":"fur" , "x":0.300000000000000044}],"extras":{"n":12345678901234567890},"images":[{"uri":"coat%20a.PNG"},{"uri":"data:,x"},{"uri":"http://x.org/y.jpg"}]"#;
    let rest = format!("{rest},{unknown}");
    let mut others = numbers.glb(&rest);
    others.extend([4, 0, 0, 0]);
    others.extend(b"ACMEfurs");
    let length = others.len() as u32;
    others[8..12].copy_from_slice(&length.to_le_bytes());
    let bare = br#"{"asset":{"version":"2.0"},"nodes":[{"name" : "a"},{"children":[0],"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,1,2,3,1]}]}"#;
    let empty = Numbers::default().glb(r#""nodes":[{"name":"a"}]"#);
    for bytes in [
        numbers.document(&rest).into_bytes(),
        others,
        bare.to_vec(),
        empty,
    ] {
        let mut own = SceneFile::from_bytes(&bytes, "own", |_| unreachable!()).unwrap();
        file(&mut digest, &own.to_bytes().unwrap());
        let body = own.scene().armature.clone();
        let move_all = |name: &str, random: &mut Random| {
            let poses: Vec<Pose> = (0..3).map(|_| pose(&body, random)).collect();
            Clip::through_poses(name, &body, &[0.0, 0.5, 1.5], &poses).unwrap()
        };
        for name in ["wave", "wave back"] {
            own.add_clip(&move_all(name, &mut random), &WriteOptions::default())
                .unwrap();
            file(&mut digest, &own.to_bytes().unwrap());
        }
        let still = Clip::builder("still", &body).build();
        own.add_clip(&still, &WriteOptions::default()).unwrap();
        let again: Result<(), UnwritableScene> = own.add_clip(&still, &WriteOptions::default());
        digest.refused(again);
        let mut posed = pose(&body, &mut random);
        posed
            .set_local(bone(&body, 0), body.rest().local(bone(&body, 0)).unwrap())
            .unwrap();
        own.set_rest(&posed).unwrap();
        let bytes = own.to_bytes().unwrap();
        file(&mut digest, &bytes);
        add(&mut digest, &read(&bytes));
        add(&mut digest, own.scene());
        digest.refused(own.set_rest(armature(9, &mut random).rest()));
        let foreign = Clip::builder("foreign", &armature(9, &mut random)).build();
        digest.refused(own.add_clip(&foreign, &WriteOptions::default()));
        let mut slow = WriteOptions::default();
        slow.keys_per_second = 0.0;
        digest.refused(own.add_clip(&still.renamed("slow"), &slow));
        moved(&mut digest, &own);
    }
    digest.value()
}

/// The file in other containers, and in another folder than what it names.
fn moved(digest: &mut Digest, own: &SceneFile) {
    let folder = std::env::temp_dir().join(format!("kinopt-same-scenes-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("else")).unwrap();
    let path = |name: &str| folder.join(name);
    for name in ["a.glb", "a.gltf", "a.GLB"] {
        own.write(path(name)).unwrap();
        file(digest, &std::fs::read(path(name)).unwrap());
    }
    std::fs::write(path("coat a.PNG"), b"\x89PNG\r\n\x1a\nfur").unwrap();
    let there = SceneFile::read(path("a.gltf")).unwrap();
    for name in ["b.gltf", "else/b.gltf", "else/b.glb"] {
        there.write(path(name)).unwrap();
        file(digest, &std::fs::read(path(name)).unwrap());
    }
    digest.text(own.write(path("a.obj")).unwrap_err().problem.to_string());
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn of_amended_scenes() {
    check_single(&[("scenes, amended", amended())]);
}
