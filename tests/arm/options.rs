//! Promise: every option of an arm has its documented effect, checked by independent kinematics of the file.

use std::sync::OnceLock;

use kinopt::arm::{Arm, ArmBuilder, Axis, PoseBounds, Search};
use kinopt::robot::Robot;
use kinopt::solver::Termination;
use nalgebra::{DMatrix, DVector};
use support::arms::{distance, within_limits};
use support::random::{Random, case_count, cases};
use support::urdf_matrices::{Matrix, Tree, apart, inverse, placement, product};

const FILE: &str = "../models/franka_panda.urdf";
const POSTURE: [f64; 7] = [0.0, 0.0, 0.5, -1.5, 0.2, 1.8, 0.4];

fn builder() -> ArmBuilder<'static> {
    static ROBOT: OnceLock<Robot> = OnceLock::new();
    let robot = ROBOT.get_or_init(|| Robot::read(FILE).unwrap());
    Arm::builder(robot, "base", "flange")
}

fn base_from_tip(q: &[f64]) -> Matrix {
    static TREE: OnceLock<Tree> = OnceLock::new();
    let tree = TREE.get_or_init(|| Tree::read(FILE));
    const NAMES: [&str; 7] = [
        "joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7",
    ];
    let values: Vec<_> = NAMES.into_iter().zip(q.iter().copied()).collect();
    tree.base_from_tip("base", "flange", &values)
}

/// Column of a rotation, or the translation.
fn column(matrix: &Matrix, j: usize) -> [f64; 3] {
    [matrix[0][j], matrix[1][j], matrix[2][j]]
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Angle between two unit vectors, exact near 0.
fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let chord = norm(std::array::from_fn(|k| a[k] - b[k]));
    2.0 * (0.5 * chord).asin()
}

/// Vector part of the quaternion of a rotation below half a turn.
fn quaternion_vector(r: &Matrix) -> [f64; 3] {
    let w = 0.5 * (1.0 + r[0][0] + r[1][1] + r[2][2]).sqrt();
    [
        (r[2][1] - r[1][2]) / (4.0 * w),
        (r[0][2] - r[2][0]) / (4.0 * w),
        (r[1][0] - r[0][1]) / (4.0 * w),
    ]
}

/// The arm of a search, with an atlas if the search uses one; built once.
fn plain(search: Search) -> &'static Arm {
    static ARMS: [OnceLock<Arm>; 3] = [const { OnceLock::new() }; 3];
    let (index, atlas) = match search {
        Search::Start => (0, false),
        Search::First => (1, true),
        _ => (2, false),
    };
    ARMS[index].get_or_init(|| {
        let arm = builder().with_search(search).with_atlas(atlas);
        arm.build().unwrap()
    })
}

/// Solves random poses from random starts and passes (target, found) to `judge`. Returns the number of solves.
fn solved(goal: PoseBounds, count: usize, mut judge: impl FnMut(&Matrix, &Matrix)) -> usize {
    let count = case_count(count, count.div_ceil(3));
    let mut all = 0;
    for search in [Search::Start, Search::First, Search::Nearest] {
        let arm = plain(search).with_goal(goal).unwrap();
        let mut random = Random::split_mix(41);
        let count = if search == Search::Nearest {
            count.div_ceil(3)
        } else {
            count
        };
        all += count;
        for _ in 0..count {
            let target = base_from_tip(&random.configuration(&arm));
            let start = random.configuration(&arm);
            let solution = arm.solve(placement(&target), &start).unwrap();
            assert!(solution.reached, "{}", solution.explain());
            assert!(within_limits(&arm, &solution.q));
            judge(&target, &base_from_tip(&solution.q));
        }
    }
    all
}

#[test]
fn position_goal_leaves_orientation_free() {
    let mut turned = 0;
    let all = solved(PoseBounds::position(), 30, |target, found| {
        let (metres, radians) = apart(target, found);
        assert!(metres <= 1e-6, "{metres:e}");
        turned += usize::from(radians > 0.1);
    });
    assert!(2 * turned > all, "the freedom was not used: {turned}");
}

#[test]
fn free_rotation_about_any_tool_axis() {
    for (axis, j) in [(Axis::X, 0), (Axis::Y, 1), (Axis::Z, 2)] {
        let mut turned = 0;
        let all = solved(PoseBounds::free_about(axis), 18, |target, found| {
            let (metres, radians) = apart(target, found);
            let tilt = angle(column(target, j), column(found, j));
            assert!(
                metres <= 1e-6 && tilt <= 1e-6,
                "{axis:?}: {metres:e} {tilt:e}"
            );
            turned += usize::from(radians > 0.1);
        });
        assert!(3 * turned > all, "the freedom was not used: {turned}");
    }
}

