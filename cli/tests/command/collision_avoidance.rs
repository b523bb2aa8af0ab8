//! Promise: `kinopt solve --world` returns a collision-free solution, or names the pairs in contact with their
//! penetration depths.

use crate::forked_rig::*;

const POSE: &str = "flange=0.45,0.05,0.42,0,1,0,0";

fn with(target: &str, options: &str) -> serde_json::Value {
    let panda = model("franka_panda.urdf");
    let table = model("worlds/table.json");
    answer!("solve {panda} --base base --target {target} --world {table} {options}")
}

#[test]
fn arm_solution_is_free_or_names_collisions() {
    let free = with(POSE, "");
    assert_eq!(free["reached"], true);
    assert_eq!(free["goals_reached"], true);
    has!(free, {"collisions": []});
    // Without collision options the result has no collision fields.
    let panda = model("franka_panda.urdf");
    let plain = answer!("solve {panda} --base base --target {POSE}");
    assert_eq!(plain.get("collisions"), None);
    // Target inside the table.
    let inside = with("flange=0.6,0,0.18,0,1,0,0", "");
    assert_eq!(inside["reached"], false);
    let pairs = list(&inside["collisions"]);
    assert!(
        pairs
            .iter()
            .any(|pair| pair["second"] == "table" && pair["second_kind"] == "obstacle"),
        "{pairs:?}"
    );
    assert!(pairs.iter().all(|pair| pair["on_the_way"] == false));
    assert!(number(&pairs[0]["distance"]) < 0.0);
    // The pose is reachable, but only in collision. A target out of reach is not.
    assert_eq!(inside["goals_reached"], true);
    let unreachable = with("flange=3,0,0.18,0,1,0,0", "");
    has!(unreachable, {"reached": false, "goals_reached": false});
    let text = inside["explanation"].as_str().unwrap();
    says!(text => "`table`");
    // No configuration has this margin.
    let wide = with(POSE, "--margin 0.4");
    assert_eq!(wide["reached"], false);
}

