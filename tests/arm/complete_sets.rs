//! Promise: six revolute joints have complete solution sets. Every solution reaches its target within the limits, no
//! attempt finds another one, and closed forms agree with eliminations.
//! `KINOPT_CASES` sets the number of poses for each arm (best with `--release`).

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use kinopt::arm::{AllSolutions, Argument, Arm, PoseSolution, Search};
use kinopt::model::{Limits, Model};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::arms::{distance, robot, within_limits};
use support::random::{Random, cases};
use support::urdf_matrices::{apart, from_placement};

/// Denavit-Hartenberg parameters of a joint: a and d in metres, α in radians.
type Row = (f64, f64, f64);

const PUMA: [Row; 6] = [
    (0.0, 0.0, -FRAC_PI_2),
    (0.4318, 0.1501, 0.0),
    (-0.0203, 0.0, FRAC_PI_2),
    (0.0, 0.4318, -FRAC_PI_2),
    (0.0, 0.0, FRAC_PI_2),
    (0.0, 0.06, 0.0),
];
/// A wrist with an offset behind parallel axes.
const OFFSET_WRIST: [Row; 6] = [
    (0.0, 0.245, -FRAC_PI_2),
    (0.54, 0.0, 0.0),
    (0.0, 0.0, -FRAC_PI_2),
    (0.0, 0.54, FRAC_PI_2),
    (0.0, 0.15, -FRAC_PI_2),
    (0.0, 0.16, 0.0),
];
/// An arm with sixteen real solutions: C. Manseur and K. L. Doty, "A robot manipulator with 16 real inverse kinematic
/// solution sets", International Journal of Robotics Research 8 (1989).
const MANSEUR_DOTY: [Row; 6] = [
    (0.3, 0.0, FRAC_PI_2),
    (1.0, 0.0, 0.017_453_292_519_943_3),
    (0.0, 0.2, FRAC_PI_2),
    (1.5, 0.0, 0.017_453_292_519_943_3),
    (0.0, 0.0, FRAC_PI_2),
    (0.0, 0.0, 0.017_453_292_519_943_3),
];
/// No two successive axes meet, and none are parallel or perpendicular.
const GENERAL: [Row; 6] = [
    (0.3, 0.1, 1.1),
    (0.8, -0.2, 0.4),
    (0.2, 0.3, -1.3),
    (-0.1, 0.6, 0.8),
    (0.25, -0.1, 1.2),
    (0.1, 0.3, 0.5),
];

fn arm_of(rows: &[Row], limits: Limits) -> Arm {
    let mut builder = Model::builder("arm");
    let z = Vector3::new(0.0, 0.0, 1.0);
    let (mut parent, mut parent_from_joint) = (None, Placement::identity());
    for (i, &(a, d, alpha)) in rows.iter().enumerate() {
        let name = format!("joint{i}");
        parent = Some(builder.revolute(&name, parent, parent_from_joint, z, limits));
        let turn = Matrix3::rotation(Vector3::new(1.0, 0.0, 0.0), (alpha.sin(), alpha.cos()));
        parent_from_joint = Placement::new(turn, Vector3::new(a, 0.0, d));
    }
    builder.frame("base", None, Placement::identity());
    builder.frame("tool", parent, parent_from_joint);
    let model = builder.build().unwrap();
    // So exact that near a singular pose no configuration next to a solution is one.
    let arm = Arm::builder(&model, "base", "tool").with_position_tolerance(1e-10);
    let arm = arm.with_orientation_tolerance(1e-10).with_atlas(false);
    arm.build().unwrap()
}

fn full_turn(rows: &[Row]) -> Arm {
    arm_of(rows, Limits::new(-PI, PI))
}

fn assert_solutions(arm: &Arm, target: &Placement<f64>, all: &AllSolutions) {
    for (i, solution) in all.solutions.iter().enumerate() {
        let found = arm.base_from_tool(&solution.q).unwrap();
        let (metres, radians) = apart(&from_placement(&found), &from_placement(target));
        assert!(metres < 1e-8 && radians < 1e-8, "{metres:e} {radians:e}");
        assert!((metres - solution.position_error).abs() < 1e-9);
        assert!(within_limits(arm, &solution.q));
        let is_new = |other: &PoseSolution| distance(&solution.q, &other.q) > 1e-5;
        assert!(all.solutions[..i].iter().all(is_new));
    }
}

