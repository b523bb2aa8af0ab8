//! Promise: included content keeps its position and order, up to 32 nested files.

use kinopt::robot::{ParseIssue, Robot, RobotFileError};

use crate::mjcf::malformed::files;

#[test]
fn included_bodies_keep_their_order() {
    let body = |name: &str| format!("<body name=\"{name}\"><joint name=\"{name}\"/></body>");
    let whole = |bodies: &str| format!("<mujoco><worldbody>{bodies}</worldbody></mujoco>");
    let main = format!(
        "{}<include file=\"part.xml\"/>{}",
        body("first"),
        body("last")
    );
    let part = ["a", "b", "c"].map(body).concat();
    let folder = files(
        "mjcf_order",
        &[
            ("main.xml", &whole(&main)),
            ("part.xml", &format!("<mujoco>{part}</mujoco>")),
        ],
    );
    let path = folder.join("main.xml");
    let text = Robot::mjcf_reader().text_with_includes(&path).unwrap();
    for robot in [
        Robot::read_mjcf(&path).unwrap(),
        Robot::parse_mjcf(&text, "whole.xml").unwrap(),
    ] {
        let joints = robot.model().joints().iter();
        let names: Vec<_> = joints.map(|joint| joint.name.as_str()).collect();
        assert_eq!(names, ["first", "a", "b", "c", "last"]);
    }
}

#[test]
fn nested_includes_are_limited() {
    let chain = |length: usize| {
        let name = |k: usize| format!("chain_{k}.xml");
        let texts: Vec<_> = (0..=length)
            .map(|k| {
                let inner = match k < length {
                    true => format!("<include file=\"{}\"/>", name(k + 1)),
                    false => "<worldbody><body name=\"inmost\"/></worldbody>".to_owned(),
                };
                (name(k), format!("<mujoco>{inner}</mujoco>"))
            })
            .collect();
        let texts: Vec<_> = texts
            .iter()
            .map(|(name, text)| (name.as_str(), text.as_str()))
            .collect();
        let folder = files(&format!("mjcf_chain_{length}"), &texts);
        Robot::read_mjcf(folder.join(name(0)))
    };
    assert!(chain(32).unwrap().model().frame("inmost").is_ok());
    let error = chain(33).unwrap_err();
    assert!(
        matches!(
            &error,
            RobotFileError::Element { file, fault: ParseIssue::TooDeep { limit: 32 }, .. } if file.ends_with("chain_32.xml")
        ),
        "{error}"
    );
}
