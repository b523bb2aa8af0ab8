//! `kinopt info`: what a model has.

use std::path::PathBuf;

use clap::Args;
use kinopt::io::rig::Rig;
use kinopt::model::{Joint, JointKind, Limits};
use serde::Serialize;

use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::number_format::{LengthFormat, limit, six_digits};
use crate::output;
use crate::table::{Align, Table};

const EXAMPLES: &str = "\
Examples:
  kinopt info arm.json           for people: limits in degrees and in radians
  kinopt info arm.json --json    for programs: limits in radians, null where there is none";

/// What a model has: joints with their limits, frames, degrees of freedom and which of them are
/// free, and for a rig its mesh, skin weights, keyframes and pinned tips.
///
/// Joints are listed in the order in which a configuration holds their values.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The model: a rig's .json file.
    #[arg(value_name = "MODEL")]
    model: PathBuf,
}

#[derive(Serialize)]
struct Document<'a> {
    file: &'a str,
    kind: &'static str,
    degrees_of_freedom: usize,
    free: usize,
    size: f64,
    joints: Vec<JointDocument<'a>>,
    frames: Vec<&'a str>,
    #[serde(flatten)]
    rig: Option<RigDocument<'a>>,
}

#[derive(Serialize)]
struct JointDocument<'a> {
    name: &'a str,
    kind: &'static str,
    /// Its place in a configuration; none for a fixed joint.
    coordinate: Option<usize>,
    free: bool,
    /// Radians or metres; none where there is no limit.
    lower: Option<f64>,
    upper: Option<f64>,
}

#[derive(Serialize)]
struct RigDocument<'a> {
    bones: Vec<BoneDocument<'a>>,
    mesh: Option<MeshDocument>,
    weights: Option<WeightsDocument>,
    keyframes: Option<KeyframesDocument>,
    constrained: Vec<&'a str>,
}

#[derive(Serialize)]
struct BoneDocument<'a> {
    name: &'a str,
    parent: Option<&'a str>,
    length: f64,
    rest_tail: [f64; 3],
    rest_tip: [f64; 3],
}

#[derive(Serialize)]
struct MeshDocument {
    vertices: usize,
    triangles: usize,
    normals: bool,
    closed: bool,
    bounding_box: Option<[[f32; 3]; 2]>,
}

#[derive(Serialize)]
struct WeightsDocument {
    max_influences: usize,
}

#[derive(Serialize)]
struct KeyframesDocument {
    bones: usize,
    keys: usize,
    /// In seconds.
    start: f64,
    end: f64,
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let loaded = LoadedModel::read(&arguments.model)?;
    let document = document(&loaded);
    if json {
        output::json(&document)
    } else {
        output::result(&text(&loaded, &document))
    }
}

fn document(loaded: &LoadedModel) -> Document<'_> {
    let model = &loaded.model;
    let free = loaded.free_coordinates();
    let moving = model.moving_joints().iter().enumerate();
    let moving = moving.filter_map(|(coordinate, id)| {
        let joint = model.joints().get(id.index())?;
        let free = free.get(coordinate).copied().unwrap_or(false);
        Some(joint_document(joint, Some(coordinate), free))
    });
    let fixed = model.joints().iter().filter(|j| j.kind == JointKind::Fixed);
    let fixed = fixed.map(|joint| joint_document(joint, None, false));
    Document {
        file: &loaded.file,
        kind: loaded.kind(),
        degrees_of_freedom: model.degrees_of_freedom(),
        free: free.iter().filter(|free| **free).count(),
        size: loaded.size(),
        joints: moving.chain(fixed).collect(),
        frames: match &loaded.rig {
            Some(rig) => bone_names(rig).collect(),
            None => model.frames().iter().map(|f| f.name.as_str()).collect(),
        },
        rig: loaded.rig.as_deref().map(rig_document),
    }
}

fn joint_document(joint: &Joint, coordinate: Option<usize>, free: bool) -> JointDocument<'_> {
    let finite = |limit: f64| limit.is_finite().then_some(limit);
    let limited = coordinate.is_some();
    JointDocument {
        name: &joint.name,
        kind: match joint.kind {
            JointKind::Fixed => "fixed",
            JointKind::Revolute => "revolute",
            JointKind::Continuous => "continuous",
            JointKind::Prismatic => "prismatic",
        },
        coordinate,
        free,
        lower: finite(joint.limits.lower).filter(|_| limited),
        upper: finite(joint.limits.upper).filter(|_| limited),
    }
}

fn bone_names(rig: &Rig) -> impl Iterator<Item = &str> {
    rig.skeleton.bones().iter().map(|bone| bone.name.as_str())
}

