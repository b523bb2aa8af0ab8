//! Promise: docs/reference/options.md names options of `kinopt solve`, `body`, `servo` and `path`, and keys of problem
//! files.

use std::collections::BTreeSet;

use serde_json::Value;

/// Flags in a text.
fn flags(text: &str) -> BTreeSet<&str> {
    let words = text.split(|sign: char| !(sign.is_ascii_alphanumeric() || sign == '-'));
    let flags = words.filter(|word| word.starts_with("--") && !word.ends_with('-'));
    flags.collect()
}

/// Flags that a help page explains, each at the begin of a line.
fn explained(help: &str) -> BTreeSet<&str> {
    let lines = help.lines().map(str::trim_start);
    let begins = lines.filter(|line| line.starts_with('-'));
    let named = begins.filter_map(|line| flags(line).into_iter().next());
    named.collect()
}

/// Keys of problem files in table cells, such as `"attempts"`.
fn keys(rows: &str) -> BTreeSet<&str> {
    let parts = rows.split("`\"").skip(1);
    parts
        .filter_map(|part| Some(part.split_once("\"`")?.0))
        .collect()
}

#[test]
fn every_documented_option_exists() {
    let page = std::fs::read_to_string("../docs/reference/options.md").unwrap();
    let (rest, paths) = page.split_once("\n## Paths\n").unwrap();
    let rows = |text: &str| {
        let rows = text.lines().filter(|line| line.starts_with('|'));
        rows.collect::<Vec<_>>().join("\n")
    };
    let solving = ["solve", "body", "servo"].map(|name| text!("{name} --help"));
    for (rows, help) in [
        (rows(rest), solving.concat()),
        (rows(paths), text!("path --help")),
    ] {
        let (named, in_help) = (flags(&rows), explained(&help));
        assert!(named.len() > 4, "{named:?}");
        let unknown: Vec<_> = named.difference(&in_help).collect();
        assert!(unknown.is_empty(), "{unknown:?}");
    }
    let schema = include_str!("../../../docs/reference/problem.schema.json");
    let schema: Value = serde_json::from_str(schema).unwrap();
    let sections = schema["properties"].as_object().unwrap();
    let all = rows(&page);
    let named = keys(&all);
    assert!(named.len() > 8, "{named:?}");
    for key in named {
        let found = sections.contains_key(key)
            || sections
                .values()
                .any(|section| section["properties"].get(key).is_some());
        assert!(found, "{key}");
    }
}
