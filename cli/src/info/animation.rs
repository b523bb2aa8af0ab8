//! Report of an armature with clips, as JSON and text.

use std::collections::BTreeSet;

use kinopt::animation::{Armature, Clip};
use kinopt::counted;
use kinopt::io::gltf::{Scene, SceneMesh};
use kinopt::motion::posing::guess_hinges;
use serde::Serialize;

use crate::animated_armature::{AnimatedArmature, CapturedFrames};
use crate::failure::Outcome;
use crate::number_format::LengthFormat;
use crate::table::{self, Table};

#[derive(Serialize)]
pub(super) struct Document<'a> {
    file: &'a str,
    kind: &'static str,
    size: f64,
    bones: Vec<BoneDocument<'a>>,
    clips: Vec<ClipDocument<'a>>,
    /// Only for motion capture.
    #[serde(skip_serializing_if = "Option::is_none")]
    captured: Option<CapturedDocument>,
    /// Only for scenes.
    #[serde(skip_serializing_if = "Option::is_none")]
    meshes: Option<Vec<MeshDocument<'a>>>,
    /// Guessed hinges of knees and elbows.
    hinges: Vec<HingeDocument>,
    /// Notes of the reader.
    notes: &'a [String],
}

#[derive(Serialize)]
struct HingeDocument {
    bone: String,
    /// Axis in the axes of the bone.
    axis: [f64; 3],
    /// Lower and upper bound from rest, degrees.
    range: [f64; 2],
    /// Angle between the two segments of the limb at rest, degrees.
    rest_bend: f64,
    /// Reason for the axis.
    source: String,
}

#[derive(Serialize)]
struct MeshDocument<'a> {
    name: &'a str,
    bone: Option<&'a str>,
    vertices: usize,
    triangles: usize,
    normals: bool,
    /// Number of joints of its skin; `None` without a skin.
    joints: Option<usize>,
    max_influences: Option<usize>,
    morph_targets: Vec<&'a str>,
}

#[derive(Serialize)]
struct BoneDocument<'a> {
    name: &'a str,
    parent: Option<&'a str>,
    rest_position: [f64; 3],
    /// Only for motion capture.
    #[serde(skip_serializing_if = "Option::is_none")]
    channels: Option<Vec<&'static str>>,
    /// True if a skin has the bone as a joint; only for scenes.
    #[serde(skip_serializing_if = "Option::is_none")]
    joint: Option<bool>,
}

#[derive(Serialize)]
struct ClipDocument<'a> {
    name: &'a str,
    /// Start and end in seconds.
    start: f32,
    end: f32,
}

#[derive(Serialize)]
struct CapturedDocument {
    frames: usize,
    /// Time between frames, in seconds.
    frame_time: f64,
    /// Number of values in a frame.
    channels: usize,
}

/// Content of an armature with clips.
pub(super) fn document(animated: &AnimatedArmature) -> Outcome<Document<'_>> {
    let armature = &animated.armature;
    let names = armature.names();
    let placements = animated.placements(armature.rest())?;
    let scene = animated.scene.as_ref().map(|file| file.scene());
    let joints = scene.map(joints);
    let bones = names.iter().zip(&placements).enumerate();
    let bones = bones.map(|(index, (name, placement))| {
        let bone = armature.bone_at(index);
        let parent = bone.and_then(|bone| armature.parent(bone));
        let parent = parent.and_then(|parent| names.get(parent.index()));
        let captured = animated.frames.as_ref();
        let channels = captured.and_then(|frames| frames.channels.get(index));
        BoneDocument {
            name,
            parent: parent.map(String::as_str),
            rest_position: placement.translation.to_array(),
            channels: channels.map(|channels| channels.iter().map(|c| c.name()).collect()),
            joint: joints.as_ref().map(|joints| joints.contains(&index)),
        }
    });
    Ok(Document {
        file: &animated.file,
        kind: animated.kind,
        size: animated.size()?,
        bones: bones.collect(),
        clips: animated.clips.iter().map(clip).collect(),
        captured: animated.frames.as_ref().map(captured),
        meshes: scene.map(meshes),
        hinges: hinges(animated)?,
        notes: &animated.notes,
    })
}

fn hinges(animated: &AnimatedArmature) -> Outcome<Vec<HingeDocument>> {
    let AnimatedArmature {
        file,
        armature,
        turning,
        ..
    } = animated;
    let skeleton = armature.turning_skeleton(file.clone(), turning);
    let skeleton = skeleton.map_err(|error| failure!("{file}: {error}"))?;
    let guesses = guess_hinges(&skeleton).into_iter();
    let hinges = guesses.map(|guess| HingeDocument {
        axis: guess.hinge.axis.to_array(),
        range: [guess.hinge.limits.lower, guess.hinge.limits.upper].map(f64::to_degrees),
        rest_bend: guess.rest_bend.to_degrees(),
        source: guess.source.to_string(),
        bone: guess.bone,
    });
    Ok(hinges.collect())
}

