//! Promise: the file of `--problem` holds options by section. Its schema and the reference page list the keys that the
//! command accepts, and the error for an unknown key lists the valid ones.
//!
//! `KINOPT_BLESS=1 cargo test -p kinopt-cli --test command problem_files` writes docs/reference/problem.md.

use std::fmt::Write;

use crate::forked_rig::*;
use crate::seeded_robot::Seeded;
use serde_json::{Value, json};

const PAGE_PATH: &str = "../docs/reference/problem.md";
const PAGE_HEADER: &str = "# Problem files

`--problem FILE` reads options that only few need from a JSON object of sections. Keys are named like options. Angles are in radians, lengths in metres, paths
relative to the folder of the file. Text has the format of the command line. An option of the command line replaces the value of the file. Lists are replaced as
a whole.

```json
{
    \"$schema\": \"problem.schema.json\",
    \"model\": {\"base_joint\": \"free\", \"base_bounds\": {\"z\": [0, 1]}},
    \"goal\": {\"target\": [\"left_hand=0.3,0.1,-0.1\"]},
    \"body\": {\"hold\": [\"left_sole\", \"right_sole\"]},
    \"tasks\": [{\"task\": \"gaze\", \"frame\": \"head\", \"axis\": [1, 0, 0], \"direction\": [1, 1, 0], \"half_angle\": 0.3}],
    \"solve\": {\"start\": \"bent\", \"attempts\": 50}
}
```

This page is generated from the JSON schema, [problem.schema.json](problem.schema.json). Editors check a file by it. The solving subcommands and `kinopt path` use
all sections. Other subcommands use `model` (without `lock`, `only`, `group`, `time` and `clip`), `files` and `collisions`. `kinopt animate` uses `files` and
`output`. All ignore the rest.
";

fn schema() -> Value {
    serde_json::from_str(include_str!("../../../docs/reference/problem.schema.json")).unwrap()
}

/// Sections of the schema with their keys.
fn sections() -> Vec<(String, Vec<String>)> {
    let schema = schema();
    let sections = schema["properties"].as_object().unwrap();
    let keys = |section: &Value| {
        let keys = section["properties"].as_object();
        keys.map(|keys| keys.keys().cloned().collect())
    };
    let with_keys = sections
        .iter()
        .filter_map(|(name, section)| Some((name.clone(), keys(section)?)));
    with_keys.collect()
}

/// Type of a value in words.
fn type_of(schema: &Value, defs: &Value) -> String {
    if let Some(reference) = schema["$ref"].as_str() {
        let name = reference.rsplit('/').next().unwrap();
        return match name {
            "texts" => "list of texts".to_owned(),
            "numbers" => "number, or one a joint".to_owned(),
            "placement" => "placement".to_owned(),
            "range" => "`[low, high]`".to_owned(),
            _ => type_of(&defs[name], defs),
        };
    }
    if let Some(names) = schema["enum"].as_array() {
        let names = names.iter().map(|name| format!("`{}`", word(name)));
        return names.collect::<Vec<_>>().join(", ");
    }
    match schema["type"].as_str() {
        Some("boolean") => "`true` or `false`".to_owned(),
        Some("string") => "text".to_owned(),
        Some("integer") => "whole number".to_owned(),
        Some("array") if schema["items"]["type"] == "array" => "list of pairs".to_owned(),
        Some("array") if schema["items"]["$ref"] == "#/$defs/loop" => {
            "list of `{\"frames\": [A, B], \"placements\": [P, Q]}`".to_owned()
        }
        Some("array") => format!("list of {}s", type_of(&schema["items"], defs)),
        Some("object") => "object".to_owned(),
        Some(other) => other.to_owned(),
        None => "text or numbers".to_owned(),
    }
}

#[test]
fn problem_page_equals_the_schema() {
    let schema = schema();
    let mut page = PAGE_HEADER.to_owned();
    for (name, keys) in sections() {
        let section = &schema["properties"][&name];
        let about = word(&section["description"]);
        write!(
            page,
            "\n## {name}\n\n{about}\n\n| key | value | meaning |\n|---|---|---|\n"
        )
        .unwrap();
        for key in keys {
            let entry = &section["properties"][&key];
            let (value, about) = (
                type_of(entry, &schema["$defs"]),
                word(&entry["description"]),
            );
            writeln!(page, "| `{key}` | {value} | {about} |").unwrap();
        }
    }
    let tasks = word(&schema["properties"]["tasks"]["description"]);
    let tasks = tasks.replace(
        "the guide of whole bodies",
        "[whole bodies](../guide/whole-bodies.md)",
    );
    write!(page, "\n## tasks\n\n{tasks}\n").unwrap();
    if std::env::var_os("KINOPT_BLESS").is_some() {
        std::fs::write(PAGE_PATH, &page).unwrap();
    }
    let current = std::fs::read_to_string(PAGE_PATH).unwrap();
    assert!(
        current == page,
        "KINOPT_BLESS=1 writes docs/reference/problem.md"
    );
}

