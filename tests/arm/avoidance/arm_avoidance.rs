//! Promise: a reached solution of an arm with collision avoidance is collision-free by exact distances. If none is
//! found, the solution names the contacts.

use std::f64::consts::TAU;

use kinopt::arm::{Arm, PoseOutcome, Search};
use kinopt::collision::{Checker, CollisionModel, World};
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::checked_arms::{CheckedArm, checked_arm, cluttered, panda};
use support::fault_tables::ExpectedError;
use support::random::{Random, case_count, cases};

#[test]
fn reached_solutions_are_collision_free() {
    let mut random = Random::new(14);
    let mut panda = panda(Search::Start);
    let (mut count, mut reached) = (0, 0);
    for margin in [0.0, 0.01] {
        for _ in cases(500, 30) {
            panda = panda.with_world(&cluttered(&mut random), margin);
            let (goal, start) = (
                panda.collision_free_configuration(&mut random),
                random.configuration(&panda.arm),
            );
            let target = panda.arm.base_from_tool(&goal).unwrap();
            let solution = panda.arm.solve(target, &start).unwrap();
            let touched = panda.arm.collisions(&solution.q).unwrap();
            count += 1;
            if solution.reached {
                reached += 1;
                assert!(touched.is_empty(), "{touched:?}");
                assert!(solution.collisions().is_empty());
            } else {
                assert_eq!(solution.collisions(), touched);
                assert!(solution.goals_reached(), "{}", solution.explain());
                assert!(
                    touched.iter().all(|pair| pair.distance < margin),
                    "{touched:?}"
                );
                let named = solution.explain().contains(&touched[0].second);
                assert!(named, "{}", solution.explain());
            }
        }
    }
    assert!(reached * 100 >= count * 97, "{reached} of {count}");
}

/// For joints with two turns, no result is a whole turn farther from the start than necessary.
#[test]
fn free_solution_is_no_whole_turn_away() {
    let mut random = Random::new(31);
    let mut ur5 = checked_arm("universal_ur5e", Search::Start);
    let plain = ur5.arm.clone();
    let mut went_round = 0;
    for _ in cases(300, 40) {
        ur5 = ur5.with_world(&cluttered(&mut random), 0.0);
        let (goal, start) = (
            ur5.collision_free_configuration(&mut random),
            random.configuration(&ur5.arm),
        );
        let target = ur5.arm.base_from_tool(&goal).unwrap();
        let solution = ur5.arm.solve(target, &start).unwrap();
        let straight = plain.solve(target, &start).unwrap();
        if !solution.reached || solution.q == straight.q {
            continue;
        }
        went_round += 1;
        let joints = solution.q.iter().zip(&start).zip(ur5.arm.limits());
        for ((q, start), limits) in joints {
            let turned = [q - TAU, q + TAU].into_iter();
            let mut others = turned.filter(|turned| limits.contains(*turned));
            let nearest = others.all(|other| (q - start).abs() <= (other - start).abs());
            assert!(nearest, "{q} from {start}");
        }
    }
    assert!(went_round > 5, "{went_round}");
}

#[test]
fn nearest_free_solution_is_nearest() {
    let mut random = Random::new(3);
    let mut near = panda(Search::Nearest);
    let mut any = panda(Search::Start);
    for _ in cases(40, 6) {
        let world = cluttered(&mut random);
        (near, any) = (near.with_world(&world, 0.0), any.with_world(&world, 0.0));
        let (goal, start) = (
            near.collision_free_configuration(&mut random),
            random.configuration(&near.arm),
        );
        let target = near.arm.base_from_tool(&goal).unwrap();
        let [nearest, other] = [&near, &any].map(|p| p.arm.solve(target, &start).unwrap());
        let distance = |q: &[f64]| {
            let squares = q.iter().zip(&start).map(|(a, b)| (a - b) * (a - b));
            squares.sum::<f64>().sqrt()
        };
        assert!(nearest.reached || !other.reached);
        if other.reached {
            let (nearest, other) = (distance(&nearest.q), distance(&other.q));
            assert!(nearest <= other + 1e-9, "{nearest} {other}");
        }
    }
}

#[test]
fn all_solutions_are_collision_free() {
    let mut random = Random::new(41);
    let mut panda = panda(Search::Start);
    let plain = panda.arm.clone();
    let (mut listed, mut touching) = (0, 0);
    for _ in cases(40, 8) {
        panda = panda.with_world(&cluttered(&mut random), 0.01);
        let (goal, start) = (
            panda.collision_free_configuration(&mut random),
            random.configuration(&panda.arm),
        );
        let target = panda.arm.base_from_tool(&goal).unwrap();
        for solution in panda.arm.solve_all_from(target, &start).unwrap().solutions {
            assert!(panda.arm.collisions(&solution.q).unwrap().is_empty());
            listed += 1;
        }
        for solution in plain.solve_all_from(target, &start).unwrap().solutions {
            touching += usize::from(!panda.arm.collisions(&solution.q).unwrap().is_empty());
        }
    }
    assert!(listed > 10 && touching > 10, "{listed} {touching}");
}

