//! Promise: an arm with another tool or goal gives bitwise the results of an arm built with it.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout
)]

use kinopt::arm::{Arm, ArmError, ArmModel, Axis, PoseBounds, Search};
use kinopt::model::{Limits, Model};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::arms::robot;
use support::fault_tables::ExpectedError;
use support::random::{Random, case_count};

const UNIT_Z: Vector3<f64> = Vector3::UNITS[2];

fn tools() -> [Placement<f64>; 3] {
    let tilted = Matrix3::rotation(Vector3::new(0.6, 0.0, 0.8), 0.7_f64.sin_cos());
    [
        Placement::translation(UNIT_Z * 0.12),
        // Longer than the arm, and back along the last axis.
        Placement::new(tilted, Vector3::new(0.3, -0.2, -3.0)),
        Placement::new(tilted, Vector3::zero()),
    ]
}

/// Solves reachable and unreachable targets with both arms and compares the results.
fn assert_equal_results(one: &Arm, other: &Arm, seed: u64) {
    let mut random = Random::split_mix(seed);
    for question in 0..12 {
        let [start, goal] = [(); 2].map(|()| random.configuration(one));
        let mut target = one.base_from_tool(&goal).unwrap();
        assert_eq!(target, other.base_from_tool(&goal).unwrap());
        let is_unreachable = question % 6 == 5;
        if is_unreachable {
            target.translation += Vector3::new(9.0, 0.0, 0.0);
        }
        let [a, b] = [one, other].map(|arm| arm.solve(target, &start).unwrap());
        assert_eq!((a.reached, a.iterations), (b.reached, b.iterations));
        let bits = |q: &[f64]| -> Vec<u64> { q.iter().map(|v| v.to_bits()).collect() };
        assert_eq!(bits(&a.q), bits(&b.q), "question {question}");
        assert_eq!(
            a.reached,
            !is_unreachable,
            "question {question}: {}",
            a.explain()
        );
    }
}

fn crane() -> Model {
    let mut builder = Model::builder("crane");
    let [x, y, z] = Vector3::UNITS;
    let up = Placement::translation(z * 0.4);
    let half = Limits::new(-2.0, 2.0);
    let mut last = Some(builder.prismatic("rail", None, up, x, Limits::new(0.0, 2.0)));
    for (name, axis) in [("a", z), ("b", y), ("c", y), ("d", x), ("e", z)] {
        last = Some(builder.revolute(name, last, up, axis, half));
    }
    let reach = Limits::new(-0.2, 0.3);
    last = Some(builder.prismatic("reach", last, up, z, reach));
    builder.frame("world", None, Placement::identity());
    builder.frame("hook", last, Placement::translation(z * 0.1));
    builder.build().unwrap()
}

fn check_tools(
    joints: &impl ArmModel,
    (base, tip): (&str, &str),
    search: Search,
    tools: &[Placement<f64>],
) {
    let builder = || Arm::builder(joints, base, tip).with_search(search);
    let arm = builder().build().unwrap();
    for (index, tool) in tools.iter().copied().enumerate() {
        let rebuilt = builder().with_tool(tool).build().unwrap();
        let changed = arm.with_tool(tool).unwrap();
        assert_equal_results(&changed, &rebuilt, index as u64);
        // From tool to tool, and back to none.
        if index == 0 {
            let back = changed.with_tool(Placement::identity()).unwrap();
            assert_equal_results(&back, &arm, 7);
        }
    }
}

#[test]
fn changed_tool_equals_a_built_arm() {
    let [_, long_tool, tilted] = tools();
    let ends = ("base", "flange");
    let ur5e = robot("universal_ur5e");
    check_tools(&ur5e, ends, Search::First, &[long_tool, tilted]);
    check_tools(&crane(), ("world", "hook"), Search::Start, &[long_tool]);
}

/// With a tool so long that only rounding brings it within tolerance, nothing is reported as reached, whenever the tool
/// was set.
#[test]
fn tool_beyond_rounding_is_never_reached() {
    let robot = robot("universal_ur5e");
    let q = [0.3, -1.2, 1.1, -1.0, -1.4, 0.2];
    for (metres, reached) in [(1e6, true), (1e9, false)] {
        let tool = Placement::translation(Vector3::new(metres, 0.0, 0.0));
        let builder = || Arm::builder(&robot, "base", "flange").with_goal(PoseBounds::position());
        let rebuilt = builder().with_tool(tool).build().unwrap();
        let changed = builder().build().unwrap().with_tool(tool).unwrap();
        for arm in [rebuilt, changed] {
            let target = arm.base_from_tool(&q).unwrap();
            assert_eq!(arm.solve(target, &q).unwrap().reached, reached);
            let mut servo = arm.servo(&q, 0.01).unwrap();
            assert_eq!(servo.step(target).unwrap().reached(), reached);
        }
    }
}

