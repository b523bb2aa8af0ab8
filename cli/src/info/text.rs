//! Report of a model as text.

use super::cone::ConeDocument;
use super::document::{Document, RigDocument};
use super::robot::{self, LinkDocument};
use crate::loaded_model::LoadedModel;
use crate::number_format::{LengthFormat, six_digits, three_digits};
use crate::table::{self, Table};
use kinopt::counted;

/// Document as text with aligned tables.
pub(super) fn text(loaded: &LoadedModel, document: &Document) -> String {
    let lengths = LengthFormat::of_size(document.size);
    let mut lines = vec![
        ("model", format!("{} ({})", document.file, document.kind)),
        (
            "freedom",
            format!(
                "{} of freedom, {} of them free",
                counted(document.degrees_of_freedom, "degree"),
                document.free
            ),
        ),
        (
            loaded.robot.as_ref().map_or("size", |_| "reach"),
            format!("{} {}", lengths.number(document.size), loaded.length_unit()),
        ),
    ];
    if let Some(rig) = &document.rig {
        lines.extend(rig_lines(rig));
    }
    if let Some(robot) = &document.robot {
        lines.insert(1, ("name", robot.name.to_owned()));
        lines.push(("tips", robot.tips.join(", ")));
        if !robot.loops.is_empty() {
            let names: Vec<&str> = robot.loops.iter().map(|closure| closure.name).collect();
            lines.push(("loops", names.join(", ")));
        }
        if !robot.passive_joints.is_empty() {
            lines.push(("passive", robot.passive_joints.join(", ")));
        }
        let total =
            |count: fn(&LinkDocument) -> usize| robot.links.iter().map(count).sum::<usize>();
        let shapes = format!(
            "{} visual, {} collision, {} of meshes",
            total(|link| link.visuals),
            total(|link| link.collisions),
            counted(total(|link| link.meshes.len()), "file"),
        );
        lines.push(("shapes", shapes));
        let mass = robot.mass.map(|mass| format!("{} kg", three_digits(mass)));
        lines.push(("mass", mass.unwrap_or_else(|| "none".to_owned())));
    }
    let mut text = table::lines(lines);
    if let Some(robot) = &loaded.robot {
        text.push_str("\ntree\n");
        text.push_str(&robot::tree(robot));
        return text;
    }
    text.push_str("\njoints\n");
    text.push_str(&joint_table(document));
    text.push_str("\nframes\n");
    if let Some(rig) = &document.rig {
        text.push_str(&bone_table(rig, lengths));
    }
    text
}

fn rig_lines(rig: &RigDocument) -> Vec<(&'static str, String)> {
    let none = || "none".to_owned();
    let mesh = rig.mesh.as_ref().map(|mesh| {
        let closed = if mesh.closed { "closed" } else { "not closed" };
        let with = if mesh.normals { "with" } else { "without" };
        let vertices = counted(mesh.vertices, "vertex");
        let triangles = counted(mesh.triangles, "triangle");
        format!("{vertices}, {triangles}, {closed}, {with} normals")
    });
    let weights = rig.weights.as_ref().map(|weights| weights.max_influences);
    let weights = weights
        .map(|max_influences| format!("at most {} to a vertex", counted(max_influences, "bone")));
    let keyframes = rig.keyframes.as_ref().map(|keyframes| {
        let (keys, bones) = (
            counted(keyframes.keys, "key"),
            counted(keyframes.bones, "bone"),
        );
        let between = keyframes.interpolation.join(", ");
        let (start, end) = (keyframes.start, keyframes.end);
        format!("{keys} on {bones}, {start} s to {end} s, {between}")
    });
    let pinned = match rig.constrained.as_slice() {
        [] => none(),
        names => format!("the tips of {}", names.join(", ")),
    };
    let mut lines = vec![
        ("bones", rig.bones.len().to_string()),
        ("mesh", mesh.unwrap_or_else(none)),
        ("weights", weights.unwrap_or_else(none)),
        ("keyframes", keyframes.unwrap_or_else(none)),
        ("pinned", pinned),
    ];
    lines.extend(rig.notes.iter().map(|note| ("note", note.clone())));
    lines
}

fn joint_table(document: &Document) -> String {
    let slides = document.joints.iter().any(|j| j.kind == "prismatic");
    let unit = if slides { "rad or m" } else { "rad" };
    let mut table = Table::new(&format!(
        ">q | name | kind | >lower (deg) | >upper (deg) | >lower ({unit}) | >upper ({unit}) | "
    ));
    let shown = |limit: Option<f64>, format: fn(f64) -> String| {
        limit.map_or_else(|| "-".to_owned(), format)
    };
    let degrees = |radians: f64| three_digits(radians.to_degrees());
    for joint in &document.joints {
        let turns = |limit: Option<f64>| limit.filter(|_| joint.kind != "prismatic");
        table.row([
            joint.coordinate.map_or("-".to_owned(), |c| c.to_string()),
            joint.name.to_owned(),
            joint.kind.to_owned(),
            shown(turns(joint.lower), degrees),
            shown(turns(joint.upper), degrees),
            shown(joint.lower, six_digits),
            shown(joint.upper, six_digits),
            match joint.cone.as_ref().and_then(ConeDocument::text) {
                Some(cone) if joint.free => format!("free {cone}"),
                _ if joint.free => "free".to_owned(),
                _ => "locked".to_owned(),
            },
        ]);
    }
    table.text()
}

fn bone_table(rig: &RigDocument, lengths: LengthFormat) -> String {
    let mut table =
        Table::new("name | parent | >length | >rest tail x | >y | >z | >rest tip x | >y | >z");
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
