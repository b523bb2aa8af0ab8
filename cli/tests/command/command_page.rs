//! Promise: docs/reference/command.md is the `--help` of each subcommand. `KINOPT_BLESS=1 cargo test -p kinopt-cli
//! --test command command_page` writes the page.

use std::fmt::Write;
use std::process::Command;

const PAGE_PATH: &str = "../docs/reference/command.md";
const PAGE_HEADER: &str = "# The command

`cargo install --path cli` installs the command. A test generates this page from `kinopt SUBCOMMAND --help`.
All subcommands take `--json`. `kinopt bench` needs a build with `--features bench`; `kinopt bench --help` describes it.
";
const SUBCOMMANDS: [&str; 12] = [
    "solve", "body", "batch", "track", "servo", "path", "retarget", "animate", "fk", "info",
    "check", "spheres",
];

/// Words as Markdown. Angle brackets are escaped.
fn words(text: &str) -> String {
    let parts = text.split('`').enumerate();
    let parts = parts.map(|(k, part)| match k % 2 {
        0 => part.replace('<', "\\<"),
        _ => part.to_owned(),
    });
    parts.collect::<Vec<_>>().join("`")
}

/// Lines joined to sentences. List items are separated by semicolons.
fn joined(lines: &[&str]) -> String {
    let mut text = String::new();
    for line in lines.iter().map(|line| line.trim()) {
        if line.is_empty() {
            let ended = text.is_empty() || text.ends_with(['.', ':', ']']);
            text += if ended { "" } else { "." };
            continue;
        }
        let (between, line) = match line.strip_prefix("- ") {
            Some(item) if text.ends_with(':') => (" ", item),
            Some(item) => ("; ", item),
            None => (" ", line),
        };
        text += if text.is_empty() { "" } else { between };
        text += &line.split_whitespace().collect::<Vec<_>>().join(" ");
    }
    words(&text)
}

fn paragraphs(text: &str) -> String {
    let parts = text
        .split("\n\n")
        .map(|part| joined(&part.lines().collect::<Vec<_>>()));
    parts.collect::<Vec<_>>().join("\n\n")
}

/// Returns `true` if a line begins the help of a flag or an argument.
fn begins(line: &str) -> bool {
    let shift = line.len() - line.trim_start().len();
    (2..=6).contains(&shift) && line.trim_start().starts_with(['-', '<', '['])
}

/// Section of a subcommand.
fn section(name: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_kinopt"));
    // Line width without a terminal.
    let done = command
        .args([name, "--help"])
        .env_remove("COLUMNS")
        .output();
    let help = String::from_utf8(done.unwrap().stdout).unwrap();
    let (about, rest) = help.split_once("\nUsage: ").unwrap();
    let (usage, rest) = rest.split_once("\n\n").unwrap();
    let about = paragraphs(about.trim());
    let mut page = format!("\n## kinopt {name}\n\n{about}\n\n```text\n{usage}\n```\n");
    let mut lines = rest.lines().peekable();
    let mut heading = String::new();
    while let Some(line) = lines.next() {
        if line.is_empty() {
            continue;
        }
        if begins(line) {
            let mut help_lines = Vec::new();
            while lines
                .peek()
                .is_some_and(|next| next.is_empty() || next.starts_with("       "))
            {
                help_lines.extend(lines.next());
            }
            let term = line.trim();
            if !term.contains("--help") {
                let heading = std::mem::take(&mut heading);
                writeln!(page, "{heading}- `{term}`: {}", joined(&help_lines)).unwrap();
            }
        } else if lines.peek().is_some_and(|next| begins(next)) {
            let title = line.trim_end_matches(':').to_lowercase();
            heading = format!("\n### {name}: {title}\n\n");
        } else {
            let rest: Vec<&str> = std::iter::once(line).chain(lines.by_ref()).collect();
            write!(page, "\n```text\n{}\n```\n", rest.join("\n").trim_end()).unwrap();
        }
    }
    page
}

#[test]
fn command_page_equals_the_help() {
    let sections = SUBCOMMANDS.map(section);
    let page = PAGE_HEADER.to_owned() + &sections.concat();
    if std::env::var_os("KINOPT_BLESS").is_some() {
        std::fs::write(PAGE_PATH, &page).unwrap();
    }
    let current = std::fs::read_to_string(PAGE_PATH).unwrap();
    assert!(
        current == page,
        "KINOPT_BLESS=1 writes docs/reference/command.md"
    );
}
