//! Hints for options that another subcommand or the file of `--problem` has.

use serde_json::Value;

/// Schema of problem files, as in docs/reference/problem.schema.json.
const SCHEMA: &str = include_str!("problem.schema.json");

/// Options with the subcommand that has them, or with the option that replaces them.
const MOVED: [(&str, &str); 29] = [
    ("--targets", "kinopt batch, track, servo or reach"),
    ("--batch", "kinopt batch --together"),
    ("--threads", "kinopt batch or reach"),
    ("--track", "kinopt track"),
    ("--servo", "kinopt servo --rate HZ"),
    ("--velocity-limits", "kinopt servo"),
    ("--acceleration-limits", "kinopt servo"),
    ("--jerk-limits", "kinopt servo"),
    ("--straight-line", "kinopt servo"),
    ("--ray", "kinopt body"),
    ("--center-of-mass", "kinopt body"),
    ("--balance", "kinopt body"),
    ("--balance-margin", "kinopt body"),
    ("--weight", "kinopt body"),
    ("--level", "kinopt body"),
    (
        "--tasks",
        "kinopt body, with `tasks` in the file of --problem",
    ),
    (
        "--restarts",
        "one less than `attempts` of the file of --problem",
    ),
    ("--free", "--hold none"),
    ("--free-axis", "--interval, such as rz=free for the z axis"),
    ("--frame", "--tip"),
    ("--keep-clear", "--margin M"),
    ("--help-all", "--help"),
    ("--target", "kinopt solve, body or reach"),
    ("--search", "kinopt solve or batch"),
    ("--criterion", "kinopt reach"),
    ("--max-boxes", "kinopt reach"),
    ("--hold", "kinopt solve, body, batch or track"),
    (
        "--out",
        "kinopt solve, body, reach, path, animate, retarget or spheres",
    ),
    ("--into", "kinopt solve, body or animate"),
];

/// Place of an option that a subcommand does not have, if there is one.
pub(crate) fn hint(option: &str) -> Option<String> {
    let option = option.split('=').next().unwrap_or(option);
    let moved = MOVED.iter().find(|(name, _)| *name == option);
    match (moved, place_of(option)) {
        (Some((_, place)), _) => Some(format!("{option}: see {place}")),
        (None, Some(place)) => Some(format!("{option}: see {place} in the file of --problem")),
        (None, None) => None,
    }
}

/// Place of the key of an option such as `--rng-seed`, in JSON; `None` without such a key.
fn place_of(option: &str) -> Option<String> {
    let key = option.strip_prefix("--")?.replace('-', "_");
    let schema: Value = serde_json::from_str(SCHEMA).ok()?;
    let sections = schema.get("properties")?.as_object()?;
    let has_key = |section: &Value| {
        section
            .get("properties")
            .is_some_and(|p| p.get(&key).is_some())
    };
    let section = sections.iter().find(|(_, section)| has_key(section));
    match section {
        Some((section, _)) => Some(format!("{{\"{section}\": {{\"{key}\": …}}}}")),
        None if sections.contains_key(&key) => Some(format!("{{\"{key}\": …}}")),
        None => None,
    }
}
