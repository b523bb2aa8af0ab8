//! Promise: errors of malformed rigs name the file, the location and the problem.

use kinopt::io::rig::{Rig, RigNote};
use kinopt::io::{FileLocation, ReadProblem, dmat, ply};
use serde_json::{Value, json};
use support::fault_tables::faults;
use support::small_rig::{DMAT, JSON, PLY, SmallRig};

/// Edits the valid rig's JSON and checks that the error contains all `parts`.
fn assert_rejected(case: &str, edit: impl FnOnce(&mut Value), parts: &[&str]) {
    let mut json: Value = serde_json::from_str(JSON).unwrap();
    edit(&mut json);
    assert_rig_rejected(case, &SmallRig::with_json(&json.to_string()), parts);
}

fn assert_rig_rejected(case: &str, rig: &SmallRig, parts: &[&str]) {
    let message = match rig.parse() {
        Ok(_) => panic!("{case}: was read"),
        Err(error) => error.to_string(),
    };
    for part in ["small.json"].iter().chain(parts) {
        assert!(message.contains(part), "{case}: no `{part}` in: {message}");
    }
}

#[test]
fn valid_rig_is_read() {
    let rig = SmallRig::with_json(JSON).parse().unwrap();
    assert_eq!(rig.skeleton.bones().len(), 3);
    assert_eq!(rig.mesh.unwrap().triangles().len(), 1);
    assert_eq!(rig.weights.unwrap().bone_count(), 3);
    assert_eq!(rig.clip.tracks().len(), 1);
}

