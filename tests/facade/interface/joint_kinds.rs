//! Promise: only the files that CONTRIBUTING.md names contain knowledge about single kinds of joints.

use std::collections::BTreeSet;
use std::path::Path;

use kinopt::model::{JointKind, Limits, Model};
use kinopt::spatial::{Placement, Vector3};

/// Path to the root from the folder in which these tests run.
const ROOT: &str = "../";

/// Collects every source file below a folder that names one of the kinds, by its path from the root.
fn naming(kinds: &[&str], folder: &Path, found: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            naming(kinds, &path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = std::fs::read_to_string(&path).unwrap();
            let mut whole = kinds.iter().map(|kind| format!("JointKind::{kind}"));
            let named = path.ends_with("model/joint.rs") || whole.any(|kind| text.contains(&kind));
            if named {
                let path = path.to_str().unwrap().replace('\\', "/");
                found.insert(path.strip_prefix(ROOT).unwrap().to_owned());
            }
        }
    }
}

#[test]
fn joint_kinds_occur_only_where_documented() {
    let page = std::fs::read_to_string("../CONTRIBUTING.md").unwrap();
    let (_, page) = page.split_once("## A kind of joint").unwrap();
    let (page, _) = page.split_once("\n## ").unwrap();
    // First the kinds with one number, then the kind with four.
    let (of_one, of_several) = page.split_once("One of several numbers").unwrap();
    let of_one_number = &["Fixed", "Revolute", "Continuous", "Prismatic"][..];
    for (kinds, page) in [(of_one_number, of_one), (&["Ball"], of_several)] {
        let words = page.split('`');
        let files =
            words.filter(|word| word.starts_with("crates/") || word.starts_with("cli/src/"));
        let files: BTreeSet<String> = files.map(str::to_owned).collect();
        let mut found = BTreeSet::new();
        for folder in ["crates", "cli/src"] {
            naming(kinds, &Path::new(ROOT).join(folder), &mut found);
        }
        assert_eq!(found, files);
    }
}

#[test]
fn joint_kind_describes_its_value() {
    let mut builder = Model::builder("one of each");
    let (at, axis) = (Placement::identity(), Vector3::UNITS[2]);
    builder.fixed("fixed", None, at);
    builder.revolute("revolute", None, at, axis, Limits::new(-1.0, 1.0));
    builder.continuous("continuous", None, at, axis);
    builder.prismatic("prismatic", None, at, axis, Limits::new(-1.0, 1.0));
    let model = builder.build().unwrap();
    for joint in model.joints() {
        let kind: JointKind = joint.kind;
        assert_eq!(kind.name(), joint.name);
        assert_eq!(kind.moves(), kind.turns() != kind.slides());
        let coordinate = model.coordinate(model.joint(&joint.name).unwrap());
        assert_eq!(coordinate.is_some(), kind.moves());
    }
}
