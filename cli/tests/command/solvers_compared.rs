//! Promise: `kinopt bench` compares solvers on a robot or a rig, writes results that can be read
//! again, and keeps what is done when it is interrupted.

use crate::forked_rig::{Folder, json, kinopt, stderr};
use serde_json::{Value, json};

fn model(name: &str) -> String {
    format!("{}/../models/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn results(folder: &Folder) -> Value {
    let text = std::fs::read_to_string(folder.file("out/results.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

const TWO: [&str; 4] = ["--solver", "kinopt default", "--solver", "argmin L-BFGS"];

#[test]
fn a_robot_and_its_default_tip() {
    let folder = Folder::new("bench-robot");
    let (file, out) = (model("franka_panda.urdf"), folder.file("out"));
    let mut arguments = vec!["bench", &file, "--out", &out, "--json"];
    arguments.extend([
        "--problems",
        "random:3",
        "--bones",
        "8",
        "--time-limit",
        "60000",
    ]);
    arguments.extend(TWO);
    let document = json(&arguments);
    assert_eq!(document["problems"], 3);
    assert_eq!(document["interrupted"], false);
    let runs = document["runs"].as_array().unwrap();
    let names: Vec<_> = runs
        .iter()
        .map(|run| run["jacobian"].as_str().unwrap())
        .collect();
    let routes = ["analytic", "dual", "fd", "central"];
    assert_eq!(names, [routes, routes].concat());

    let results = results(&folder);
    // The tool is farther out than the fingers that slide beside it.
    assert_eq!(results["model"]["frames"], json!(["tool"]));
    assert_eq!(results["model"]["turns"], true);
    for key in ["tool", "date"] {
        assert!(!results["provenance"][key].as_str().unwrap().is_empty());
    }
    assert_eq!(
        results["jacobian_cost"][0]["points"]
            .as_array()
            .unwrap()
            .len(),
        4
    );
    let records = results["runs"][0]["records"].as_array().unwrap();
    assert!(records.iter().all(|record| record["solved"] == true));

    let table = std::fs::read_to_string(folder.file("out/results.md")).unwrap();
    for picture in [
        "solved-over-time",
        "profile",
        "routes",
        "course",
        "jacobian",
    ] {
        let file = format!("{picture}.svg");
        assert!(table.contains(&file));
        let svg = std::fs::read_to_string(folder.file(&format!("out/{file}"))).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("time") || picture == "course");
    }
}

#[test]
fn a_rig_and_its_pinned_tips() {
    let folder = Folder::new("bench-rig");
    let (file, out) = (folder.rig(), folder.file("out"));
    let mut arguments = vec!["bench", &file, "--out", &out, "--json"];
    arguments.extend([
        "--problems",
        "random:2",
        "--bones",
        "0",
        "--solver",
        "lane engine",
    ]);
    arguments.extend(TWO);
    let document = json(&arguments);
    let lanes = document["runs"].as_array().unwrap().iter();
    let lanes = lanes
        .into_iter()
        .find(|run| run["solver"] == "lane engine")
        .unwrap();
    assert!(lanes["sat_out"].as_str().unwrap().contains("one frame"));
    let results = results(&folder);
    assert_eq!(
        results["model"]["frames"],
        json!(["bone/2/tip", "bone/4/tip"])
    );
    assert_eq!(results["model"]["turns"], false);
}

#[test]
fn targets_of_a_file() {
    let folder = Folder::new("bench-file");
    let (file, out) = (model("universal_ur5e.urdf"), folder.file("out"));
    // Where the flange stands at a configuration that `fk` tells.
    let placed = json(&["fk", &file, "--q=0.3,-1,1.2,-0.4,0.6,0.2", "--json"]);
    let flange = &placed["frames"]["flange"];
    let numbers = ["position", "quaternion"].map(|key| flange[key].as_array().unwrap().clone());
    let targets = folder.file("targets.json");
    let written = json!({
        "targets": [numbers.concat()],
        "tip_link": "flange",
        "starts": [[0.2, -0.9, 1.1, -0.3, 0.5, 0.1]],
    });
    std::fs::write(&targets, written.to_string()).unwrap();
    let mut arguments = vec![
        "bench",
        &file,
        "--out",
        &out,
        "--json",
        "--targets",
        &targets,
    ];
    arguments.extend(["--bones", "0", "--solver", "levenberg-marquardt"]);
    let document = json(&arguments);
    assert_eq!(document["problems"], 1);
    let record = &results(&folder)["runs"][0]["records"][0];
    assert_eq!(record["solved"], true);
    assert_eq!(record["attempts"], 1);
}

#[cfg(unix)]
#[test]
fn an_interrupt_keeps_what_is_done() {
    use std::process::{Command, Stdio};

    let folder = Folder::new("bench-interrupt");
    let (file, out) = (model("universal_ur5e.urdf"), folder.file("out"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_kinopt"))
        .args([
            "bench",
            &file,
            "--out",
            &out,
            "--problems",
            "random:5000",
            "--position-only",
        ])
        .args(["--solver", "levenberg-marquardt", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_secs(4));
    assert!(
        child.try_wait().unwrap().is_none(),
        "so many problems take longer"
    );
    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert!(stderr(&output).contains("interrupted"));
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["interrupted"], true);

    let results = results(&folder);
    let done = results["problems"].as_u64().unwrap();
    assert!(0 < done && done < 5000);
    assert_eq!(results["setting"]["problems"], 5000);
    for run in results["runs"].as_array().unwrap() {
        assert_eq!(run["records"].as_array().unwrap().len() as u64, done);
    }
    for file in ["results.md", "solved-over-time.svg"] {
        assert!(
            std::fs::metadata(folder.file(&format!("out/{file}")))
                .unwrap()
                .len()
                > 0
        );
    }
}

/// Models that this project has never seen carry no licence, so they are not shipped: set
/// `KINOPT_SHARED` to the folder that has them under `robots/` and `rigs/`.
#[test]
#[allow(clippy::print_stderr)] // To say that nothing was tested.
fn models_of_others() {
    let Some(shared) = std::env::var_os("KINOPT_SHARED") else {
        eprintln!("SKIPPED: KINOPT_SHARED is not set, so no models of others were read");
        return;
    };
    let shared = std::path::Path::new(&shared);
    for model in ["robots/ur5.urdf", "rigs/ikea-lamp.json"] {
        let folder = Folder::new(&format!("bench-others-{}", model.len()));
        let file = shared.join(model).display().to_string();
        let out = folder.file("out");
        let mut arguments = vec!["bench", &file, "--out", &out, "--json", "--bones", "0"];
        arguments.extend(["--problems", "random:3", "--time-limit", "60000"]);
        arguments.extend(["--solver", "kinopt default", "--solver", "lane engine"]);
        let document = json(&arguments);
        for run in document["runs"].as_array().unwrap() {
            assert_eq!(run["solved"], 3, "{model}: {run}");
        }
    }
}

#[test]
fn wrong_usage_is_named() {
    let folder = Folder::new("bench-usage");
    let (file, out) = (model("universal_ur5e.urdf"), folder.file("out"));
    for (wrong, reason) in [
        (["--problems", "12"], "random:N"),
        (["--solver", "newton"], "levenberg-marquardt"),
        (["--problem", "100"], "100 problems"),
        (["--tolerance", "0"], "above 0"),
    ] {
        let output = kinopt(&["bench", &file, "--out", &out, wrong[0], wrong[1]]);
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
        assert!(stderr(&output).contains(reason), "{}", stderr(&output));
    }
    let output = kinopt(&["bench", &file, "--out", &out, "--tip", "hand"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("flange"));
}
