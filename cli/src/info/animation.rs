//! What there is to say about an armature with clips, for programs and for people.

use kinopt::animation::Clip;
use serde::Serialize;

use crate::animated_armature::{AnimatedArmature, CapturedFrames};
use crate::failure::Outcome;
use crate::number_format::LengthFormat;
use crate::table::{Align, Table};

#[derive(Serialize)]
pub(super) struct Document<'a> {
    file: &'a str,
    kind: &'static str,
    size: f64,
    bones: Vec<BoneDocument<'a>>,
    clips: Vec<ClipDocument<'a>>,
    /// Only of motion capture.
    #[serde(skip_serializing_if = "Option::is_none")]
    captured: Option<CapturedDocument>,
}

#[derive(Serialize)]
struct BoneDocument<'a> {
    name: &'a str,
    parent: Option<&'a str>,
    rest_position: [f64; 3],
    /// Only in motion capture.
    #[serde(skip_serializing_if = "Option::is_none")]
    channels: Option<Vec<&'static str>>,
}

#[derive(Serialize)]
struct ClipDocument<'a> {
    name: &'a str,
    /// In seconds.
    start: f32,
    end: f32,
}

#[derive(Serialize)]
struct CapturedDocument {
    frames: usize,
    /// In seconds.
    frame_time: f64,
    /// Numbers in a frame.
    channels: usize,
}

/// Everything there is to say about an armature with clips.
pub(super) fn document(animated: &AnimatedArmature) -> Outcome<Document<'_>> {
    let armature = &animated.armature;
    let names = armature.names();
    let placements = animated.placements(armature.rest())?;
    let bones = names.iter().zip(&placements).enumerate();
    let bones = bones.map(|(index, (name, placement))| {
        let parent = armature
            .bone_at(index)
            .and_then(|bone| armature.parent(bone));
        let parent = parent.and_then(|parent| names.get(parent.index()));
        let captured = animated.frames.as_ref();
        let channels = captured.and_then(|frames| frames.channels.get(index));
        BoneDocument {
            name,
            parent: parent.map(String::as_str),
            rest_position: placement.translation.to_array(),
            channels: channels.map(|channels| channels.iter().map(|c| c.name()).collect()),
        }
    });
    Ok(Document {
        file: &animated.file,
        kind: animated.kind,
        size: animated.size()?,
        bones: bones.collect(),
        clips: animated.clips.iter().map(clip).collect(),
        captured: animated.frames.as_ref().map(captured),
    })
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

/// The document as text with an aligned table.
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
        let CapturedDocument {
            frames,
            frame_time,
            channels,
        } = captured;
        let moving = document.bones.iter();
        let moving = moving.filter(|bone| bone.channels.as_ref().is_some_and(|c| !c.is_empty()));
        let rate = 1.0 / frame_time;
        lines.extend([
            (
                "frames",
                format!("{frames}, one every {frame_time} s ({rate:.3} a second)"),
            ),
            (
                "channels",
                format!("{channels} on {} bones", moving.count()),
            ),
        ]);
    }
    let mut text = String::new();
    for (name, line) in lines {
        text.push_str(&format!("{name:<10}{line}\n"));
    }
    text.push_str("\nbones\n");
    text.push_str(&bone_table(document, lengths));
    text
}

fn bone_table(document: &Document, lengths: LengthFormat) -> String {
    let (left, right) = (Align::Left, Align::Right);
    let mut table = Table::new([
        ("name", left),
        ("parent", left),
        ("rest x", right),
        ("y", right),
        ("z", right),
        ("", left),
    ]);
    for bone in &document.bones {
        let [x, y, z] = lengths.vector(bone.rest_position);
        let channels = bone.channels.as_ref();
        table.row([
            bone.name.to_owned(),
            bone.parent.unwrap_or("-").to_owned(),
            x,
            y,
            z,
            channels.map_or_else(String::new, |channels| channels.join(" ")),
        ]);
    }
    table.text()
}