/// Largest difference of two configurations, up to whole turns.
fn angle_between(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| {
        let difference = (a - b).rem_euclid(TAU);
        difference.min(TAU - difference)
    });
    differences.fold(0.0, f64::max)
}

fn contains(all: &AllSolutions, q: &[f64]) -> bool {
    let is_equal = |solution: &PoseSolution| angle_between(&solution.q, q) < 1e-4;
    all.solutions.iter().any(is_equal)
}

#[test]
fn configuration_of_the_target_is_found() {
    let ur = robot("universal_ur5e");
    let ur = Arm::builder(&ur, "base", "flange")
        .with_atlas(false)
        .build();
    let arms = [
        (ur.unwrap(), Argument::ThreeParallelAxes),
        (full_turn(&PUMA), Argument::SphericalWrist),
        (full_turn(&OFFSET_WRIST), Argument::None),
        (full_turn(&MANSEUR_DOTY), Argument::None),
        (full_turn(&GENERAL), Argument::None),
    ];
    for (arm, argument) in &arms {
        let mut random = Random::split_mix(71);
        let (mut complete, mut all_cases) = (0, 0);
        for _ in cases(200, 40) {
            let q = random.configuration(arm);
            let target = arm.base_from_tool(&q).unwrap();
            let all = arm.solve_all(target).unwrap();
            assert_solutions(arm, &target, &all);
            assert!(contains(&all, &q), "{argument:?} {q:?}");
            if *argument != Argument::None {
                assert_eq!(all.argument, *argument);
            }
            complete += usize::from(all.complete);
            all_cases += 1;
        }
        assert!(complete * 20 >= all_cases * 19, "{argument:?}: {complete}");
    }
}

/// An elimination knows nothing of a closed form's structure: a tilt of the axes by 1e-3 rad hides it.
#[test]
fn nearly_structured_arms_have_as_many_solutions() {
    let mut tilted = PUMA;
    for (i, row) in tilted.iter_mut().enumerate() {
        row.2 += 1e-3 * (1.0 + 0.3 * i as f64);
        row.0 += 1e-3;
    }
    let (exact, tilted) = (full_turn(&PUMA), full_turn(&tilted));
    let mut random = Random::split_mix(72);
    for _ in cases(100, 30) {
        let q = random.configuration(&exact);
        let [all, of_tilted] = [&exact, &tilted].map(|arm| {
            let target = arm.base_from_tool(&q).unwrap();
            (arm.solve_all(target).unwrap(), target)
        });
        assert!(contains(&of_tilted.0, &q));
        // Away from singular poses the solutions of both are neighbours.
        let is_near = |solution: &PoseSolution| {
            let mut near = of_tilted.0.solutions.iter();
            near.any(|other| angle_between(&solution.q, &other.q) < 0.2)
        };
        let near = all
            .0
            .solutions
            .iter()
            .filter(|solution| is_near(solution))
            .count();
        assert!(near >= 6 || all.0.solutions.len() < 8, "{near}");
    }
}

#[test]
fn attempts_find_no_other_solution() {
    for rows in [&PUMA, &OFFSET_WRIST, &GENERAL] {
        let arm = full_turn(rows);
        let mut random = Random::split_mix(73);
        for _ in cases(20, 4) {
            let target = arm.base_from_tool(&random.configuration(&arm)).unwrap();
            let all = arm.solve_all(target).unwrap();
            for _ in 0..100 {
                let start = random.configuration(&arm);
                let found = arm.solve(target, &start).unwrap();
                assert!(!found.reached || contains(&all, &found.q), "{:?}", found.q);
            }
        }
    }
}

#[test]
fn arm_of_manseur_and_doty_has_sixteen_solutions() {
    let arm = full_turn(&MANSEUR_DOTY);
    // The pose of their paper.
    let r = Matrix3::from_columns(
        Vector3::new(-0.760117, 0.133333, -0.635959),
        Vector3::new(-0.641689, 0.0, 0.766965),
        Vector3::new(0.102262, 0.991071, 0.085558),
    );
    let target = Placement::new(r, Vector3::new(-1.140175, 0.0, 0.0)).made_rigid();
    let all = arm.solve_all(target).unwrap();
    assert_solutions(&arm, &target, &all);
    assert_eq!(all.solutions.len(), 16);
    assert!(all.complete);
}

