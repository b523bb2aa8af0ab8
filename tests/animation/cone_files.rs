//! Promise: a file of cones gives the limits of bones in degrees, and the error of an invalid file names the place.

use kinopt::io::cones;
use kinopt::model::Limits;
use kinopt::spatial::Vector3;
use support::fault_tables::ExpectedError;

#[test]
fn degrees_become_radians() {
    let text = r#"{
        "whole":  {"swing": 180, "twist": [-180, 180]},
        "ellipse": {"swing": [45, 30], "about": [0, 2, 0]},
        "hinge":  {"axis": [0, 0, 1], "swing": 0.5, "twist": [0, 90]},
        "turned": {"twist": [-10, -5]},
        "whole angle": {"angle": 60}
    }"#;
    let cones = cones::from_bytes(text.as_bytes(), "cones.json").unwrap();
    let pi = std::f64::consts::PI;
    assert_eq!(cones["whole"].limits.swing, [pi; 2]);
    assert_eq!(cones["whole"].limits.twist, Limits::new(-pi, pi));
    assert_eq!(
        cones["ellipse"].limits.swing,
        [pi / 4.0, 30f64.to_radians()]
    );
    assert_eq!(
        cones["ellipse"].limits.about,
        Some(Vector3::new(0.0, 2.0, 0.0))
    );
    assert_eq!(cones["ellipse"].limits.twist, Limits::UNBOUNDED);
    assert_eq!(cones["hinge"].axis, Some(Vector3::UNITS[2]));
    assert_eq!(cones["hinge"].limits.twist, Limits::new(0.0, pi / 2.0));
    assert_eq!(
        (cones["turned"].axis, cones["turned"].limits.about),
        (None, None)
    );
    assert_eq!(cones["turned"].limits.swing, [pi; 2]);
    assert_eq!(cones["turned"].limits.angle, None);
    assert_eq!(cones["whole angle"].limits.angle, Some(60f64.to_radians()));
}

/// Files, the path of their fault, and the reason.
const FAULTS: &str = r#"
{"a": {"swing": 0}} | a.swing | 0 degrees
{"a": {"swing": 181}} | a.swing | 181 degrees
{"a": {"swing": [10, -1], "about": [1, 0, 0]}} | a.swing | -1 degrees
{"a": {"swing": [10, 20]}} | a.swing | `about`
{"a": {"swing": 10, "about": [1, 0, 0]}} | a.about | two numbers
{"a": {"swing": [10, 20], "about": [0, 0, 0]}} | a.about | no direction
{"a": {"swing": 10, "axis": [0, 0, 0]}} | a.axis | no direction
{"a": {"swing": 10, "twist": [5, -5]}} | a.twist | not a range
{"a": {"swing": 10, "twist": [-181, 0]}} | a.twist | not a range
{"a": {"swing": "wide"}} | a | degrees
{"a": {"cone": 10}} | a | unknown field `cone`
{"a": {"swing": 10, "swing": 20}} | a | duplicate field
{"a": {"swing": 10}, "a": {"swing": 20}} | a | twice
{"a": {}} | a | none of
{"a": 10} | a | expected struct
{} |  | no bone
[] |  | an object with a cone
{"a": {"swing": 10} |  | EOF
"#;

#[test]
fn errors_name_the_path() {
    for row in FAULTS.lines().filter(|row| !row.is_empty()) {
        let mut parts = row.split(" | ");
        let text = parts.next().unwrap();
        let message = cones::from_bytes(text.as_bytes(), "man.json")
            .unwrap_err()
            .to_string();
        let is_named =
            message.starts_with("man.json: ") && parts.all(|part| message.contains(part));
        assert!(is_named, "{row}: {message}");
    }
    cones::read("no such file.json").says("no such file.json");
}