/// Joints of skins, by bone index.
fn joints(scene: &Scene) -> BTreeSet<usize> {
    let skins = scene.meshes.iter().filter_map(|mesh| mesh.skin.as_ref());
    let joints = skins.flat_map(|skin| &skin.joints);
    joints.map(|joint| joint.index()).collect()
}

fn meshes(scene: &Scene) -> Vec<MeshDocument<'_>> {
    let meshes = scene.meshes.iter();
    meshes
        .map(|mesh_node| mesh(mesh_node, &scene.armature))
        .collect()
}

fn mesh<'a>(mesh: &'a SceneMesh, armature: &'a Armature) -> MeshDocument<'a> {
    let targets = mesh.morph_targets.targets().iter();
    let skin = mesh.skin.as_ref();
    MeshDocument {
        name: &mesh.name,
        bone: armature.names().get(mesh.bone.index()).map(String::as_str),
        vertices: mesh.mesh.positions().len(),
        triangles: mesh.mesh.triangles().len(),
        normals: !mesh.mesh.normals().is_empty(),
        joints: skin.map(|skin| skin.joints.len()),
        max_influences: skin.map(|skin| skin.weights.max_influences()),
        morph_targets: targets.map(|target| target.name()).collect(),
    }
}

fn clip(clip: &Clip) -> ClipDocument<'_> {
    let [start, end] = clip.span();
    let name = clip.name();
    ClipDocument { name, start, end }
}

fn captured(frames: &CapturedFrames) -> CapturedDocument {
    CapturedDocument {
        frames: frames.count,
        frame_time: frames.time,
        channels: frames.channels.iter().map(Vec::len).sum(),
    }
}

/// Document as text with an aligned table.
pub(super) fn text(document: &Document) -> String {
    let lengths = LengthFormat::of_size(document.size);
    let size = lengths.number(document.size);
    let mut lines = vec![
        ("model", format!("{} ({})", document.file, document.kind)),
        ("bones", document.bones.len().to_string()),
        ("size", format!("{size} in the file's unit of length")),
    ];
    for ClipDocument { name, start, end } in &document.clips {
        lines.push(("clip", format!("{name}, {start} s to {end} s")));
    }
    if let Some(captured) = &document.captured {
        let (frames, frame_time) = (captured.frames, captured.frame_time);
        let moving = document.bones.iter();
        let moving = moving.filter(|bone| bone.channels.as_ref().is_some_and(|c| !c.is_empty()));
        let rate = 1.0 / frame_time;
        let frames = format!("{frames}, one every {frame_time} s ({rate:.3} a second)");
        lines.push(("frames", frames));
        let channels = format!(
            "{} on {}",
            captured.channels,
            counted(moving.count(), "bone")
        );
        lines.push(("channels", channels));
    }
    for mesh in document.meshes.iter().flatten() {
        lines.push(("mesh", mesh_line(mesh)));
    }
    for hinge in &document.hinges {
        let [lower, upper] = hinge.range;
        let [x, y, z] = hinge.axis;
        // Without negative zeros.
        let [x, y, z, lower, upper] =
            [x, y, z, lower, upper].map(|v| (1e3 * v).round() / 1e3 + 0.0);
        let axis = format!("{x:.3} {y:.3} {z:.3}");
        let HingeDocument { bone, source, .. } = hinge;
        lines.push((
            "hinge",
            format!("{bone} about {axis}, {lower:.1} to {upper:.1} degrees, by {source}"),
        ));
    }
    for note in document.notes {
        lines.push(("note", note.clone()));
    }
    let mut text = table::lines(lines);
    text.push_str("\nbones\n");
    text.push_str(&bone_table(document, lengths));
    text
}

fn mesh_line(mesh: &MeshDocument) -> String {
    let mut line = format!(
        "{} on {}: {}, {}, {} normals",
        mesh.name,
        mesh.bone.unwrap_or("-"),
        counted(mesh.vertices, "vertex"),
        counted(mesh.triangles, "triangle"),
        if mesh.normals { "with" } else { "without" },
    );
    if let (Some(joints), Some(max_influences)) = (mesh.joints, mesh.max_influences) {
        line.push_str(&format!(
            ", {}, at most {max_influences} to a vertex",
            counted(joints, "joint")
        ));
    }
    if !mesh.morph_targets.is_empty() {
        let names = mesh.morph_targets.join(", ");
        line.push_str(&format!(", morph targets {names}"));
    }
    line
}

fn bone_table(document: &Document, lengths: LengthFormat) -> String {
    let mut table = Table::new("name | parent | >rest x | >y | >z | ");
    for bone in &document.bones {
        let [x, y, z] = lengths.vector(bone.rest_position);
        let channels = bone.channels.as_ref();
        table.row([
            bone.name.to_owned(),
            bone.parent.unwrap_or("-").to_owned(),
            x,
            y,
            z,
            match (channels, bone.joint) {
                (Some(channels), _) => channels.join(" "),
                (None, Some(true)) => "joint".to_owned(),
                (None, _) => String::new(),
            },
        ]);
    }
    table.text()
}