#[test]
fn whole_turns_within_limits_are_solutions() {
    let wide = arm_of(&PUMA, Limits::new(-TAU, TAU));
    let narrow = full_turn(&PUMA);
    let mut random = Random::split_mix(74);
    for _ in cases(20, 5) {
        let target = wide.base_from_tool(&random.configuration(&wide)).unwrap();
        let [turned, principal] = [&wide, &narrow].map(|arm| arm.solve_all(target).unwrap());
        assert_solutions(&wide, &target, &turned);
        assert_eq!(turned.solutions.len(), principal.solutions.len() * 64);
    }
}

#[test]
fn limits_are_inclusive() {
    let q = [0.3, -0.7, 0.9, 0.4, 1.1, -0.5];
    let target = full_turn(&PUMA).base_from_tool(&q).unwrap();
    let arm = arm_of(&PUMA, Limits::new(-0.7, 1.1));
    let all = arm.solve_all(target).unwrap();
    assert!(contains(&all, &q));
    assert!(within_limits(&arm, &all.solutions[0].q));
    let arm = arm_of(&PUMA, Limits::new(-0.7 + 1e-6, 1.1));
    assert!(!contains(&arm.solve_all(target).unwrap(), &q));
}

/// Each of the eight solutions of an arm with a spherical wrist has another combination of branches.
#[test]
fn branches_name_the_solutions() {
    let ur = robot("universal_ur5e");
    let ur = Arm::builder(&ur, "base", "flange").with_atlas(false);
    let ur = ur.with_joint_limits("joint3", Limits::new(-PI, PI));
    for (arm, turns) in [(full_turn(&PUMA), 1), (ur.build().unwrap(), 32)] {
        let mut random = Random::split_mix(75);
        for _ in cases(20, 5) {
            let target = arm.base_from_tool(&random.configuration(&arm)).unwrap();
            let all = arm.solve_all(target).unwrap();
            let mut branches: Vec<_> = all.solutions.iter().map(|s| s.branch).collect();
            assert!(
                branches
                    .iter()
                    .all(|b| b.shoulder.is_some() && b.elbow.is_some())
            );
            branches.sort_by_key(|branch| format!("{branch:?}"));
            let repeated = branches.chunk_by(|a, b| a == b).map(<[_]>::len);
            assert!(repeated.into_iter().all(|count| count == turns));
        }
    }
}

/// A stretched arm has a double solution, and an aligned wrist a family of solutions.
#[test]
fn singular_poses_keep_their_solutions() {
    let arm = full_turn(&PUMA);
    // The elbow angle at which the wrist is farthest from the shoulder.
    let stretched = [
        0.3,
        -0.4,
        (0.0203_f64 / 0.4318).atan() + FRAC_PI_2,
        0.5,
        0.8,
        -0.2,
    ];
    let all = arm
        .solve_all(arm.base_from_tool(&stretched).unwrap())
        .unwrap();
    let is_near = |s: &PoseSolution| angle_between(&s.q, &stretched) < 1e-3;
    assert!(all.solutions.iter().any(is_near), "{all:?}");
    let aligned = [0.3, -0.4, 0.8, 0.5, 0.0, -0.2];
    let all = arm
        .solve_all(arm.base_from_tool(&aligned).unwrap())
        .unwrap();
    assert!(all.has_family && !all.complete && all.argument == Argument::None);
    assert!(!all.solutions.is_empty());
}

#[test]
fn unreachable_target_has_a_complete_empty_set() {
    for rows in [&PUMA, &OFFSET_WRIST, &GENERAL] {
        let arm = full_turn(rows);
        let target = Placement::translation(Vector3::new(5.0, 0.0, 0.0));
        let all = arm.solve_all(target).unwrap();
        assert!(all.solutions.is_empty() && all.complete);
    }
}

#[test]
fn nearest_search_returns_the_nearest_of_the_set() {
    for rows in [&PUMA, &OFFSET_WRIST] {
        let arm = arm_of(rows, Limits::new(-TAU, TAU));
        let arm = arm.with_search(Search::Nearest).unwrap();
        let mut random = Random::split_mix(76);
        for _ in cases(50, 10) {
            let target = arm.base_from_tool(&random.configuration(&arm)).unwrap();
            let start = random.configuration(&arm);
            let all = arm.solve_all_from(target, &start).unwrap();
            let nearest = arm.solve(target, &start).unwrap();
            assert!(nearest.reached);
            let [ours, first] = [&nearest.q, &all.solutions[0].q].map(|q| distance(q, &start));
            assert!(ours <= first + 1e-9, "{ours} {first}");
        }
    }
}
