//! Promise: `skin-report` compares skinning methods on a twisted tube, as a table, as JSON and as a picture. Linear
//! blend skinning loses the predicted area; dual quaternions lose almost none.

use crate::forked_rig::*;

#[test]
fn volumes_equal_theory() {
    let report = answer!("skin-report");
    let rows = list(&report["twists"]);
    let degrees: Vec<f64> = rows.iter().map(|row| number(&row["degrees"])).collect();
    assert_eq!(degrees, [0.0, 45.0, 90.0, 135.0, 180.0]);
    let blended = number(&report["blended_share"]);
    for row in rows {
        let twist = number(&row["degrees"]).to_radians();
        // A ring of weight w keeps the fraction 1 − 2 w (1 − w)(1 − cos φ) of its area.
        let expected = 1.0 - blended * (1.0 - twist.cos()) / 3.0;
        assert!((number(&row["lbs"]["volume"]) - expected).abs() < 2e-3);
        assert!((number(&row["lbs"]["waist"]) - (twist / 2.0).cos()).abs() < 1e-5);
        assert!((number(&row["dqs"]["volume"]) - 1.0).abs() < 5e-3);
        assert!((number(&row["dqs"]["waist"]) - 1.0).abs() < 1e-5);
    }
}

#[test]
fn table_has_a_row_per_twist() {
    let text = text!("skin-report --twists=-30,60");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 3, "{text}");
    assert!(lines[0].contains("twist, °") && lines[1].contains("-30.000"));
}

#[test]
fn wrong_usage_is_rejected() {
    refused!("skin-report --twists 0,190" => 2, "190");
    refused!("skin-report --twists a" => 2, "`a`");
    refused!("skin-report --twists ," => 2, "at least one");
    refused!("skin-report --out twist.png" => 2, ".svg");
}
