//! Promise: a reach map says that a cell is unreachable only if no configuration reaches any of its poses, and its
//! configurations reach the centres of their cells. Independent results agree: the ring of a planar arm, and forward
//! kinematics of random configurations.

use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

use kinopt::arm::{Arm, Axis, CellReach, PoseBounds, PoseReach, ReachMap, ReachMapError};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3, rotation_log};
use support::arms::robot;
use support::random::{Random, case_count};

/// Arm of three parallel joints with links of 0.4, 0.3 and 0.1 m.
const PLANAR: &str = r#"<robot name="planar"><link name="base"/><link name="a"/><link name="b"/><link name="c"/>
  <link name="tip"/>
  <joint name="first" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint>
  <joint name="second" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0.4 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-2.9" upper="2.9" effort="1" velocity="1"/></joint>
  <joint name="third" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0.3 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-2.9" upper="2.9" effort="1" velocity="1"/></joint>
  <joint name="end" type="fixed"><parent link="c"/><child link="tip"/><origin xyz="0.1 0 0"/></joint></robot>"#;
/// Steps of coarse maps, metres and radians.
const STEP: f64 = 0.4;
const ANGLE: f64 = FRAC_PI_2;

static UR5E: LazyLock<(Arm, ReachMap)> = LazyLock::new(|| {
    let arm = arm("universal_ur5e");
    let map = coarse(&arm);
    (arm, map)
});

fn planar(goal: PoseBounds) -> Arm {
    let robot = Robot::parse(PLANAR, "planar.urdf").unwrap();
    Arm::builder(&robot, "base", "tip")
        .with_goal(goal)
        .build()
        .unwrap()
}

fn arm(model: &str) -> Arm {
    Arm::new(&robot(model), "base", "flange").unwrap()
}

fn coarse(arm: &Arm) -> ReachMap {
    ReachMap::builder(arm)
        .with_position_step(STEP)
        .with_orientation_step(ANGLE)
        .build_parallel()
        .unwrap()
}

fn random_pose(random: &mut Random, size: f64) -> Placement<f64> {
    let position = [0.0; 3].map(|_: f64| random.within(-size, size));
    let rotation = random.rotation();
    let column = |k: usize| [0, 1, 2].map(|row| rotation[(row, k)]).into();
    let rotation = kinopt::spatial::Matrix3::from_columns(column(0), column(1), column(2));
    Placement::new(rotation, position.into())
}

/// Smallest and largest distance of the planar arm's tip from its base, by brute force over the limits.
fn planar_ring() -> (f64, f64) {
    let angles = || (-290..=290).map(|hundredth| 0.01 * f64::from(hundredth));
    let distances = angles().flat_map(|second| {
        angles().map(move |third| {
            let x = 0.4 + 0.3 * second.cos() + 0.1 * (second + third).cos();
            x.hypot(0.3 * second.sin() + 0.1 * (second + third).sin())
        })
    });
    distances.fold((f64::INFINITY, 0.0), |(least, most), distance| {
        (distance.min(least), distance.max(most))
    })
}

#[test]
fn planar_arm_fills_a_ring() {
    let (nearest, farthest) = planar_ring();
    let arm = planar(PoseBounds::position());
    let step = 0.2;
    let map = ReachMap::builder(&arm)
        .with_position_step(step)
        .build()
        .unwrap();
    let (mut reached, mut proven) = (0, 0);
    for column in -4..=4_i32 {
        for row in -4..=4_i32 {
            let [x, y] = [column, row].map(|cell| step * f64::from(cell));
            let (distance, half_diagonal) = (x.hypot(y), step * 0.75_f64.sqrt());
            let centre = Placement::translation(Vector3::new(x, y, 0.0));
            match map.query(&centre).unwrap() {
                CellReach::Unreachable => {
                    assert!(distance < nearest || distance > farthest, "{x} {y}");
                    proven += 1;
                }
                CellReach::Reached { configuration } => {
                    let tip = arm.base_from_tool(&configuration).unwrap().translation;
                    assert!((tip - centre.translation).norm() < 2e-4);
                    reached += 1;
                }
                CellReach::Unknown => {
                    let border = (distance - nearest).abs().min((distance - farthest).abs());
                    assert!(border < half_diagonal, "{x} {y}");
                }
            }
            let above = Placement::translation(Vector3::new(x, y, 1.01 * step));
            let reach = map.query(&above).unwrap();
            assert!(!matches!(reach, CellReach::Reached { .. }));
        }
    }
    assert!(reached > 40 && proven > 10, "{reached} {proven}");
}

