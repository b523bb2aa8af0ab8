//! Promise: what a kind of joint is stands in the files that CONTRIBUTING's page names and nowhere else; the rest asks
//! the kind.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeSet;
use std::path::Path;

use kinopt::model::{JointKind, Limits, Model};
use kinopt::spatial::{Placement, Vector3};

/// Where these tests run from the root.
const ROOT: &str = "../";

/// Every source below a folder that names one of some kinds, by its path from the root.
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
fn a_kind_is_added_where_the_page_says() {
    let page = std::fs::read_to_string("../CONTRIBUTING.md").unwrap();
    let (_, page) = page.split_once("## A kind of joint").unwrap();
    let (page, _) = page.split_once("\n## ").unwrap();
    // Those of one number first, then the one of four.
    let (of_one, of_several) = page.split_once("One of several numbers").unwrap();
    let of_one_number = &["Fixed", "Revolute", "Continuous", "Prismatic"][..];
    for (kinds, page) in [(of_one_number, of_one), (&["Ball"], of_several)] {
        let words = page.split('`');
        let files = words.filter(|word| word.starts_with("src/") || word.starts_with("cli/src/"));
        let files: BTreeSet<String> = files.map(str::to_owned).collect();
        let mut found = BTreeSet::new();
        for folder in ["src", "cli/src"] {
            naming(kinds, &Path::new(ROOT).join(folder), &mut found);
        }
        assert_eq!(found, files);
    }
}

#[test]
fn a_kind_says_what_its_value_is() {
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
