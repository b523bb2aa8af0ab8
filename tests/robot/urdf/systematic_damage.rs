//! Promise: with every attribute and element of every shipped robot damaged in turn, nothing panics. A fault in the
//! kinematics is an error with its location. Files that are still readable give models from which arms can be built.

use std::ops::Range;

use kinopt::arm::Arm;
use kinopt::robot::Robot;
use roxmltree::Document;
use support::random::part;

const ROBOTS: [&str; 7] = [
    "adept_cobra_s600",
    "aldebaran_nao",
    "franka_panda",
    "kuka_iiwa14",
    "rethink_baxter",
    "universal_ur10e",
    "universal_ur5e",
];

fn text(name: &str) -> String {
    std::fs::read_to_string(format!("../models/{name}.urdf")).unwrap()
}

/// An attribute of a file.
struct Attribute {
    element: String,
    name: String,
    /// Byte ranges of the whole attribute and of its value.
    attribute_range: Range<usize>,
    value: Range<usize>,
    /// The joint that contains it.
    joint: Option<String>,
}

fn attributes(text: &str) -> Vec<Attribute> {
    let document = Document::parse(text).unwrap();
    let nodes = document.descendants().filter(|node| node.is_element());
    let all = nodes.flat_map(|node| {
        let joint = node.ancestors().find(|a| a.has_tag_name("joint"));
        let joint = joint.and_then(|joint| joint.attribute("name"));
        node.attributes().map(move |attribute| Attribute {
            element: node.tag_name().name().to_owned(),
            name: attribute.name().to_owned(),
            attribute_range: attribute.range(),
            value: attribute.range_value(),
            joint: joint.map(str::to_owned),
        })
    });
    all.collect()
}

fn without(text: &str, range: &Range<usize>) -> String {
    format!("{}{}", &text[..range.start], &text[range.end..])
}

fn replaced(text: &str, range: &Range<usize>, new: &str) -> String {
    format!("{}{new}{}", &text[..range.start], &text[range.end..])
}

/// Reads damaged text: an error starts with the file's name; a robot is consistent.
fn read(text: &str) -> Result<Robot, String> {
    match Robot::parse(text, "damaged.urdf") {
        Ok(robot) => {
            let model = robot.model();
            for joint in model.joints() {
                assert!(joint.limits.is_valid() && !joint.limits.lower.is_nan());
            }
            for frame in model.frames().iter().rev().take(2) {
                let root = &model.frames()[0].name;
                // Without an atlas, which only takes time here.
                let arm = Arm::builder(&robot, root, &frame.name);
                if let Ok(arm) = arm.with_atlas(false).build() {
                    let q: Vec<f64> = arm.limits().map(|l| l.clamp(0.0)).collect();
                    let at = arm.base_from_tool(&q).unwrap();
                    assert!(at.check_rigid(1e-6).is_ok(), "{at:?}");
                }
            }
            Ok(robot)
        }
        Err(error) => {
            let message = error.to_string();
            assert!(message.starts_with("damaged.urdf:"), "{message}");
            Err(message)
        }
    }
}

/// Attributes without which a joint or link is invalid. `effort` and `velocity` are not kinematics; a missing `lower`
/// or `upper` is 0 by the format.
fn is_needed(attribute: &Attribute) -> bool {
    matches!(
        (attribute.element.as_str(), attribute.name.as_str()),
        ("link", "name")
            | ("joint", "name" | "type")
            | ("parent" | "child", "link")
            | ("mimic", "joint")
    )
}

#[test]
fn each_attribute_is_removed() {
    for name in part(ROBOTS, 3) {
        let text = text(name);
        let mut needed = 0;
        for attribute in attributes(&text) {
            let read = read(&without(&text, &attribute.attribute_range));
            if is_needed(&attribute) {
                needed += 1;
                let location = format!("{name}: {:?} {}", attribute.joint, attribute.name);
                let error = read.map(|_| location.clone()).unwrap_err();
                assert!(error.contains(&attribute.name), "{location}: {error}");
            } else if let (Ok(robot), "lower" | "upper") = (&read, attribute.name.as_str()) {
                let id = robot
                    .model()
                    .joint(attribute.joint.as_ref().unwrap())
                    .unwrap();
                let limits = robot.model().joints()[id.index()].limits;
                let missing = if attribute.name == "lower" {
                    limits.lower
                } else {
                    limits.upper
                };
                assert_eq!(missing, 0.0, "{name}: {:?}", attribute.joint);
            }
        }
        assert!(needed > 20, "{name}: {needed}");
    }
}

