//! Promise: so it is between drawn poses and configurations, for curves that cannot be, and for drawn shapes of meshes.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;

use glam::{Quat, Vec3, Vec3A, Vec4};
use kinopt::animation::curve::{BezierHandle, KeyedCurve, TensionContinuityBias, repair_keys};
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{Armature, ArmatureBone, BallPoseMap, Easing, EulerPoseMap};
use kinopt::io::gltf::Scene;
use kinopt::io::rig::Rig;
use kinopt::mesh::TriangleMesh;
use kinopt::model::Limits;
use kinopt::skeleton::{BallSkeleton, BoneId, Cones, Skeleton, SkeletonRoot};
use kinopt::skinning::{BlendShapes, MorphTarget, MorphTargets, PosedVertices, SkinningMethod};
use support::random::Random;
use support::skins::Vertices;
use support::small_rig::{JSON, SmallRig};

use crate::animated::{check_single, local, number, rotation, vector};
use crate::digest::{Digest, Value};
use crate::drawn::{at_times, one_of};

/// A tree of bones whose scales are even, so that a skeleton can be made of it.
fn body(random: &mut Random, bones: usize) -> Armature {
    let list = (0..bones).map(|k| {
        let mut rest = local(random);
        if at_times(random, 0.5) {
            rest.rotation = Quat::IDENTITY;
        }
        rest.scale = Vec3A::splat(one_of(random, &[1.0, 1.0, 0.8, 1.3]));
        ArmatureBone {
            name: format!("bone {k}"),
            parent: (k > 0).then(|| (k - 1).min(random.below(k + 2))),
            rest,
        }
    });
    Armature::new(list.collect(), Vec::new()).unwrap()
}

/// Turned in any way, or about the bone's own axis alone, which leaves two angles for one turn.
fn turned(random: &mut Random) -> Quat {
    let angle = number(random, 1.5);
    match random.below(4) {
        0 => Quat::from_xyzw(angle, 0.0, 0.0, 1.0).normalize(),
        1 => {
            Quat::from_xyzw(angle, 0.0, 0.0, 1.0).normalize() * Quat::from_xyzw(0.0, 0.0, 1.0, 0.0)
        }
        _ => rotation(random),
    }
}

fn configurations() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2081));
    for case in 0..200 {
        let body = body(&mut random, 1 + case % 6);
        let bounds = random.clone();
        let limits = |bone: BoneId| {
            let mut own = bounds.clone();
            (0..bone.index()).for_each(|_| _ = own.bits());
            [(); 3].map(|()| match own.below(4) {
                0 => Limits::UNBOUNDED,
                _ => Limits::new(-own.within(0.05, 1.0), own.within(0.05, 1.0)),
            })
        };
        let Some(skeleton) = digest.answer(body.skeleton("drawn", limits)) else {
            continue;
        };
        digest.json(&skeleton);
        let angles = EulerPoseMap::new(&skeleton);
        let turning: BTreeSet<BoneId> = body
            .bone_ids()
            .filter(|_| at_times(&mut random, 0.6))
            .collect();
        let some = body.turning_skeleton("some", &turning).unwrap();
        let root = one_of(&mut random, &[SkeletonRoot::Fixed, SkeletonRoot::FREE]);
        let figure = digest.answer(BallSkeleton::new(some, &Cones::new(), root));
        for _ in 0..4 {
            let mut pose = body.rest().clone();
            for bone in body.bone_ids() {
                let own = body.rest().local(bone).unwrap();
                pose.set_rotation(bone, own.rotation * turned(&mut random))
                    .unwrap();
                if at_times(&mut random, 0.3) {
                    pose.set_translation(bone, vector(&mut random, 1.0))
                        .unwrap();
                }
            }
            let mut q = Vec::new();
            angles.angles_of(&pose, &mut q).unwrap();
            digest.doubles(q.iter().copied());
            let mut again = pose.clone();
            angles.pose_of(&q, &mut again).unwrap();
            digest.pose(&again);
            let Some(figure) = &figure else { continue };
            let turns = BallPoseMap::new(&body, figure);
            turns.configuration_of(&pose, &mut q).unwrap();
            digest.doubles(q.iter().copied());
            let mut again = body.rest().clone();
            digest.answer(turns.pose_of(&q, &mut again));
            digest.pose(&again);
        }
    }
    digest.value()
}