/// Values of the small rig that are replaced or left out, by their JSON pointers.
const FAULTS: &str = r#"
/bones => [] | bones:  | no bones
/bones/1/parent_id => 0.5 | bones[1].parent_id | 0.5
/bones/1/xzx_min => null | bones[1].xzx_min | null
/bones/1/xzx_max/2 => "x" | bones[1].xzx_max[2] | string
/model => null | model:  | null
/fk_animation => null | fk_animation:  | null
/ik_constraints => "2" | ik_constraints:  | array
/ik_constraints => [1.5] | ik_constraints[0] | 1.5
/bones/1/xzx_min => [0, 0] | bones[1].xzx_min:  | 2 numbers
/bones/1/xzx_max => [0, 0, 0, 0] | bones[1].xzx_max:  | 4 numbers
/fk_animation/0/keys/1/xzx => [] | fk_animation[0].keys[1].xzx:  | 0 numbers
/bones/2/length => -0.1 | bones[2].length:  | -0.1
/bones/1/xzx_min => [0, 91, 0] | bones[1].xzx_min[1]:  | 91 | xzx_max[1] | 90
/bones/1/xzx_min => [0, 0, 1e10] | bones[1].xzx_min[2]:  | 1e10
/ik_constraints => 18446744073709551615 | ik_constraints: 
/fk_animation/0/keys/1/t => -1 | fk_animation[0].keys[1].t:  | -1
/fk_animation/0/keys/1/t => 0.75 | fk_animation[0].keys[1].t:  | 0.75
/bones/2/weight_id => 0 | bones[2].weight_id:  | bone 1
/bones/2/weight_id => -1 | weights.file:  | column 1
/fk_animation/0/interpolation => "cubic" | fk_animation[0].interpolation | cubic
/bones => nothing | missing field `bones`
/model/file => nothing | model:  | missing field `file`
/fk_animation/0/keys => nothing | fk_animation[0]:  | `keys`
/fk_animation/0/keys/1/t => nothing | fk_animation[0].keys[1]:  | `t`
/bones/1/parent_id => 1 | bones[1].parent_id:  | 1 | cycles
/bones/1/parent_id => 2 | bones[1].parent_id:  | 2 | cycles
/bones/1/parent_id => 3 | bones[1].parent_id:  | 3 | cycles
/bones/1/parent_id => -2 | bones[1].parent_id:  | -2 | cycles
/bones/1/parent_id => 9223372036854775807 | bones[1].parent_id:  | 9223372036854775807 | cycles
/bones/1/parent_id => -9223372036854775808 | bones[1].parent_id:  | -9223372036854775808 | cycles
/bones/1/name => "" | bones[1].name:  | empty
/bones/1/name => null | bones[1].name | null
/bones/1/name => 7 | bones[1].name | string
/bones/1/name => "arm/tip" | bones[1].name:  | `arm/tip` | slash
/bones/1/name => "bone/2" | bones[1].name:  | `bone/2` | `bone/1`
/fk_animation/0/bone_id => 3 | fk_animation[0].bone_id:  | 3 | 0 to 2
/ik_constraints => 3 | ik_constraints:  | 3 | 0 to 2
/ik_constraints => [0, 3] | ik_constraints[1]:  | 3
/fk_animation/0/bone_id => -1 | fk_animation[0].bone_id:  | -1 | 0 to 2
/ik_constraints => -1 | ik_constraints:  | -1 | 0 to 2
/ik_constraints => [0, -1] | ik_constraints[1]:  | -1
/fk_animation/0/bone_id => -9223372036854775808 | fk_animation[0].bone_id:  | -9223372036854775808 | 0 to 2
/ik_constraints => -9223372036854775808 | ik_constraints:  | -9223372036854775808 | 0 to 2
/ik_constraints => [0, -9223372036854775808] | ik_constraints[1]:  | -9223372036854775808
/bones/1/rest_T/0/0 => 1.01 | bones[1].rest_T:  | rigid | orthonormal
/bones/1/rest_T/0/1 => 0.01 | bones[1].rest_T:  | rigid | orthonormal
/bones/1/rest_T/2/2 => -1 | bones[1].rest_T:  | rigid | reflection
/bones/1/rest_T/1/1 => 0 | bones[1].rest_T:  | rigid
/bones/1/rest_T/1/1 => 1e300 | bones[1].rest_T:  | rigid
/bones/1/rest_T/3/0 => 0.1 | bones[1].rest_T[3]:  | 0 0 0 1
/bones/1/rest_T/3/3 => 2 | bones[1].rest_T[3]:  | 0 0 0 1
/bones/1/rest_T/3/3 => 0 | bones[1].rest_T[3]:  | 0 0 0 1
/bones/1/rest_T/3/3 => -1 | bones[1].rest_T[3]:  | 0 0 0 1
/bones/1/rest_T/3/1 => -0.1 | bones[1].rest_T[3]:  | 0 0 0 1
/bones/1/weight_id => 2 | bones[1].weight_id:  | 2 | 2 columns
/bones/1/weight_id => -2 | bones[1].weight_id:  | -2 | 2 columns
/bones/1/weight_id => 9223372036854775807 | bones[1].weight_id:  | 9223372036854775807 | 2 columns
/bones/1/parent_id => nothing | bones[1]:  | missing field `parent_id`
/bones/2/parent_id => null | bones[2].parent_id | null
/bones/2/parent_id => "1" | bones[2].parent_id | string
/bones/1/weight_id => nothing | bones[1]:  | missing field `weight_id`
/bones/2/weight_id => null | bones[2].weight_id | null
/bones/2/weight_id => "1" | bones[2].weight_id | string
/bones/1/length => nothing | bones[1]:  | missing field `length`
/bones/2/length => null | bones[2].length | null
/bones/2/length => "1" | bones[2].length | string
/bones/1/rest_T => nothing | bones[1]:  | missing field `rest_T`
/bones/2/rest_T => null | bones[2].rest_T | null
/bones/2/rest_T => "1" | bones[2].rest_T | string
/bones/2/rest_T => [[1,0,0,0],[0,1,0,0],[0,0,1,0]] | bones[2].rest_T:  | 3 rows
/bones/2/rest_T/1 => [0,1,0] | bones[2].rest_T[1]:  | 3 numbers
"#;

