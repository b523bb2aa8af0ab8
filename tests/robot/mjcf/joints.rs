//! Promise: ranges apply as in MuJoCo, in its units, and a ball joint stays within its total angle.

use kinopt::model::{BallLimits, JointKind, Limits};
use kinopt::robot::{RepairKind, Robot};

fn joint(compiler: &str, joint: &str) -> Robot {
    let text = format!(
        r#"<mujoco><compiler {compiler}/><default><joint armature="1"/></default>
        <worldbody><body name="b"><joint name="j" {joint}/></body></worldbody></mujoco>"#
    );
    Robot::parse_mjcf(&text, "joint.xml").unwrap()
}

fn limits(compiler: &str, attributes: &str) -> Limits {
    joint(compiler, attributes).model().joints()[0].limits
}

#[test]
fn range_applies_unless_disabled() {
    let bound = Limits::new(-1.0, 2.0);
    let range = r#"range="-1 2""#;
    for (compiler, joint, expected) in [
        (r#"angle="radian""#, range.to_owned(), bound),
        (
            r#"angle="radian""#,
            format!(r#"{range} limited="auto""#),
            bound,
        ),
        (
            r#"angle="radian""#,
            format!(r#"{range} limited="false""#),
            Limits::UNBOUNDED,
        ),
        (
            r#"angle="radian" autolimits="false""#,
            format!(r#"{range} limited="true""#),
            bound,
        ),
        (
            r#"angle="radian" autolimits="false""#,
            format!(r#"{range} limited="false""#),
            Limits::UNBOUNDED,
        ),
        (
            r#"angle="radian""#,
            r#"range="0 0""#.to_owned(),
            Limits::UNBOUNDED,
        ),
        (
            r#"angle="degree""#,
            format!(r#"type="slide" {range}"#),
            bound,
        ),
    ] {
        assert_eq!(limits(compiler, &joint), expected, "{compiler} {joint}");
    }
    let degrees = limits("", r#"range="-90 180""#);
    let [quarter, half] = [std::f64::consts::FRAC_PI_2, std::f64::consts::PI];
    assert!((degrees.lower + quarter).abs() < 1e-15 && (degrees.upper - half).abs() < 1e-15);
}

#[test]
fn ball_range_limits_the_total_angle() {
    for angle in [0.1, 1.0, 2.0, 3.1] {
        let robot = joint(
            r#"angle="radian""#,
            &format!(r#"type="ball" range="0 {angle}""#),
        );
        let model = robot.model();
        assert_eq!(model.joints()[0].kind, JointKind::Ball);
        assert_eq!(
            model.joints()[0].ball,
            Some(BallLimits::within_angle(angle))
        );
        assert!(robot.repairs().is_empty());
        let mut farthest = 0.0_f64;
        for seed in 0..2000 {
            let q = model.random_configuration(seed);
            farthest = farthest.max(2.0 * q[0].abs().min(1.0).acos());
        }
        assert!(
            farthest <= angle + 1e-9 && farthest > 0.95 * angle,
            "{farthest} {angle}"
        );
        let turned = |change: f64| [(0.5 * change).cos(), 0.0, (0.5 * change).sin(), 0.0];
        assert!(model.is_within_limits(&turned(angle - 1e-9)));
        assert!(!model.is_within_limits(&turned(angle + 1e-9)));
        // By name too, once for all four numbers.
        let outside = |change: f64| model.joints_outside_limits(&turned(change)).unwrap();
        assert_eq!(outside(angle - 1e-9), []);
        assert_eq!(outside(angle + 1e-9), [model.moving_joints()[0]]);
    }
    let free = joint("", r#"type="ball" range="0 180""#);
    assert!(free.model().joints()[0].ball.is_none() && free.repairs().is_empty());
}

#[test]
fn ball_range_above_half_a_turn_is_noted() {
    for (compiler, range, end) in [
        (r#"angle="radian""#, "0 4", 4.0),
        ("", "0 185", 185.0_f64.to_radians()),
        ("", "0 720", 720.0_f64.to_radians()),
    ] {
        let robot = joint(compiler, &format!(r#"type="ball" range="{range}""#));
        assert!(robot.model().joints()[0].ball.is_none(), "{range}");
        assert_eq!(robot.repairs().len(), 1, "{range}");
        let note = &robot.repairs()[0];
        assert_eq!((note.line, note.element.as_str()), (2, "joint `j`"));
        assert!(
            matches!(note.mended, RepairKind::StopsNothing { angle } if (angle - end).abs() < 1e-12)
        );
        assert!(note.to_string().contains("no limit"), "{note}");
    }
    // Half a turn, exact or rounded, means unlimited; so does `limited`.
    for range in ["0 3.1416", "0 3.142", r#"0 4" limited="false"#] {
        let robot = joint(
            r#"angle="radian""#,
            &format!(r#"type="ball" range="{range}""#),
        );
        assert!(robot.model().joints()[0].ball.is_none() && robot.repairs().is_empty());
    }
}

#[test]
fn largest_joint_force_is_kept() {
    let robot = joint("", r#"actuatorfrcrange="-88 50""#);
    let id = robot.model().joint("j").unwrap();
    assert_eq!(robot.effort_limit(id), Some(88.0));
    let robot = joint(
        "",
        r#"actuatorfrcrange="-88 50" actuatorfrclimited="false""#,
    );
    assert_eq!(robot.effort_limit(id), None);
    // A preceding free joint becomes several joints without limits.
    let text = r#"<mujoco><worldbody><body><freejoint name="base"/>
        <body><joint name="hip" actuatorfrcrange="-88 50"/><body><joint name="knee"/>
        <body><joint name="ankle" actuatorfrcrange="-7 7"/></body></body></body></body></worldbody></mujoco>"#;
    let robot = Robot::parse_mjcf(text, "joint.xml").unwrap();
    let ids = robot.model().joint_ids();
    let reported = ids.filter_map(|id| {
        let name = robot.model().joints()[id.index()].name.as_str();
        Some((name, robot.effort_limit(id)?))
    });
    assert_eq!(
        reported.collect::<Vec<_>>(),
        [("hip", 88.0), ("ankle", 7.0)]
    );
}

/// Of repeated class defaults the later one applies, attribute by attribute; an inner class precedes an outer one.
#[test]
fn last_class_default_applies() {
    let text = r#"<mujoco><compiler angle="radian"/><default><joint range="-1 1" axis="1 0 0"/><joint range="-2 2"/>
        <default class="inner"><joint axis="0 1 0"/><joint axis="0 0 1"/></default></default>
        <worldbody><body><joint name="outer"/><body><joint name="inner" class="inner"/>
        <body><joint name="own" class="inner" range="-3 3"/></body></body></body></worldbody></mujoco>"#;
    let robot = Robot::parse_mjcf(text, "joint.xml").unwrap();
    let joints = robot.model().joints().iter();
    let read: Vec<_> = joints
        .map(|joint| (joint.limits.upper, joint.axis.to_array()))
        .collect();
    let [x, z] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(read, [(2.0, x), (2.0, z), (3.0, z)]);
}