/// Keys of which some are out of order, not numbers, or of another count.
fn curves() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2082));
    for _ in 0..300 {
        let count = random.below(4);
        let about = |random: &mut Random| match random.below(12) {
            0 => count + 1,
            1 => count.saturating_sub(1),
            _ => count,
        };
        let odd = [0.25, 0.25, 0.25, 0.25, 0.25, 0.25, f32::NAN, -3.0];
        let mut time = -0.5;
        let times: Vec<f32> = (0..about(&mut random))
            .map(|_| {
                time += one_of(&mut random, &odd);
                time
            })
            .collect();
        let number = |random: &mut Random| {
            one_of(
                random,
                &[0.5, 0.25, -1.0, 1.5, 0.75, -0.5, 2.0, f32::INFINITY],
            )
        };
        let values: Vec<f32> = (0..about(&mut random))
            .map(|_| number(&mut random))
            .collect();
        let others = about(&mut random);
        let curve = match random.below(6) {
            0 => KeyedCurve::linear(times, values),
            1 => KeyedCurve::eased(times, values, vec![Easing::Linear; others]),
            2 => {
                let tangents = (0..others).map(|_| [number(&mut random), number(&mut random)]);
                let tangents = tangents.collect();
                KeyedCurve::cubic(times, values, tangents)
            }
            3 => KeyedCurve::kochanek_bartels(
                times,
                values,
                &vec![TensionContinuityBias::default(); others],
            ),
            _ => {
                let mut handle = |side: f32| BezierHandle {
                    time: side
                        * one_of(
                            &mut random,
                            &[0.0, 0.1, 0.2, 0.25, 0.25, 0.3, -0.1, f32::NAN],
                        ),
                    value: number(&mut random),
                };
                let handles = (0..others).map(|_| [handle(-1.0), handle(1.0)]).collect();
                KeyedCurve::bezier(times, values, handles)
            }
        };
        if let Some(curve) = digest.answer(curve) {
            for time in [-1.0, -0.2, 0.1, 0.3, 9.0, f32::NAN] {
                digest.singles([curve.at(time), curve.rate(time)]);
            }
        }
    }
    for _ in 0..120 {
        let count = random.below(4);
        let (others, more) = (count + random.below(8) / 7, count + random.below(8) / 7);
        let times: Vec<f32> = (0..count)
            .map(|k| k as f32 + one_of(&mut random, &[0.0, 0.1, 0.1, -1.5]))
            .collect();
        let turn = |random: &mut Random| {
            rotation(random) * one_of(random, &[1.0, 2.0, 1.0, 1e-20, 1.0, 0.0, 1.0, f32::NAN])
        };
        let keys: Vec<Quat> = (0..others).map(|_| turn(&mut random)).collect();
        let mut pairs: Vec<(f32, Quat)> = times.iter().copied().zip(keys.clone()).collect();
        let repaired = repair_keys(&mut pairs, |key| key.is_finite());
        digest.debug((repaired, pairs));
        let curve = match random.below(5) {
            0 => RotationCurve::slerp(times, keys),
            1 => RotationCurve::squad(times, keys),
            2 => RotationCurve::smooth(times, keys),
            3 => RotationCurve::eased(times, keys, vec![Easing::CubicIn; more]),
            _ => {
                let rate = one_of(&mut random, &[Vec4::X, Vec4::Y, Vec4::INFINITY]);
                RotationCurve::cubic(times, keys, vec![[rate, Vec4::Z]; more])
            }
        };
        if let Some(curve) = digest.answer(curve) {
            for time in [-1.0, 0.2, 0.6, 1.3, 9.0, f32::NAN] {
                digest.quaternion(curve.at(time));
            }
        }
    }
    digest.value()
}