#[test]
fn faults_are_named() {
    for mut fault in faults(FAULTS) {
        let mut json: Value = serde_json::from_str(JSON).unwrap();
        let (parent, key) = fault.from.rsplit_once('/').unwrap();
        let parent = json.pointer_mut(parent).unwrap();
        match (fault.to.as_str(), key.parse::<usize>()) {
            ("nothing", _) => drop(parent.as_object_mut().unwrap().remove(key).unwrap()),
            (value, Ok(index)) => parent[index] = serde_json::from_str(value).unwrap(),
            (value, Err(_)) => parent[key] = serde_json::from_str(value).unwrap(),
        }
        fault.parts.push("small.json");
        fault.check(SmallRig::with_json(&json.to_string()).parse());
    }
}

#[test]
fn faults_of_several_values_are_named() {
    assert_rejected(
        "cycle",
        |j| {
            j["bones"][1]["parent_id"] = json!(2);
            j["bones"][2]["parent_id"] = json!(1);
        },
        &["bones[1].parent_id"],
    );
    assert_rejected(
        "twice",
        |j| {
            j["bones"][0]["name"] = json!("arm");
            j["bones"][2]["name"] = json!("arm");
        },
        &["bones[2].name: ", "`arm`", "twice"],
    );
    assert_rejected(
        "upper end",
        |j| {
            j["bones"][1]["xzx_min"] = json!([-1e10, 0, 0]);
            j["bones"][1]["xzx_max"] = json!([-1e10, 0, 0]);
        },
        &["bones[1].xzx_max[0]: ", "-1", "no limit"],
    );
    assert_rejected(
        "two tracks",
        |j| {
            let track = j["fk_animation"][0].clone();
            j["fk_animation"].as_array_mut().unwrap().push(track);
        },
        &["fk_animation[1].bone_id: ", "bone 1"],
    );
}

#[test]
fn invalid_json_is_named() {
    let text = |case: &str, json: &str, parts: &[&str]| {
        assert_rig_rejected(case, &SmallRig::with_json(json), parts);
    };
    text("nothing", "", &["EOF", "line 1"]);
    text("truncated", &JSON[..200], &["EOF"]);
    text("trailing", &format!("{} 1", JSON), &["trailing characters"]);
    text("an array", "[1]", &["invalid"]);
    text(
        "no comma",
        r#"{"here":{} "there":1}"#,
        &["small.json: here: "],
    );
    text(
        "NaN",
        &JSON.replace("0.5", "NaN"),
        &["bones[1].length", "expected"],
    );
    text(
        "infinite",
        &JSON.replace("0.5", "1e999"),
        &["bones[1].length", "out of range"],
    );
    text(
        "twice",
        &JSON.replace("\"length\":0.5", "\"length\":0.5,\"length\":1"),
        &["bones[1]", "duplicate"],
    );
    text("deep", &"[".repeat(100_000), &["small.json"]);
    let unknown = format!("{{\"x\":{}", "[".repeat(100_000));
    text("deep, unknown", &unknown, &["EOF"]);
}

#[test]
fn mismatched_weights_are_named() {
    let table = |case: &str, dmat: &str, parts: &[&str]| {
        let rig = SmallRig {
            dmat: Some(dmat.into()),
            ..SmallRig::with_json(JSON)
        };
        assert_rig_rejected(case, &rig, parts);
    };
    table(
        "sum",
        "2 3\n1 0.5 0 0 0.4 1",
        &["weights.file: ", "small.dmat", "vertex 1", "0.9"],
    );
    table(
        "rows",
        "2 2\n1 0.5 0 0.5",
        &["weights.file: ", "2 vertices", "3"],
    );
    table(
        "more rows",
        "2 4\n1 0.5 0 0.5 0 0.5 1 0.5",
        &["weights.file: ", "4 vertices", "3"],
    );
    table(
        "truncated",
        &DMAT[..DMAT.len() - 4],
        &["weights.file: ", "small.dmat", "is damaged"],
    );
    table(
        "absurd",
        "2 4000000000000\n1 2 3",
        &["weights.file: ", "small.dmat", "line 1", "is damaged"],
    );

    // An unclaimed column is accepted if it is zero.
    let spare = format!("3 {}0 0 0\n", DMAT.strip_prefix("2 ").unwrap());
    let rig = SmallRig {
        dmat: Some(spare.into()),
        ..SmallRig::with_json(JSON)
    };
    assert_eq!(rig.parse().unwrap().weights.unwrap().max_influences(), 2);
}