#[test]
fn planar_poses_outside_the_plane_are_not_reached() {
    let arm = planar(PoseBounds::pose());
    let map = ReachMap::builder(&arm)
        .with_position_step(0.4)
        .with_orientation_step(0.8)
        .build_parallel()
        .unwrap();
    let mut random = Random::new(2);
    let mut proven = 0;
    for _ in 0..500 {
        let pose = random_pose(&mut random, 0.7);
        let reach = map.query(&pose).unwrap();
        proven += usize::from(reach == CellReach::Unreachable);
        // A tilt far beyond the bins of the plane's orientations.
        if pose.translation.z.abs() > 0.4 || pose.rotation.z.z < 0.3 {
            assert!(!matches!(reach, CellReach::Reached { .. }));
        }
        let q = random.configuration(&arm);
        let reached = arm.base_from_tool(&q).unwrap();
        assert_ne!(map.query(&reached).unwrap(), CellReach::Unreachable);
    }
    assert!(proven > 20, "{proven}");
}

#[test]
fn reached_poses_are_never_unreachable() {
    let free = arm("universal_ur5e").with_goal(PoseBounds::free_about(Axis::Z));
    let arms = [arm("franka_panda"), arm("kuka_iiwa14"), free.unwrap()];
    for (model, arm) in arms.iter().enumerate() {
        let map = coarse(arm);
        let mut random = Random::new(11);
        let (mut with_configuration, cases) = (0, case_count(10_000, 1_000));
        for _ in 0..cases {
            let q = random.configuration(arm);
            let reach = map.query(&arm.base_from_tool(&q).unwrap()).unwrap();
            assert_ne!(reach, CellReach::Unreachable, "{model}: {q:?}");
            with_configuration += usize::from(matches!(reach, CellReach::Reached { .. }));
        }
        assert!(
            3 * with_configuration > cases,
            "{model}: {with_configuration}"
        );
    }
}

#[test]
fn configurations_reach_the_centres_of_cells() {
    let (arm, map) = &*UR5E;
    let mut random = Random::new(12);
    let (mut reached, mut unreachable) = (0, 0);
    for _ in 0..2_000 {
        let pose = random_pose(&mut random, 1.2);
        let Some(centre) = map.cell_centre(&pose) else {
            assert_eq!(map.query(&pose).unwrap(), CellReach::Unreachable);
            continue;
        };
        let offset = pose.translation - centre.translation;
        assert!(
            offset
                .to_array()
                .iter()
                .all(|along| along.abs() < 0.5 * STEP + 1e-9)
        );
        let angle = rotation_log(&(centre.rotation.transpose() * pose.rotation)).norm();
        assert!(angle < 1.1 * ANGLE, "{angle}");
        match map.query(&pose).unwrap() {
            CellReach::Reached { configuration } => {
                let tool = arm.base_from_tool(&configuration).unwrap();
                assert!((tool.translation - centre.translation).norm() < 1e-3);
                let turn = centre.rotation.transpose() * tool.rotation;
                assert!(rotation_log(&turn).norm() < 2e-3);
                reached += 1;
            }
            CellReach::Unreachable => {
                unreachable += 1;
                if unreachable % 5 == 0 {
                    let solution = arm.solve(pose, arm.default_start()).unwrap();
                    assert!(!solution.reached, "{pose:?}");
                }
            }
            CellReach::Unknown => {}
        }
    }
    assert!(
        reached > 100 && unreachable > 100,
        "{reached} {unreachable}"
    );
}

