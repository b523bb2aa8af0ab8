//! Armatures of any number of bones and clips for them, built in code.

use glam::{Quat, Vec3, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{Armature, ArmatureBone, Channel, Clip, LocalTransform};

use crate::Sequence;

/// Animated channels of the bones, and layout of their key times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keying {
    /// Rotations of all bones and the root's translation, with common key times at 30 Hz, as in motion capture of a
    /// body.
    Body,
    /// Translation, rotation and scale of all bones, with common key times at 30 Hz.
    Everything,
    /// Rotations of all bones and the root's translation, each with its own key times, 12 a second on average, as after
    /// key reduction.
    Reduced,
    /// Translation, rotation and scale of all bones, each with its own key times, 12 a second.
    ReducedEverything,
}

impl Keying {
    /// All variants.
    pub const ALL: [Self; 4] = [
        Self::Body,
        Self::Everything,
        Self::Reduced,
        Self::ReducedEverything,
    ];
}

/// Armature of branching chains of four bones; parents precede children.
#[must_use]
pub fn armature(bones: usize) -> Armature {
    let list = (0..bones).map(|k| ArmatureBone {
        name: format!("bone {k}"),
        parent: match k {
            0 => None,
            k if k % 4 == 1 => Some(k / 6),
            k => Some(k - 1),
        },
        rest: LocalTransform {
            translation: Vec3A::new(0.0, 0.12, 0.01),
            ..LocalTransform::IDENTITY
        },
    });
    Armature::new(list.collect(), Vec::new()).expect("its bones are valid")
}

/// A clip of two seconds.
#[must_use]
pub fn clip(armature: &Armature, keying: Keying, random: &mut Sequence) -> Clip {
    let everything = matches!(keying, Keying::Everything | Keying::ReducedEverything);
    let reduced = matches!(keying, Keying::Reduced | Keying::ReducedEverything);
    let mut number = |size: f32| size * (2.0 * random.unit() as f32 - 1.0);
    let mut builder = Clip::builder(format!("{keying:?}"), armature);
    for index in 0..armature.bones() {
        let bone = armature.bone_at(index).expect("it is there");
        let mut times = || -> Vec<f32> {
            if !reduced {
                return (0..=60).map(|key| key as f32 / 30.0).collect();
            }
            let mut inner: Vec<f32> = (0..24).map(|_| 1.0 + number(0.999)).collect();
            inner.extend([0.0, 2.0]);
            inner.sort_by(f32::total_cmp);
            inner.dedup();
            inner
        };
        let [first, second, third] = [times(), times(), times()];
        let mut vector = |size: f32| Vec3A::new(number(size), number(size), number(size));
        let mut rotation = Quat::IDENTITY;
        let turned = first.iter().map(|_| {
            rotation = (rotation * Quat::from_scaled_axis(Vec3::from(vector(0.2)))).normalize();
            rotation
        });
        let turned = turned.collect();
        let rotation = RotationCurve::slerp(first, turned).expect("valid keys");
        let mut channels = vec![Channel::Rotation(rotation)];
        if everything || index == 0 {
            let moved = second.iter().map(|_| vector(0.1)).collect();
            let curve = KeyedCurve::linear(second, moved).expect("valid keys");
            channels.push(Channel::Translation(curve));
        }
        if everything {
            let scaled = third.iter().map(|_| Vec3A::ONE + vector(0.1)).collect();
            let curve = KeyedCurve::linear(third, scaled).expect("valid keys");
            channels.push(Channel::Scale(curve));
        }
        for channel in channels {
            builder.channel(bone, channel).expect("one of each");
        }
    }
    builder.build()
}
