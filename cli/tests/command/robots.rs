//! Promise: a URDF robot is shown as a tree of links, placed by its joint values, and solved for one or several
//! targets within its limits.

use crate::forked_rig::*;
use crate::seeded_robot::{Seeded, seven, typed};
use serde_json::{Value, json};

#[test]
fn info_shows_the_link_tree() {
    let panda = Seeded::panda();
    let text = text!("info {panda}");
    let line = |name: &str| {
        let mut lines = text
            .lines()
            .filter(|line| line.trim_start().starts_with(name));
        let line = lines.next().unwrap();
        (line.len() - line.trim_start().len(), line)
    };
    for (name, words) in [
        ("link4 ", "joint4 | revolute | -176.001° | -3.999°"),
        ("flange ", "flange_mount | fixed"),
        ("finger_left ", "prismatic | 0.040000 m | y | 7"),
        ("finger_right ", "follows finger_left_slide | -y | 8 | m"),
    ] {
        says!(line(name).1 => words);
    }
    assert_eq!(line("link2 ").0, line("link1 ").0 + 2);
    assert_eq!(line("finger_left ").0, line("finger_right ").0);
    says!(text => "9 degrees of freedom, 8 of them free | tool, finger_left, finger_right");
    says!(text => "speed | effort | 124.618°/s | 87.000 N·m | 0.050 m/s | 70.000 N ");
    let info = answer!("info {panda}");
    has!(info, {"kind": "robot", "root": "base", "name": "franka_panda"});
    assert_eq!(info["tips"], json!(["tool", "finger_left", "finger_right"]));
    assert_eq!(info["moving_joints"][8], "finger_right_slide");
    let follower = &info["joints"][8];
    has!(follower, {"mimic/joint": "finger_left_slide", "mimic/ratio": 1.0, "free": false});
    has!(follower, {"parent_link": "hand", "child_link": "finger_right"});
    assert_eq!(follower["axis"], json!([0.0, -1.0, 0.0]));
}

#[test]
fn fk_places_links_in_any_base() {
    let panda = Seeded::panda();
    let q = panda.configuration(3);
    let given = format!("--q={}", commas(&q));
    let fk = answer!("fk {panda} {given} --frame=tool");
    assert_eq!(list(&fk["joints"]).len(), 9);
    let position = |fk: &Value| numbers(&fk["frames"]["tool"]["position"]);
    assert!(distance(&position(&fk), &panda.pose(&q)[..3]) < 1e-14);
    // The tool's offset from the hand is the file's, for any configuration.
    let fk = answer!("fk {panda} {given} --frame=tool --base=hand");
    assert!(distance(&position(&fk), &[0.0, 0.0, 0.1034]) < 1e-14);

    // Values by name, in any order: joints without a value are at rest, and mimic joints follow their source.
    let folder = Folder::new("by-name");
    let content = json!({"joints": ["finger_left_slide", "joint2"], "q": [0.03, 0.5]});
    let file = folder.text("q.json", content);
    let fk = answer!("fk {panda} --q-file {file}");
    let rest = -0.0698;
    assert_eq!(
        fk["q"],
        json!([0.0, 0.5, 0.0, rest, 0.0, 0.0, 0.0, 0.03, 0.03])
    );
    // A named mimic joint has its given value.
    let content = json!({"joints": ["finger_right_slide", "finger_left_slide"], "q": [0.01, 0.03]});
    let file = folder.text("fingers.json", content);
    let fingers = answer!("fk {panda} --q-file {file}");
    assert_eq!(numbers(&fingers["q"])[7..], [0.03, 0.01]);
    // Inconsistent mimic joints cause a note.
    let output = kinopt!("fk {panda} --q=0,0,0,-1,0,1,0,0.01,0.02");
    says!(stderr(&output) => "finger_right_slide");
}

