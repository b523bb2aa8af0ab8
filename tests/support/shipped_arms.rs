//! Arms and limbs of the shipped robots, and recorded cases in JSON.

use kinopt::spatial::{Matrix3, Placement, Vector3};
use serde_json::Value;

/// Model, base and tip of every shipped arm and limb.
pub const SHIPPED_ARMS: [[&str; 3]; 11] = [
    ["adept_cobra_s600", "base", "flange"],
    ["aldebaran_nao", "torso", "left_hand"],
    ["aldebaran_nao", "torso", "right_hand"],
    ["aldebaran_nao", "torso", "left_sole"],
    ["aldebaran_nao", "left_sole", "right_sole"],
    ["franka_panda", "base", "flange"],
    ["kuka_iiwa14", "base", "flange"],
    ["rethink_baxter", "torso", "left_tool"],
    ["rethink_baxter", "torso", "right_tool"],
    ["universal_ur10e", "base", "flange"],
    ["universal_ur5e", "base", "flange"],
];

/// Recorded cases of a file in `tests/reference`.
pub fn recorded(file: &str) -> Value {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../reference");
    let text = std::fs::read_to_string(format!("{folder}/{file}")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// Numbers of a JSON list.
pub fn numbers(list: &Value) -> Vec<f64> {
    let numbers = list.as_array().unwrap().iter();
    numbers.map(|number| number.as_f64().unwrap()).collect()
}

/// Placement of a 4 × 4 matrix in row-major order.
pub fn matrix_placement(rows: &Value) -> Placement<f64> {
    let rows: Vec<Vec<f64>> = rows.as_array().unwrap().iter().map(numbers).collect();
    let column = |k: usize| Vector3::new(rows[0][k], rows[1][k], rows[2][k]);
    let rotation = Matrix3 {
        x: column(0),
        y: column(1),
        z: column(2),
    };
    Placement::new(rotation, column(3))
}
