//! Promise: --derivative returns the sensitivity of a solution to its targets, from the arm and the general solvers.
//! It equals the difference of a repeated solve.

use crate::forked_rig::*;
use serde_json::Value;

const UR5E: &str = "../models/universal_ur5e.urdf";

fn by_target(answer: &Value, frame: &str) -> Vec<Vec<f64>> {
    let rows = list(&answer["derivative"]["by_target"][frame]).iter();
    rows.map(numbers).collect()
}

/// The target is rotated by half a turn about x, so its y and z axes are reversed.
#[test]
fn derivative_predicts_the_moved_solution() {
    let solve = |x: f64, z: f64, more: &str| {
        answer!("solve {UR5E} --target flange={x},0.2,{z},0,1,0,0 --tolerance 1e-12 {more}")
    };
    let solution = solve(0.4, 0.5, "@output.derivative=true");
    assert_eq!(solution["derivative"]["differentiability"], "unique");
    assert_eq!(solution["derivative"]["velocity"], solution["joints"]);
    let q = numbers(&solution["q"]);
    let start = q.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let start = format!("--start {start}");
    let by_target_rows = by_target(&solution, "flange");
    for (column, along, sign) in [(0, [1.0, 0.0], 1.0), (2, [0.0, 1.0], -1.0)] {
        let step = 1e-4;
        let [ahead, behind] = [step, -step].map(|step| {
            let moved = solve(0.4 + step * along[0], 0.5 + step * along[1], &start);
            numbers(&moved["q"])
        });
        for (joint, row) in by_target_rows.iter().enumerate() {
            let seen = sign * (ahead[joint] - behind[joint]) / (2.0 * step);
            assert!((row[column] - seen).abs() < 1e-5, "{joint}: {row:?} {seen}");
        }
    }
    let general = solve(
        0.4,
        0.5,
        &format!("{start} @output.derivative=true @solve.max_iterations=50"),
    );
    for (row, expected) in by_target(&general, "flange").iter().zip(&by_target_rows) {
        assert!(distance(row, expected) < 1e-6, "{row:?} {expected:?}");
    }
    let text = text!("solve {UR5E} --target flange=0.4,0.2,0.5,0,1,0,0 @output.derivative=true");
    says!(text => "Derivative by the target: the solution is differentiable");
    says!(text => "by flange | per m along x | per rad about x");
}

#[test]
fn derivative_is_optional_and_states_its_existence() {
    let options = "--target flange=0.4,0.2,0.5";
    let answer = answer!("solve {UR5E} {options} @output.derivative=true");
    let differentiability = &answer["derivative"]["differentiability"];
    assert_eq!(differentiability, "shortest_of_many", "{answer}");
    assert!(
        answer!("solve {UR5E} {options}")
            .get("derivative")
            .is_none()
    );
}