/// Counts include the attempts before a contact was found.
#[test]
fn continued_search_reports_total_counts() {
    let mut random = Random::new(8);
    let near = panda(Search::Nearest);
    let plain = near.arm.with_search(Search::Nearest).unwrap();
    let near = near.with_world(&cluttered(&mut random), 0.0);
    let searched_on = (0..60).find_map(|_| {
        let (goal, start) = (
            near.collision_free_configuration(&mut random),
            random.configuration(&near.arm),
        );
        let target = near.arm.base_from_tool(&goal).unwrap();
        let first = plain.solve(target, &start).unwrap();
        let touches = !near.arm.collisions(&first.q).unwrap().is_empty();
        touches.then(|| (first, near.arm.solve(target, &start).unwrap()))
    });
    let (first, clear) = searched_on.unwrap();
    assert!(clear.iterations > first.iterations);
    assert!(clear.attempts > first.attempts);
}

/// A collision-free result comes from an attempt after those of the plain result, which is in contact.
#[test]
fn winner_is_numbered_over_all_attempts() {
    for search in [Search::Start, Search::Nearest] {
        let mut random = Random::new(8);
        let near = panda(search);
        let plain = near.arm.with_search(search).unwrap();
        let near = near.with_world(&cluttered(&mut random), 0.0);
        let mut went_on = 0;
        for _ in cases(240, 90) {
            let (goal, start) = (
                near.collision_free_configuration(&mut random),
                random.configuration(&near.arm),
            );
            let targets = [near.arm.base_from_tool(&goal).unwrap()];
            let outcomes = [&plain, &near.arm].map(|arm| {
                let (mut q, mut outcomes) = ([0.0; 7], [PoseOutcome::default()]);
                arm.solve_batch_into(&targets, &start, &mut q, &mut outcomes)
                    .unwrap();
                outcomes[0]
            });
            let [first, clear] = outcomes;
            let Some(winner) = clear.winner else {
                continue;
            };
            assert!(winner < clear.attempts, "{clear:?}");
            if clear.attempts > first.attempts {
                went_on += 1;
                assert!(winner >= first.attempts, "{first:?} {clear:?}");
            }
        }
        assert!(went_on > 3, "{went_on}");
    }
}

/// The limit of attempts applies once to the plain search and once to the collision-free one.
#[test]
fn attempts_stay_within_the_limit() {
    for attempts in [1, 3] {
        let mut random = Random::new(8);
        let alone = panda(Search::Start);
        let few = Arm::builder(&robot("franka_panda"), "base", "flange")
            .with_search(Search::Start)
            .with_attempts(attempts)
            .build()
            .unwrap();
        let few = CheckedArm { arm: few, ..alone }.with_world(&cluttered(&mut random), 0.0);
        let mut went_on = 0;
        for _ in 0..240 {
            let (goal, start) = (
                few.collision_free_configuration(&mut random),
                random.configuration(&few.arm),
            );
            let target = few.arm.base_from_tool(&goal).unwrap();
            let solution = few.arm.solve(target, &start).unwrap();
            assert!(
                solution.attempts <= 2 * attempts as usize,
                "{} of {attempts}",
                solution.attempts
            );
            went_on += usize::from(solution.attempts > attempts as usize);
        }
        assert!(went_on > 3, "{went_on}");
    }
}

#[test]
fn target_in_an_obstacle_is_reported() {
    let goal = [0.3, 0.2, 0.1, -1.8, 0.1, 2.0, 0.5];
    let alone = panda(Search::Start);
    let target = alone.arm.base_from_tool(&goal).unwrap();
    let mut world = World::new();
    world
        .add_box("crate", [0.3; 3], target.translation)
        .unwrap();
    let panda = alone.with_world(&world, 0.0);
    let solution = panda.arm.solve(target, &goal).unwrap();
    assert!(!solution.reached && solution.goals_reached());
    assert!(solution.position_error().unwrap() < 1e-6);
    assert!(
        solution
            .collisions()
            .iter()
            .any(|pair| pair.second == "crate" && pair.depth() > 0.05)
    );
    let text = solution.explain();
    assert!(
        text.contains("`crate`") && text.starts_with("Not reached"),
        "{text}"
    );
    // A batch gives the same result.
    let batch = panda.arm.solve_batch(&[target], &goal).unwrap();
    assert_eq!(batch[0].q, solution.q);
    assert_eq!(batch[0].collisions(), solution.collisions());
    // A target out of reach is not reported as in contact.
    let unreachable = Placement::translation(Vector3::new(3.0, 0.0, 0.0));
    let solution = panda.arm.solve(unreachable, &goal).unwrap();
    assert!(!solution.reached && !solution.goals_reached());
}

