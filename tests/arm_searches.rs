//! Nearest is nearest, distinct ones differ, postures and bounded moves keep their word.
#![cfg(feature = "urdf")]
#![allow(clippy::unwrap_used)]

mod arm_support;

use arm_support::{Random, apart, base_from_tip, distance, panda, robot, within_limits};
use kinopt::arm::{Arm, Axis, Goal, Search};
use kinopt::robot::Robot;
use kinopt::solver::Termination;

fn nearest_beats_restarts(robot: &Robot, base: &str, tip: &str) {
    let build = |search, seed| {
        let builder = Arm::builder(robot, base, tip).unwrap().with_seed(seed);
        builder.with_search(search).build().unwrap()
    };
    let (nearest, first) = (build(Search::Nearest, 0), build(Search::Start, 0));
    let mut random = Random(3);
    let (cases, mut kept) = (20, 0);
    for _ in 0..cases {
        let truth = random.configuration(&nearest);
        let wanted = nearest.base_from_tool(&truth).unwrap();
        let start = random.configuration(&nearest);
        let ours = nearest.solve(wanted, &start).unwrap();
        assert!(ours.reached && within_limits(&nearest, &ours.q));
        let mut best = f64::INFINITY;
        for _ in 0..100 {
            let other = first.solve(wanted, &random.configuration(&first)).unwrap();
            best = best.min(distance(&other.q, &start));
        }
        kept += usize::from(distance(&ours.q, &start) <= best + 1e-9);
    }
    assert!(kept * 100 >= cases * 95, "{kept} of {cases}");
}

#[test]
fn nearest_is_at_least_as_near_as_a_hundred_restarts() {
    let (robot_, base, tip) = panda();
    nearest_beats_restarts(&robot_, base, tip);
    nearest_beats_restarts(&robot("kuka_iiwa14"), "base", "flange");
}

#[test]
fn distinct_solutions_differ_and_come_nearest_first() {
    let robot = robot("universal_ur5e");
    let search = Search::Distinct {
        k: 6,
        distance: 0.8,
    };
    let arm = Arm::builder(&robot, "base", "flange").unwrap();
    let arm = arm.with_search(search).build().unwrap();
    let mut random = Random(4);
    for _ in 0..10 {
        let wanted = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        let start = random.configuration(&arm);
        let all = arm.solve_all(wanted, &start).unwrap();
        assert!(all.len() >= 2 && all.len() <= 6);
        for (i, a) in all.iter().enumerate() {
            assert!(a.reached && within_limits(&arm, &a.q));
            assert!(all[i + 1..].iter().all(|b| distance(&a.q, &b.q) > 0.8));
        }
        assert!(
            all.windows(2)
                .all(|p| distance(&p[0].q, &start) <= distance(&p[1].q, &start))
        );
    }
}

#[test]
fn goals_that_leave_room() {
    let (robot, base, tip) = panda();
    let mut random = Random(5);
    let goals = [
        Goal::position(),
        Goal::free_about(Axis::Z),
        Goal::within([0.01, 0.0, 0.02, 0.1, 0.0, 0.2]),
    ];
    for goal in goals {
        let arm = Arm::builder(&robot, base, tip)
            .unwrap()
            .with_goal(goal)
            .build()
            .unwrap();
        for _ in 0..20 {
            let truth = random.configuration(&arm);
            let wanted = base_from_tip(robot.model(), &arm, &truth, base, tip);
            let solution = arm.solve(wanted, &random.configuration(&arm)).unwrap();
            assert!(solution.reached, "{}", solution.explain());
            let off = wanted.inverse() * base_from_tip(robot.model(), &arm, &solution.q, base, tip);
            let turn = off.rotation.scaled_axis();
            let chord = off.rotation.imag() * 2.0 * off.rotation.w.signum();
            let parts = off.translation.vector.iter().chain(chord.iter());
            for (k, (value, room)) in parts.zip(goal.half_widths()).enumerate() {
                let room = if k < 3 {
                    room
                } else {
                    room.min(std::f64::consts::PI)
                };
                assert!(value.abs() <= room + 1.1e-6, "{k}: {value} {room} {turn:?}");
            }
        }
    }
}

#[test]
fn a_posture_pulls_within_the_null_space() {
    let (robot, base, tip) = panda();
    let posture = [0.0, 0.0, 0.5, -1.5, 0.2, 1.8, 0.4];
    let plain = Arm::new(&robot, base, tip).unwrap();
    let posed = Arm::builder(&robot, base, tip)
        .unwrap()
        .with_posture(&posture);
    let posed = posed.build().unwrap();
    let mut random = Random(6);
    let mut nearer = 0;
    for _ in 0..30 {
        let wanted = plain.base_from_tool(&random.configuration(&plain)).unwrap();
        let start = random.configuration(&plain);
        let (a, b) = (
            plain.solve(wanted, &start).unwrap(),
            posed.solve(wanted, &start).unwrap(),
        );
        assert!(a.reached && b.reached && within_limits(&posed, &b.q));
        let at = base_from_tip(robot.model(), &posed, &b.q, base, tip);
        let (metres, radians) = apart(&at, &nalgebra::Isometry3::from(&wanted));
        assert!(metres <= 1e-6 && radians <= 1.05e-6);
        assert!(distance(&b.q, &posture) <= distance(&a.q, &posture) + 1e-12);
        nearer += usize::from(distance(&b.q, &posture) < distance(&a.q, &posture) - 0.05);
    }
    assert!(nearer >= 15, "{nearer}");
}

#[test]
fn bounded_moves_are_kept_and_named_when_they_do_not_suffice() {
    let (robot, base, tip) = panda();
    let most = [0.1; 7];
    let arm = Arm::builder(&robot, base, tip)
        .unwrap()
        .with_max_move(&most)
        .build()
        .unwrap();
    let mut random = Random(7);
    let (mut reached, mut stuck) = (0, 0);
    for k in 0..40 {
        let start = random.configuration(&arm);
        let goal = if k % 2 == 0 {
            let near: Vec<f64> = start
                .iter()
                .zip(arm.limits())
                .map(|(v, l)| l.clamp(v + 0.1 * (random.unit() - 0.5)))
                .collect();
            near
        } else {
            random.configuration(&arm)
        };
        let solution = arm
            .solve(arm.base_from_tool(&goal).unwrap(), &start)
            .unwrap();
        assert!(within_limits(&arm, &solution.q));
        assert!(
            solution
                .q
                .iter()
                .zip(&start)
                .all(|(a, b)| (a - b).abs() <= 0.1)
        );
        if solution.reached {
            reached += 1;
        } else {
            stuck += 1;
            assert_eq!(solution.termination, Termination::CannotContinue);
            assert_eq!(solution.termination.name(), "cannot_continue");
            assert!(solution.active_limits().count() > 0);
        }
        assert!(k % 2 == 1 || solution.reached, "{}", solution.explain());
    }
    assert!(reached >= 20 && stuck >= 15, "{reached} {stuck}");
}