#[test]
fn every_search_and_solver_reaches_the_target() {
    let panda = Seeded::panda();
    let pose = panda.pose(&panda.configuration(11));
    let target = typed("tool", &pose);
    for options in [
        "",
        "--search=first",
        "--search=nearest",
        "--search=all",
        "--start=random @solve.rng_seed=4",
        "--posture=0,0,0,-1.5,0,1.5,0",
        "@solve.attempts=50 --time-limit=1000",
        "@solve.solver=levenberg-marquardt",
        "@solve.solver=gauss-newton @solve.jacobian=dual",
        "@solve.attempts=41 @solve.jacobian=central",
        // Reached after several attempts from other starts.
        "@solve.solver=projected-gradient-bb @solve.max_iterations=2000",
    ] {
        let solution = answer!("solve {panda} {target} {options}");
        assert_eq!(solution["reached"], true, "{options}: {solution}");
        let q = numbers(&solution["q"]);
        panda.check(&q, &pose);
        // The target does not depend on the fingers, so they keep their start value.
        assert_eq!(q[7], q[8]);
        assert!(q[7] == 0.0 || options.contains("--start=random"));
        has!(solution, {"joints/3": "joint4", "tasks/0/frame": "tool"});
        let task = &solution["tasks"][0];
        assert_eq!(task["reached"], true);
        assert!(number(&task["orientation_error"]) <= 1e-6);
        assert!(number(&solution["micros"]) > 0.0);
        if options == "--search=all" {
            let others = list(&solution["alternatives"]);
            assert!(others.len() > 2);
            for other in others {
                panda.check(&numbers(other), &pose);
                assert!(distance(&numbers(other), &q) > 0.5);
            }
        }
    }
}

#[test]
fn partial_poses_are_targets() {
    let panda = Seeded::panda();
    let pose = panda.pose(&panda.configuration(11));
    let by_pose = typed("tool", &pose);
    let point = typed("tool", &pose[..3]);
    for (target, option) in [(&point, "--degrees"), (&by_pose, "--position-only")] {
        let solution = answer!("solve {panda} {target} {option}");
        assert_eq!(solution["reached"], true);
        let [position, orientation] = panda.errors(&numbers(&solution["q"]), &pose);
        assert!(position <= 1.001e-6 && orientation > 1e-3);
        assert!(solution["tasks"][0]["orientation_error"].is_null());
    }
    let solution = answer!("solve {panda} {by_pose} --interval=rz=free");
    assert_eq!(solution["reached"], true);
    let q = numbers(&solution["q"]);
    let base_from_tool = panda.base_from("tool", &q);
    let expected = panda.base_from("tool", &panda.configuration(11));
    let between = expected.rotation.z.dot(base_from_tool.rotation.z);
    assert!((between - 1.0).abs() < 1e-11, "{between}");
    assert!(panda.errors(&q, &pose)[0] <= 1.001e-6);
}

#[test]
fn move_limits_are_kept() {
    let ur5e = Seeded::new("universal_ur5e", "base", "flange");
    let start = ur5e.configuration(2);
    let near: Vec<f64> = start.iter().map(|value| value + 0.05).collect();
    let (typed_start, target) = (commas(&start), typed("flange", &ur5e.pose(&near)));
    for (bound, reached) in [(0.1, true), (0.01, false)] {
        let solution = answer!("solve {ur5e} --start={typed_start} {target} --max-move={bound}");
        assert_eq!(solution["reached"], reached);
        for (value, from) in numbers(&solution["q"]).iter().zip(&start) {
            assert!((value - from).abs() <= bound);
        }
        if !reached {
            assert_eq!(solution["termination"], "cannot_continue");
            let blocking = list(&solution["active_limits"]);
            assert!(!blocking.is_empty() && blocking.iter().all(|limit| limit["kind"] == "move"));
        }
    }
}

#[test]
fn targets_are_in_the_base_frame() {
    // The z axes of link1 and the world differ, and link3 moves with the arm.
    for base in ["link1", "link3"] {
        let panda = Seeded::new("franka_panda", base, "tool");
        let pose = panda.pose(&panda.configuration(8));
        let target = typed("tool", &pose);
        for solver in ["--search=start", "@solve.solver=levenberg-marquardt"] {
            let solution = answer!("solve {panda} {target} --base {base} {solver}");
            assert_eq!(solution["reached"], true, "{base} {solver}");
            panda.check(&numbers(&solution["q"]), &pose);
        }
    }
}

