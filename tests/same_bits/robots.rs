//! Promise: so it is for robots that are read from URDF, and for every fault that is found: each document with one thing
//! changed is the same robot, mended the same way, or the same error.
#![allow(clippy::unwrap_used)]

use kinopt::robot::Robot;

use crate::digest::{Digest, Value, check};
use crate::robot_texts::{add_error, add_text, changed, told};

const JOINTS: &str = include_str!("robots/joints.urdf");
const CHAINS: &str = include_str!("robots/chains.urdf");
const LINKS: &str = include_str!("robots/links.urdf");
const MENDED: &str = include_str!("robots/mended.urdf");

/// What attributes say instead.
const VALUES: [&str; 14] = [
    "",
    "nan",
    "0.5",
    "a",
    "0 0 0",
    "-1",
    "1 2",
    "0.5, 1, 2",
    "turn",
    "1e400",
    "fixed",
    "0 0 0 0",
    "${x}",
    "1.1",
];

/// As strict and as lenient readers have it, which differ in what strict ones refuse.
fn add(digest: &mut Digest, text: &str, file: &str) {
    let strict = match Robot::parse(text, file) {
        Ok(robot) => return add_text(digest, &told(&robot)),
        Err(error) => error.to_string(),
    };
    add_text(digest, &strict);
    match Robot::reader().lenient().parse(text, file) {
        Ok(robot) => add_text(digest, &told(&robot)),
        Err(error) if error.to_string() == strict => {}
        Err(error) => add_error(digest, &error),
    }
}

/// Each document as it is, and with one thing changed at a time.
fn urdf(texts: &[(&str, &str)]) -> Value {
    let mut digest = Digest::new();
    for (text, file) in texts {
        add(&mut digest, text, file);
        let lenient = Robot::reader().lenient().parse(text, file);
        add_text(&mut digest, &told(&lenient.unwrap()));
        for changed in changed(text, &VALUES) {
            add(&mut digest, &changed, file);
        }
    }
    digest.value()
}

/// What a lenient reader alone can read, and what neither can.
fn mended() -> Value {
    let mut digest = Digest::new();
    add(&mut digest, MENDED, "mended.urdf");
    let lines: Vec<&str> = MENDED.lines().collect();
    for left_out in 0..lines.len() {
        let kept = lines.iter().enumerate();
        let kept = kept.filter(|(line, _)| *line != left_out);
        let text: Vec<&str> = kept.map(|(_, line)| *line).collect();
        add(&mut digest, &text.join("\n"), "mended.urdf");
    }
    let ring = r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
      <joint name="i" type="fixed"><parent link="d"/><child link="c"/></joint>
      <joint name="j" type="fixed"><parent link="b"/><child link="d"/></joint>
      <joint name="k" type="fixed"><parent link="d"/><child link="b"/></joint></robot>"#;
    for text in [
        "",
        "<robot name='x'",
        "<robot name='x'/>",
        "<world/>",
        "\u{feff}<robot name='x'><link name='a'/></robot>",
        "<robot name='x'><link name='a'/><link name='b'/></robot>",
        "<robot name='x'><link name='a'/>\n<link name='a'/></robot>",
        "<robot name='x' xmlns:xacro='http://ros.org/wiki/xacro'>\n<xacro:include/></robot>",
        "<robot name='x'><xacro:include/></robot>",
        "<!DOCTYPE x><robot name='x'/>",
        ring,
    ] {
        add(&mut digest, text, "few.urdf");
    }
    digest.value()
}

#[test]
fn of_robots_with_one_thing_changed() {
    check(&[
        (
            "URDF: joints, each thing changed",
            urdf(&[(JOINTS, "joints.urdf"), (CHAINS, "chains.urdf")]),
        ),
        (
            "URDF: links, each thing changed",
            urdf(&[(LINKS, "links.urdf")]),
        ),
        ("URDF: what is mended and what is not", mended()),
    ]);
}