#[test]
fn free_translation_along_any_tool_axis() {
    for (axis, j) in [(Axis::X, 0), (Axis::Y, 1), (Axis::Z, 2)] {
        let mut slid = 0;
        let all = solved(PoseBounds::free_along(axis), 12, |target, found| {
            let mut offset = column(&product(&inverse(target), found), 3);
            slid += usize::from(offset[j].abs() > 0.01);
            offset[j] = 0.0;
            let (_, radians) = apart(target, found);
            assert!(
                norm(offset) <= 1e-6 && radians <= 1e-6,
                "{axis:?}: {offset:?} {radians:e}"
            );
        });
        assert!(3 * slid > all, "the freedom was not used: {slid}");
    }
}

#[test]
fn goal_bounds_in_the_tool_frame_hold() {
    let (inf, pi) = (f64::INFINITY, std::f64::consts::PI);
    for half_widths in [
        [0.01, 0.0, 0.02, 0.1, 0.0, 0.2],
        [0.0, 0.0, 0.0, 0.3, 0.2, 0.4],
        [0.05, 0.05, 0.05, 0.0, 0.0, 0.0],
        [inf, 0.03, 0.0, 0.2, pi, 0.0],
    ] {
        let mut used = 0;
        let all = solved(PoseBounds::within(half_widths), 9, |target, found| {
            let offset = product(&inverse(target), found);
            let excess = |value: f64, half_width: f64| (value.abs() - half_width).max(0.0);
            let (p, v) = (column(&offset, 3), quaternion_vector(&offset));
            let metres = norm(std::array::from_fn(|k| excess(p[k], half_widths[k])));
            // A rotation by θ about one axis has the component 2 sin(θ / 2).
            let chords = std::array::from_fn(|k| {
                let half_width = half_widths[3 + k];
                let half_width = if half_width >= pi {
                    inf
                } else {
                    2.0 * (0.5 * half_width).sin()
                };
                excess(2.0 * v[k], half_width)
            });
            assert!(metres <= 1e-6, "{half_widths:?}: {metres:e}");
            assert!(norm(chords) <= 1e-6, "{half_widths:?}: {chords:?}");
            let (metres, radians) = apart(target, found);
            used += usize::from(metres > 1e-4 || radians > 1e-3);
        });
        assert!(3 * used > all, "the room was not used: {used}");
    }
}

#[test]
fn tolerances_are_met() {
    for (metres, radians) in [(1e-2, 1e-1), (1e-4, 1e-8), (1e-10, 1e-10)] {
        let arm = builder().with_position_tolerance(metres);
        let arm = arm.with_orientation_tolerance(radians).build().unwrap();
        let mut random = Random::split_mix(42);
        for _ in cases(30, 10) {
            let target = base_from_tip(&random.configuration(&arm));
            let start = random.configuration(&arm);
            let solution = arm.solve(placement(&target), &start).unwrap();
            let (p, r) = apart(&target, &base_from_tip(&solution.q));
            assert!(solution.reached, "{metres:e}: {}", solution.explain());
            // The two evaluations differ by up to 1e-14 by rounding.
            assert!(p <= metres + 1e-14 && r <= radians + 1e-14, "{p:e} {r:e}");
        }
    }
}

/// Jacobian of the pose by central differences of matrices: translation and rotation in base axes.
fn jacobian(q: &[f64]) -> DMatrix<f64> {
    let h = 1e-6;
    let mut jacobian = DMatrix::zeros(6, q.len());
    for k in 0..q.len() {
        let moved = |angle: f64| {
            let mut q = q.to_vec();
            q[k] += angle;
            base_from_tip(&q)
        };
        let (less, more) = (moved(-h), moved(h));
        let turn = quaternion_vector(&product(&more, &inverse(&less)));
        for i in 0..3 {
            jacobian[(i, k)] = (more[i][3] - less[i][3]) / (2.0 * h);
            jacobian[(3 + i, k)] = 2.0 * turn[i] / (2.0 * h);
        }
    }
    jacobian
}

