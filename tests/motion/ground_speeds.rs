//! Promise: the ground that passes under feet passes across the axis up, by the feet that are near it, however they rise and
//! fall meanwhile.

use glam::{Vec3, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::{Armature, ArmatureBone, Channel, Clip, LocalTransform};
use kinopt::motion::clip_ik::ground_speed;

/// The speed of the ground under a foot that goes straight from key to key: (seconds, place).
fn speed(keys: &[(f32, Vec3)], up: Vec3) -> Vec3 {
    let bone = |name: &str, parent| ArmatureBone {
        name: name.into(),
        parent,
        rest: LocalTransform::IDENTITY,
    };
    let bones = vec![bone("hips", None), bone("foot", Some(0))];
    let armature = Armature::new(bones, Vec::new()).unwrap();
    let foot = armature.bone("foot").unwrap();
    let (times, places) = (keys.iter())
        .map(|(at, place)| (*at, Vec3A::from(*place)))
        .unzip();
    let way = KeyedCurve::linear(times, places).unwrap();
    let mut clip = Clip::builder("step", &armature);
    clip.channel(foot, Channel::Translation(way)).unwrap();
    ground_speed(&armature, &clip.build(), &[foot], up, 100.0).unwrap()
}

/// A foot on a slope: what passes is level, the slope's rise is no way of the body.
#[test]
fn a_foot_that_rises_all_the_way_passes_over_level_ground() {
    let way = Vec3::new(0.3, 0.2, -1.1);
    for up in [
        Vec3::X,
        Vec3::Y,
        Vec3::Z,
        Vec3::NEG_Y,
        Vec3::new(0.0, 3.0, 4.0),
        Vec3::new(1.0, -2.0, 2.0),
    ] {
        let axis = up.normalize();
        let level = way - axis * way.dot(axis);
        let passes = speed(&[(0.0, Vec3::ONE), (2.0, Vec3::ONE + way * 2.0)], up);
        assert!(passes.distance(-level) < 1e-4, "up {up}: {passes}");
        assert!(passes.dot(axis).abs() < 1e-5, "up {up}: {passes}");
    }
}

/// What a foot does in the air is not asked, were it most of the time.
#[test]
fn a_foot_in_the_air_says_nothing() {
    let z = |z: f32, y: f32| Vec3::new(0.0, y, z);
    let keys = [
        (0.0, z(0.4, 0.0)),
        (0.5, z(-0.1, 0.0)),
        (0.55, z(-0.1, 0.3)),
        (1.95, z(0.4, 0.3)),
        (2.0, z(0.4, 0.0)),
    ];
    let passes = speed(&keys, Vec3::Y);
    assert!(passes.distance(Vec3::Z) < 1e-3, "{passes}");
}
