//! Promise: `--center-of-mass` moves a body's centre of mass to a point, and `--balance` keeps it over the support
//! polygon. Both accept robots with masses and rigs with a mesh.

use crate::forked_rig::*;
use serde_json::Value;

const LEANING_ROBOT: &str = "../tests/kinematics/leaning.urdf";

/// Centre of mass from the masses of the robot file and the placements of `fk`.
fn centre(q: &[f64]) -> [f64; 3] {
    let masses = [
        ("shank", [0.01, -0.02, 0.18], 3.2),
        ("motor", [0.0, 0.05, 0.02], 1.1),
        ("thigh", [-0.03, 0.0, 0.2], 5.5),
        ("trunk", [0.02, 0.01, 0.25], 17.25),
        ("slider", [0.1, 0.0, 0.0], 0.75),
    ];
    let placed = answer!("fk {LEANING_ROBOT} --q={}", commas(q));
    let mut sum = [0.0; 3];
    for (link, at, mass) in masses {
        let frame = &placed["frames"][link];
        let (position, turn) = (numbers(&frame["position"]), numbers(&frame["quaternion"]));
        // v + 2 w (u × v) + 2 u × (u × v)
        let u = [turn[1], turn[2], turn[3]];
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ]
        };
        let once = cross(u, at);
        let twice = cross(u, once);
        for k in 0..3 {
            let along = at[k] + 2.0 * (turn[0] * once[k] + twice[k]);
            sum[k] += mass / 27.8 * (position[k] + along);
        }
    }
    sum
}

fn task<'a>(answer: &'a Value, name: &str) -> &'a Value {
    let tasks = list(&answer["tasks"]).iter();
    tasks.clone().find(|task| task["name"] == name).unwrap()
}

#[test]
fn centre_of_mass_reaches_its_target() {
    let above = answer!("body {LEANING_ROBOT} --center-of-mass 0.05,0.12");
    assert_eq!(above["reached"], true);
    let [x, y, _] = centre(&numbers(&above["q"]));
    assert!(
        (x - 0.05).abs() < 2e-6 && (y - 0.12).abs() < 2e-6,
        "{x} {y}"
    );
    assert_eq!(task(&above, "center of mass")["reached"], true);

    let high = answer!("body {LEANING_ROBOT} --center-of-mass=-0.02,free,0.66");
    let [x, _, z] = centre(&numbers(&high["q"]));
    assert!(
        (x + 0.02).abs() < 2e-6 && (z - 0.66).abs() < 2e-6,
        "{x} {z}"
    );
    let unreachable = answer!("body {LEANING_ROBOT} --center-of-mass 3,0");
    assert_eq!(unreachable["reached"], false);
}

#[test]
fn balanced_body_stays_over_its_feet() {
    // Sole of 20 × 20 cm next to the ankle.
    let corners = [[-0.1, 0.0], [0.1, 0.0], [0.1, 0.2], [-0.1, 0.2]];
    let sole: Vec<String> = (corners.iter())
        .map(|[x, y]| format!("--balance plate={x},{y},0"))
        .collect();
    let sole = sole.join(" ");
    let reach = format!("body {LEANING_ROBOT} --target trunk=0.35,0.1,0.7 {sole}");
    let answer = answer!("{reach} --balance-margin 0.02");
    let [x, y, _] = centre(&numbers(&answer["q"]));
    // Balance is at a higher priority level than the target.
    assert_eq!(task(&answer, "balance")["reached"], true);
    assert!(x < 0.08 + 2e-6 && y < 0.18 + 2e-6, "{x} {y}");
    // A start in balance is already a solution.
    let start_balanced = answer!("body {LEANING_ROBOT} {sole}");
    assert_eq!(start_balanced["reached"], true);
    assert_eq!(numbers(&start_balanced["q"]), [0.0; 4]);
    let text = text!("body {LEANING_ROBOT} {sole}");
    says!(text => "balance");
}

#[test]
fn rig_balances_by_the_volume_of_its_mesh() {
    let rig = "../models/humanoid/humanoid.json";
    let answer = answer!("body {rig} --hold none --center-of-mass 0.05,0");
    assert_eq!(answer["reached"], true);
    let feet = "--balance left_toes --balance right_toes --balance left_foot/tail --balance right_foot/tail";
    let answer = answer!("body {rig} {feet} --target left_hand=0.4,0.3,1.1");
    assert_eq!(task(&answer, "balance")["reached"], true);
}

/// The sole link is fixed to the foot, whose box is 16 × 8 cm. The origins of both soles form a line between the
/// ankles.
#[test]
fn support_includes_all_links_fixed_to_the_feet() {
    let nao = "../models/aldebaran_nao.urdf";
    let standing_command = format!(
        "body {nao} --base-joint free --hold left_sole --hold right_sole --start bent --target left_hand=0.31,0.11,-0.12"
    );
    let robot = kinopt::robot::Robot::read(nao).unwrap();
    let robot = robot
        .with_base_joint(kinopt::robot::BaseJoint::FREE)
        .unwrap();
    let ahead = |options: &str| {
        let answer = answer!("{standing_command} {options}");
        assert_eq!(answer["reached"], true, "{options}");
        let (model, masses) = (robot.model(), robot.masses().unwrap());
        let centre = kinopt::kinematics::centre_of_mass(model, &masses, &numbers(&answer["q"]));
        centre.unwrap().x
    };
    assert!(ahead("") > 0.1);
    let soles = "--balance left_sole --balance right_sole";
    let [edge, within] = [
        ahead(soles),
        ahead(&format!("{soles} --balance-margin 0.03")),
    ];
    assert!(
        (edge - 0.1).abs() < 1e-5 && (within - 0.07).abs() < 1e-5,
        "{edge} {within}"
    );
}

#[test]
fn massless_models_and_invalid_options_are_rejected() {
    let arm = "../models/franka_panda.urdf";
    refused!("body {arm} --center-of-mass 0,0" => 1, "no centre of mass");
    refused!("body {arm} --balance link0" => 1, "no centre of mass");
    refused!("body {LEANING_ROBOT} --balance foot" => 1, "`foot` | shank");
    refused!("body {LEANING_ROBOT} --center-of-mass 1" => 2, "x,y");
    refused!("body {LEANING_ROBOT} --center-of-mass free,free,free" => 2, "free");
    refused!("body {LEANING_ROBOT} --balance plate=1,2" => 2, "the point");
    refused!("body {LEANING_ROBOT}" => 2, "nothing to solve | --target");
}