#[test]
fn each_number_is_invalid_or_huge() {
    for name in part(ROBOTS, 3) {
        let text = text(name);
        for attribute in attributes(&text) {
            let numeric = match (attribute.element.as_str(), attribute.name.as_str()) {
                ("origin", "xyz" | "rpy") | ("axis", "xyz") => true,
                ("limit", "lower" | "upper") | ("mimic", _) => attribute.name != "joint",
                _ => false,
            };
            let Some(joint) = attribute.joint.as_ref().filter(|_| numeric) else {
                continue;
            };
            let count = text[attribute.value.clone()].split_whitespace().count();
            for invalid in ["nan", "-inf", "1e400", "0,1", ""] {
                let numbers = vec![invalid; count].join(" ");
                let error = read(&replaced(&text, &attribute.value, &numbers));
                let error = error.map(|_| ()).unwrap_err();
                let named = error.contains(joint.as_str());
                assert!(named, "{name} {} {invalid}: {error}", attribute.name);
            }
            // Huge but finite: accepted or rejected, but no panic.
            let numbers = vec!["1e308"; count].join(" ");
            let _ = Robot::parse(&replaced(&text, &attribute.value, &numbers), "damaged.urdf");
        }
    }
}

#[test]
fn each_element_is_removed() {
    for name in part(ROBOTS, 3) {
        let text = text(name);
        let document = Document::parse(&text).unwrap();
        let inner = document.descendants().filter(|node| {
            node.is_element()
                && node
                    .parent_element()
                    .is_some_and(|p| !p.has_tag_name("link"))
        });
        for node in inner {
            let read = read(&without(&text, &node.range()));
            let joint = node.parent_element().filter(|p| p.has_tag_name("joint"));
            let Some(joint) = joint.and_then(|joint| joint.attribute("name")) else {
                continue;
            };
            let moves = matches!(
                node.parent_element().and_then(|p| p.attribute("type")),
                Some("revolute" | "prismatic")
            );
            let needed = match node.tag_name().name() {
                "parent" | "child" => true,
                "limit" => moves,
                _ => false,
            };
            if needed {
                let error = read.map(|_| ()).unwrap_err();
                assert!(error.contains(joint), "{name}: {error}");
            }
        }
    }
}

#[test]
fn each_name_is_duplicated() {
    for name in part(ROBOTS, 3) {
        let text = text(name);
        let all = attributes(&text);
        for element in ["link", "joint"] {
            let named: Vec<_> = (all.iter())
                .filter(|a| a.element == element && a.name == "name")
                .collect();
            for pair in named.windows(2) {
                let twice = &text[pair[0].value.clone()];
                let error = read(&replaced(&text, &pair[1].value, twice)).map(|_| ());
                assert!(
                    error.as_ref().unwrap_err().contains(twice),
                    "{name}: {error:?}"
                );
            }
        }
    }
}

/// Every joint is connected back to every earlier link: to itself, in a cycle, or with two parents.
#[test]
fn each_joint_is_bent_into_a_cycle() {
    for name in part(ROBOTS, 3) {
        let text = text(name);
        let all = attributes(&text);
        let children = all.iter().filter(|a| a.element == "child");
        let links: Vec<&str> = (all.iter())
            .filter(|a| a.element == "link")
            .map(|a| &text[a.value.clone()])
            .collect();
        for child in children {
            for link in links.iter().step_by(3) {
                if text[child.value.clone()] == **link {
                    continue;
                }
                let error = read(&replaced(&text, &child.value, link)).map(|_| ());
                assert!(error.is_err(), "{name}: {link}");
            }
        }
    }
}

#[test]
fn truncated_files_are_errors() {
    for name in part(ROBOTS, 3) {
        let text = text(name);
        let end = text.trim_end().len();
        for at in (0..end).step_by(41).filter(|&at| text.is_char_boundary(at)) {
            assert!(read(&text[..at]).is_err(), "{name}: {at} bytes");
        }
    }
}

/// A chain of 3 000 links is read and moved, in any order of joints.
#[test]
fn chain_of_3000_links_is_read() {
    let joints = (0..3000).map(|k| {
        format!(
            "<link name=\"l{}\"/><joint name=\"j{k}\" type=\"continuous\"><parent link=\"l{k}\"/>\
             <child link=\"l{}\"/><origin xyz=\"0.001 0 0\"/><axis xyz=\"0 0 1\"/></joint>",
            k + 1,
            k + 1
        )
    });
    let forwards: Vec<String> = joints.collect();
    let backwards: Vec<String> = forwards.iter().rev().cloned().collect();
    for joints in [forwards, backwards] {
        let text = format!(
            "<robot name=\"deep\"><link name=\"l0\"/>{}</robot>",
            joints.concat()
        );
        let robot = Robot::parse(&text, "deep.urdf").unwrap();
        let builder = Arm::builder(&robot, "l0", "l3000");
        let arm = builder.with_atlas(false).build().unwrap();
        let at = arm.base_from_tool(&vec![0.0; 3000]).unwrap();
        assert!((at.translation.x - 3.0).abs() < 1e-9);
    }
}
