//! JSON schema of problem files.

use serde_json::Value;

/// Schema, as in docs/reference/problem.schema.json.
const SCHEMA: &str = include_str!("schema.json");

/// Place of the key of an option such as `--rng-seed`, in JSON; `None` without such a key.
pub(crate) fn place_of(option: &str) -> Option<String> {
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