/// Largest null-space component of a wanted displacement, over the joints that it does not push out of their limits.
fn null_space_part(arm: &Arm, q: &[f64], posture: &[f64]) -> f64 {
    let jacobian = jacobian(q);
    let mut held = vec![false; q.len()];
    loop {
        let free: Vec<usize> = (0..q.len()).filter(|&k| !held[k]).collect();
        let columns = jacobian.select_columns(&free);
        let displacement =
            DVector::from_iterator(free.len(), free.iter().map(|&k| posture[k] - q[k]));
        let inverse = columns.clone().pseudo_inverse(1e-9).unwrap();
        let displacement = &displacement - inverse * (&columns * &displacement);
        let limits: Vec<_> = arm.limits().collect();
        let outward = |&(i, &k): &(usize, &usize)| {
            (q[k] <= limits[k].lower && displacement[i] < 0.0)
                || (q[k] >= limits[k].upper && displacement[i] > 0.0)
        };
        match free.iter().enumerate().find(outward) {
            Some((_, &k)) => held[k] = true,
            None => return displacement.norm(),
        }
    }
}

#[test]
fn posture_is_closest_within_the_null_space() {
    for search in [Search::Start, Search::First] {
        let plain = plain(search);
        let atlas = search == Search::First;
        let posed = builder().with_search(search).with_atlas(atlas);
        let posed = posed.with_posture(&POSTURE).build().unwrap();
        let mut random = Random::split_mix(43);
        let (mut nearer, mut best) = (0, 0);
        for _ in 0..40 {
            let target = base_from_tip(&random.configuration(plain));
            let start = random.configuration(plain);
            let a = plain.solve(placement(&target), &start).unwrap();
            let b = posed.solve(placement(&target), &start).unwrap();
            assert!(a.reached && b.reached && within_limits(&posed, &b.q));
            let (metres, radians) = apart(&target, &base_from_tip(&b.q));
            assert!(metres <= 1e-6 && radians <= 1e-6, "{metres:e} {radians:e}");
            let (before, after) = (distance(&a.q, &POSTURE), distance(&b.q, &POSTURE));
            assert!(after <= before, "{before} {after}");
            nearer += usize::from(after < before - 1e-3);
            let left = null_space_part(&posed, &b.q, &POSTURE);
            best += usize::from(left < 1e-2);
        }
        assert!(nearer >= 25 && best >= 36, "{search:?}: {nearer} {best}");
    }
}

