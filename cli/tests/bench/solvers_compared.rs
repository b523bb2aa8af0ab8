//! Promise: `kinopt bench` compares solvers on a robot or a rig. Its result files can be read again, and an
//! interruption keeps the finished runs.

use crate::forked_rig::*;
use serde_json::{Value, json};

fn results(folder: &Folder) -> Value {
    let text = std::fs::read_to_string(folder.file("out/results.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

const TWO_SOLVERS: &str = "--solver 'kinopt default' --solver 'argmin L-BFGS'";

#[test]
fn bench_runs_on_a_robot_with_default_tip() {
    let folder = Folder::new("bench-robot");
    let (file, out) = (model("franka_panda.urdf"), folder.file("out"));
    let limits = "--problems random:3 --bones 8 --time-limit 60000";
    let document = answer!("bench {file} --out {out} {limits} {TWO_SOLVERS}");
    has!(document, {"problems": 3, "interrupted": false});
    let runs = list(&document["runs"]);
    let names: Vec<_> = runs.iter().map(|run| word(&run["jacobian"])).collect();
    let routes = ["analytic", "dual", "fd", "central"];
    assert_eq!(names, [routes, routes].concat());

    let results = results(&folder);
    // The tool is farther from the base than the prismatic fingers.
    has!(results["model"], {"frames": ["tool"], "turns": true});
    for key in ["tool", "date"] {
        assert!(!word(&results["provenance"][key]).is_empty());
    }
    assert_eq!(list(&results["jacobian_cost"][0]["points"]).len(), 4);
    let records = list(&results["runs"][0]["records"]);
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
fn bench_runs_on_a_rig_with_pinned_tips() {
    let folder = Folder::new("bench-rig");
    let (file, out) = (folder.rig(), folder.file("out"));
    let limits = "--problems random:2 --bones 0 --solver 'SIMD solver'";
    let document = answer!("bench {file} --out {out} {limits} {TWO_SOLVERS}");
    let mut runs = list(&document["runs"]).iter();
    let lanes = runs.find(|run| run["solver"] == "SIMD solver").unwrap();
    says!(word(&lanes["sat_out"]) => "one frame");
    let frames = ["bone/2/tip", "bone/4/tip"];
    has!(results(&folder)["model"], {"frames": frames, "turns": false});
}

#[test]
fn bench_runs_on_targets_of_a_file() {
    let folder = Folder::new("bench-file");
    let (file, out) = (model("universal_ur5e.urdf"), folder.file("out"));
    // Pose of the flange at a configuration, by `fk`.
    let placed = answer!("fk {file} --q=0.3,-1,1.2,-0.4,0.6,0.2");
    let flange = &placed["frames"]["flange"];
    let pose = ["position", "quaternion"]
        .map(|key| numbers(&flange[key]))
        .concat();
    let starts = [[0.2, -0.9, 1.1, -0.3, 0.5, 0.1]];
    let content = json!({"targets": [pose], "tip_link": "flange", "starts": starts});
    let targets = folder.text("targets.json", content);
    let one = "--bones 0 --solver levenberg-marquardt";
    let document = answer!("bench {file} --out {out} --targets {targets} {one}");
    assert_eq!(document["problems"], 1);
    let record = &results(&folder)["runs"][0]["records"][0];
    has!(record, {"solved": true, "attempts": 1});
}

#[cfg(unix)]
#[test]
fn interrupted_bench_keeps_finished_results() {
    use std::process::{Command, Stdio};

    let folder = Folder::new("bench-interrupt");
    let (file, out) = (model("universal_ur5e.urdf"), folder.file("out"));
    let line = format!("bench {file} --out {out} --problems random:5000 --position-only --json");
    let mut child = Command::new(env!("CARGO_BIN_EXE_kinopt"))
        .args(line.split(' '))
        .args(["--solver", "levenberg-marquardt"])
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
    let killed = Command::new("kill").args(["-INT", &id]).status().unwrap();
    assert!(killed.success());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    says!(stderr(&output) => "interrupted");
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["interrupted"], true);

    let results = results(&folder);
    let done = count(&results["problems"]);
    assert!(0 < done && done < 5000);
    assert_eq!(results["setting"]["problems"], 5000);
    for run in list(&results["runs"]) {
        assert_eq!(list(&run["records"]).len() as u64, done);
    }
    for file in ["out/results.md", "out/solved-over-time.svg"] {
        assert!(std::fs::metadata(folder.file(file)).unwrap().len() > 0);
    }
}

/// Runs `bench` on models outside the repository, which have no licence for distribution. `KINOPT_SHARED` names the
/// folder with their subfolders `robots/` and `rigs/`.
#[test]
#[allow(clippy::print_stderr)] // To say that nothing was tested.
fn bench_runs_on_external_models() {
    let Some(shared) = std::env::var_os("KINOPT_SHARED") else {
        eprintln!("SKIPPED: KINOPT_SHARED is not set, so no models of others were read");
        return;
    };
    let shared = std::path::Path::new(&shared);
    for model in ["robots/ur5.urdf", "rigs/ikea-lamp.json"] {
        let folder = Folder::new(&format!("bench-others-{}", model.len()));
        let file = shared.join(model).display().to_string();
        let out = folder.file("out");
        let limits = "--bones 0 --problems random:3 --time-limit 60000";
        let solvers = "--solver 'kinopt default' --solver 'SIMD solver'";
        let document = answer!("bench {file} --out {out} {limits} {solvers}");
        for run in list(&document["runs"]) {
            assert_eq!(run["solved"], 3, "{model}: {run}");
        }
    }
}

#[test]
fn wrong_usage_is_named() {
    let folder = Folder::new("bench-usage");
    let (file, out) = (model("universal_ur5e.urdf"), folder.file("out"));
    refused!("bench {file} --out {out} --problems 12" => 2, "random:N");
    refused!("bench {file} --out {out} --solver newton" => 2, "levenberg-marquardt");
    refused!("bench {file} --out {out} --charted 100" => 2, "100 problems");
    refused!("bench {file} --out {out} --tolerance 0" => 2, "above 0");
    refused!("bench {file} --out {out} --tip hand" => 1, "flange");
}
