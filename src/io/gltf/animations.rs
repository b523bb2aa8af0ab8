//! Animations as clips: steps, lines and cubic splines of translation, rotation, scale and morph
//! weights.

use ::gltf::json::animation::{Animation, Interpolation, Property, Sampler};
use ::gltf::json::validation::Checked;
use glam::{Quat, Vec3A, Vec4};

use super::accessors::Source;
use super::meshes::Meshes;
use super::nodes::{Nodes, label, missing_node, node_label};
use super::note::Note;
use crate::animation::curve::{CurveValue, KeyError, KeyedCurve};
use crate::animation::rotation::RotationCurve;
use crate::animation::{Armature, Channel, Clip, ClipBuilder};
use crate::io::ReadError;

/// What the channels of one animation are for.
struct Context<'a, 'b> {
    source: &'a Source<'b>,
    nodes: &'a Nodes,
    meshes: &'a Meshes,
    animation: &'a Animation,
    /// `animations[3]`.
    path: String,
    /// "animation `walk`".
    title: String,
}

/// The keys of a sampler.
struct Keys<T> {
    times: Vec<f32>,
    /// One for each key, or with cubic splines three: arriving tangent, value, leaving tangent.
    outputs: Vec<T>,
    interpolation: Interpolation,
    /// "animation `walk`, rotation of node `hip`".
    user: String,
    path: String,
}

pub(super) fn read(
    source: &Source<'_>,
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
        let of = format!("of {}", node_label(&source.root.nodes, node));
        let samplers = &self.animation.samplers;
        let sampler = samplers.get(channel.sampler.value()).ok_or_else(|| {
            let problem = format!(
                "{}: sampler {} does not exist; there are {}",
                self.title,
                channel.sampler.value(),
                samplers.len()
            );
            source.fail(format!("{path}.sampler"), problem)
        })?;
        let Checked::Valid(property) = channel.target.path else {
            notes.push(Note::left_out(
                format!("{path}.target.path"),
                format!(
                    "{}: a channel {of} that is none of translation, rotation, scale and weights",
                    self.title
                ),
            ));
            return Ok(());
        };
        let (what, at) = (property_name(property), channel.sampler.value());
        let user = format!("{}, {what} {of}", self.title);
        let at = format!("{}.samplers[{at}]", self.path);
        let vec3 = |v: [f64; 3]| Vec3A::from_array(v.map(|number| number as f32));
        let read = match property {
            Property::Translation => {
                let keys = self.keys(sampler, at, user.clone(), vec3)?;
                Channel::Translation(curve(source, keys, 1)?.swap_remove(0))
            }
            Property::Scale => {
                let keys = self.keys(sampler, at, user.clone(), vec3)?;
                Channel::Scale(curve(source, keys, 1)?.swap_remove(0))
            }
            Property::Rotation => {
                let vec4 = |v: [f64; 4]| Vec4::from_array(v.map(|number| number as f32));
                let keys = self.keys(sampler, at, user.clone(), vec4)?;
                Channel::Rotation(rotation(source, keys)?)
            }
            Property::MorphTargetWeights => {
                return self.weights(sampler, at, user, node, builder, notes);
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
        let mesh = self.meshes.of_node.get(&node);
        let Some(mesh) = mesh.and_then(|&mesh| self.meshes.meshes.get(mesh)) else {
            notes.push(Note::left_out(
                path,
                format!("{user}, which carries no mesh here"),
            ));
            return Ok(());
        };
        let first = mesh.first_morph_weight;
        let targets = mesh.morph_targets.targets().len();
        if targets == 0 {
            let problem = format!("{user}: mesh `{}` has no morph targets", mesh.name);
            return Err(self.source.fail(path, problem));
        }
        let keys = self.keys(sampler, path.clone(), user.clone(), |[weight]: [f64; 1]| {
            weight as f32
        })?;
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
        of: impl Fn([f64; N]) -> T,
    ) -> Result<Keys<T>, ReadError> {
        let Checked::Valid(interpolation) = sampler.interpolation else {
            let problem = format!("{user}: is none of STEP, LINEAR and CUBICSPLINE");
            return Err(self.source.fail(format!("{path}.interpolation"), problem));
        };
        let input = format!("{user}, times");
        Ok(Keys {
            times: self
                .source
                .read(sampler.input, &input, |[time]: [f64; 1]| time as f32)?,
            outputs: self.source.read(sampler.output, &user, of)?,
            interpolation,
            user,
            path,
        })
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

impl<T: Clone> Keys<T> {
    fn fail(&self, source: &Source<'_>, error: &KeyError) -> ReadError {
        source.fail(self.path.as_str(), format!("{}: {error}", self.user))
    }

    /// The values of one of `width` curves that are keyed together, and with cubic splines their
    /// arriving and leaving tangents. For each key the file lists the arriving tangents of all
    /// curves, then their values, then the leaving tangents (section 3.11).
    fn of(&self, place: usize, width: usize, side: usize) -> Vec<T> {
        let sides = self.sides();
        let own = self
            .outputs
            .iter()
            .skip(side * width + place)
            .step_by(sides * width);
        own.cloned().collect()
    }

    fn sides(&self) -> usize {
        match self.interpolation {
            Interpolation::CubicSpline => 3,
            Interpolation::Linear | Interpolation::Step => 1,
        }
    }

    fn check(&self, source: &Source<'_>, width: usize) -> Result<(), ReadError> {
        let (given, keys) = (self.outputs.len(), self.times.len());
        let needed = keys.checked_mul(self.sides() * width);
        if needed == Some(given) {
            return Ok(());
        }
        let each = self.sides() * width;
        let problem = format!(
            "{}: {given} values for {keys} keys of {each} each",
            self.user
        );
        Err(source.fail(self.path.as_str(), problem))
    }
}

/// `width` curves that are keyed together.
fn curve<V>(
    source: &Source<'_>,
    keys: Keys<V>,
    width: usize,
) -> Result<Vec<KeyedCurve<V>>, ReadError>
where
    V: CurveValue<Real = f32> + Clone,
{
    keys.check(source, width)?;
    source.charge::<f32>(keys.times.len().saturating_mul(width), &keys.path)?;
    let curves = (0..width).map(|place| {
        let times = keys.times.clone();
        let side = |side| keys.of(place, width, side);
        let curve = match keys.interpolation {
            Interpolation::Step => KeyedCurve::step(times, side(0)),
            Interpolation::Linear => KeyedCurve::linear(times, side(0)),
            Interpolation::CubicSpline => {
                let tangents = side(0).into_iter().zip(side(2)).map(|(a, b)| [a, b]);
                KeyedCurve::cubic(times, side(1), tangents.collect())
            }
        };
        curve.map_err(|error| keys.fail(source, &error))
    });
    curves.collect()
}

fn rotation(source: &Source<'_>, keys: Keys<Vec4>) -> Result<RotationCurve, ReadError> {
    keys.check(source, 1)?;
    let times = keys.times.clone();
    let rotations = |side| {
        keys.of(0, 1, side)
            .into_iter()
            .map(Quat::from_vec4)
            .collect()
    };
    let curve = match keys.interpolation {
        Interpolation::Step => RotationCurve::step(times, rotations(0)),
        Interpolation::Linear => RotationCurve::slerp(times, rotations(0)),
        Interpolation::CubicSpline => {
            let tangents = keys.of(0, 1, 0).into_iter().zip(keys.of(0, 1, 2));
            let tangents = tangents.map(|(a, b)| [a, b]).collect();
            RotationCurve::cubic(times, rotations(1), tangents)
        }
    };
    curve.map_err(|error| keys.fail(source, &error))
}
