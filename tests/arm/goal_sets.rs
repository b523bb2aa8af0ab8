//! Promise: a goal set gives for each arm and goal what a single query gives, and ranks the reached goals by the
//! criterion.

use kinopt::arm::{Arm, Criterion, GoalSet, GoalStatus, QueryError};
use kinopt::collision::{Checker, CollisionModel, Shape, World};
use kinopt::spatial::{Placement, Vector3};
use support::arms::{panda, robot};
use support::random::Random;

fn goals(arm: &Arm, count: u64) -> Vec<Placement<f64>> {
    let mut random = Random::new(2);
    (0..count)
        .map(|seed| {
            let reachable = arm.base_from_tool(&arm.random_configuration(seed)).unwrap();
            // A third is moved to where some are out of reach.
            match seed % 3 {
                0 => {
                    let offset = [0.0; 3].map(|_: f64| random.within(-0.6, 0.6));
                    Placement::translation(offset.into()) * reachable
                }
                _ => reachable,
            }
        })
        .collect()
}

#[test]
fn every_arm_and_goal_is_as_a_single_query() {
    let (robot, base, tip) = panda();
    let arm = Arm::new(&robot, base, tip).unwrap();
    let tools = [0.0, 0.12].map(|length| Placement::translation(Vector3::new(0.0, 0.0, length)));
    let set = GoalSet::of_tools(&arm, &tools).unwrap();
    let goals = goals(&arm, 300);
    let start = arm.default_start().to_vec();
    let starts = vec![start.clone(), start.clone()];
    let solution = set.solve(&goals, &starts, Criterion::Distance).unwrap();
    let mut statuses = [0; 3];
    for (index, arm) in set.arms().iter().enumerate() {
        for (number, goal) in goals.iter().enumerate() {
            let outcome = solution.outcome(index, number);
            let single = arm.solve(*goal, &start).unwrap();
            let q = solution.configuration(index, number).unwrap();
            assert_eq!(outcome.status == GoalStatus::Reached, single.reached);
            match outcome.status {
                GoalStatus::Reached => {
                    statuses[0] += 1;
                    assert_eq!(q, single.q);
                    let squares = q.iter().zip(&start).map(|(q, s)| (q - s).powi(2));
                    assert!((outcome.cost - squares.sum::<f64>().sqrt()).abs() < 1e-12);
                }
                GoalStatus::Missed => statuses[1] += 1,
                GoalStatus::OutOfReach => {
                    statuses[2] += 1;
                    let answer = arm.reachability(*goal, &start, 10).unwrap();
                    assert_eq!(answer.is_reachable(), Some(false));
                }
                other => panic!("{other:?}"),
            }
        }
    }
    assert!(statuses.iter().all(|count| *count > 10), "{statuses:?}");
    let ranking = solution.ranking();
    assert_eq!(ranking.len(), statuses[0]);
    let costs: Vec<f64> = ranking
        .iter()
        .map(|&(arm, goal)| solution.outcome(arm, goal).cost)
        .collect();
    assert!(costs.is_sorted());
    let threaded = set.solve_parallel(&goals, &starts, Criterion::Distance);
    let threaded = threaded.unwrap();
    // Rows without a search are NaN, which differs from itself.
    let bits = |rows: &[Vec<f64>]| {
        rows.concat()
            .iter()
            .map(|v| v.to_bits())
            .collect::<Vec<_>>()
    };
    assert!(bits(&threaded.q) == bits(&solution.q) && threaded.outcomes == solution.outcomes);
}

#[test]
fn manipulability_is_largest_for_the_best() {
    let robot = robot("universal_ur5e");
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let start = arm.default_start().to_vec();
    let goals: Vec<_> = goals(&arm, 60).into_iter().skip(1).step_by(3).collect();
    let set = GoalSet::new([arm.clone()]);
    let solution = set
        .solve(&goals, &[start], Criterion::Manipulability)
        .unwrap();
    let mut jacobian = arm.jacobian().unwrap();
    // Product of the singular values, instead of the determinant of J Jᵀ.
    let mut measure = |goal: usize| {
        let q = solution.configuration(0, goal).unwrap();
        jacobian
            .at(q)
            .unwrap()
            .clone()
            .svd(false, false)
            .singular_values
            .product()
    };
    let (_, best) = solution.best().unwrap();
    let best = measure(best);
    for goal in 0..goals.len() {
        let outcome = solution.outcome(0, goal);
        if outcome.status == GoalStatus::Reached {
            assert!((outcome.cost + measure(goal)).abs() < 1e-9);
            assert!(measure(goal) <= best + 1e-12);
        }
    }
}

#[test]
fn obstacles_and_clearance_count() {
    let (robot, base, tip) = panda();
    let free = Arm::new(&robot, base, tip).unwrap();
    let q = [0.3, 0.4, 0.2, -1.6, 0.1, 1.9, 0.5];
    let goal = free.base_from_tool(&q).unwrap();
    // The first world has a ball at the goal, the second one next to it.
    let arms = [0.0, 0.4].map(|offset| {
        let at = goal.translation + Vector3::new(0.0, offset, 0.0);
        let mut world = World::new();
        let ball = Shape::sphere(0.08).unwrap();
        world.add("ball", ball, Placement::translation(at)).unwrap();
        let bodies = CollisionModel::of(&robot).unwrap();
        let bodies = bodies.with_pairs_sampled(200, 1).unwrap();
        let checker = Checker::new(bodies).with_world(&world).unwrap();
        free.clone()
            .with_checker(&checker, &robot.model().neutral())
            .unwrap()
    });
    let set = GoalSet::new(arms);
    let starts = vec![q.to_vec(); 2];
    let criterion = Criterion::Clearance { max_distance: 0.5 };
    let solution = set.solve(&[goal], &starts, criterion).unwrap();
    assert_eq!(solution.outcome(0, 0).status, GoalStatus::InCollision);
    assert_eq!(solution.best(), Some((1, 0)));
    let found = solution.configuration(1, 0).unwrap();
    let clearance = set.arms()[1].clearance(found, 0.5).unwrap().unwrap();
    assert!(clearance >= 0.0 && solution.outcome(1, 0).cost == -clearance);
    let error = GoalSet::new([free])
        .solve(&[goal], &starts[..1], criterion)
        .unwrap_err();
    assert_eq!(error, QueryError::NothingToKeepClearOf);
}
