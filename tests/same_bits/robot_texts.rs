//! Robots as texts to digest, and documents with one thing changed.
#![allow(clippy::unwrap_used)]

use std::fmt::Write;
use std::ops::Range;

use kinopt::robot::Robot;
use roxmltree::Document;

use crate::digest::Digest;

/// Adds a debug text or the text of a file.
pub(crate) fn add_text(digest: &mut Digest, text: &str) {
    digest.bytes(text);
}

/// Adds an error message.
pub(crate) fn add_error(digest: &mut Digest, error: &dyn std::fmt::Display) {
    digest.text(error.to_string().replace('\\', "/"));
}

/// Everything that a robot says of itself, but its file.
pub(crate) fn told(robot: &Robot) -> String {
    let model = robot.model();
    let mut text = format!("{} {:?}\n", robot.name(), model.length_unit());
    for joint in model.joints() {
        writeln!(text, "{joint:?}").unwrap();
    }
    for frame in model.frames() {
        writeln!(text, "{frame:?}").unwrap();
    }
    writeln!(text, "{:?}", model.loops()).unwrap();
    writeln!(
        text,
        "{:?} {:?}",
        model.moving_joints(),
        model.free_joints()
    )
    .unwrap();
    writeln!(text, "{:?} {:?}", robot.mimics(), robot.map()).unwrap();
    for joint in model.joint_ids() {
        writeln!(
            text,
            "{:?} {:?} {:?} {:?}",
            robot.velocity_limit(joint),
            robot.acceleration_limit(joint),
            robot.effort_limit(joint),
            robot.soft_limits(joint)
        )
        .unwrap();
    }
    for frame in model.frame_ids() {
        writeln!(text, "{:?} {:?}", robot.link(frame), robot.sole(frame)).unwrap();
    }
    writeln!(text, "{:?} {:?}", robot.passive_joints(), robot.tips()).unwrap();
    writeln!(text, "{:?} {}", robot.free_root(), robot.moves_as_a_whole()).unwrap();
    for repair in robot.repairs() {
        writeln!(text, "{repair} {repair:?}").unwrap();
    }
    match robot.masses() {
        Ok(masses) => writeln!(text, "{:?} {}", masses.points(), masses.total()).unwrap(),
        Err(error) => writeln!(text, "{error}").unwrap(),
    }
    match robot.total_mass() {
        Ok(mass) => writeln!(text, "{mass}").unwrap(),
        Err(error) => writeln!(text, "{error}").unwrap(),
    }
    text
}

/// The document with one thing changed at a time: each attribute away, another, and its last number another; each
/// element away, there twice, and misspelt. Lines stay where they are.
pub(crate) fn changed(text: &str, values: &[&str]) -> Vec<String> {
    let document = Document::parse(text).unwrap();
    let with = |range: &Range<usize>, new: &str| {
        format!("{}{new}{}", &text[..range.start], &text[range.end..])
    };
    let mut all = Vec::new();
    let mut turn = 0;
    for node in document.descendants().filter(roxmltree::Node::is_element) {
        for attribute in node.attributes() {
            let value = attribute.range_value();
            all.push(with(&attribute.range(), ""));
            all.push(with(&value, values[turn % values.len()]));
            turn += 1;
            let own = &text[value.clone()];
            if let Some(at) = own.rfind(|c: char| c.is_ascii_digit()) {
                let at = value.start + at;
                all.push(with(&(at..at + 1), "7"));
            }
        }
        let whole = node.range();
        if node.parent_element().is_some() {
            all.push(with(&whole, ""));
            all.push(with(&(whole.start..whole.start), &text[whole.clone()]));
            if node.children().next().is_none() {
                let name = whole.start + 1..whole.start + 1 + node.tag_name().name().len();
                all.push(with(&name, &text[name.start..name.end - 1]));
            }
        }
    }
    all
}
