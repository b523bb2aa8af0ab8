//! Promise: crates of the library depend on each other as ARCHITECTURE.md says.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

type Graph = BTreeSet<(String, BTreeSet<String>)>;

/// The rows of the table of crates in ARCHITECTURE.md, with the dependencies in the last column.
fn documented(architecture: &str) -> Graph {
    let cells = |line: &str| -> Option<(String, BTreeSet<String>)> {
        let [_, name, _, uses, _] = line.split('|').collect::<Vec<_>>().try_into().ok()?;
        let quoted = |text: &str| {
            text.split('`')
                .skip(1)
                .step_by(2)
                .map(str::to_owned)
                .collect()
        };
        let names: Vec<String> = quoted(name);
        let uses: Vec<String> = quoted(uses);
        let name = names.into_iter().next()?;
        let is_crate = name.starts_with("kinopt-");
        is_crate.then(|| (name, uses.into_iter().collect()))
    };
    architecture.lines().filter_map(cells).collect()
}

/// The packages of `crates/` that the facade re-exports, with their dependencies on each other, by `cargo metadata`.
fn built(root: &Path) -> Graph {
    let output = Command::new(env!("CARGO"))
        .args([
            "metadata",
            "--no-deps",
            "--offline",
            "--format-version",
            "1",
        ])
        .current_dir(root)
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let dependencies = |package: &Value| -> BTreeSet<String> {
        let list = package["dependencies"].as_array().unwrap().iter();
        list.filter(|dependency| dependency["kind"].is_null())
            .filter_map(|dependency| dependency["name"].as_str())
            .filter(|name| name.starts_with("kinopt-"))
            .map(str::to_owned)
            .collect()
    };
    let packages = metadata["packages"].as_array().unwrap();
    let facade = packages.iter().find(|package| package["name"] == "kinopt");
    let re_exported = dependencies(facade.unwrap());
    packages
        .iter()
        .map(|package| {
            (
                package["name"].as_str().unwrap().to_owned(),
                dependencies(package),
            )
        })
        .filter(|(name, _)| re_exported.contains(name))
        .collect()
}

#[test]
fn crates_depend_as_the_architecture_says() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let architecture = std::fs::read_to_string(root.join("ARCHITECTURE.md")).unwrap();
    let documented = documented(&architecture);
    assert_eq!(documented.len(), 9, "the table of crates was not found");
    assert_eq!(built(root), documented);
}