/// Blend shapes and morph targets in buffers that hold other things.
fn shapes() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2083));
    let weight =
        |random: &mut Random| one_of(random, &[0.0, 0.25, 0.5, 1.0, -0.5, 0.5, 0.25, f32::NAN]);
    for _ in 0..60 {
        let (count, vertices) = (random.below(4), 1 + random.below(4));
        let points = |random: &mut Random, count: usize| -> Vec<Vec3> {
            (0..count).map(|_| vector(random, 1.0).into()).collect()
        };
        let own = (0..count).map(|k| {
            let name = one_of(&mut random, &["a", "b", "c", "d"]);
            let name = if at_times(&mut random, 0.1) {
                name.to_owned()
            } else {
                format!("shape {k}")
            };
            let own = vertices + usize::from(at_times(&mut random, 0.05));
            (name, points(&mut random, own))
        });
        let own: Vec<(String, Vec<Vec3>)> = own.collect();
        let mut room = vec![Vec3::splat(7.0); vertices];
        if let Some(shapes) = digest.answer(BlendShapes::new(own)) {
            for _ in 0..3 {
                let given = count + usize::from(at_times(&mut random, 0.1));
                let mut weights: Vec<f32> = (0..given).map(|_| weight(&mut random)).collect();
                if let Some(last) = weights.pop().filter(|_| at_times(&mut random, 0.8)) {
                    let sum: f32 = weights.iter().sum();
                    weights.push(if sum.is_finite() { 1.0 - sum } else { last });
                }
                digest.answer(shapes.blend(&weights, &mut room));
                digest.singles(room.iter().flat_map(|v| v.to_array()));
            }
        }
        let rest = Vertices::random(&mut random, vertices);
        let targets = (0..count).map(|k| {
            let mut at: Vec<u32> = (0..vertices as u32)
                .filter(|_| at_times(&mut random, 0.7))
                .collect();
            if at_times(&mut random, 0.05) {
                at.push(vertices as u32 + 1);
            }
            let mut deltas = || match at_times(&mut random, 0.4) {
                true => Vec::new(),
                false => points(&mut random, at.len()),
            };
            let (normals, tangents) = (deltas(), deltas());
            let positions = points(&mut random, at.len());
            MorphTarget::new(format!("target {k}"), at, positions, normals, tangents).unwrap()
        });
        let targets: Vec<MorphTarget> = targets.collect();
        let Some(targets) = digest.answer(MorphTargets::new(vertices, targets)) else {
            continue;
        };
        for _ in 0..3 {
            let mut own = rest.clone();
            let given = count + usize::from(at_times(&mut random, 0.1));
            let weights: Vec<f32> = (0..given).map(|_| weight(&mut random)).collect();
            if at_times(&mut random, 0.3) {
                own.normals.clear();
            }
            if at_times(&mut random, 0.1) {
                own.tangents.pop();
            }
            let posed = own.posed();
            digest.answer(targets.apply(&weights, posed.positions, posed.normals, posed.tangents));
            let vectors = own.positions.iter().chain(&own.normals);
            digest.singles(vectors.flat_map(|v| v.to_array()));
            digest.singles(own.tangents.iter().flat_map(|v| v.to_array()));
        }
    }
    digest.value()
}

/// A rig whose mesh has normals, into whichever buffers there are.
fn rigs() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2084));
    let mut rig: Rig = SmallRig::with_json(JSON).parse().unwrap();
    let bare = rig.mesh.take().unwrap();
    let normals = vec![Vec3::X, Vec3::Y, Vec3::new(0.6, 0.0, 0.8)];
    let mesh = TriangleMesh::new(
        bare.positions().to_vec(),
        normals,
        bare.triangles().to_vec(),
    );
    rig.mesh = Some(mesh.unwrap());
    // A bone that is called as the mesh would be.
    for name in ["bone", "mesh", "mesh'"] {
        let mut bones = rig.skeleton.bones().to_vec();
        bones[1].name = "mesh".into();
        bones[2].name = name.into();
        let Some(skeleton) = digest.answer(Skeleton::new("named", bones)) else {
            continue;
        };
        let skin = rig.mesh.as_ref().zip(rig.weights.as_ref());
        let scene = Scene::of_skeleton(&skeleton, skin).unwrap();
        digest.debug(scene.armature.names());
    }
    for method in SkinningMethod::ALL {
        let mut posing = rig.posing(method).unwrap();
        for _ in 0..6 {
            let q: Vec<f64> = (0..rig.skeleton.angles())
                .map(|_| random.within(-1.0, 1.0))
                .collect();
            let lengths = [(); 3].map(|()| one_of(&mut random, &[0, 3, 3, 2]));
            let (mut places, mut directions) =
                (vec![Vec3::ONE; lengths[0]], vec![Vec3::ONE; lengths[1]]);
            let mut tangents = vec![
                Vec4::ONE;
                if at_times(&mut random, 0.1) {
                    lengths[2]
                } else {
                    0
                }
            ];
            let posed = PosedVertices {
                positions: &mut places,
                normals: &mut directions,
                tangents: &mut tangents,
            };
            digest.answer(posing.deform(&q, posed));
            digest.singles(places.iter().chain(&directions).flat_map(|v| v.to_array()));
        }
    }
    digest.value()
}

#[test]
fn of_drawn_poses() {
    check_single(&[
        ("drawn poses and configurations", configurations()),
        ("drawn keys, and what is refused of them", curves()),
        ("drawn shapes of meshes", shapes()),
        ("drawn buffers of a rig", rigs()),
    ]);
}
