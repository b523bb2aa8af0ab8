//! Promise: the commands in the README and in docs/, docs/guide and docs/reference succeed in the project's root.

use std::process::Command;

use crate::forked_rig::*;
use serde_json::Value;

/// Prefix of the command when cargo runs it, without the package name.
const CARGO_RUN_PREFIX: &str = "cargo run ";

/// Pages with executed blocks.
fn pages() -> Vec<(String, String)> {
    let readme = std::fs::read_to_string("../README.md").unwrap();
    let mut found = vec![("README".to_owned(), readme)];
    let folders = ["../docs", "../docs/guide", "../docs/reference"];
    let entries = folders.map(|folder| std::fs::read_dir(folder).unwrap());
    for entry in entries.into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "md") {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            found.push((name, std::fs::read_to_string(path).unwrap()));
        }
    }
    found.sort();
    found
}

/// Fenced blocks of a language, except those after an HTML comment, which other tests run.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let fence = format!("\n```{language}\n");
    let parts: Vec<&str> = page.split(&fence).collect();
    let unmarked = parts.windows(2).filter(|pair| !pair[0].ends_with("-->"));
    let blocks = unmarked.map(|pair| pair[1].split("\n```").next().unwrap_or_default());
    blocks.map(|block| block.replace("\\\n", " ")).collect()
}

/// Runs the command in a temporary folder, with the project's files.
fn run(folder: &Folder, line: &str) -> String {
    let words = line.strip_prefix(CARGO_RUN_PREFIX).unwrap_or(line);
    let words = words.split_whitespace().skip(1).map(|word| {
        let model = std::path::Path::new("..").join(word);
        match word.starts_with("models/") || word.starts_with("tests/") {
            true => model.canonicalize().unwrap().into_os_string(),
            false => word.into(),
        }
    });
    let mut command = Command::new(env!("CARGO_BIN_EXE_kinopt"));
    let done = command
        .args(words)
        .current_dir(folder.file("."))
        .output()
        .unwrap();
    assert!(
        done.status.success(),
        "{line}\n{}{}",
        stdout(&done),
        stderr(&done)
    );
    stdout(&done).to_owned()
}

#[test]
fn commands_of_all_pages_succeed() {
    let mut lines = 0;
    for (name, page) in pages() {
        let folder = Folder::new(&name);
        for line in blocks(&page, "sh").iter().flat_map(|block| block.lines()) {
            let begins = line.starts_with("kinopt ") || line.starts_with(CARGO_RUN_PREFIX);
            assert!(begins, "{name}: {line}");
            let text = run(&folder, line);
            assert!(!text.is_empty(), "{name}: {line}");
            lines += 1;
        }
    }
    assert!(lines >= 20, "{lines}");
}

#[test]
fn commands_of_body_pages_reach_targets() {
    let folder = Folder::new("bodies");
    let pages = pages();
    let page = |page_name: &str| {
        let found = pages.iter().find(|(name, _)| name == page_name);
        found.map(|(_, page)| page).unwrap()
    };
    let bodies = ["whole-bodies", "balance", "ball-joints"].map(page);
    let commands = bodies.map(|page| blocks(page, "sh")).concat();
    for line in commands.iter().flat_map(|block| block.lines()) {
        if line.starts_with("kinopt solve") || line.starts_with("kinopt body") {
            let text = run(&folder, &format!("{line} --json"));
            let answer: Value = serde_json::from_str(&text).unwrap();
            assert_eq!(answer["reached"], true, "{line}");
        }
    }
    let cones = blocks(page("ball-joints"), "json");
    let [cones] = cones.as_slice() else {
        panic!("one block: {cones:?}")
    };
    let file = folder.text("cones.json", cones);
    let info: Value = answer!("info ../models/humanoid/humanoid.json @model.cones={file}");
    let with = list(&info["joints"])
        .iter()
        .filter(|joint| !joint["cone"].is_null());
    assert_eq!(with.count(), 3);
}
