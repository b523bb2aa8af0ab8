//! Mimic joints follow through any number of masters, and their limits restrict the one that leads.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use kinopt::robot::Robot;

/// Joints a, b, c on one base: c follows b follows a.
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
    // The last follower comes first in the file: order must not matter.
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
fn followers_of_followers_compose() {
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
fn each_follower_narrows_the_range_of_the_leader() {
    // b = -2a within [-1, 0.5] allows a in [-0.25, 0.5]; c = b + 0.4 within [0, 9] allows a <= 0.2.
    let robot = robot(
        [(-1.0, 1.0), (-1.0, 0.5), (0.0, 9.0)],
        (-2.0, 0.0),
        (1.0, 0.4),
    );
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
fn a_locked_leader_locks_its_followers() {
    let wide = (-100.0, 100.0);
    let robot = robot([wide; 3], (2.0, 0.0), (0.5, 1.0));
    let leader = robot.model().joint("a").unwrap();
    let map = robot.parameters().with_locked(leader, 0.5).build().unwrap();
    assert_eq!(map.variables(), 0);
    let mut q = [0.0; 3];
    map.expand(&[], &mut q).unwrap();
    assert_eq!(q, [1.5, 1.0, 0.5]);
}
