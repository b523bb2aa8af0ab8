//! Promise: the whole computation from keys to skin equals the formula of each step in double precision, to 1e-5 of the
//! model's size. Its steps: keys around a time, slerp and lerp, hierarchy, skinning matrices, shapes, weighted sums.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use glam::{Affine3A, DAffine3, DQuat, DVec3, Quat, Vec3, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{Armature, Channel, Clip, Cursor, LocalTransform, Playback};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{MeshWeights, MorphTarget, MorphTargets, SkinWeights, SkinningMethod};
use support::armatures::{armature, rotation, vector};
use support::random::Random;
use support::skins::{Vertices, weights};

const BONES: usize = 17;
const VERTICES: usize = 300;

/// Keys as they were set.
struct Keys {
    times: Vec<f32>,
    translations: Vec<Vec<Vec3A>>,
    rotations: Vec<Vec<Quat>>,
    /// Weights by morph target.
    morphs: Vec<Vec<f32>>,
}

impl Keys {
    fn random(random: &mut Random) -> Self {
        let times = vec![0.0, 0.3, 1.1, 1.5, 2.75];
        let each = |random: &mut Random, sample: &mut dyn FnMut(&mut Random) -> f32| {
            times.iter().map(|_| sample(random)).collect::<Vec<f32>>()
        };
        let morphs = (0..2).map(|_| each(random, &mut |random| random.unit() as f32));
        let morphs = morphs.collect();
        let translations = (0..BONES).map(|_| times.iter().map(|_| vector(random, 0.5)).collect());
        let translations = translations.collect();
        // Random signs: q and −q are the same rotation.
        let mut some = |_| rotation(random, 1.7) * [1.0, -1.0][random.below(2)];
        let rotations = (0..BONES).map(|_| times.iter().map(&mut some).collect());
        let rotations = rotations.collect();
        Self {
            times,
            translations,
            rotations,
            morphs,
        }
    }

    fn clip(&self, armature: &Armature) -> Clip {
        let mut builder = Clip::builder("keys", armature);
        for index in 0..BONES {
            let bone = armature.bone_at(index).unwrap();
            let moved = KeyedCurve::linear(self.times.clone(), self.translations[index].clone());
            let turned = RotationCurve::slerp(self.times.clone(), self.rotations[index].clone());
            builder
                .channel(bone, Channel::Translation(moved.unwrap()))
                .unwrap()
                .channel(bone, Channel::Rotation(turned.unwrap()))
                .unwrap();
        }
        for (target, weights) in self.morphs.iter().enumerate() {
            let curve = KeyedCurve::linear(self.times.clone(), weights.clone());
            builder.morph_weight(target, curve.unwrap()).unwrap();
        }
        builder.build()
    }

    /// Key before a time, and α = (t − t_prev) / (t_next − t_prev).
    fn around(&self, time: f64) -> (usize, f64) {
        let times: Vec<f64> = self.times.iter().map(|&t| t.into()).collect();
        let next = times.iter().position(|&t| t > time).unwrap();
        let alpha = (time - times[next - 1]) / (times[next] - times[next - 1]);
        (next - 1, alpha)
    }

    /// Bone placements in the model, W_j = W_parent L_j, with L interpolated by glam's slerp.
    fn model_from_bone(&self, armature: &Armature, time: f64) -> Vec<DAffine3> {
        let (key, alpha) = self.around(time);
        let mut world: Vec<DAffine3> = Vec::new();
        for index in 0..BONES {
            let bone = armature.bone_at(index).unwrap();
            let [from, to] = [key, key + 1].map(|k| self.rotations[index][k].as_dquat());
            // glam takes the shorter arc as well.
            let turned = from.normalize().slerp(to.normalize(), alpha);
            let [from, to] = [key, key + 1].map(|k| self.translations[index][k].as_dvec3());
            let scale = armature.rest().local(bone).unwrap().scale.as_dvec3();
            let moved = from * (1.0 - alpha) + to * alpha;
            let local = DAffine3::from_scale_rotation_translation(scale, turned, moved);
            let parent = armature.parent(bone).map(|parent| world[parent.index()]);
            world.push(parent.unwrap_or(DAffine3::IDENTITY) * local);
        }
        world
    }
}

