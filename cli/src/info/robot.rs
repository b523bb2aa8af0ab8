//! Report of a robot beyond its joints: tree of links, tips, mimic joints.

use std::collections::BTreeSet;

use kinopt::model::{FrameId, Joint, JointId};
use kinopt::robot::{Geometry, Link, Repair, Robot};
use serde::Serialize;

use super::cone::ConeDocument;
use crate::loaded_model::LoadedModel;
use crate::number_format::{six_digits, three_digits};
use crate::table::Table;

#[derive(Serialize)]
pub(super) struct RobotDocument<'a> {
    pub(super) name: &'a str,
    /// Root link, which the base joint connects to the world.
    pub(super) root: Option<&'a str>,
    /// Links without child links.
    pub(super) tips: Vec<&'a str>,
    /// Joints of a configuration, in its order.
    pub(super) moving_joints: Vec<&'a str>,
    /// Mass of all links, kg; `None` if no link has a mass.
    pub(super) mass: Option<f64>,
    pub(super) links: Vec<LinkDocument<'a>>,
    /// Loop closures of every solution.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) loops: Vec<LoopDocument<'a>>,
    /// Passive joints.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) passive_joints: Vec<&'a str>,
    /// Repairs and defaults of the reader.
    pub(super) repairs: Vec<RepairDocument<'a>>,
}

#[derive(Serialize)]
pub(super) struct LinkDocument<'a> {
    pub(super) name: &'a str,
    /// Mass, kg.
    pub(super) mass: Option<f64>,
    /// Number of visual shapes.
    pub(super) visuals: usize,
    pub(super) collisions: usize,
    /// Mesh files, as named in the robot's file.
    pub(super) meshes: BTreeSet<&'a str>,
}

#[derive(Serialize)]
pub(super) struct LoopDocument<'a> {
    pub(super) name: &'a str,
    /// "connect" or "weld".
    pub(super) kind: &'static str,
    pub(super) frames: [&'a str; 2],
    /// Joints that move the two frames relative to each other.
    pub(super) joints: Vec<&'a str>,
}

#[derive(Serialize)]
pub(super) struct RepairDocument<'a> {
    pub(super) line: u32,
    pub(super) element: &'a str,
    pub(super) repair: String,
}

/// Position of a joint between links.
#[derive(Serialize)]
pub(super) struct PlaceDocument<'a> {
    pub(super) parent_link: Option<&'a str>,
    pub(super) child_link: Option<&'a str>,
    /// Unit axis in the joint's frame; `None` for a fixed joint.
    pub(super) axis: Option<[f64; 3]>,
    pub(super) mimic: Option<MimicDocument<'a>>,
    /// Velocity limit, rad/s or m/s; `None` if the file has none.
    pub(super) velocity: Option<f64>,
    pub(super) effort: Option<f64>,
    /// Soft limits of the safety controller, radians or metres; null on a side without a limit.
    pub(super) soft_limits: Option<[Option<f64>; 2]>,
}

/// Mimic joint: its value is `ratio` times that of `joint`, plus `offset` (radians or metres).
#[derive(Serialize)]
pub(super) struct MimicDocument<'a> {
    pub(super) joint: &'a str,
    pub(super) ratio: f64,
    pub(super) offset: f64,
}

pub(super) fn document<'a>(loaded: &'a LoadedModel, robot: &'a Robot) -> RobotDocument<'a> {
    RobotDocument {
        name: robot.name(),
        root: loaded.root_link(),
        tips: loaded.tip_links(),
        moving_joints: loaded.joint_names(),
        mass: links(robot)
            .filter_map(|(_, link)| Some(link.inertial?.mass))
            .reduce(|all, mass| all + mass),
        links: links(robot).map(link_document).collect(),
        loops: loops(loaded),
        passive_joints: (robot.passive_joints().iter())
            .map(|id| loaded.joint_name(*id))
            .collect(),
        repairs: robot.repairs().iter().map(repair_document).collect(),
    }
}

fn loops(loaded: &LoadedModel) -> Vec<LoopDocument<'_>> {
    let model = &loaded.model;
    let named = |frame: FrameId| model.frames()[frame.index()].name.as_str();
    let loops = model.loops().iter().map(|closure| LoopDocument {
        name: &closure.name,
        kind: closure.kind.name(),
        frames: closure.frames.map(named),
        joints: (model.loop_joints(closure).iter())
            .map(|id| loaded.joint_name(*id))
            .collect(),
    });
    loops.collect()
}

fn links(robot: &Robot) -> impl Iterator<Item = (&str, &Link)> {
    let frames = robot.model().frame_ids().zip(robot.model().frames());
    frames.filter_map(|(id, frame)| Some((frame.name.as_str(), robot.link(id)?)))
}

fn link_document<'a>((name, link): (&'a str, &'a Link)) -> LinkDocument<'a> {
    let shapes = link.visuals.iter().chain(&link.collisions);
    let meshes: BTreeSet<&str> = shapes
        .filter_map(|shape| match &shape.geometry {
            Geometry::Mesh { file, .. } => Some(file.as_str()),
            _ => None,
        })
        .collect();
    LinkDocument {
        name,
        mass: link.inertial.map(|inertial| inertial.mass),
        visuals: link.visuals.len(),
        collisions: link.collisions.len(),
        meshes,
    }
}

