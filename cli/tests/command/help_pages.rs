//! Promise: a help page has at most 60 lines of 100 columns, and a subcommand at most 25 options.

use std::process::Command;

/// Standard output of the command, without a terminal.
fn output(arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_kinopt"));
    let done = command.args(arguments).env_remove("COLUMNS").output();
    let done = done.unwrap();
    assert!(done.status.success(), "{arguments:?}");
    String::from_utf8(done.stdout).unwrap()
}

/// Subcommands of the main page.
fn subcommands() -> Vec<String> {
    let page = output(&["--help"]);
    let (_, list) = page.split_once("\nCommands:\n").unwrap();
    let (list, _) = list.split_once("\n\n").unwrap();
    let entries = list.lines().filter(|line| !line.starts_with("   "));
    let names = entries.filter_map(|line| line.split_whitespace().next());
    names
        .filter(|name| *name != "help")
        .map(str::to_owned)
        .collect()
}

#[test]
fn help_pages_keep_their_limits() {
    let subcommands = subcommands();
    assert!(subcommands.len() >= 12, "{subcommands:?}");
    let names = subcommands.iter().map(String::as_str);
    for arguments in names
        .map(|name| vec![name, "--help"])
        .chain([vec!["--help"]])
    {
        let page = output(&arguments);
        assert!(
            page.lines().count() <= 60,
            "{arguments:?}: {}",
            page.lines().count()
        );
        for line in page.lines() {
            assert!(line.chars().count() <= 100, "{arguments:?}: {line}");
        }
        // Options are before the examples, each at the begin of a line.
        let (options, _) = page.split_once("\nExamples:").unwrap_or((&page, ""));
        let lines = options.lines().map(str::trim_start);
        let options = lines.filter(|line| line.starts_with("--") || line.starts_with("-h, --"));
        let count = options.count();
        assert!((1..=25).contains(&count), "{arguments:?}: {count} options");
    }
    let page = output(&["solve", "-h"]);
    assert_eq!(page, output(&["solve", "--help"]));
}

#[test]
fn solving_pages_explain_problem_files() {
    for name in ["solve", "body", "batch", "track", "servo", "reach", "path"] {
        let page = output(&[name, "--help"]);
        for words in [
            "--problem <FILE>",
            "{\"model\": ",
            "docs/reference/problem.md",
            "Examples:",
        ] {
            assert!(page.contains(words), "{name}: {words}");
        }
    }
}