#[test]
fn joint_weights_define_the_nearest_solution() {
    let weights = [5.0, 1.0, 1.0, 0.2, 1.0, 1.0, 0.1];
    let even = plain(Search::Nearest);
    let weighted = builder().with_search(Search::Nearest).with_atlas(false);
    let weighted = weighted.with_joint_weights(&weights).build().unwrap();
    let move_cost = |a: &[f64], b: &[f64]| {
        let parts = a.iter().zip(b).zip(weights);
        parts
            .map(|((a, b), w)| (w * (a - b)).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let mut random = Random::split_mix(44);
    let (mut nearer, mut counted, mut best, cases) = (0, 0, 0, case_count(20, 8));
    for _ in 0..cases {
        let target = placement(&base_from_tip(&random.configuration(even)));
        let start = random.configuration(even);
        let a = even.solve(target, &start).unwrap();
        let b = weighted.solve(target, &start).unwrap();
        assert!(a.reached && b.reached);
        nearer += usize::from(move_cost(&b.q, &start) <= move_cost(&a.q, &start) + 1e-9);
        // Without active limits, the weighted displacement from the start is orthogonal to the null space.
        let weighted_jacobian = jacobian(&b.q)
            * DMatrix::from_diagonal(&DVector::from_iterator(7, weights.iter().map(|w| 1.0 / w)));
        let displacement = DVector::from_fn(7, |k, _| weights[k] * (b.q[k] - start[k]));
        let inverse = weighted_jacobian.clone().pseudo_inverse(1e-9).unwrap();
        let left = (&displacement - inverse * (&weighted_jacobian * &displacement)).norm();
        let mut inside = weighted.limits().zip(&b.q);
        if inside.all(|(l, q)| l.lower < *q && *q < l.upper) {
            counted += 1;
            best += usize::from(left < 1e-2);
        }
    }
    assert!(nearer * 100 >= cases * 95, "{nearer} of {cases}");
    assert!(
        counted * 4 >= cases && best * 10 >= counted * 9,
        "{best} of {counted}"
    );
}

#[test]
fn move_limits_hold_exactly() {
    let inf = f64::INFINITY;
    let max_move = [0.3, 0.0, inf, 0.2, 1e-9, inf, 0.5];
    let arm = builder().with_max_move(&max_move).build().unwrap();
    let mut random = Random::split_mix(45);
    let (mut reached, mut stuck) = (0, 0);
    for k in 0..40 {
        // Every other start is outside the limits: move limits apply from its projection.
        let mut start = random.configuration(&arm);
        if k % 2 == 0 {
            start[3] += 9.0;
        }
        let limits: Vec<_> = arm.limits().collect();
        let inside: Vec<f64> = limits
            .iter()
            .zip(&start)
            .map(|(l, v)| l.clamp(*v))
            .collect();
        let truth: Vec<f64> = if k % 4 < 2 {
            let moved = inside.iter().zip(max_move).zip(&limits);
            moved
                .map(|((v, max_move), l)| {
                    l.clamp(v + max_move.min(0.4) * (2.0 * random.unit() - 1.0))
                })
                .collect()
        } else {
            random.configuration(&arm)
        };
        let target = base_from_tip(&truth);
        let solution = arm.solve(placement(&target), &start).unwrap();
        assert!(within_limits(&arm, &solution.q));
        for ((value, from), max_move) in solution.q.iter().zip(&inside).zip(max_move) {
            assert!(
                (value - from).abs() <= max_move,
                "{value} {from} {max_move}"
            );
        }
        let (metres, radians) = apart(&target, &base_from_tip(&solution.q));
        assert_eq!(solution.reached, metres <= 1e-6 && radians <= 1e-6);
        if k % 4 < 2 {
            assert!(solution.reached, "{}", solution.explain());
        }
        if solution.reached {
            reached += 1;
        } else {
            stuck += 1;
            assert_eq!(solution.termination, Termination::CannotContinue);
            assert!(
                solution.active_limits().count() > 0,
                "{}",
                solution.explain()
            );
        }
    }
    assert!(reached >= 20 && stuck >= 15, "{reached} {stuck}");
}

#[test]
fn seeds_reproduce_and_vary_results() {
    let arm = |search, seed| {
        let builder = builder().with_search(search).with_seed(seed);
        builder.with_atlas(false).build().unwrap()
    };
    for search in [Search::First, Search::Start] {
        let (one, again, other) = (arm(search, 1), arm(search, 1), arm(search, 2));
        let mut random = Random::split_mix(46);
        let mut changed = 0;
        for _ in 0..30 {
            let target = placement(&base_from_tip(&random.configuration(&one)));
            let start = random.configuration(&one);
            let a = one.solve(target, &start).unwrap();
            let b = other.solve(target, &start).unwrap();
            assert!(a.reached && b.reached);
            let same = again.solve(target, &start).unwrap();
            assert_eq!((&a.q, a.iterations), (&same.q, same.iterations));
            changed += usize::from(a.q != b.q);
        }
        assert!(changed >= 5, "{search:?}: {changed}");
    }
    // From nearby the attempt from the start succeeds, so seeds have no influence.
    let (one, other) = (arm(Search::Start, 1), arm(Search::Start, 2));
    let mut random = Random::split_mix(47);
    for _ in 0..20 {
        let start = random.configuration(&one);
        let near: Vec<f64> = (start.iter().zip(one.limits()))
            .map(|(v, l)| l.clamp(v + 0.02 * (random.unit() - 0.5)))
            .collect();
        let target = placement(&base_from_tip(&near));
        let a = one.solve(target, &start).unwrap();
        assert_eq!(a.q, other.solve(target, &start).unwrap().q);
    }
}

#[test]
fn option_out_of_range_is_named() {
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let b = builder;
    for (invalid, name) in [
        (b().with_position_tolerance(0.0), "position_tolerance"),
        (b().with_position_tolerance(nan), "position_tolerance"),
        (
            b().with_orientation_tolerance(-1.0),
            "orientation_tolerance",
        ),
        (b().with_orientation_tolerance(inf), "orientation_tolerance"),
        (b().with_metres_per_radian(0.0), "metres_per_radian"),
        (
            b().with_goal(PoseBounds::within([nan, 0.0, 0.0, 0.0, 0.0, 0.0])),
            "goal",
        ),
        (
            b().with_goal(PoseBounds::within([0.0, 0.0, 0.0, 0.0, -0.1, 0.0])),
            "goal",
        ),
        (b().with_goal(PoseBounds::within([inf; 6])), "goal"),
        (b().with_attempts(0), "attempts"),
        (b().with_iterations(0), "iterations"),
        (b().with_limit_avoidance(-1e-9), "limit_avoidance"),
        (b().with_limit_avoidance(nan), "limit_avoidance"),
        (b().with_limit_avoidance(inf), "limit_avoidance"),
        (b().with_joint_weights(&[1.0; 6]), "joint_weights"),
        (b().with_joint_weights(&[0.0; 7]), "joint_weights"),
        (b().with_max_move(&[0.1; 8]), "max_move"),
        (b().with_max_move(&[nan; 7]), "max_move"),
        (b().with_max_move(&[-0.1; 7]), "max_move"),
        (b().with_posture(&[0.0; 3]), "posture"),
        (b().with_posture(&[nan; 7]), "posture"),
        (
            b().with_posture(&POSTURE).with_search(Search::Nearest),
            "posture",
        ),
    ] {
        let error = invalid.build().unwrap_err().to_string();
        assert!(error.contains(name), "{name}: {error}");
        // Errors of joint counts list the joints.
        let listed = !error.contains("for each free joint") || error.contains("joint1, joint2");
        assert!(listed, "{error}");
    }
}

/// A posture outside the limits is clamped.
#[test]
fn posture_is_clamped_to_the_limits() {
    let (robot, base, tip) = support::arms::panda();
    let posed = |posture: &[f64]| {
        let arm = Arm::builder(&robot, base, tip).with_atlas(false);
        arm.with_posture(posture).build().unwrap()
    };
    let beyond = [9.0, -9.0, 0.3, -9.0, 9.0, 9.0, -0.4];
    let arm = posed(&beyond);
    let limits = arm.limits().zip(&beyond);
    let within: Vec<f64> = limits.map(|(limits, q)| limits.clamp(*q)).collect();
    let target = arm
        .base_from_tool(&[0.1, -0.3, 0.2, -2.0, 0.2, 1.7, 0.4])
        .unwrap();
    let [one, other] = [arm, posed(&within)].map(|arm| arm.solve(target, &[0.0; 7]).unwrap());
    assert!(one.reached && one.q == other.q);
}

/// Path followers and tracks keep the move limits in every step.
#[test]
fn move_limits_hold_in_every_path_step() {
    let arm = builder().with_max_move(&[0.02; 7]).build().unwrap();
    let mut random = Random::split_mix(46);
    for _ in 0..6 {
        let [start, target_q] = [(); 2].map(|()| random.configuration(&arm));
        let target = arm.base_from_tool(&target_q).unwrap();
        let mut follower = arm.follower(&start).unwrap();
        let (mut last, mut solution) = (start.clone(), kinopt::Solution::default());
        let assert_same_configuration = |last: &mut Vec<f64>, q: &[f64]| {
            for (value, from) in q.iter().zip(&*last) {
                assert!((value - from).abs() <= 0.02 + 1e-15, "{value} {from}");
            }
            last.copy_from_slice(q);
        };
        for _ in 0..20 {
            follower.advance(target, &mut solution).unwrap();
            assert_same_configuration(&mut last, &solution.q);
        }
        last.copy_from_slice(&start);
        for solution in arm.track(&[target; 20], &start).unwrap().report {
            assert_same_configuration(&mut last, &solution.q);
        }
    }
}

/// A position goal leaves three degrees of freedom of six joints to a posture.
#[test]
fn posture_uses_the_freedom_of_a_position_goal() {
    let robot = support::arms::robot("universal_ur5e");
    let builder = || Arm::builder(&robot, "base", "flange").with_goal(PoseBounds::position());
    let posture = [0.1, -1.0, 0.9, -1.2, -0.7, 0.3];
    let plain = builder().build().unwrap();
    let with_posture = builder().with_posture(&posture).build().unwrap();
    let mut random = Random::split_mix(47);
    let (mut led_by, mut not_led) = (0.0, 0.0);
    for _ in 0..10 {
        let mut nearby = |size: f64| -> Vec<f64> {
            let near = posture.iter();
            near.map(|value| value + size * (2.0 * random.unit() - 1.0))
                .collect()
        };
        let (target_q, start) = (nearby(0.3), nearby(0.8));
        let target = plain.base_from_tool(&target_q).unwrap();
        let found = [&plain, &with_posture].map(|arm| arm.solve(target, &start).unwrap());
        assert!(found.iter().all(|solution| solution.reached));
        let [without, with] = found.map(|solution| distance(&solution.q, &posture));
        // The target's own configuration has that distance as well.
        assert!(with <= distance(&target_q, &posture), "{with} {without}");
        (led_by, not_led) = (led_by + with, not_led + without);
    }
    assert!(1.5 * led_by < not_led, "{led_by} {not_led}");
}