/// The error for an unknown key lists exactly the keys of the schema.
#[test]
fn schema_has_the_keys_of_the_command() {
    let (folder, rig) = Folder::with_rig("schema");
    let expected = |message: &str| {
        let (_, names) = message.split_once("expected one of ").unwrap();
        let mut names: Vec<String> = names
            .split('`')
            .skip(1)
            .step_by(2)
            .map(str::to_owned)
            .collect();
        names.sort();
        names
    };
    for (section, keys) in sections() {
        let file = folder.text("wrong.json", json!({&section: {"colour": 1}}));
        let output = kinopt!("info {rig} --problem {file}");
        assert_eq!(output.status.code(), Some(1));
        let message = stderr(&output);
        says(
            message,
            &format!("wrong.json: {section}: unknown field `colour`"),
        );
        assert_eq!(expected(message), keys, "{section}");
    }
    let file = folder.text("wrong.json", json!({"modle": {}}));
    let names = sections()
        .into_iter()
        .map(|(name, _)| name)
        .collect::<Vec<_>>()
        .join(" | ");
    refused!("info {rig} --problem {file}" => 1, "wrong.json | `modle` | {names} | tasks");
}

#[test]
fn options_replace_values_of_the_file() {
    let (folder, panda) = (Folder::new("replaced"), Seeded::panda());
    let target = "tool=0.4,0.1,0.5";
    let file = folder.text(
        "problem.json",
        json!({"$schema": "x", "goal": {"target": ["tool=9,0,0"]}, "solve": {"tolerance": 0.5, "posture": 0.0,
            "max_move": 3.0}}),
    );
    let replaced = "--tolerance 1e-6 --max-move 1 --posture 0,0,0,-1.5,0,1.5,0";
    let both = answer!("solve {panda} --target {target} {replaced} --problem {file}");
    let alone = answer!("solve {panda} --target {target} {replaced}");
    assert_eq!(both["q"], alone["q"]);
}

#[test]
fn file_holds_a_whole_problem() {
    let (folder, panda) = (Folder::new("whole"), Seeded::panda());
    let world = std::fs::read_to_string(model("worlds/table.json")).unwrap();
    folder.text("table.json", world);
    // The path of the world is relative to the file.
    let file = folder.text(
        "problem.json",
        json!({
            "goal": {"target": ["flange=0.45,0.05,0.42,0,1,0,0"], "base": "base", "interval": ["rz=free"]},
            "collisions": {"world": "table.json", "margin": 0.01},
            "model": {"lock": ["joint3=0.1"]},
            "solve": {"search": "nearest", "start": [0, -0.8, 0.1, -2.4, 0, 1.6, 0.8, 0.01, 0.01]},
        }),
    );
    let options = "--target flange=0.45,0.05,0.42,0,1,0,0 --base base --interval rz=free --margin 0.01 --lock joint3=0.1 \
                   --search nearest --start 0,-0.8,0.1,-2.4,0,1.6,0.8,0.01,0.01";
    let of_options = answer!(
        "solve {panda} {options} --world {}",
        model("worlds/table.json")
    );
    let of_file = answer!("solve {panda} --problem {file}");
    has!(of_file, {"reached": true, "q": of_options["q"]});
}

#[test]
fn values_out_of_range_are_rejected() {
    let (_folder, rig) = Folder::with_rig("ranges");
    for (key, words) in [
        ("solve.tolerance=-1", "solve: | below 0"),
        ("solve.time_limit=0", "solve: | above 0"),
        ("solve.metres_per_radian=-2", "solve: | above 0"),
        ("solve.posture=[1e200]", "solve: | 1e150"),
        ("solve.search=best", "solve: | nearest"),
        ("solve.start=home", "solve: | `rest`"),
        ("solve.rng_seed=-1", "solve: | u64"),
        ("goal.target=[\"bone/2=1,2\"]", "goal: | not 2"),
        ("goal.interval=[\"w=1\"]", "goal: | rx, ry, rz"),
        ("goal.tool=[1,2]", "goal: | not 2"),
        ("body.level=[\"a=b\"]", "body: | whole number"),
        ("body.up=w", "body: | x, y, z"),
        ("model.base_joint=hover", "model: | free"),
        ("collisions.meshes=boxes", "collisions: | pieces"),
        ("output.skinning=best", "output: | lbs, dqs"),
        ("path.order=xyz", "path: | w-last"),
        ("tasks=1", "tasks: is not a list"),
    ] {
        refused!("info {rig} @{key}" => 1, "{words}");
    }
}
