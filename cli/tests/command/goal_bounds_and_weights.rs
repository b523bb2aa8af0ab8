//! Promise: goal bounds of single axes, frame weights and joint weights have their documented effect.
//! `--fail-on-miss` sets the exit code.

use crate::forked_rig::*;
use crate::seeded_robot::{Seeded, seven, typed};
use kinopt::spatial::{Matrix3, Placement, Vector3};

/// Placement of the tool in target coordinates.
fn in_target(panda: &Seeded, q: &[f64], target: &Placement<f64>) -> Placement<f64> {
    target.inverse() * panda.base_from("tool", q)
}

#[test]
fn goal_bounds_of_an_arm_are_used() {
    let panda = Seeded::panda();
    let q = panda.configuration(11);
    let expected = panda.base_from("tool", &q);
    let start = commas(&q);
    // An offset of 2 cm along the target's x is within the bounds; −3 cm is not.
    for (offset, within) in [(0.02, true), (-0.03, false)] {
        let shifted = expected * Placement::translation(Vector3::new(-offset, 0.0, 0.0));
        let target = typed("tool", &seven(&shifted));
        let solution = answer!("solve {panda} {target} --start={start} --interval=x=-0.01..0.03");
        assert_eq!(solution["reached"], true);
        let apart = in_target(&panda, &numbers(&solution["q"]), &shifted);
        let x = apart.translation.x;
        assert!((-0.01 - 2e-6..=0.03 + 2e-6).contains(&x), "{x}");
        assert!(apart.translation.y.abs() < 2e-6 && apart.translation.z.abs() < 2e-6);
        assert_eq!((x - offset).abs() < 1e-5, within, "{x}");
    }
    // Rotation bounds, in degrees.
    let target = typed("tool", &panda.pose(&q));
    let apart = |bounds: &str| {
        let solution = answer!("solve {panda} {target} --interval={bounds}");
        assert_eq!(solution["reached"], true);
        in_target(&panda, &numbers(&solution["q"]), &expected)
    };
    let free = apart("rz=free,y=0.02");
    assert!((free.rotation.z.z - 1.0).abs() < 1e-9);
    assert!(free.translation.y.abs() < 0.02 + 2e-6);
    let Matrix3 { x, y, .. } = apart("rx=10 --degrees").rotation;
    assert!(x.x > 1.0 - 1e-9 && y.z.abs() < 10.1_f64.to_radians().sin());
    refused!("solve {panda} {target} --interval=w=1" => 2, "rx, ry, rz");
    refused!("solve {panda} {target} --interval=rz=0..1" => 2, "symmetric");
    refused!("solve {panda} {target} --interval=x=2..1" => 2, "above the upper end");
    let point = "--target=tool=0.4,0,0.5";
    refused!("solve {panda} {point} --interval=rz=1" => 2, "orientation");
}

/// Goal bounds of figures, and of robots with a general solver.
#[test]
fn goal_bounds_of_other_models_are_used() {
    let (_folder, rig) = Folder::with_rig("room");
    // The tip of the stretched arm is at x = −3. No configuration has this rotation about the bone's axis there.
    let turned = "--target=bone/2=-3,0,0,0,0,0.997495,0.070737";
    for solver in ["", "@solve.solver=levenberg-marquardt"] {
        let solution = |line: &str| answer!("solve {rig} {line} {solver}");
        for (line, reached) in [
            ("--target=bone/2=-3.1,0,0", false),
            ("--target=bone/2=-3.1,0,0 --interval=x=0..0.2", true),
            ("--target=bone/2=-3.1,0,0 --interval=x=-0.2..0", false),
            (turned, false),
            (&format!("{turned} --interval=rx=free"), true),
            (&format!("{turned} --interval=rx=free"), true),
            (&format!("{turned} --interval=ry=free"), false),
        ] {
            assert_eq!(solution(line)["reached"], reached, "{line} {solver}");
        }
    }
    // Bounds apply to every target; rotation bounds to those with an orientation.
    let two = format!("{turned} --target=bone/4=3.1,0,0");
    for (bounds, reached) in [
        ("", [false, false]),
        ("--interval=x=-0.2..0.2", [false, true]),
        ("--interval=rx=free", [true, false]),
        ("--interval=rx=free --interval=x=-0.2..0.2", [true, true]),
    ] {
        let solution = answer!("solve {rig} {two} {bounds}");
        let tasks = [0, 1].map(|task| solution["tasks"][task]["reached"] == true);
        assert_eq!(tasks, reached, "{bounds}");
    }
    let points = "--target=bone/2=-2.5,0.5,0 --target=bone/4=2.5,0.5,0";
    refused!("solve {rig} {points} --interval=rz=1" => 2, "orientation");
    let ray = "--ray=bone/2=0,0,5:1,0,0";
    refused!("body {rig} {ray} @goal.interval=[\"x=1\"]" => 2, "--interval | there are none");
    refused!("solve {rig} --target=bone/2=-3,0,0 --interval=rx=free" => 2, "orientation");

    let panda = Seeded::panda();
    let q = panda.configuration(11);
    let target = typed("tool", &panda.pose(&q));
    let solver = "@solve.solver=levenberg-marquardt";
    let solution = answer!("solve {panda} {target} {solver} --interval=rz=free,y=0.01..0.02");
    assert_eq!(solution["reached"], true);
    let expected = panda.base_from("tool", &q);
    let apart = in_target(&panda, &numbers(&solution["q"]), &expected);
    assert!((0.01 - 2e-6..=0.02 + 2e-6).contains(&apart.translation.y));
    assert!((apart.rotation.z.z - 1.0).abs() < 1e-9);
}

