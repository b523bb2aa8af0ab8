//! Promise: the speed of the ground under the feet is perpendicular to the up axis. It results from the feet near the
//! ground, however they rise and descend.

use glam::{Vec3, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::{Armature, ArmatureBone, Channel, Clip, LocalTransform};
use kinopt::motion::clip_ik::ground_speed;

/// Speed of the ground under a foot that moves linearly between keys (seconds, position).
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
        .map(|(at, position)| (*at, Vec3A::from(*position)))
        .unzip();
    let curve = KeyedCurve::linear(times, places).unwrap();
    let mut clip = Clip::builder("step", &armature);
    clip.channel(foot, Channel::Translation(curve)).unwrap();
    ground_speed(&armature, &clip.build(), &[foot], up, 100.0).unwrap()
}

/// A foot on a slope: the result is level, because the slope's rise is no displacement of the subject.
#[test]
fn rising_foot_gives_a_level_ground_speed() {
    let displacement = Vec3::new(0.3, 0.2, -1.1);
    for up in [
        Vec3::X,
        Vec3::Y,
        Vec3::Z,
        Vec3::NEG_Y,
        Vec3::new(0.0, 3.0, 4.0),
        Vec3::new(1.0, -2.0, 2.0),
    ] {
        let axis = up.normalize();
        let level = displacement - axis * displacement.dot(axis);
        let passes = speed(
            &[(0.0, Vec3::ONE), (2.0, Vec3::ONE + displacement * 2.0)],
            up,
        );
        assert!(passes.distance(-level) < 1e-4, "up {up}: {passes}");
        assert!(passes.dot(axis).abs() < 1e-5, "up {up}: {passes}");
    }
}

/// The motion of a foot in the air has no influence, even if that is most of the time.
#[test]
fn foot_in_the_air_has_no_influence() {
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
