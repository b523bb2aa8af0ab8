//! Promise: mimic joints follow through any number of source joints. Their ranges restrict the source joint only on
//! request.

use kinopt::robot::Robot;
use support::fault_tables::ExpectedError;

/// Joints a, b, c on one base: c mimics b and b mimics a.
fn robot(limits: [(f64, f64); 3], b: (f64, f64), c: (f64, f64)) -> Robot {
    let joint = |name: &str, (lower, upper): (f64, f64), mimic: String| {
        format!(
            "<link name='l{name}'/><joint name='{name}' type='revolute'><parent link='base'/>\
             <child link='l{name}'/><limit lower='{lower}' upper='{upper}' velocity='1'/>{mimic}\
             </joint>"
        )
    };
    let follow = |master: &str, (ratio, offset): (f64, f64)| {
        format!("<mimic joint='{master}' multiplier='{ratio}' offset='{offset}'/>")
    };
    // The last mimic joint comes first in the file: the order must not matter.
    let joints = joint("c", limits[2], follow("b", c))
        + &joint("b", limits[1], follow("a", b))
        + &joint("a", limits[0], String::new());
    Robot::parse(
        &format!("<robot name='m'><link name='base'/>{joints}</robot>"),
        "m",
    )
    .unwrap()
}

#[test]
fn mimics_of_mimics_compose() {
    let wide = (-100.0, 100.0);
    let robot = robot([(-1.0, 1.0), wide, wide], (-2.0, 0.5), (3.0, -1.0));
    let map = robot.map();
    assert_eq!(map.variables(), 1);
    let mut q = [0.0; 3];
    map.expand(&[0.25], &mut q).unwrap();
    // b = -2a + 0.5 = 0; c = 3b - 1 = -1.
    assert_eq!(q, [-1.0, 0.0, 0.25]);
}

#[test]
fn mimic_limits_on_request_restrict_the_source() {
    // b = -2a within [-1, 0.5] allows a in [-0.25, 0.5]; c = b + 0.4 within [0, 9] allows a <= 0.2.
    let robot = robot(
        [(-1.0, 1.0), (-1.0, 0.5), (0.0, 9.0)],
        (-2.0, 0.0),
        (1.0, 0.4),
    )
    .with_mimic_limits()
    .unwrap();
    let (lower, upper) = (robot.map().lower(), robot.map().upper());
    assert!((lower[0] + 0.25).abs() < 1e-15 && (upper[0] - 0.2).abs() < 1e-15);
    for x in [lower[0], upper[0]] {
        let mut q = [0.0; 3];
        robot.map().expand_within_limits(&[x], &mut q).unwrap();
        for (value, limits) in q.iter().zip(robot.model().limits()) {
            assert!(limits.contains(*value));
        }
    }
}

#[test]
fn locked_source_joint_locks_its_mimics() {
    let wide = (-100.0, 100.0);
    let robot = robot([wide; 3], (2.0, 0.0), (0.5, 1.0));
    let leader = robot.model().joint("a").unwrap();
    let map = robot.parameters().with_locked(leader, 0.5).build().unwrap();
    assert_eq!(map.variables(), 0);
    let mut q = [0.0; 3];
    map.expand(&[], &mut q).unwrap();
    assert_eq!(q, [1.5, 1.0, 0.5]);
}

/// Notes of a robot.
fn notes(robot: &Robot) -> Vec<String> {
    robot.repairs().iter().map(ToString::to_string).collect()
}

#[test]
fn source_joint_keeps_its_exact_limits() {
    // Ratios and offsets without exact quotients.
    for (ratio, offset) in [
        (1.0, 0.0),
        (-1.0, 0.1),
        (0.7, -0.3),
        (-1.3, 0.37),
        (0.0, 0.2),
    ] {
        for range in [(0.0, 0.0), (-0.1, 0.3), (-9.0, 9.0)] {
            let robot = robot(
                [(-0.1, 0.8), range, (0.0, 0.5)],
                (ratio, offset),
                (0.9, 0.1),
            );
            let (lower, upper) = (robot.map().lower(), robot.map().upper());
            assert_eq!(
                (lower, upper),
                (&[-0.1][..], &[0.8][..]),
                "{ratio} {offset} {range:?}"
            );
            for x in [-0.1, 0.33, 0.8] {
                let mut q = [0.0; 3];
                robot.map().expand_within_limits(&[x], &mut q).unwrap();
                let b = ratio * x + offset;
                assert!((q[1] - b).abs() < 1e-15 && (q[0] - (0.9 * b + 0.1)).abs() < 1e-15);
                assert!(robot.is_within_limits(&q) && robot.model().is_within_limits(&q));
            }
        }
    }
}

