//! Promise: docs/reference/options.md names exactly the flags of `kinopt solve` and `kinopt path`.

use std::collections::BTreeSet;

/// Flags in a text.
fn flags(text: &str) -> BTreeSet<&str> {
    let words = text.split(|sign: char| !(sign.is_ascii_alphanumeric() || sign == '-'));
    let flags = words.filter(|word| word.starts_with("--") && !word.ends_with('-'));
    flags.collect()
}

/// Flags that the long help of a subcommand explains, each at the begin of a line.
fn explained(help: &str) -> BTreeSet<&str> {
    let lines = help.lines().map(str::trim_start);
    let begins = lines.filter(|line| line.starts_with('-'));
    let named = begins.filter_map(|line| flags(line).into_iter().next());
    named.collect()
}

#[test]
fn every_documented_flag_exists() {
    let page = std::fs::read_to_string("../docs/reference/options.md").unwrap();
    let (rest, paths) = page.split_once("\n## Paths\n").unwrap();
    let rows = |text: &str| {
        let rows = text.lines().filter(|line| line.starts_with('|'));
        rows.collect::<Vec<_>>().join("\n")
    };
    for (rows, help) in [
        (rows(rest), text!("solve --help-all")),
        (rows(paths), text!("path --help-all")),
    ] {
        let (named, in_help) = (flags(&rows), explained(&help));
        assert!(named.len() > 8, "{named:?}");
        let unknown: Vec<_> = named.difference(&in_help).collect();
        assert!(unknown.is_empty(), "{unknown:?}");
    }
}
