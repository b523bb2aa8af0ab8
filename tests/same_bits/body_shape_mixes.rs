//! Promise: so it is for the shapes of a figure's skin, however thick, wide and short it is and however its weights are shared out, and for the
//! pairs that samples of chains drawn at random leave, with shapes written and read in between.
#![allow(clippy::unwrap_used)]

use glam::Vec3;
use kinopt::collision::CollisionModel;
use kinopt::io::rig::Rig;
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::SkinWeights;
use support::random::Random;

use crate::checker_mixes::shapes;
use crate::clear_body_mixes::chain;
use crate::digest::{Digest, Value, check};
use crate::every_joint::model;

impl Digest {
    fn shapes(&mut self, own: &CollisionModel) {
        for object in own.objects() {
            self.text(&object.name);
            self.placement(&object.link_from_shape);
            self.noted(&(object.link, object.shape.kind()));
        }
        self.noted(&(own.links(), own.pairs(), own.notes()));
    }
}

fn skins() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(951));
    let rig = Rig::read("../models/humanoid/humanoid.json").unwrap();
    let (mesh, weights) = (rig.mesh.as_ref().unwrap(), rig.weights.as_ref().unwrap());
    let (vertices, bones) = (mesh.positions().len(), rig.skeleton.bones().len());
    for case in 0..4 {
        // A few vertices of the figure, stretched.
        let stretch = [(); 3].map(|()| [1.0_f32, 0.3, 3.0, 0.0][random.below(4)]);
        let stretch = if case == 0 { [1.0; 3] } else { stretch };
        let picked: Vec<usize> = (0..vertices).filter(|_| random.below(6) == 0).collect();
        let own = picked
            .iter()
            .map(|&k| mesh.positions()[k] * Vec3::from(stretch));
        let own = TriangleMesh::new(own.collect(), vec![], vec![]).unwrap();
        let mut shared = SkinWeights::builder(picked.len(), bones);
        for (vertex, &from) in picked.iter().enumerate() {
            for influence in weights.influences(from) {
                shared
                    .add(vertex, influence.bone as usize, influence.weight)
                    .unwrap();
            }
        }
        let shared = shared.build().unwrap();
        digest.shapes(&kinopt::motion::skin_capsules(&rig.skeleton, &own, &shared).unwrap());
        digest.refusal(kinopt::motion::skin_capsules(&rig.skeleton, mesh, &shared));
        // Clouds of a bone each: rods, discs, blobs, and too few.
        let mut places = Vec::new();
        let mut of_bones = SkinWeights::builder(12 * bones, bones);
        for bone in 0..bones {
            let size = [(); 3].map(|()| [0.3, 0.1, 0.02][random.below(3)]);
            let count = [12, 12, 5, 8][random.below(4)];
            for k in 0..12 {
                let at = size.map(|size: f64| random.within(-size, size));
                let at = Vec3::from_array(at.map(|x| x as f32));
                let stands = rig.skeleton.bones()[bone].model_from_rest.translation;
                let from = Vec3::from_array(stands.to_array().map(|x| x as f32));
                places.push(from + at);
                let to = if k < count { bone } else { 0 };
                of_bones.add(12 * bone + k, to, 1.0).unwrap();
            }
        }
        let clouds = TriangleMesh::new(places, vec![], vec![]).unwrap();
        let of_bones = of_bones.build().unwrap();
        digest.shapes(&kinopt::motion::skin_capsules(&rig.skeleton, &clouds, &of_bones).unwrap());
    }
    digest.value()
}

fn pairs() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(952));
    for case in 0..40 {
        let (_, own) = chain(&mut random, case % 3 == 0);
        let samples = [1, 3, 8, 20][random.below(4)];
        let own = own.with_pairs_sampled(samples, case).unwrap();
        digest.shapes(&own);
        digest.bytes(own.to_srdf());
    }
    for case in 0..2 {
        let body = model(&mut random, case == 1);
        let own = shapes(&body, &mut random, 4);
        digest.shapes(&own.with_pairs_sampled(4, case).unwrap());
    }
    digest.value()
}

#[test]
fn of_mixed_skins() {
    check(&[("shapes of mixed skins", skins())]);
}

#[test]
fn of_mixed_samples_of_pairs() {
    check(&[("pairs that few samples leave", pairs())]);
}