fn rest_in_model(armature: &Armature) -> Vec<DAffine3> {
    let mut world: Vec<DAffine3> = Vec::new();
    for index in 0..BONES {
        let bone = armature.bone_at(index).unwrap();
        let LocalTransform {
            translation,
            rotation,
            scale,
        } = armature.rest().local(bone).unwrap();
        let turned: DQuat = rotation.as_dquat().normalize();
        let [scale, moved] = [scale, translation].map(|v| v.as_dvec3());
        let local = DAffine3::from_scale_rotation_translation(scale, turned, moved);
        let parent = armature.parent(bone).map(|parent| world[parent.index()]);
        world.push(parent.unwrap_or(DAffine3::IDENTITY) * local);
    }
    world
}

#[test]
fn pipeline_matches_double_precision() {
    let mut random = Random::new(131);
    for most in [4, 7] {
        let armature = armature(BONES, &mut random);
        let keys = Keys::random(&mut random);
        let clip = keys.clip(&armature);
        let weights: SkinWeights = weights(&mut random, VERTICES, BONES, most);
        let fast = MeshWeights::from(weights.clone());
        let mut face = || Vertices::random(&mut random, VERTICES).positions;
        let (rest, shapes) = (face(), [face(), face()]);
        let mesh = |face: &[Vec3]| TriangleMesh::new(face.to_vec(), vec![], vec![]).unwrap();
        let target =
            |shape: &Vec<Vec3>| MorphTarget::between("shape", &mesh(&rest), &mesh(shape), 0.0);
        let targets = shapes.iter().map(|shape| target(shape).unwrap()).collect();
        let targets = MorphTargets::new(VERTICES, targets).unwrap();
        let bind = rest_in_model(&armature);

        let (mut pose, mut cursor) = (armature.rest().clone(), Cursor::new());
        let mut model = vec![Affine3A::IDENTITY; BONES];
        let mut skin = model.clone();
        for frame in 0..27 {
            let time = 0.1 * f64::from(frame);
            clip.sample(time, Playback::Hold, &mut cursor, &mut pose)
                .unwrap();
            armature.local_to_model(&pose, &mut model).unwrap();
            armature.skinning_transforms(&model, &mut skin).unwrap();
            let mut shaped = rest.clone();
            targets
                .apply(pose.morph_weights(), &mut shaped, &mut [], &mut [])
                .unwrap();
            let posed = fast
                .mesh(SkinningMethod::LinearBlend, &mesh(&shaped), &skin)
                .unwrap();

            let world = keys.model_from_bone(&armature, time);
            let (key, alpha) = keys.around(time);
            let shares = keys.morphs.iter().map(|weights| {
                f64::from(weights[key]) * (1.0 - alpha) + f64::from(weights[key + 1]) * alpha
            });
            let shares: Vec<f64> = shares.collect();
            let size = world
                .iter()
                .map(|w| w.translation.length())
                .fold(1.0, f64::max);
            for (vertex, actual) in posed.positions().iter().enumerate() {
                let base = rest[vertex].as_dvec3();
                let moves = shapes.iter().zip(&shares);
                let moves = moves.map(|(shape, share)| (shape[vertex].as_dvec3() - base) * *share);
                let shaped = base + moves.sum::<DVec3>();
                let sum = weights.influences(vertex).iter().map(|influence| {
                    let bone = influence.bone as usize;
                    let moved = world[bone] * bind[bone].inverse();
                    moved.transform_point3(shaped) * influence.weight
                });
                let deviation = (actual.as_dvec3() - sum.sum::<DVec3>()).length();
                assert!(deviation < 1e-5 * size, "{deviation} of {size} at {time} s");
            }
        }
    }
}
