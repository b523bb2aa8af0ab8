//! Promise: `skin-report` says what each way to skin keeps of a twisted tube, as a table, as JSON and
//! as a picture: linear blend loses what theory says, dual quaternions next to nothing.

use crate::forked_rig::{json, kinopt, says, stderr, stdout};

#[test]
fn volumes_follow_theory() {
    let report = json(&["skin-report", "--json"]);
    let rows = report["twists"].as_array().unwrap();
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let degrees: Vec<f64> = rows.iter().map(|row| number(&row["degrees"])).collect();
    assert_eq!(degrees, [0.0, 45.0, 90.0, 135.0, 180.0]);
    let blended = number(&report["blended_share"]);
    for row in rows {
        let twist = number(&row["degrees"]).to_radians();
        // A ring of weight w keeps the share 1 − 2 w (1 − w)(1 − cos φ) of its area.
        let expected = 1.0 - blended * (1.0 - twist.cos()) / 3.0;
        assert!((number(&row["lbs"]["volume"]) - expected).abs() < 2e-3);
        assert!((number(&row["lbs"]["waist"]) - (twist / 2.0).cos()).abs() < 1e-5);
        assert!((number(&row["dqs"]["volume"]) - 1.0).abs() < 5e-3);
        assert!((number(&row["dqs"]["waist"]) - 1.0).abs() < 1e-5);
    }
}

#[test]
fn the_table_has_a_row_per_twist() {
    let output = kinopt(&["skin-report", "--twists=-30,60"]);
    let lines: Vec<&str> = stdout(&output).lines().collect();
    assert_eq!(lines.len(), 3, "{}", stdout(&output));
    assert!(lines[0].contains("twist, °") && lines[1].contains("-30.000"));
}

#[cfg(feature = "charts")]
#[test]
fn the_picture_shows_both() {
    use crate::forked_rig::Folder;
    let folder = Folder::new("twist");
    let file = folder.file("twist.svg");
    let output = kinopt(&["skin-report", "--out", &file]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let svg = std::fs::read_to_string(&file).unwrap();
    for text in ["<svg", "volume, %", "lbs", "dqs", "180 degrees"] {
        assert!(svg.contains(text), "no {text}");
    }
}

#[test]
fn wrong_usage_is_refused() {
    for (arguments, word) in [
        (["--twists", "0,190"], "190"),
        (["--twists", "a"], "`a`"),
        (["--twists", ","], "at least one"),
        (["--out", "twist.png"], ".svg"),
    ] {
        let output = kinopt(&["skin-report", arguments[0], arguments[1]]);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        says(stderr(&output), word);
    }
}