fn repair_document(repair: &Repair) -> RepairDocument<'_> {
    RepairDocument {
        line: repair.line,
        element: &repair.element,
        repair: repair.mended.to_string(),
    }
}

pub(super) fn joint_place<'a>(robot: &'a Robot, id: JointId, joint: &Joint) -> PlaceDocument<'a> {
    let named = |id: JointId| Some(robot.model().joints().get(id.index())?.name.as_str());
    let mimic = robot.mimics().iter().find(|mimic| mimic.joint == id);
    PlaceDocument {
        parent_link: link_on(robot, joint.parent),
        child_link: link_on(robot, Some(id)),
        axis: (joint.kind.moves()).then(|| joint.axis.to_array()),
        velocity: robot.velocity_limit(id),
        effort: robot.effort_limit(id),
        soft_limits: robot.soft_limits(id).map(|soft| {
            let finite = |limit: f64| limit.is_finite().then_some(limit);
            [finite(soft.lower), finite(soft.upper)]
        }),
        mimic: mimic.and_then(|mimic| {
            Some(MimicDocument {
                joint: named(mimic.master)?,
                ratio: mimic.ratio,
                offset: mimic.offset,
            })
        }),
    }
}

/// Link that a joint moves; `None` selects the root link.
fn link_on(robot: &Robot, joint: Option<JointId>) -> Option<&str> {
    let mut frames = robot.model().frames().iter();
    let link = frames.find(|frame| frame.joint == joint);
    link.map(|frame| frame.name.as_str())
}

/// Tree of links, indented by depth, with the joint above each link.
pub(super) fn tree(robot: &Robot) -> String {
    let mut table =
        Table::new("link | joint | kind | axis | >lower | >upper | >speed | >effort | >q | ");
    let root = link_on(robot, None).unwrap_or("").to_owned();
    table.row([root]);
    // Depth first with an explicit stack: a file may have a chain of a thousand links.
    let mut stack: Vec<(JointId, usize)> = Vec::new();
    let push_children = |stack: &mut Vec<(JointId, usize)>, parent: Option<JointId>, depth| {
        let joints = robot.model().joint_ids().zip(robot.model().joints());
        let children: Vec<JointId> = joints
            .filter(|(_, joint)| joint.parent == parent)
            .map(|(id, _)| id)
            .collect();
        stack.extend(children.into_iter().rev().map(|id| (id, depth)));
    };
    push_children(&mut stack, None, 1);
    while let Some((id, depth)) = stack.pop() {
        if let Some(joint) = robot.model().joints().get(id.index()) {
            table.row(row(robot, id, joint, depth));
        }
        push_children(&mut stack, Some(id), depth + 1);
    }
    table.text()
}

fn row(robot: &Robot, id: JointId, joint: &Joint, depth: usize) -> [String; 10] {
    let joint_place = joint_place(robot, id, joint);
    let link = format!(
        "{}{}",
        "  ".repeat(depth),
        joint_place.child_link.unwrap_or("-")
    );
    let coordinate = robot.model().coordinate(id);
    let slides = joint.kind.slides();
    let limit = |limit: f64| match joint.kind.moves() {
        false => String::new(),
        true if !limit.is_finite() => "none".to_owned(),
        true if slides => format!("{} m", six_digits(limit)),
        true => format!("{}°", three_digits(limit.to_degrees())),
    };
    let speed = |speed: f64| match slides {
        true => format!("{} m/s", three_digits(speed)),
        false => format!("{}°/s", three_digits(speed.to_degrees())),
    };
    let effort = |effort: f64| match slides {
        true => format!("{} N", three_digits(effort)),
        false => format!("{} N·m", three_digits(effort)),
    };
    let note = match &joint_place.mimic {
        Some(mimic) => follows(mimic),
        None if coordinate.is_some() && joint.limits.is_locked() => "locked".to_owned(),
        None => (ConeDocument::of(joint).and_then(|cone| cone.text())).unwrap_or_default(),
    };
    [
        link,
        joint.name.clone(),
        joint.kind.name().to_owned(),
        joint_place.axis.map(axis).unwrap_or_default(),
        limit(joint.limits.lower),
        limit(joint.limits.upper),
        joint_place.velocity.map(speed).unwrap_or_default(),
        joint_place.effort.map(effort).unwrap_or_default(),
        coordinate.map(|c| c.to_string()).unwrap_or_default(),
        note,
    ]
}

fn follows(mimic: &MimicDocument) -> String {
    let mut text = format!("follows {}", mimic.joint);
    if mimic.ratio != 1.0 {
        text.push_str(&format!(" × {}", mimic.ratio));
    }
    if mimic.offset != 0.0 {
        let sign = if mimic.offset < 0.0 { '-' } else { '+' };
        text.push_str(&format!(" {sign} {}", mimic.offset.abs()));
    }
    text
}

/// Coordinate axis by its letter, any other axis by its components.
fn axis(axis: [f64; 3]) -> String {
    let signs = axis.map(|component| component.abs() == 1.0);
    let letter = signs.iter().position(|&is_unit| is_unit);
    match letter.and_then(|at| Some((axis.get(at)?, ["x", "y", "z"].get(at)?))) {
        Some((sign, letter)) if *sign < 0.0 => format!("-{letter}"),
        Some((_, letter)) => (*letter).to_owned(),
        None => axis.map(three_digits).join(" "),
    }
}
