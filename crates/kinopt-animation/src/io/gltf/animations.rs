//! Animations as clips: step, linear and cubic spline curves of translation, rotation, scale and morph weights.

use glam::{Vec3A, Vec4};
use gltf_json::animation::{Animation, Property, Sampler};
use gltf_json::validation::Checked;

use super::keys::{SamplerKeys, curve, rotation};
use super::meshes::Meshes;
use super::nodes::{Nodes, label, missing_node, node_label};
use super::note::Note;
use super::omissions::Nodeless;
use super::source::GltfSource;
use crate::animation::{Armature, Channel, Clip, ClipBuilder};
use crate::io::ReadError;

/// One animation and the objects that its channels refer to.
struct Context<'a, 'b> {
    source: &'a GltfSource<'b>,
    nodes: &'a Nodes,
    meshes: &'a Meshes,
    animation: &'a Animation,
    /// Path in the document, such as `animations[3]`.
    path: String,
    /// Name in messages, such as "animation `walk`".
    title: String,
}

pub(super) fn read(
    source: &GltfSource<'_>,
    nodeless: &Nodeless,
    nodes: &Nodes,
    meshes: &Meshes,
    armature: &Armature,
    notes: &mut Vec<Note>,
) -> Result<Vec<Clip>, ReadError> {
    let animations = source.root.animations.iter().enumerate();
    let clips = animations.map(|(index, animation)| {
        let context = Context {
            source,
            nodes,
            meshes,
            animation,
            path: format!("animations[{index}]"),
            title: label("animation", index, animation.name.as_ref()),
        };
        let name = match &animation.name {
            Some(name) if !name.is_empty() => name.clone(),
            _ => format!("animation/{index}"),
        };
        let mut builder = Clip::builder(name, armature);
        for channel in 0..animation.channels.len() {
            if nodeless.contains(&(index, channel)) {
                let path = format!("{}.channels[{channel}].target", context.path);
                let what = format!("{}: a channel without a node", context.title);
                notes.push(Note::left_out(path, what));
                continue;
            }
            context.channel(channel, &mut builder, notes)?;
        }
        Ok(builder.build())
    });
    clips.collect()
}

impl Context<'_, '_> {
    fn channel(
        &self,
        number: usize,
        builder: &mut ClipBuilder<'_>,
        notes: &mut Vec<Note>,
    ) -> Result<(), ReadError> {
        let source = self.source;
        let channel = &self.animation.channels[number];
        let path = format!("{}.channels[{number}]", self.path);
        let node = channel.target.node.value();
        let Some(&bone) = self.nodes.bone_of.get(node) else {
            return Err(missing_node(source, format!("{path}.target.node"), node));
        };
        let of_node = format!("of {}", node_label(&source.root.nodes, node));
        let samplers = &self.animation.samplers;
        let sampler = samplers.get(channel.sampler.value()).ok_or_else(|| {
            let (title, sampler_index, count) =
                (&self.title, channel.sampler.value(), samplers.len());
            let problem =
                format!("{title}: sampler {sampler_index} does not exist; there are {count}");
            source.fail(format!("{path}.sampler"), problem)
        })?;
        let Checked::Valid(property) = channel.target.path else {
            let none = "not one of translation, rotation, scale, weights";
            let what = format!("{}: a channel {of_node} that is {none}", self.title);
            notes.push(Note::left_out(format!("{path}.target.path"), what));
            return Ok(());
        };
        let (what, sampler_index) = (property_name(property), channel.sampler.value());
        let user = format!("{}, {what} {of_node}", self.title);
        let sampler_path = format!("{}.samplers[{sampler_index}]", self.path);
        let vec3 = |v: [f64; 3]| Vec3A::from_array(v.map(|number| number as f32));
        let read = match property {
            Property::Translation => {
                let keys = self.keys(sampler, sampler_path, user.clone(), vec3, notes)?;
                Channel::Translation(curve(source, keys, 1)?.swap_remove(0))
            }
            Property::Scale => {
                let keys = self.keys(sampler, sampler_path, user.clone(), vec3, notes)?;
                Channel::Scale(curve(source, keys, 1)?.swap_remove(0))
            }
            Property::Rotation => {
                let vec4 = |v: [f64; 4]| Vec4::from_array(v.map(|number| number as f32));
                let keys = self.keys(sampler, sampler_path, user.clone(), vec4, notes)?;
                Channel::Rotation(rotation(source, keys)?)
            }
            Property::MorphTargetWeights => {
                return self.weights(sampler, sampler_path, user, node, builder, notes);
            }
        };
        let added = builder.channel(bone, read);
        added.map_err(|error| source.fail(path, format!("{user}: {error}")))?;
        Ok(())
    }

    fn weights(
        &self,
        sampler: &Sampler,
        path: String,
        user: String,
        node: usize,
        builder: &mut ClipBuilder<'_>,
        notes: &mut Vec<Note>,
    ) -> Result<(), ReadError> {
        let mesh = self.meshes.index_of_node.get(&node);
        let Some(mesh) = mesh.and_then(|&mesh| self.meshes.meshes.get(mesh)) else {
            notes.push(Note::left_out(path, format!("{user}, which has no mesh")));
            return Ok(());
        };
        let first = mesh.first_morph_weight;
        let targets = mesh.morph_targets.targets().len();
        if targets == 0 {
            let problem = format!("{user}: mesh `{}` has no morph targets", mesh.name);
            return Err(self.source.fail(path, problem));
        }
        let weight = |[weight]: [f64; 1]| weight as f32;
        let keys = self.keys(sampler, path.clone(), user.clone(), weight, notes)?;
        for (target, curve) in curve(self.source, keys, targets)?.into_iter().enumerate() {
            let added = builder.morph_weight(first + target, curve);
            added.map_err(|error| self.source.fail(path.as_str(), format!("{user}: {error}")))?;
        }
        Ok(())
    }

    fn keys<const N: usize, T: Clone>(
        &self,
        sampler: &Sampler,
        path: String,
        user: String,
        convert: impl Fn([f64; N]) -> T,
        notes: &mut Vec<Note>,
    ) -> Result<SamplerKeys<T>, ReadError> {
        let Checked::Valid(interpolation) = sampler.interpolation else {
            let problem = format!("{user}: must be one of STEP, LINEAR, CUBICSPLINE");
            return Err(self.source.fail(format!("{path}.interpolation"), problem));
        };
        let input = format!("{user}, times");
        let time = |[time]: [f64; 1]| time as f32;
        let mut keys = SamplerKeys {
            times: self.source.read(sampler.input, &input, time)?,
            outputs: self.source.read(sampler.output, &user, convert)?,
            interpolation,
            user,
            path,
        };
        let repeated = keys.remove_repeated_times();
        if repeated > 0 {
            let what = format!(
                "{}: {repeated} keys removed, as the next key has the same time",
                keys.user
            );
            notes.push(Note::repaired(keys.path.as_str(), what));
        }
        Ok(keys)
    }
}

fn property_name(property: Property) -> &'static str {
    match property {
        Property::Translation => "translation",
        Property::Rotation => "rotation",
        Property::Scale => "scale",
        Property::MorphTargetWeights => "morph weights",
    }
}