#[test]
fn changed_goal_equals_a_built_arm() {
    let robot = robot("universal_ur5e");
    let builder = || Arm::builder(&robot, "base", "flange");
    let tool = tools()[1];
    let arm = builder().build().unwrap();
    for goal in [
        PoseBounds::free_about(Axis::Z),
        PoseBounds::within([0.0, 0.01, f64::INFINITY, 0.1, 0.0, 0.0]),
    ] {
        let rebuilt = builder().with_tool(tool).with_goal(goal).build().unwrap();
        let changed = arm.with_goal(goal).unwrap().with_tool(tool).unwrap();
        assert_equal_results(&changed, &rebuilt, 3);
    }
}

#[test]
fn changed_search_equals_a_built_arm() {
    let robot = robot("universal_ur5e");
    let builder = || Arm::builder(&robot, "base", "flange").with_tool(tools()[1]);
    let arm = builder().build().unwrap();
    for search in [Search::First, Search::Nearest] {
        let rebuilt = builder().with_search(search).build().unwrap();
        assert_equal_results(&arm.with_search(search).unwrap(), &rebuilt, 5);
    }
    let target = arm
        .base_from_tool(&[0.3, -1.2, 1.1, -1.0, -1.4, 0.2])
        .unwrap();
    let without_tool = Arm::builder(&robot, "base", "flange").build().unwrap();
    let changed = without_tool.with_tool(tools()[1]).unwrap();
    let [here, rebuilt] = [&changed, &arm].map(|arm| arm.solve_all(target).unwrap());
    assert!(here.complete);
    assert_eq!(here, rebuilt);
}

#[test]
fn metres_per_radian_is_kept() {
    let robot = robot("universal_ur5e");
    let builder = || {
        let builder = Arm::builder(&robot, "base", "flange");
        builder.with_atlas(false).with_metres_per_radian(0.01)
    };
    let unreachable = Placement::translation(Vector3::new(5.0, 0.0, 0.0));
    let tool = tools()[0];
    let rebuilt = builder().with_tool(tool).build().unwrap();
    let changed = builder().build().unwrap().with_tool(tool).unwrap();
    let [a, b] = [rebuilt, changed].map(|arm| arm.solve(unreachable, &[0.1; 6]).unwrap().q);
    assert_eq!(a, b);
}

#[test]
fn invalid_tools_and_goals_are_rejected() {
    let robot = robot("universal_ur5e");
    let builder = Arm::builder(&robot, "base", "flange");
    let arm = builder.with_atlas(false).build().unwrap();
    let mut stretched = Placement::identity();
    stretched.rotation.x = UNIT_Z;
    let error = arm.with_tool(stretched).unwrap_err();
    assert!(matches!(error, ArmError::Tool(_)), "{error}");
    arm.with_goal(PoseBounds::within([f64::INFINITY; 6]))
        .says("at least one component must");
    arm.with_goal(PoseBounds::within([-1.0; 6]))
        .says("half widths");
}

/// Seeds depend on the joints only: without removing the tool they would be no better than random.
#[test]
fn seeds_work_with_any_tool() {
    for (model, base, tip) in [
        (robot("universal_ur5e").model().clone(), "base", "flange"),
        (crane(), "world", "hook"),
    ] {
        let builder = || Arm::builder(&model, base, tip).with_search(Search::First);
        let bare = builder().build().unwrap();
        let unseeded = builder().with_atlas(false).build().unwrap();
        let mean = |arm: &Arm| {
            let (mut random, mut iterations, count) =
                (Random::split_mix(11), 0, case_count(150, 60));
            for _ in 0..count {
                let [start, goal] = [(); 2].map(|()| random.configuration(arm));
                let target = arm.base_from_tool(&goal).unwrap();
                let solution = arm.solve(target, &start).unwrap();
                assert!(solution.reached, "{}", solution.explain());
                iterations += solution.iterations;
            }
            iterations as f64 / count as f64
        };
        let without_tool = mean(&bare);
        for tool in tools() {
            let (seeded, random) = (
                bare.with_tool(tool).unwrap(),
                unseeded.with_tool(tool).unwrap(),
            );
            let [seeded, random] = [seeded, random].map(|arm| mean(&arm));
            let figures =
                format!("{without_tool:.1} without a tool, {seeded:.1} with, {random:.1} unseeded");
            assert!(
                seeded < 0.7 * random && seeded < 1.5 * without_tool,
                "{figures}"
            );
            println!("{figures}");
        }
    }
}