#[test]
fn task_weights_balance_conflicting_targets() {
    let (_folder, rig) = Folder::with_rig("weights");
    // Two conflicting targets of one arm. The weights decide the compromise.
    let ask = |weight: &str| {
        let targets = "--target=bone/2=-2.5,0.5,0 --target=bone/1=-1.5,-0.8,0";
        let solution = answer!("body {rig} {targets} {weight}");
        [0, 1].map(|task| number(&solution["tasks"][task]["position_error"]))
    };
    let even = ask("");
    let (hand, elbow) = (ask("--weight=bone/2=20"), ask("--weight=bone/1=20"));
    assert!(even[0] > 1e-3 && even[1] > 1e-3, "{even:?}");
    let less = hand[0] < 0.5 * even[0] && elbow[1] < 0.5 * even[1];
    assert!(less, "{even:?} {hand:?} {elbow:?}");
    let hand = "--target=bone/2=-2.5,0.5,0 --weight=bone/2";
    refused!("body {rig} {hand}=1 --weight=bone/3=2" => 1, "`bone/3`");
    refused!("body {rig} {hand}=0" => 2, "not above 0");
    refused!("body {rig} {hand}=1 --weight=bone/2=2" => 2, "given twice");
}

#[test]
fn joint_weights_select_the_nearest_solution() {
    let panda = Seeded::panda();
    let q = panda.configuration(11);
    let target = typed("tool", &panda.pose(&q));
    let moved = |weights: &str| {
        let solution =
            answer!("solve {panda} {target} --search=nearest @solve.joint_weights=[{weights}]");
        assert_eq!(solution["reached"], true);
        let start = answer!("solve {panda} {target} --max-move=0");
        (number(&solution["q"][0]) - number(&start["q"][0])).abs()
    };
    let (even, heavy) = (moved("1"), moved("100,1,1,1,1,1,1"));
    assert!(heavy < even, "{heavy} {even}");
    refused!("solve {panda} {target} @solve.joint_weights=[1,2]" => 2, "joint_weights");
    // The unit weight decides between position and orientation error of an unreachable pose.
    let unreachable = "--target=tool=1.5,0,0.5,1,0,0,0";
    let angle = |metres: f64| {
        let solution = answer!("solve {panda} {unreachable} @solve.metres_per_radian={metres}");
        number(&solution["tasks"][0]["orientation_error"])
    };
    assert!(angle(10.0) < angle(0.01));
}

#[test]
fn fail_on_miss_sets_the_exit_code() {
    let scara = Seeded::new("adept_cobra_s600", "base", "flange");
    let folder = Folder::new("misses");
    let content = r#"{"targets": [[2, 0, 0.2], [0.4, 0.1, 0.2]], "tip_link": "flange"}"#;
    let targets = folder.text("targets.json", content);
    let unreachable = "--target=flange=2,0,0.2";
    let near = "--target=flange=0.4,0.1,0.2";
    for (line, code, message) in [
        (format!("solve {scara} {unreachable}"), 0, ""),
        (
            format!("solve {scara} {unreachable} --fail-on-miss"),
            3,
            "target was not reached",
        ),
        (format!("solve {scara} {near} --fail-on-miss"), 0, ""),
        (format!("batch {scara} --targets {targets}"), 0, ""),
        (
            format!("batch {scara} --targets {targets} --fail-on-miss"),
            3,
            "1 of 2",
        ),
    ] {
        for format in ["", "--json"] {
            let output = kinopt!("{line} {format}");
            let messages = stderr(&output);
            assert_eq!(output.status.code(), Some(code), "{line}: {messages}");
            // The result is printed in any case.
            assert!(!stdout(&output).is_empty());
            says!(messages => message);
        }
    }
}

/// The weight of a held frame decides how far a conflicting target moves it.
#[test]
fn held_frames_have_a_weight() {
    let panda = Seeded::panda();
    let slips = [0.1, 1.0, 10.0].map(|weight| {
        let held = format!("@body.no_priorities=true --hold=link5 --weight=link5={weight}");
        let solution = answer!("body {panda} --target=tool=0.7,0.4,0.9 {held}");
        number(&solution["tasks"][1]["position_error"])
    });
    assert!(
        slips[0] > 1.5 * slips[1] && slips[1] > 10.0 * slips[2],
        "{slips:?}"
    );
}