#[test]
fn changed_tool_keeps_the_checker() {
    let mut random = Random::new(21);
    let world = cluttered(&mut random);
    let panda = panda(Search::Start).with_world(&world, 0.0);
    let tool = Placement::translation(Vector3::new(0.0, 0.0, 0.1));
    let tooled = panda.arm.with_tool(tool).unwrap();
    let mut checked = 0;
    while checked < case_count(100, 15) {
        let start = random.configuration(&panda.arm);
        let target = tooled
            .base_from_tool(&panda.collision_free_configuration(&mut random))
            .unwrap();
        let solution = tooled.solve(target, &start).unwrap();
        assert_eq!(
            solution.reached,
            tooled.collisions(&solution.q).unwrap().is_empty()
        );
        checked += 1;
    }
}

#[test]
fn checker_of_another_model_is_rejected() {
    let panda = panda(Search::Start);
    let other = CollisionModel::of(&robot("universal_ur5e")).unwrap();
    panda
        .arm
        .with_checker(&Checker::new(other), &[0.0; 6])
        .says("checker");
}

#[test]
fn locked_joints_are_checked_at_locked_values() {
    let mut random = Random::new(31);
    let CheckedArm {
        checker, q_model, ..
    } = panda(Search::Start);
    let robot = robot("franka_panda");
    let builder = Arm::builder(&robot, "base", "flange").with_locked("joint3", 1.2);
    let mut arm = builder.build().unwrap();
    let mut reached = 0;
    for _ in cases(300, 60) {
        let checker = checker.clone().with_world(&cluttered(&mut random)).unwrap();
        arm = arm.with_checker(&checker, &q_model).unwrap();
        let q = random.configuration(&arm);
        let solution = arm.solve(arm.base_from_tool(&q).unwrap(), &q).unwrap();
        let touched = arm.collisions(&solution.q).unwrap();
        reached += usize::from(solution.reached);
        assert_eq!(solution.reached, touched.is_empty(), "{touched:?}");
    }
    assert!(reached > 5, "{reached}");
}

/// A rod in the hand, without link or spheres: attached from the start, or later. As a world placement its offset in
/// the hand would touch little.
#[test]
fn attached_objects_are_kept_collision_free() {
    let mut random = Random::new(31);
    let [plain, empty] = [(); 2].map(|()| panda(Search::Start).with_world(&World::new(), 0.0));
    let mut reported = [0; 2];
    for _ in cases(60, 12) {
        let mut world = cluttered(&mut random);
        world
            .add_box("rod", [0.4, 0.02, 0.02], Vector3::new(0.0, 0.0, 3.0))
            .unwrap();
        let without = plain.arm.with_world(&world, None).unwrap();
        let hand = Vector3::new(0.4, 0.0, 0.05);
        world.attach("rod", "flange", hand).unwrap();
        let checker = plain.checker.clone().with_world(&world).unwrap();
        let rebuilt = Arm::clone(&plain.arm);
        let rebuilt = rebuilt.with_checker(&checker, &plain.q_model).unwrap();
        let taken = without.with_world(&world, None).unwrap();
        let after = empty.arm.with_world(&world, None).unwrap();
        let (goal, start) = (
            random.configuration(&plain.arm),
            random.configuration(&plain.arm),
        );
        let target = plain.arm.base_from_tool(&goal).unwrap();
        for arm in [rebuilt, taken, after] {
            let solution = arm.solve(target, &start).unwrap();
            let touched = arm.collisions(&solution.q).unwrap();
            assert_eq!(solution.reached, touched.is_empty(), "{touched:?}");
            reported[usize::from(solution.reached)] += 1;
        }
    }
    assert!(
        reported.iter().all(|reported| *reported > 5),
        "{reported:?}"
    );
}

/// The number of solutions with exact checks is limited per problem.
#[test]
fn earlier_problems_do_not_reduce_checks() {
    let mut random = Random::new(33);
    let panda = panda(Search::Nearest).with_world(&cluttered(&mut random), 0.0);
    let new = panda.arm.clone();
    for turn in cases(60, 20) {
        let (goal, start) = (
            random.configuration(&panda.arm),
            random.configuration(&panda.arm),
        );
        let target = panda.arm.base_from_tool(&goal).unwrap();
        let [reused, fresh] =
            [&panda.arm, &new.clone()].map(|arm| arm.solve(target, &start).unwrap());
        assert_eq!(format!("{reused:?}"), format!("{fresh:?}"), "{turn}");
    }
}

#[test]
fn non_finite_joint_values_are_rejected() {
    let unobstructed = panda(Search::Start).with_world(&World::new(), 0.0);
    for wrong in [f64::NAN, f64::INFINITY] {
        let mut q = vec![0.0; 7];
        q[3] = wrong;
        unobstructed.arm.collisions(&q).says("joint4");
        let mut q_model = unobstructed.q_model.clone();
        q_model[3] = wrong;
        unobstructed
            .arm
            .joint_values(&q_model, &mut q[..])
            .says("joint4");
    }
}
