//! Promise: linear joint equalities give mimic joints, for any `ref`. Others are dropped with a note. Loops are read
//! unless they are inactive or involve a mocap body.

use kinopt::model::LoopKind;
use kinopt::robot::Robot;

/// Three revolute joints in a row with the given equalities.
fn robot(equalities: &str) -> Robot {
    let text = format!(
        r#"<mujoco><compiler angle="radian"/><default><default class="off"><equality active="false"/></default></default>
        <worldbody><body name="a"><joint name="a" ref="0.5"/><body name="b" pos="1 0 0"><joint name="b" ref="-1"/>
          <body name="c" pos="1 0 0"><joint name="c"/><joint name="ball" type="ball"/></body></body></body></worldbody>
        <equality>{equalities}</equality></mujoco>"#
    );
    Robot::parse_mjcf(&text, "chain.xml").unwrap()
}

#[test]
fn linear_equality_gives_a_mimic_joint() {
    let robot = robot(r#"<joint joint1="b" joint2="a" polycoef="0.25 -2"/>"#);
    let [mimic] = robot.mimics() else {
        panic!("{:?}", robot.mimics())
    };
    let at = |a: f64| mimic.ratio * a + mimic.offset;
    // y - y₀ = 0.25 - 2 (x - x₀) with x₀ = 0.5 and y₀ = -1.
    for a in [-1.0, 0.5, 2.0] {
        assert!((at(a) - (-1.0 + 0.25 - 2.0 * (a - 0.5))).abs() < 1e-15);
    }
    assert_eq!(robot.map().variables(), 2 + 3);
}

/// A mimic joint of a driven joint is driven and not passive.
#[test]
fn mimic_joint_needs_no_motor() {
    let coupled = r#"<joint joint1="b" joint2="a" polycoef="0.25 -2"/>"#;
    let motor = r#"</equality><actuator><motor joint="a"/></actuator><equality>"#;
    let passive = |equalities: &str| {
        let robot = robot(equalities);
        let joints = robot.model().joints();
        let name = |id: &kinopt::model::JointId| joints[id.index()].name.clone();
        robot.passive_joints().iter().map(name).collect::<Vec<_>>()
    };
    assert_eq!(passive(motor), ["b", "c", "ball"]);
    assert_eq!(passive(&format!("{coupled}{motor}")), ["c", "ball"]);
    // A ball joint's motor may use the parent's axes.
    let turned = motor.replace("</actuator>", r#"<motor jointinparent="ball"/></actuator>"#);
    assert_eq!(passive(&turned), ["b", "c"]);
}

#[test]
fn equality_without_coefficients_is_one_to_one() {
    let robot = robot(r#"<joint joint1="c" joint2="a"/>"#);
    let mimic = robot.mimics()[0];
    assert_eq!((mimic.ratio, mimic.offset), (1.0, -0.5));
}

#[test]
fn equality_of_one_joint_locks_it() {
    let robot = robot(r#"<joint joint1="a" polycoef="0.25"/>"#);
    let limits = robot.model().limits().next().unwrap();
    assert_eq!((limits.lower, limits.upper), (0.75, 0.75));
    assert_eq!(robot.map().variables(), 2 + 3);
}

/// The error has the equality's line.
#[test]
fn locked_value_outside_its_range_is_named() {
    let text = r#"<mujoco><compiler angle="radian"/><worldbody>
        <body name="b"><joint name="a" range="-1 1"/></body></worldbody>
        <equality><joint name="held" joint1="a" polycoef="1.5"/></equality></mujoco>"#;
    let message = Robot::parse_mjcf(text, "held.xml").unwrap_err().to_string();
    assert!(message.starts_with("held.xml:3: joint `held`"), "{message}");
    assert!(
        message.contains("`a`: locked position 1.5 is outside [-1, 1]"),
        "{message}"
    );
}

#[test]
fn unsupported_equalities_are_noted() {
    for (equalities, note) in [
        (
            r#"<joint joint1="a" joint2="b" polycoef="0 1 0.5"/>"#,
            "linear relation",
        ),
        (r#"<joint joint1="a" joint2="ball"/>"#, "linear relation"),
        (r#"<tendon tendon1="cable"/>"#, "<tendon> is not supported"),
    ] {
        let robot = robot(equalities);
        assert!(robot.mimics().is_empty());
        assert!(
            robot.repairs()[0].to_string().contains(note),
            "{:?}",
            robot.repairs()
        );
    }
    let twice = robot(r#"<joint joint1="a" joint2="b"/><joint joint1="a" joint2="c"/>"#);
    let ring = robot(
        r#"<joint joint1="a" joint2="b"/><joint joint1="b" joint2="c"/><joint joint1="c" joint2="a"/>"#,
    );
    for (robot, followers) in [(twice, 1), (ring, 2)] {
        assert_eq!(
            (robot.mimics().len(), robot.repairs().len()),
            (followers, 1)
        );
        assert!(
            robot.repairs()[0]
                .to_string()
                .contains("already has a source")
        );
    }
}

#[test]
fn active_loops_are_read_with_names() {
    let robot = robot(
        r#"<connect name="bar" body1="a" body2="c" anchor="1 0 0"/><weld body1="c"/><weld body1="c" body2="a"/>
        <connect body1="a" body2="b" anchor="0 0 0" active="false"/><weld class="off" body1="a" body2="b"/>
        <joint class="off" joint1="a" joint2="b"/>"#,
    );
    let loops = robot.model().loops();
    let names: Vec<_> = loops.iter().map(|closed| closed.name.as_str()).collect();
    assert_eq!(names, ["bar", "c/weld", "c/weld/2"]);
    let name = |frame: kinopt::model::FrameId| robot.model().frames()[frame.index()].name.as_str();
    assert_eq!(loops[0].frames.map(name), ["a", "c"]);
    assert_eq!(loops[1].frames.map(name), ["c", "world"]);
    assert_eq!(loops[0].kind, LoopKind::Connect);
    assert_eq!(loops[1].kind, LoopKind::Weld);
    assert!(robot.mimics().is_empty() && robot.repairs().is_empty());
}

/// Also if the file gives that name to a later loop.
#[test]
fn unnamed_loop_gets_an_unused_name() {
    let robot =
        robot(r#"<weld body1="c"/><connect name="c/weld" body1="a" body2="c" anchor="1 0 0"/>"#);
    let loops = robot.model().loops();
    let names: Vec<_> = loops.iter().map(|closed| closed.name.as_str()).collect();
    assert_eq!(names, ["c/weld/2", "c/weld"]);
}

#[test]
fn mocap_equality_is_no_loop() {
    let text = r#"<mujoco><worldbody><body name="hand"><freejoint/><site name="palm"/></body>
      <body name="mouse" mocap="true"><site name="pointer"/></body></worldbody>
      <equality><weld body1="mouse" body2="hand"/><connect site1="palm" site2="pointer"/></equality></mujoco>"#;
    let robot = Robot::parse_mjcf(text, "teleoperated.xml").unwrap();
    assert!(robot.model().loops().is_empty());
    assert_eq!(robot.repairs().len(), 2);
    assert!(robot.repairs()[0].to_string().contains("mocap"));
}

/// A loop is closed in the file's reference pose, also with a rotated floating body.
#[test]
fn loop_is_closed_in_the_reference_pose() {
    use kinopt::ik::LoopClosure;
    let half = 0.5;
    for (quaternion, read) in [
        ("1 0 0 0", [1.0, 0.0, 0.0, 0.0]),
        ("0.5 -0.5 0.5 0.5", [half, -half, half, half]),
        ("0.8 0 0.6 0", [0.8, 0.0, 0.6, 0.0]),
        ("0 0.6 0 0.8", [0.0, 0.6, 0.0, 0.8]),
    ] {
        for equality in ["connect", "weld"] {
            let text = format!(
                r#"<mujoco><compiler angle="radian"/><worldbody>
                <body name="a" pos="0.1 0.2 0.3" quat="{quaternion}"><freejoint/></body>
                <body name="c" pos="-0.3 0.1 0" euler="0.3 0.2 -0.5"><joint name="h" ref="0.4" range="-1 1"/></body></worldbody>
                <equality><{equality} body1="a" body2="c" anchor="0.25 -0.1 0.05"/></equality></mujoco>"#
            );
            let robot = Robot::parse_mjcf(&text, "drawn.xml").unwrap();
            let hinge = robot.model().joint("h").unwrap();
            let closure = LoopClosure::new(robot.parameters(), &[hinge]).unwrap();
            let [w, x, y, z] = read;
            let gaps = closure.gaps(&[0.1, 0.2, 0.3, w, x, y, z, 0.4]).unwrap();
            assert_eq!(gaps.len(), 1);
            assert!(gaps[0].gap < 1e-12 && gaps[0].angle < 1e-7, "{gaps:?}");
        }
    }
}
