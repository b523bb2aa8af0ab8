//! Promise: docs/options.md names every flag of `kinopt solve` and of the options of `kinopt path`, and none that there is not.

use std::collections::BTreeSet;

/// The flags in a text.
fn flags(text: &str) -> BTreeSet<&str> {
    let words = text.split(|sign: char| !(sign.is_ascii_alphanumeric() || sign == '-'));
    let flags = words.filter(|word| word.starts_with("--") && !word.ends_with('-'));
    flags.collect()
}

/// Those that the long help of a subcommand explains: each begins a line.
fn explained(help: &str) -> BTreeSet<&str> {
    let lines = help.lines().map(str::trim_start);
    let begins = lines.filter(|line| line.starts_with("--") || line.starts_with('-'));
    let named = begins.filter_map(|line| flags(line).into_iter().next());
    named.filter(|flag| *flag != "--help").collect()
}

#[test]
fn every_flag_has_its_row() {
    let page = std::fs::read_to_string("../docs/options.md").unwrap();
    let (head, rest) = page.split_once("\n## Paths\n").unwrap();
    let (paths, command) = rest.split_once("\n## The command\n").unwrap();
    let rows = |text: &str| {
        let rows = text.lines().filter(|line| line.starts_with('|'));
        rows.collect::<Vec<_>>().join("\n")
    };
    let of_solve = rows(head) + &rows(command);
    let solve = text!("solve --help");
    assert_eq!(flags(&of_solve), explained(&solve));
    let path = text!("path --help");
    let (rows, there) = (rows(paths), explained(&path));
    let unknown: Vec<_> = flags(&rows).difference(&there).copied().collect();
    assert!(unknown.is_empty(), "{unknown:?}");
}
