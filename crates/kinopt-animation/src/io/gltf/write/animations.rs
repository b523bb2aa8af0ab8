//! Writing of clips.

use gltf_json::Index;
use gltf_json::animation::{
    Animation, Channel as Entry, Interpolation, Property as Path, Sampler, Target,
};
use gltf_json::validation::Checked;

use super::UnwritableScene;
use super::buffer::Document;
use super::keys::{ChannelKeys, EncodedKeys, exact, of_channel, sample_times};
use crate::animation::{Armature, Channel, Clip, Property, clip};
use crate::io::gltf::scene::{Scene, SceneMesh};
use kinopt_kinematics::curve::KeyedCurve;
use kinopt_kinematics::skeleton::BoneId;

/// An animation under construction.
struct AnimationBuilder<'a> {
    document: &'a mut Document,
    animation: Animation,
    /// Time shift in seconds: glTF has no negative times.
    shift: f32,
}

pub(super) fn add(
    scene: &Scene,
    clip: &Clip,
    rate: f32,
    document: &mut Document,
) -> Result<(), UnwritableScene> {
    let armature = &scene.armature;
    let size_error = |problem| UnwritableScene::Clip {
        clip: clip.name().to_owned(),
        problem,
    };
    let channels = clip.channels(armature).map_err(size_error)?;
    let morphs = clip.morph_channels(armature).map_err(size_error)?;
    let keyed = clip::keyed_span(&channels, &morphs);
    let [start, end] = clip.span();
    let [first, last] = keyed.map_or([start, end], |[s, e]| [s.min(start), e.max(end)]);
    let mut builder = AnimationBuilder {
        document,
        animation: plain!(Animation {
            channels: Vec::new(),
            name: Some(clip.name().to_owned()),
            samplers: Vec::new(),
        }),
        shift: (-first).max(0.0),
    };
    for (bone, channel) in &channels {
        let path = match channel {
            Channel::Translation(_) => Path::Translation,
            Channel::Rotation(_) | Channel::Euler(_) => Path::Rotation,
            Channel::Scale(_) => Path::Scale,
        };
        match of_channel(channel, rate)? {
            ChannelKeys::Vectors(keys) => builder.channel(*bone, path, &keys),
            ChannelKeys::Rotations(keys) => builder.channel(*bone, path, &keys),
        }
    }
    for mesh in &scene.meshes {
        if let Some(keys) = weights(mesh, &morphs, armature, rate)? {
            builder.channel(mesh.bone, Path::MorphTargetWeights, &keys);
        }
    }
    if keyed != Some([first, last]) {
        builder.add_constant_translation(armature, &channels, [first, last]);
    }
    let animation = builder.animation;
    if !animation.channels.is_empty() {
        document.root.animations.push(animation);
    }
    Ok(())
}

impl AnimationBuilder<'_> {
    fn channel<const N: usize>(&mut self, bone: BoneId, path: Path, keys: &EncodedKeys<N>) {
        let times: Vec<f32> = keys.times.iter().map(|time| time + self.shift).collect();
        let sampler = plain!(Sampler {
            input: self.document.times(&times),
            interpolation: Checked::Valid(keys.interpolation),
            output: self.document.numbers(&keys.outputs, false, None),
        });
        let sampler = Index::push(&mut self.animation.samplers, sampler);
        self.animation.channels.push(plain!(Entry {
            sampler,
            target: plain!(Target {
                node: Index::new(bone.index() as u32),
                path: Checked::Valid(path),
            }),
        }));
    }

    /// Adds constant keys of a bone's translation over the span. A glTF animation lasts exactly as long as its keys,
    /// while a clip may last longer.
    fn add_constant_translation(
        &mut self,
        armature: &Armature,
        channels: &[(BoneId, Channel)],
        span: [f32; 2],
    ) {
        let has_translation = |bone: BoneId| {
            let mut bone_channels = channels.iter().filter(|(other, _)| *other == bone);
            bone_channels.any(|(_, channel)| channel.property() == Property::Translation)
        };
        let mut bones = (0..armature.bones()).map(BoneId::new);
        let Some(bone) = bones.find(|bone| !has_translation(*bone)) else {
            return;
        };
        let translation = armature.rest().local_of(bone).translation.to_array();
        let mut times = span.to_vec();
        times.dedup();
        let keys = EncodedKeys {
            outputs: vec![translation; times.len()],
            times,
            interpolation: Interpolation::Step,
        };
        self.channel(bone, Path::Translation, &keys);
    }
}