#[test]
fn body_solution_is_free_or_names_collisions() {
    let folder = Folder::new("bodies-among-obstacles");
    let world = r#"{"boxes": [{"name": "board", "size": [0.2, 0.3, 0.2], "position": [0.3, 0.11, -0.11]}]}"#;
    let (nao, world) = (
        model("aldebaran_nao.urdf"),
        folder.text("world.json", world),
    );
    let body = "--base-joint free --hold left_sole --hold right_sole --start bent";
    let ask =
        |target: &str| answer!("solve {nao} {body} --target left_hand={target} --world {world}");
    // Targets above and inside the board.
    let above = ask("0.2,0.11,0.05");
    has!(above, {"reached": true, "collisions": []});
    let inside = ask("0.23,0.11,-0.05");
    // The target is reachable, but only in collision.
    has!(inside, {"reached": false, "goals_reached": true});
    let pairs = list(&inside["collisions"]);
    assert!(
        pairs.iter().any(|pair| pair["second"] == "board"),
        "{pairs:?}"
    );
    assert!(number(&pairs[0]["distance"]) < 0.0);
    let text = inside["explanation"].as_str().unwrap();
    says!(text => "all required tasks are met | `board`");
    assert!(!text.ends_with('\n'));
    let unreachable = ask("3,0,1");
    has!(unreachable, {"reached": false, "goals_reached": false});
    // Allowed collisions with the board are ignored.
    let names = pairs.iter().filter(|pair| pair["second"] == "board");
    let may: Vec<String> = names
        .map(|pair| format!(r#"["{}","board"]"#, pair["first"].as_str().unwrap()))
        .collect();
    let may = format!("@collisions.allow_collision=[{}]", may.join(","));
    let through =
        answer!("solve {nao} {body} --target left_hand=0.23,0.11,-0.05 --world {world} {may}");
    assert!(
        list(&through["collisions"])
            .iter()
            .all(|pair| pair["second"] != "board")
            || through["reached"] == true,
        "{through}"
    );
}

#[test]
fn allowed_pairs_are_ignored_by_every_subcommand() {
    let (panda, folder) = (model("franka_panda.urdf"), Folder::new("allow-collision"));
    let table = model("worlds/table.json");
    let inside = "flange=0.6,0,0.18,0,1,0,0";
    let pairs = with(inside, "");
    let pairs = list(&pairs["collisions"]);
    let links = [
        "hand",
        "finger_left",
        "finger_right",
        "link7",
        "link6",
        "link5",
    ];
    let may: Vec<String> = links.map(|link| format!(r#"["{link}","table"]"#)).to_vec();
    let may = format!("@collisions.allow_collision=[{}]", may.join(","));
    assert!(pairs.iter().any(|pair| pair["second"] == "table"));
    has!(with(inside, &may), {"reached": true, "collisions": []});
    let ask = format!("solve {panda} --base base --target {inside} --world {table}");
    let allow = "@collisions.allow_collision=";
    refused!(r#"{ask} {allow}[["hand","tabel"]]"# => 2, "allow_collision | table");
    refused!(r#"{ask} {allow}[["hnad","table"]]"# => 1, "did you mean `hand`?");
    refused!(r#"{ask} {allow}[["table"]]"# => 1, "collisions | length 1");
    refused!(r#"check {panda} {allow}[["hand","table"]]"# => 2, "allow_collision | table");
    // The base is inside the floor.
    let floor = folder.text(
        "floor.json",
        r#"{"planes": [{"name": "floor", "position": [0, 0, 0.05]}]}"#,
    );
    let floor_world = folder.text(
        "kept.json",
        r#"{"planes": [{"name": "floor", "position": [0, 0, 0.05], "may_touch": ["base"]}]}"#,
    );
    let q = "--q 0,-0.8,0,-2.4,0,1.6,0.8,0.04,0.04";
    let touching = kinopt!("check {panda} {q} --world {floor}");
    assert_eq!(touching.status.code(), Some(1));
    says!(stderr(&touching) => "1 pair is in contact");
    for world in [
        format!(r#"{floor} @collisions.allow_collision=[["floor","base"]]"#),
        floor_world,
    ] {
        has!(answer!("check {panda} {q} --world {world}"), {"free": true});
    }
}

#[test]
fn world_needs_a_model_with_shapes() {
    let table = model("worlds/table.json");
    let panda = model("franka_panda.urdf");
    let folder = Folder::new("world-without-skin");
    let bones = folder.changed("bones.json", |rig| (rig.mesh, rig.weights) = (None, None));
    refused!("solve {bones} --target bone/4=0,1,0 --world {table}" => 2, "--world is for robots");
    refused!("solve {panda} --target {POSE} --margin -1" => 2, "--margin | `-1` is below 0");
    refused!("solve {panda} --base base --target {POSE} --world {table}.gone" => 1, "table.json.gone");
}

#[test]
fn sphere_model_file_changes_no_result() {
    let folder = Folder::new("spheres-of-a-file");
    let table = model("worlds/table.json");
    let panda = model("franka_panda.urdf");
    let out = folder.file("panda.yml");
    answer!("spheres {panda} --max-protrusion 0.04 --samples 0 --out {out}");
    let text = std::fs::read_to_string(&out).unwrap();
    // Spheres of one size leave parts of the shapes uncovered.
    let small = text.lines().map(|line| match line.split_once("radius") {
        Some((before, _)) => format!(
            "{before}radius: 0.02{}\n",
            if line.ends_with('}') { "}" } else { "" }
        ),
        None => format!("{line}\n"),
    });
    let small = folder.text("small.yml", small.collect::<String>());
    for (file, note) in [(&out, false), (&small, true)] {
        let free = with(POSE, &format!("@collisions.sphere_model={file}"));
        assert_eq!(free["reached"], true);
        let inside = with(
            "flange=0.6,0,0.18,0,1,0,0",
            &format!("@collisions.sphere_model={file}"),
        );
        has!(inside, {"reached": false, "goals_reached": true});
        let output = kinopt!(
            "solve {panda} --base base --target {POSE} --world {table} @collisions.sphere_model={file}"
        );
        let messages = stderr(&output);
        assert_eq!(
            messages.contains("of the shapes uncovered"),
            note,
            "{messages}"
        );
    }
    let humanoid = model("humanoid/humanoid.json");
    refused!("solve {humanoid} --target left_hand=0.3,0.4,1.5 @collisions.sphere_model={out}" => 2, "`sphere_model` is for robots");
    refused!("solve {panda} --base base --target {POSE} @collisions.sphere_model={out}.gone" => 1, "panda.yml.gone");
}

#[test]
fn world_repairs_are_reported() {
    let folder = Folder::new("mended-world");
    let sheet = r#"{"meshes": [{"name": "sheet", "vertices": [[0.6, 0, 0.1], [0.7, 0, 0.1], [0.6, 0.1, 0.1]], "triangles": [[0, 1, 2]]}]}"#;
    let (panda, world) = (model("franka_panda.urdf"), folder.text("world.json", sheet));
    let ask = format!("{panda} --world {world}");
    for line in [
        "solve {} --base base --target flange=0.45,0.05,0.42,0,1,0,0",
        "check {}",
    ] {
        let run = kinopt!("{}", line.replace("{}", &ask));
        assert!(
            stderr(&run).contains("obstacle \"sheet\": "),
            "{line}: {}",
            stderr(&run)
        );
    }
}