#[test]
fn decisions_are_those_of_exact_solutions() {
    let (arm, map) = &*UR5E;
    let mut random = Random::new(13);
    for _ in 0..50 {
        let pose = arm.base_from_tool(&random.configuration(arm)).unwrap();
        match map.decide(arm, &pose, 0).unwrap() {
            PoseReach::Reachable(solution) => {
                let tool = arm.base_from_tool(&solution.q).unwrap();
                assert!((tool.translation - pose.translation).norm() < 2e-6);
            }
            other => panic!("{other:?}"),
        }
    }
    let poses: Vec<_> = (0..60).map(|_| random_pose(&mut random, 0.8)).collect();
    let mut q = vec![0.0; 6 * poses.len()];
    let mut reached = vec![None; poses.len()];
    map.decide_into(arm, &poses, 4, &mut q, &mut reached)
        .unwrap();
    let mut equal = vec![None; poses.len()];
    let mut equal_q = q.clone();
    map.decide_into_parallel(arm, &poses, 4, &mut equal_q, &mut equal)
        .unwrap();
    assert_eq!(reached, equal);
    for ((pose, reached), q) in poses.iter().zip(&reached).zip(q.chunks(6)) {
        let solved = arm.solve(*pose, arm.default_start()).unwrap().reached;
        match reached {
            Some(true) => {
                let tool = arm.base_from_tool(q).unwrap();
                assert!((tool.translation - pose.translation).norm() < 2e-6);
            }
            _ => assert!(q[0].is_nan() && !solved),
        }
    }
    let far = Placement::translation(Vector3::new(4.0, 0.0, 0.0));
    let decision = map.decide(arm, &far, 0).unwrap();
    assert!(matches!(decision, PoseReach::Unreachable));
}

#[test]
fn threads_and_parts_give_equal_maps() {
    let arm = arm("franka_panda");
    let builder = ReachMap::builder(&arm)
        .with_position_step(0.5)
        .with_orientation_step(1.6);
    let map = builder.build().unwrap();
    assert_eq!(map, builder.build_parallel().unwrap());
    let parts = [2, 0, 1].map(|part| builder.clone().with_part(part, 3).build().unwrap());
    assert_eq!(map, ReachMap::merged(&parts).unwrap());
    assert_eq!(
        ReachMap::merged(&[map.clone(), parts[0].clone()]),
        Err(ReachMapError::NotParts)
    );
    assert_eq!(map, ReachMap::from_data(map.data().clone()).unwrap());
}

#[test]
fn other_arms_and_damaged_arrays_are_errors() {
    let arm = planar(PoseBounds::position());
    let map = ReachMap::builder(&arm)
        .with_position_step(0.2)
        .build()
        .unwrap();
    map.check_arm(&arm).unwrap();
    let message = |error: ReachMapError| error.to_string();
    let other = message(map.check_arm(&self::arm("universal_ur5e")).unwrap_err());
    assert!(
        other.contains("its joints are first, second, third"),
        "{other}"
    );
    let shorter = arm.with_tool(Placement::translation(Vector3::new(-0.05, 0.0, 0.0)));
    let other = message(map.check_arm(&shorter.unwrap()).unwrap_err());
    assert!(other.contains("placement of the tool"), "{other}");

    let mut data = map.data().clone();
    data.configurations.truncate(2 * data.arm.joints.len());
    let damaged = message(ReachMap::from_data(data).unwrap_err());
    assert!(damaged.contains("`cells`"), "{damaged}");
    let endless = ReachMap::builder(&arm).with_position_step(0.0).build();
    assert!(matches!(endless, Err(ReachMapError::Option(_))));
    let vast = ReachMap::builder(&arm).with_position_step(1e-9).build();
    assert!(matches!(vast, Err(ReachMapError::TooManyCells { .. })));
}

#[test]
fn base_at_the_goals_own_base_reaches_all() {
    let (arm, map) = &*UR5E;
    let mut random = Random::new(14);
    let base = Placement::translation(Vector3::new(2.0, -1.0, 0.3));
    let goals: Vec<_> = (0..10)
        .map(|_| base * arm.base_from_tool(&random.configuration(arm)).unwrap())
        .collect();
    let far = Placement::translation(Vector3::new(-2.0, 0.0, 0.0));
    let found = map.place_base(arm, &goals, &[far, base], 2).unwrap();
    assert_eq!((found[0].candidate, found[0].reached), (1, goals.len()));
    assert_eq!((found[1].reached, found[1].unreachable), (0, goals.len()));
    for (goal, q) in goals.iter().zip(found[0].q.chunks(arm.joint_count())) {
        let tool = base * arm.base_from_tool(q).unwrap();
        assert!((tool.translation - goal.translation).norm() < 2e-6);
    }
}