#[test]
fn two_arms_are_solved_together() {
    for base in ["torso", "left_upper_arm"] {
        let baxter = Seeded::new("rethink_baxter", base, "left_tool");
        let q = baxter.configuration(5);
        let (left, right) = (baxter.pose(&q), seven(&baxter.base_from("right_tool", &q)));
        let (one, other) = (typed("left_tool", &left), typed("right_tool", &right));
        let solution = answer!("solve {baxter} {one} {other} --base {base}");
        assert_eq!(
            solution["reached"], true,
            "{base}: {}",
            solution["explanation"]
        );
        let q = numbers(&solution["q"]);
        baxter.check(&q, &left);
        Seeded::new("rethink_baxter", base, "right_tool").check(&q, &right);
    }
}

#[test]
fn text_output_shows_the_essentials() {
    let panda = Seeded::panda();
    let target = typed("tool", &panda.pose(&panda.configuration(11)));
    let text = text!("solve {panda} {target} --search=all");
    says!(text => "Reached | joint7 | solutions in all | orientation error (rad)");
    assert!(!text.contains("finger"), "{text}");
}

#[test]
fn unreachable_target_is_a_result() {
    let scara = Seeded::new("adept_cobra_s600", "base", "flange");
    says!(text!("solve {scara} --target=flange=2,0,0.2") => "Not reached");
    let solution = answer!("solve {scara} --target=flange=2,0,0.2");
    assert_eq!(solution["reached"], false);
    // Links of 325 mm and 275 mm, stretched along x.
    let error = number(&solution["tasks"][0]["position_error"]);
    assert!((error - 1.4).abs() < 1e-6, "{error}");
}

#[test]
fn wrong_names_and_options_are_rejected() {
    let panda = Seeded::panda();
    let rig = Folder::new("rig-options");
    let rig = rig.rig();
    let (pose, both) = ("--target=tool=0.4,0,0.5,0,1,0,0", "--target=hand=0.4,0,0.5");
    let point = "--target=bone/2=-2.5,0.5,0";
    refused!("solve {panda} --target=claw=1,2,3" => 1, "`claw` | no link named | `kinopt info` lists all");
    refused!("solve {panda} {pose} --base=Link_77" => 1, "`Link_77` | did you mean `link7`");
    refused!("fk {panda} --base=toool" => 1, "`toool` | did you mean `tool`");
    refused!("solve {panda} {pose} --max-move=1,2" => 2, "--max-move | 7 | joint4 | 9");
    refused!("solve {panda} {pose} --start=1,2" => 2, "--start | joint4");
    refused!("solve {panda} {pose} --search=best" => 2, "nearest | all");
    refused!("solve {panda} {pose} --search=first @solve.solver=gauss-newton" => 2, "--search | `solver`");
    refused!("solve {panda} {pose} {both} --search=first" => 2, "--search | 2 targets");
    refused!("solve {panda} {pose} @solve.attempts=0" => 1, "solve: | nonzero");
    refused!("solve {panda} {pose} --interval=rw=free" => 2, "rz");
    refused!("solve {panda} {both} --interval=rz=free" => 2, "--interval | orientation");
    refused!("solve {rig} {point} --search=nearest" => 2, "--search | rig | start or first");
    refused!("info robot.step" => 1, ".step | .urdf | .json");
    refused!("info robot.xacro" => 1, "xacro robot.xacro > OUT.urdf | pip install xacro");
}

/// Joints that no target depends on keep their start values, for every method and number of attempts.
#[test]
fn other_arm_stays_at_its_start() {
    let file = model("rethink_baxter.urdf");
    let robot = kinopt::robot::Robot::read(&file).unwrap();
    let start = robot.model().random_configuration(0);
    let more = "--start=random @solve.attempts=4 @solve.max_iterations=30";
    for target in ["0.6,0.4,0.2", "6,0.4,0.2"] {
        for (solver, jacobian) in METHODS
            .iter()
            .flat_map(|solver| [(solver, "analytic"), (solver, "fd")])
        {
            let options = format!("@solve.solver={solver} @solve.jacobian={jacobian}");
            let solution = answer!("solve {file} --target=left_tool={target} {options} {more}");
            let names = list(&solution["joints"]);
            let pairs = numbers(&solution["q"]).into_iter().zip(&start);
            for ((q, start), name) in pairs.zip(names) {
                let other = word(name).starts_with("right");
                assert!(!other || q == *start, "{target} {options}: {name}");
            }
        }
    }
}
