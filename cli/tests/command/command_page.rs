//! Promise: docs/reference/command.md is the `--help` of each subcommand. `KINOPT_BLESS=1 cargo test -p kinopt-cli
//! --test command command_page` writes the page.

use std::fmt::Write;
use std::process::Command;

const PAGE_PATH: &str = "../docs/reference/command.md";
const PAGE_HEADER: &str = "# The command

`cargo install --path cli` installs the command. A test generates this page from `kinopt SUBCOMMAND --help`.
All subcommands take `--json`. Options that only few need are keys of [problem files](problem.md).
`kinopt bench` needs a build with `--features bench`; `kinopt bench --help` describes it.
";
const SUBCOMMANDS: [&str; 15] = [
    "solve",
    "body",
    "batch",
    "track",
    "servo",
    "reach",
    "path",
    "retarget",
    "score",
    "animate",
    "fk",
    "info",
    "check",
    "spheres",
    "calibrate",
];

/// Help page of a subcommand, with the line width of an output without a terminal.
fn help(name: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_kinopt"));
    let done = command.args([name, "--help"]).env_remove("COLUMNS");
    String::from_utf8(done.output().unwrap().stdout).unwrap()
}

#[test]
fn command_page_equals_the_help() {
    let mut page = PAGE_HEADER.to_owned();
    for name in SUBCOMMANDS {
        let help = help(name);
        let (about, rest) = help.split_once("\n\n").unwrap();
        let rest = rest.trim_end();
        write!(
            page,
            "\n## kinopt {name}\n\n{about}.\n\n```text\n{rest}\n```\n"
        )
        .unwrap();
    }
    if std::env::var_os("KINOPT_BLESS").is_some() {
        std::fs::write(PAGE_PATH, &page).unwrap();
    }
    let current = std::fs::read_to_string(PAGE_PATH).unwrap();
    assert!(
        current == page,
        "KINOPT_BLESS=1 writes docs/reference/command.md"
    );
}
