//! Promise: curves that glTF cannot represent are written as linear keys through samples, and clips keep their
//! duration.

use glam::{Quat, Vec3, Vec3A, Vec4};
use kinopt::animation::curve::{BezierHandle, KeyedCurve};
use kinopt::animation::rotation::{EulerOrder, RotationCurve};
use kinopt::animation::{
    Armature, ArmatureBone, Channel, Clip, ClipBuilder, EulerCurve, LocalTransform,
};
use kinopt::io::gltf::{self, Scene, SceneMesh, WriteOptions};
use kinopt::mesh::TriangleMesh;
use kinopt::skinning::{MorphTarget, MorphTargets};
use support::gltf_text::at;

fn again(scene: &Scene, options: &WriteOptions) -> Scene {
    let bytes = gltf::to_bytes(scene, options).unwrap();
    let read = support::gltf_text::read(&bytes).unwrap();
    assert_eq!(read.notes, []);
    read
}

/// Scene of one bone with the added channels or curves.
fn moving(add: impl FnOnce(&mut ClipBuilder<'_>)) -> Scene {
    moving_from([0.0; 2], add)
}

/// Scene of one bone with these weights at rest and the added channels or curves.
fn moving_from(rest: [f32; 2], add: impl FnOnce(&mut ClipBuilder<'_>)) -> Scene {
    let bone = ArmatureBone {
        name: "bone".into(),
        parent: None,
        rest: LocalTransform::IDENTITY,
    };
    let armature = Armature::new(vec![bone], vec!["a".into(), "b".into()]).unwrap();
    let armature = armature.with_rest_morph_weights(&rest).unwrap();
    let mut builder = Clip::builder("moving", &armature);
    add(&mut builder);
    let clips = vec![builder.build()];
    let deltas = |name: &str| {
        MorphTarget::new(name, vec![0], vec![Vec3::X], Vec::new(), Vec::new()).unwrap()
    };
    let mesh = SceneMesh {
        name: "mesh".into(),
        bone: armature.bone_at(0).unwrap(),
        mesh: TriangleMesh::new(
            vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            Vec::new(),
            vec![[0, 1, 2]],
        )
        .unwrap(),
        tangents: Vec::new(),
        morph_targets: MorphTargets::new(3, vec![deltas("a"), deltas("b")]).unwrap(),
        first_morph_weight: 0,
        skin: None,
    };
    Scene {
        armature,
        meshes: vec![mesh],
        clips,
        notes: Vec::new(),
    }
}

/// Largest differences of two clips: in translation, in quaternions, in weights.
fn apart(one: &Scene, other: &Scene) -> [f32; 3] {
    let (a, b) = (&one.clips[0], &other.clips[0]);
    assert!((a.duration() - b.duration()).abs() < 1e-6);
    let mut largest = [0.0f32; 3];
    for step in 0..=1000 {
        let time = a.duration() * f64::from(step) / 1000.0;
        let (a, b) = (at(one, 0, time), at(other, 0, time));
        let [p, q] = [&a, &b].map(|pose| pose.rotations()[0]);
        let weights = a.morph_weights().iter().zip(b.morph_weights());
        let now = [
            a.translations()[0].distance(b.translations()[0]),
            Vec4::from(p)
                .distance(Vec4::from(q))
                .min(Vec4::from(p).distance(-Vec4::from(q))),
            weights.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max),
        ];
        largest = std::array::from_fn(|k| largest[k].max(now[k]));
    }
    largest
}

#[test]
fn unsupported_curves_are_sampled_at_the_rate() {
    let handle = |time, value| BezierHandle { time, value };
    let drawn = |value: Vec3A| {
        let handles = vec![
            [handle(0.0, Vec3A::ZERO), handle(0.7, value)],
            [handle(-0.3, -value), handle(0.0, Vec3A::ZERO)],
        ];
        KeyedCurve::bezier(vec![0.0, 1.0], vec![Vec3A::ZERO, value], handles).unwrap()
    };
    let turns = [0.0, 1.2, -0.6].map(Quat::from_rotation_y).to_vec();
    let angles = [Vec3A::ZERO, Vec3A::new(7.0, 1.0, -3.0)].to_vec();
    let euler = EulerCurve {
        order: EulerOrder::Xyz,
        before: Quat::from_rotation_x(0.4),
        angles: KeyedCurve::catmull_rom(vec![0.0, 1.0], angles).unwrap(),
    };
    let scene = |rotation: Channel| {
        moving(|builder| {
            let bone = kinopt::animation::Armature::new(
                vec![ArmatureBone {
                    name: "bone".into(),
                    parent: None,
                    rest: LocalTransform::IDENTITY,
                }],
                Vec::new(),
            )
            .unwrap()
            .bone_at(0)
            .unwrap();
            builder
                .channel(bone, Channel::Translation(drawn(Vec3A::new(1.0, 2.0, 0.5))))
                .unwrap();
            builder.channel(bone, rotation).unwrap();
            let steps = KeyedCurve::linear(vec![0.0, 0.3, 1.0], vec![0.0, 1.0, 0.5]).unwrap();
            let line = KeyedCurve::linear(vec![0.0, 0.6, 1.0], vec![1.0, -1.0, 0.5]).unwrap();
            builder
                .morph_weight(0, steps)
                .unwrap()
                .morph_weight(1, line)
                .unwrap();
        })
    };
    let keys = || vec![0.0, 0.4, 1.0];
    let rotations = [
        Channel::Rotation(RotationCurve::squad(keys(), turns.clone()).unwrap()),
        Channel::Rotation(RotationCurve::smooth(keys(), turns).unwrap()),
        Channel::Euler(euler),
    ];
    for rotation in rotations {
        let scene = scene(rotation);
        let sampled = |rate| apart(&scene, &again(&scene, &at_rate(rate)));
        let [coarse, fine] = [25.0, 100.0].map(sampled);
        // Between samples a line deviates from a curve by an eighth of its curvature times h².
        for (coarse, fine) in coarse.iter().zip(fine).take(2) {
            assert!(
                *coarse < 0.05 && fine < 0.003 && fine < coarse / 4.0,
                "{coarse} {fine}"
            );
        }
        // Linear curves with their own keys need no sampling.
        assert!(coarse[2] < 1e-6, "{}", coarse[2]);
    }
}

/// A constant weight next to one that steps keeps the steps: the other weight jumps at its original times.
#[test]
fn steps_beside_a_constant_weight_stay_steps() {
    for constant in [0, 1] {
        let scene = moving(|builder| {
            let steps = KeyedCurve::step(vec![0.0, 0.5, 1.0], vec![0.0, 1.0, 0.25]).unwrap();
            let still = KeyedCurve::step(vec![0.0], vec![0.7]).unwrap();
            builder
                .morph_weight(constant, still)
                .unwrap()
                .morph_weight(1 - constant, steps)
                .unwrap();
        });
        let read = again(&scene, &WriteOptions::default());
        for (time, stepped) in [
            (0.0, 0.0),
            (0.499, 0.0),
            (0.501, 1.0),
            (0.999, 1.0),
            (1.0, 0.25),
        ] {
            let weights = at(&read, 0, time);
            let weights = weights.morph_weights();
            assert_eq!(
                (weights[constant], weights[1 - constant]),
                (0.7, stepped),
                "{time}"
            );
        }
    }
}

#[test]
fn clip_duration_is_kept() {
    let build = |start: f32, end: f32| {
        moving(|builder| {
            builder.span(start, end).unwrap();
            let weights = KeyedCurve::linear(vec![0.0, 1.0], vec![0.0, 1.0]).unwrap();
            builder.morph_weight(1, weights).unwrap();
        })
    };
    let longer = build(0.0, 2.5);
    let read = again(&longer, &WriteOptions::default());
    assert_eq!(read.clips[0].span(), [0.0, 2.5]);
    assert_eq!(at(&read, 0, 0.5).morph_weights(), [0.0, 0.5]);
    // glTF has no times before 0.
    let early = again(&build(-1.0, 1.0), &WriteOptions::default());
    assert_eq!(early.clips[0].span(), [0.0, 2.0]);
    assert_eq!(at(&early, 0, 1.5).morph_weights(), [0.0, 0.5]);
}

/// Samples of a rotation have consistent signs, for programs that interpolate quaternions without checking the sign.
#[test]
fn sampled_quaternions_keep_one_sign() {
    let angles = [0.0, 4.0, -3.0, 9.0].map(|turn| Vec3A::new(turn, 0.3 * turn, 0.1));
    let euler = EulerCurve {
        order: EulerOrder::Xyz,
        before: Quat::from_rotation_x(0.4),
        angles: KeyedCurve::linear(vec![0.0, 0.02, 0.200_001, 0.5], angles.to_vec()).unwrap(),
    };
    let bone = moving(|_| {}).armature.bone_at(0).unwrap();
    let mut scene = moving(|builder| {
        builder.channel(bone, Channel::Euler(euler)).unwrap();
    });
    scene.meshes.clear();
    let bytes = gltf::to_bytes(&scene, &WriteOptions::default()).unwrap();
    // The second chunk is the buffer: a time and four numbers for each key.
    let count = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    let buffer = &bytes[12 + 8 + count(12) + 8..];
    let numbers = buffer.chunks_exact(4);
    let numbers: Vec<f32> = numbers
        .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
        .collect();
    let quaternions = numbers[numbers.len() / 5..].chunks_exact(4);
    let quaternions: Vec<Vec4> = quaternions.map(Vec4::from_slice).collect();
    assert!(quaternions.len() > 10);
    // A sample that almost coincides with a key is omitted.
    let times = &numbers[..numbers.len() / 5];
    assert!(times.windows(2).all(|t| t[1] - t[0] > 1e-5), "{times:?}");
    assert!(quaternions.iter().all(|q| (q.length() - 1.0).abs() < 1e-5));
    assert!(quaternions.windows(2).all(|q| q[0].dot(q[1]) >= 0.0));
}

fn at_rate(keys_per_second: f32) -> WriteOptions {
    let mut options = WriteOptions::default();
    options.keys_per_second = keys_per_second;
    options
}

/// A weight without a curve stays at its rest value while another weight moves, for any interpolation of the latter.
#[test]
fn weight_without_curve_stays_at_rest() {
    let (times, values) = (vec![0.0, 0.5, 1.0], vec![0.0, 1.0, 0.25]);
    let slopes = vec![[0.5, 0.5]; 3];
    for curve in [
        KeyedCurve::step(times.clone(), values.clone()),
        KeyedCurve::linear(times.clone(), values.clone()),
        KeyedCurve::cubic(times, values, slopes),
    ] {
        for moves in [0, 1] {
            let curve = curve.clone().unwrap();
            let rest = [0.3, -0.2];
            let scene = moving_from(rest, |builder| {
                builder.morph_weight(moves, curve).unwrap();
            });
            let read = again(&scene, &WriteOptions::default());
            for time in [0.0, 0.2, 0.5, 0.7, 1.0] {
                let weights = at(&read, 0, time);
                let deviation = weights.morph_weights()[1 - moves] - rest[1 - moves];
                assert!(deviation.abs() < 1e-6, "{time}: {deviation}");
            }
        }
    }
}