fn rig_document(rig: &Rig) -> RigDocument<'_> {
    let bones = rig.skeleton.bones();
    let name = |bone: kinopt::skeleton::BoneId| Some(bones.get(bone.index())?.name.as_str());
    let bone_document = |bone: &'_ kinopt::skeleton::Bone| (bone.length, bone.parent);
    RigDocument {
        bones: bones
            .iter()
            .map(|bone| {
                let (length, parent) = bone_document(bone);
                BoneDocument {
                    name: &bone.name,
                    parent: parent.and_then(name),
                    length,
                    rest_tail: bone.rest_tail().to_array(),
                    rest_tip: bone.rest_tip().to_array(),
                }
            })
            .collect(),
        mesh: rig.mesh.as_ref().map(|mesh| MeshDocument {
            vertices: mesh.positions().len(),
            triangles: mesh.triangles().len(),
            normals: !mesh.normals().is_empty(),
            closed: mesh.is_closed(),
            bounding_box: mesh
                .bounding_box()
                .map(|b| b.map(|corner| corner.to_array())),
        }),
        weights: rig.weights.as_ref().map(|weights| WeightsDocument {
            max_influences: weights.max_influences(),
        }),
        keyframes: rig.clip.time_span().map(|[start, end]| KeyframesDocument {
            bones: rig.clip.tracks().len(),
            keys: rig.clip.tracks().iter().map(|t| t.keys.len()).sum(),
            start,
            end,
        }),
        constrained: rig.constrained.iter().copied().filter_map(name).collect(),
    }
}

fn text(loaded: &LoadedModel, document: &Document) -> String {
    let lengths = LengthFormat::of_size(document.size);
    let mut lines = vec![
        ("model", format!("{} ({})", document.file, document.kind)),
        (
            "freedom",
            format!(
                "{} degrees of freedom, {} of them free",
                document.degrees_of_freedom, document.free
            ),
        ),
        (
            "size",
            format!("{} {}", lengths.number(document.size), loaded.length_unit()),
        ),
    ];
    if let Some(rig) = &document.rig {
        lines.extend(rig_lines(rig));
    }
    let mut text = String::new();
    for (name, line) in lines {
        text.push_str(&format!("{name:<10}{line}\n"));
    }
    text.push_str("\njoints\n");
    text.push_str(&joint_table(document));
    text.push_str("\nframes\n");
    match &document.rig {
        Some(rig) => text.push_str(&bone_table(rig, lengths)),
        None => {
            for name in &document.frames {
                text.push_str(&format!("  {name}\n"));
            }
        }
    }
    text
}

fn rig_lines(rig: &RigDocument) -> Vec<(&'static str, String)> {
    let none = || "none".to_owned();
    let mesh = rig.mesh.as_ref().map(|mesh| {
        format!(
            "{} vertices, {} triangles, {}, {}",
            mesh.vertices,
            mesh.triangles,
            if mesh.closed { "closed" } else { "not closed" },
            if mesh.normals {
                "with normals"
            } else {
                "without normals"
            },
        )
    });
    let weights = rig
        .weights
        .as_ref()
        .map(|weights| format!("at most {} bones to a vertex", weights.max_influences));
    let keyframes = rig.keyframes.as_ref().map(|keyframes| {
        let KeyframesDocument {
            bones,
            keys,
            start,
            end,
        } = keyframes;
        format!("{keys} keys on {bones} bones, {start} s to {end} s")
    });
    let pinned = match rig.constrained.as_slice() {
        [] => none(),
        names => format!("the tips of {}", names.join(", ")),
    };
    vec![
        ("bones", rig.bones.len().to_string()),
        ("mesh", mesh.unwrap_or_else(none)),
        ("weights", weights.unwrap_or_else(none)),
        ("keyframes", keyframes.unwrap_or_else(none)),
        ("pinned", pinned),
    ]
}

fn joint_table(document: &Document) -> String {
    let (left, right) = (Align::Left, Align::Right);
    let mut table = Table::new([
        ("q", right),
        ("name", left),
        ("kind", left),
        ("lower deg", right),
        ("upper deg", right),
        ("lower rad or m", right),
        ("upper rad or m", right),
        ("", left),
    ]);
    for joint in &document.joints {
        let limits = Limits::new(
            joint.lower.unwrap_or(f64::NEG_INFINITY),
            joint.upper.unwrap_or(f64::INFINITY),
        );
        let in_degrees = |value: f64| match joint.kind {
            "prismatic" => "-".to_owned(),
            _ => limit(value.to_degrees(), 3),
        };
        let native = |value: f64| match value.is_finite() {
            true => six_digits(value),
            false => "-".to_owned(),
        };
        let coordinate = joint.coordinate.map_or("-".to_owned(), |c| c.to_string());
        table.row([
            coordinate,
            joint.name.to_owned(),
            joint.kind.to_owned(),
            in_degrees(limits.lower),
            in_degrees(limits.upper),
            native(limits.lower),
            native(limits.upper),
            if joint.free { "free" } else { "locked" }.to_owned(),
        ]);
    }
    table.text()
}

fn bone_table(rig: &RigDocument, lengths: LengthFormat) -> String {
    let (left, right) = (Align::Left, Align::Right);
    let mut table = Table::new([
        ("name", left),
        ("parent", left),
        ("length", right),
        ("rest tail x", right),
        ("y", right),
        ("z", right),
        ("rest tip x", right),
        ("y", right),
        ("z", right),
    ]);
    for bone in &rig.bones {
        let [tail_x, tail_y, tail_z] = lengths.vector(bone.rest_tail);
        let [tip_x, tip_y, tip_z] = lengths.vector(bone.rest_tip);
        table.row([
            bone.name.to_owned(),
            bone.parent.unwrap_or("-").to_owned(),
            lengths.number(bone.length),
            tail_x,
            tail_y,
            tail_z,
            tip_x,
            tip_y,
            tip_z,
        ]);
    }
    table.text()
}
