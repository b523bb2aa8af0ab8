//! Promise: the commands that the page on whole bodies shows do what it says.

use crate::forked_rig::*;
use serde_json::Value;

const PAGE: &str = include_str!("../../../docs/whole-bodies.md");

/// What stands in fences of a language.
fn blocks(language: &str) -> impl Iterator<Item = &'static str> {
    let fence = format!("```{language}\n");
    let parts = PAGE.split("```").collect::<Vec<_>>();
    let fenced = parts.into_iter().skip(1).step_by(2);
    fenced.filter_map(move |part| part.strip_prefix(&fence[3..]))
}

#[test]
fn its_commands_succeed() {
    let lines: Vec<&str> = blocks("sh").flat_map(str::lines).collect();
    assert!(lines.len() >= 3);
    for line in lines {
        let words = line.strip_prefix("kinopt ").unwrap();
        let words = words.replace("models/", "../models/");
        let answer = answer!("{words}");
        if words.starts_with("solve") {
            assert_eq!(answer["reached"], true, "{words}");
        }
    }
}

#[test]
fn its_cones_are_of_the_humanoid() {
    let folder = Folder::new("page-cones");
    let json: Vec<&str> = blocks("json").collect();
    let [cones] = json.as_slice() else {
        panic!("one block: {json:?}")
    };
    let file = folder.text("cones.json", cones);
    let info: Value = answer!("info ../models/humanoid/humanoid.json --cones {file}");
    let with = list(&info["joints"])
        .iter()
        .filter(|joint| !joint["cone"].is_null());
    assert_eq!(with.count(), 3);
}