#[test]
fn mimic_beyond_its_range_is_noted_with_both_joints() {
    let beyond = robot(
        [(-1.0, 1.0), (-1.0, 0.5), (-9.0, 9.0)],
        (-2.0, 0.0),
        (1.0, 0.4),
    );
    assert_eq!(
        notes(&beyond),
        [
            "1: joint `b`: `a` moves `b` through [-2, 2], beyond its own range [-1, 0.5]; `a` keeps its limits"
        ]
    );
    assert!(notes(&beyond.with_mimic_limits().unwrap()).is_empty());
    let within = robot(
        [(-1.0, 1.0), (-2.0, 2.0), (-9.0, 9.0)],
        (-2.0, 0.0),
        (1.0, 0.4),
    );
    assert!(notes(&within).is_empty());
    // Files round numbers: an excess of a millionth gives no note.
    let rounded = robot(
        [(-1.0, 1.0), (-2.0, 1.9999995), (-9.0, 9.0)],
        (-2.0, 0.0),
        (1.0, 0.4),
    );
    assert!(notes(&rounded).is_empty());
}

#[test]
fn mimic_of_a_source_that_keeps_no_value_is_an_error() {
    let disjoint = robot(
        [(0.0, 1.0), (5.0, 6.0), (-9.0, 9.0)],
        (1.0, 0.0),
        (1.0, 0.0),
    );
    assert_eq!(disjoint.map().upper(), [1.0]);
    disjoint.with_mimic_limits().says("`a`");
}

#[test]
fn random_configurations_honour_mimic_joints() {
    let robot = robot(
        [(0.2, 1.0), (-3.0, 3.0), (-9.0, 9.0)],
        (-2.0, 0.5),
        (3.0, -1.0),
    );
    for (value, expected) in robot.neutral().iter().zip([-0.7, 0.1, 0.2]) {
        assert!((value - expected).abs() < 1e-15);
    }
    for seed in 0..20 {
        let q = robot.random_configuration(seed);
        assert!((q[1] - (0.5 - 2.0 * q[2])).abs() < 1e-15);
        assert!((q[0] - (3.0 * q[1] - 1.0)).abs() < 1e-14);
        assert!(robot.is_within_limits(&q));
        assert!(!robot.is_within_limits(&[q[0], q[1] + 1e-6, q[2]]));
        assert_eq!(robot.apply_mimics(&[7.0, 7.0, q[2]]).unwrap(), q);
    }
    assert!(robot.apply_mimics(&[0.0; 2]).is_err());
}

#[test]
fn base_joint_keeps_mimic_ranges() {
    use kinopt::robot::BaseJoint;
    let limits = [(-1.0, 1.0), (-1.0, 0.5), (-9.0, 9.0)];
    let based = robot(limits, (-2.0, 0.0), (1.0, 0.4))
        .with_base_joint(BaseJoint::PLANAR)
        .unwrap();
    assert_eq!(based.map().lower()[3..], [-1.0]);
    let restricted = based.with_mimic_limits().unwrap();
    assert_eq!(restricted.map().lower()[3..], [-0.25]);
}

#[test]
fn mimic_limits_restrict_an_unlimited_source() {
    let text = "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>\
                <joint name='turn' type='continuous'><parent link='a'/><child link='b'/></joint>\
                <joint name='follow' type='revolute'><parent link='a'/><child link='c'/><limit lower='-1' upper='2'/>\
                <mimic joint='turn' multiplier='-2' offset='0.5'/></joint></robot>";
    let robot = Robot::parse(text, "r.urdf").unwrap();
    assert_eq!(robot.map().upper(), [f64::INFINITY]);
    assert!(notes(&robot)[0].contains("`turn`"), "{:?}", notes(&robot));
    let both = robot.with_mimic_limits().unwrap();
    assert_eq!(
        (both.map().lower(), both.map().upper()),
        (&[-0.75][..], &[0.75][..])
    );
}