#[test]
fn unreadable_part_files_are_named() {
    let rig = SmallRig {
        ply: None,
        ..SmallRig::with_json(JSON)
    };
    assert_rig_rejected(
        "absent mesh",
        &rig,
        &["model.file: ", "small.ply", "cannot be read"],
    );
    let rig = SmallRig {
        ply: Some(PLY[..PLY.len() - 3].into()),
        ..SmallRig::with_json(JSON)
    };
    assert_rig_rejected(
        "truncated mesh",
        &rig,
        &["model.file: ", "small.ply", "line 13"],
    );
}

/// Bones and keyframes do not need the weights.
#[test]
fn missing_weights_file_is_noted() {
    let rig = SmallRig {
        dmat: None,
        ..SmallRig::with_json(JSON)
    };
    let read = rig.parse().unwrap();
    assert!(read.weights.is_none() && read.mesh.is_some());
    assert_eq!(
        (read.skeleton.bones().len(), read.clip.tracks().len()),
        (3, 1)
    );
    let file = "small.dmat".to_owned();
    assert_eq!(read.notes, [RigNote::NoWeightsFile { file }]);
    assert_eq!(
        read.notes[0].to_string(),
        "weights.file: small.dmat does not exist: there are no skin weights"
    );
    let whole = SmallRig::with_json(JSON).parse().unwrap();
    assert!(whole.notes.is_empty());
}

#[test]
fn unreadable_paths_are_named() {
    let nowhere = Rig::read("no/such/rig.json").unwrap_err();
    assert_eq!(nowhere.place, FileLocation::File);
    assert!(matches!(nowhere.problem, ReadProblem::Io(_)));
    assert!(
        nowhere
            .to_string()
            .starts_with("no/such/rig.json: cannot be read: "),
        "{nowhere}"
    );
    let folder = env!("CARGO_MANIFEST_DIR");
    for error in [
        Rig::read(folder).unwrap_err(),
        ply::read(folder).unwrap_err(),
        dmat::read(folder).unwrap_err(),
    ] {
        assert!(
            error.to_string().contains("is not a regular file"),
            "{error}"
        );
    }
    // Parts are searched next to the rig file.
    let folder = std::env::temp_dir().join(format!("kinopt-malformed-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("rig.json"), JSON).unwrap();
    let error = Rig::read(folder.join("rig.json")).unwrap_err();
    std::fs::remove_dir_all(&folder).unwrap();
    let missing = folder.join("small.ply").display().to_string();
    assert!(error.to_string().contains(&missing), "{error}");
    assert_eq!(error.place, FileLocation::Json("model.file".into()));
}

/// Tension, continuity and bias belong to one interpolation and are rejected for others.
#[test]
fn controls_of_another_interpolation_are_named() {
    for name in ["linear", "catmull-rom"] {
        assert_rejected(
            name,
            |j| {
                j["fk_animation"][0]["interpolation"] = json!(name);
                for key in 0..2 {
                    j["fk_animation"][0]["keys"][key]["tcb"] = json!([0.1, 0.2, 0.3]);
                }
            },
            // The first key with controls is named.
            &["fk_animation[0].keys[0].tcb", "kochanek-bartels", name],
        );
    }
    assert_rejected(
        "too few",
        |j| {
            j["fk_animation"][0]["interpolation"] = json!("kochanek-bartels");
            j["fk_animation"][0]["keys"][0]["tcb"] = json!([0.1, 0.2]);
        },
        &["fk_animation[0].keys[0].tcb", "2 numbers instead of 3"],
    );
}