/// Keys of a mesh's morph weights, which glTF keys together. The keys are exact if the curves have one type and equal
/// key times, and else samples with linear interpolation.
fn weights(
    mesh: &SceneMesh,
    morphs: &[(usize, KeyedCurve<f32>)],
    armature: &Armature,
    rate: f32,
) -> Result<Option<EncodedKeys<1>>, UnwritableScene> {
    let range = mesh.morph_weights();
    let curves: Vec<_> = range
        .clone()
        .map(|target| curve_of(target, morphs))
        .collect();
    let moving = || {
        curves
            .iter()
            .flatten()
            .filter(|curve| curve.values().len() > 1)
    };
    let Some(first) = moving().next().or_else(|| curves.iter().flatten().next()) else {
        return Ok(None);
    };
    let rest = armature.rest().morph_weights().get(range).unwrap_or(&[]);
    let rest_weight = |target: usize| rest.get(target).copied().unwrap_or(0.0);
    let exact_first = exact(*first);
    let common = exact_first.filter(|(kind, _)| {
        moving().all(|curve| {
            curve.times() == first.times() && exact(*curve).is_some_and(|(other, _)| other == *kind)
        })
    });
    let Some((interpolation, _)) = common else {
        let mut keys: Vec<f32> = moving().flat_map(|curve| curve.times()).copied().collect();
        keys.sort_by(f32::total_cmp);
        keys.dedup();
        let all_linear = moving().all(|curve| curve.is_linear());
        let times = match all_linear {
            true => keys,
            false => sample_times(&keys, rate)?,
        };
        let weights_at = |time: f32| {
            curves.iter().enumerate().map(move |(target, curve)| {
                [curve.map_or(rest_weight(target), |curve| curve.at(time))]
            })
        };
        return Ok(Some(EncodedKeys {
            outputs: times.iter().flat_map(|&time| weights_at(time)).collect(),
            times,
            interpolation: Interpolation::Linear,
        }));
    };
    let sides = match interpolation {
        Interpolation::CubicSpline => 3,
        Interpolation::Linear | Interpolation::Step => 1,
    };
    let mut outputs = Vec::new();
    let columns = curves.iter().enumerate().map(|(target, curve)| {
        let moving = curve.filter(|curve| curve.values().len() > 1);
        match moving.and_then(exact) {
            Some((_, outputs)) => outputs,
            None => {
                // A constant curve has zero tangents.
                let value = curve.and_then(|curve| curve.values().first().copied());
                let value = value.unwrap_or(rest_weight(target));
                let key = |_| match sides {
                    3 => vec![0.0, value, 0.0],
                    _ => vec![value],
                };
                (0..first.times().len()).flat_map(key).collect()
            }
        }
    });
    let columns: Vec<Vec<f32>> = columns.collect();
    for row in 0..first.times().len() * sides {
        outputs.extend(
            columns
                .iter()
                .map(|column| [column.get(row).copied().unwrap_or(0.0)]),
        );
    }
    Ok(Some(EncodedKeys {
        times: first.times().to_vec(),
        outputs,
        interpolation,
    }))
}

fn curve_of(target: usize, morphs: &[(usize, KeyedCurve<f32>)]) -> Option<&KeyedCurve<f32>> {
    let entry = morphs.iter().find(|(other, _)| *other == target);
    entry.map(|(_, curve)| curve)
}
