//! Promise: so it is for weights that a mesh is given, by distance and by heat, and for the volumes that go with its bones.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use kinopt::io::rig::Rig;
use kinopt::skinning::{AutomaticWeights, HeatWeights, SkinWeights, bone_volumes};

use crate::digest::{Digest, Value, check};

fn of_weights(weights: &SkinWeights) -> Value {
    let mut digest = Digest::new();
    for influence in weights.iter().flatten() {
        digest.word(influence.bone.into());
        digest.doubles([influence.weight]);
    }
    digest.value()
}

#[test]
fn of_weights_and_volumes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let rig = Rig::read(root.join("../models/humanoid/humanoid.json")).unwrap();
    let mesh = rig.mesh.as_ref().unwrap();
    let by_distance = AutomaticWeights::default().for_skeleton(mesh, &rig.skeleton);
    let by_heat = HeatWeights::default()
        .for_skeleton(mesh, &rig.skeleton)
        .unwrap();
    let mut volumes = Digest::new();
    for own in bone_volumes(mesh, &by_heat).unwrap() {
        volumes.doubles([own.volume]);
        volumes.doubles(own.centre.to_array());
    }
    check(&[
        ("weights by distance", of_weights(&by_distance.unwrap())),
        ("weights by heat", of_weights(&by_heat)),
        ("volumes of bones", volumes.value()),
    ]);
}
