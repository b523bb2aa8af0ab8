//! Promise: reachable poses of random chains with mimic joints, and of NAO from foot to foot, are reached by every
//! search.
//!
//! Longer run: `KINOPT_CASES=2500 cargo test --release --test arm mimic_chains`.

use kinopt::arm::{Arm, PoseBounds, Search};
use kinopt::robot::Robot;
use support::arms::{robot, within_limits};
use support::follower_chains::follower_chain;
use support::random::{Random, case_count};
use support::urdf_matrices::{Tree, apart, placement};

/// Solves random poses and returns the number of misses.
fn missed(arm: &Arm, tree: &Tree, (base, tip): (&str, &str), seed: u64, count: usize) -> usize {
    let mut random = Random::split_mix(seed);
    let forward_kinematics = |q: &[f64]| {
        let values: Vec<_> = arm.joints().zip(q.iter().copied()).collect();
        tree.base_from_tip(base, tip, &values)
    };
    let results = (0..count).map(|_| {
        let target = forward_kinematics(&random.configuration(arm));
        let solution = arm.solve(placement(&target), &random.configuration(arm));
        let solution = solution.unwrap();
        assert!(within_limits(arm, &solution.q));
        if solution.reached {
            let (metres, radians) = apart(&forward_kinematics(&solution.q), &target);
            assert!(metres <= 1e-6 && radians <= 1e-6, "{metres:e} {radians:e}");
        }
        !solution.reached
    });
    results.filter(|missed| *missed).count()
}

/// Arm of a random chain, its file and its tip; `None` if the mimic joints leave their source joint no value.
fn follower_arm(number: u64) -> Option<(Arm, String, String)> {
    let (text, tip) = follower_chain(number);
    let robot = Robot::parse(&text, "followers.urdf").ok()?;
    let arm = Arm::builder(&robot, "l0", &tip).with_atlas(false);
    Some((arm.build().unwrap(), text, tip))
}

#[test]
fn random_mimic_chains_reach_their_poses() {
    let count = case_count(60, 6);
    for number in 0..24 {
        let Some((arm, text, tip)) = follower_arm(number) else {
            continue;
        };
        let missed = missed(&arm, &Tree::parse(&text), ("l0", &tip), number, count);
        assert_eq!(missed, 0, "of {count} poses of chain {number}");
    }
}

/// If a goal leaves freedom, every attempt ends in a different solution.
#[test]
fn attempts_end_in_different_solutions() {
    const ATTEMPTS: u32 = 128;
    let mut looked_at = 0;
    for number in 0..12 {
        let (text, tip) = follower_chain(number);
        let Ok(robot) = Robot::parse(&text, "followers.urdf") else {
            continue;
        };
        let arm = Arm::builder(&robot, "l0", &tip)
            .with_atlas(false)
            .with_goal(PoseBounds::position())
            .with_attempts(ATTEMPTS)
            .build()
            .unwrap();
        if arm.joint_count() < 6 {
            continue;
        }
        let mut random = Random::split_mix(number);
        let target = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        let start = random.configuration(&arm);
        let found = arm.solve_all_from(target, &start).unwrap().solutions;
        assert!(found.len() >= 60, "chain {number}: {}", found.len());
        looked_at += 1;
    }
    assert!(looked_at > 2);
}

/// Random attempts alone miss these poses.
#[test]
fn poses_in_narrow_valleys_are_reached() {
    for (number, seed) in [(3, 1_000_006), (57, 1_000_060)] {
        let (text, tip) = follower_chain(number);
        let robot = Robot::parse(&text, "followers.urdf").unwrap();
        let arm = Arm::builder(&robot, "l0", &tip).with_atlas(false);
        let arm = arm.build().unwrap();
        let missed = missed(
            &arm,
            &Tree::parse(&text),
            ("l0", &tip),
            seed,
            case_count(200, 100),
        );
        assert_eq!(missed, 0, "of chain {number}");
    }
}

#[test]
fn nao_reaches_from_foot_to_foot() {
    let (nao, tree) = (
        robot("aldebaran_nao"),
        Tree::read("../models/aldebaran_nao.urdf"),
    );
    for ends in [("left_sole", "right_sole"), ("right_sole", "left_sole")] {
        let arm = Arm::new(&nao, ends.0, ends.1).unwrap();
        assert_eq!(missed(&arm, &tree, ends, 3, case_count(200, 20)), 0);
    }
}

#[test]
fn nearest_search_starts_from_seeds_too() {
    let (text, tip) = follower_chain(3);
    let robot = Robot::parse(&text, "followers.urdf").unwrap();
    let tree = Tree::parse(&text);
    let nearest = Arm::builder(&robot, "l0", &tip)
        .with_search(Search::Nearest)
        .build()
        .unwrap();
    assert_eq!(
        missed(&nearest, &tree, ("l0", &tip), 5, case_count(60, 5)),
        0
    );
}

/// The winner reached and ended the search, so it is the last attempt.
#[test]
fn winner_is_the_last_attempt() {
    let mut later = 0;
    for number in 0..24 {
        let Some((arm, ..)) = follower_arm(number) else {
            continue;
        };
        let mut random = Random::split_mix(number);
        for _ in 0..4 {
            let goal = arm.base_from_tool(&random.configuration(&arm)).unwrap();
            let start = random.configuration(&arm);
            let mut q = vec![0.0; arm.joint_count()];
            let mut outcome = [kinopt::arm::PoseOutcome::default()];
            arm.solve_batch_into(&[goal], &start, &mut q, &mut outcome)
                .unwrap();
            let [outcome] = outcome;
            if let (true, Some(winner)) = (outcome.reached, outcome.winner) {
                later += u32::from(winner > 1);
                assert_eq!(winner + 1, outcome.attempts, "{number}: {outcome:?}");
            }
        }
    }
    assert!(later >= 3, "{later}");
}

/// A source joint of ratio ½ makes no whole turns towards the start.
#[test]
fn source_joints_make_no_whole_turns() {
    let joint = |name: &str, parent: &str, child: &str, more: &str| {
        format!(
            "<joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <origin xyz=\"0.4 0 0\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-12\" upper=\"12\" effort=\"1\" velocity=\"1\"/>{more}</joint>"
        )
    };
    let text = format!(
        "<robot name=\"two\"><link name=\"l0\"/><link name=\"l1\"/><link name=\"l2\"/>{}{}</robot>",
        joint("a", "l0", "l1", ""),
        joint("b", "l1", "l2", "<mimic joint=\"a\" multiplier=\"0.5\"/>"),
    );
    let robot = Robot::parse(&text, "two.urdf").unwrap();
    let arm = Arm::builder(&robot, "l0", "l2");
    let arm = arm.with_atlas(false).build().unwrap();
    for k in 0..12 {
        let target_q = [0.5 * f64::from(k) - 3.0];
        let goal = arm.base_from_tool(&target_q).unwrap();
        for turns in [-9.0, -5.0, 6.0, 10.0] {
            let solution = arm.solve(goal, &[turns]).unwrap();
            assert!(
                solution.reached,
                "{target_q:?} from {turns}: {}",
                solution.explain()
            );
        }
    }
}

/// Of equivalent values of a joint with more than one turn, the nearest to the start within limits is returned. The
/// nearest of all may be outside them.
#[test]
fn wide_joints_return_nearest_turn_within_limits() {
    let joint = |name: &str, at: usize, end: f64, more: &str| {
        format!(
            "<link name=\"l{}\"/><joint name=\"{name}\" type=\"revolute\"><parent link=\"l{at}\"/>\
             <child link=\"l{}\"/><origin xyz=\"0.4 0 0\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-{end}\" upper=\"{end}\" effort=\"1\" velocity=\"1\"/>{more}</joint>",
            at + 1,
            at + 1
        )
    };
    let text = format!(
        "<robot name=\"wide\"><link name=\"l0\"/>{}{}{}</robot>",
        joint("a", 0, 5.0, ""),
        joint("b", 1, 2.0, ""),
        joint("c", 2, 2.0, "<mimic joint=\"b\" multiplier=\"0.5\"/>"),
    );
    let robot = Robot::parse(&text, "wide.urdf").unwrap();
    let arm = Arm::builder(&robot, "l0", "l3");
    let arm = arm.with_attempts(12).build().unwrap();
    let (mut random, mut held) = (Random::split_mix(15), 0);
    for _ in 0..40 {
        let goal = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        let start = [18.0 * random.unit() - 9.0, 2.0 * random.unit() - 1.0];
        for solution in arm.solve_all_from(goal, &start).unwrap().solutions {
            let (q, start) = (solution.q[0], start[0]);
            for turned in [q - std::f64::consts::TAU, q + std::f64::consts::TAU] {
                let nearer = (turned - start).abs() < (q - start).abs() - 1e-9;
                assert!(!nearer || turned.abs() > 5.0, "{q} from {start}");
                held += usize::from(nearer);
            }
        }
    }
    assert!(held > 5, "{held} were held by a limit");
}

/// A mimic joint's velocity limit, divided by its ratio, limits its source joint.
#[test]
fn mimic_velocity_limits_apply_to_source_joints() {
    let joint = |at: usize, speed: f64, more: &str| {
        format!(
            "<link name=\"l{}\"/><joint name=\"j{at}\" type=\"revolute\"><parent link=\"l{at}\"/>\
             <child link=\"l{}\"/><origin xyz=\"0.4 0 0\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"{speed}\"/>{more}</joint>",
            at + 1,
            at + 1
        )
    };
    for (ratio, limit) in [(-0.5, 2.0), (0.25, 3.0), (4.0, 0.25)] {
        let follows = format!("<mimic joint=\"j0\" multiplier=\"{ratio}\"/>");
        let text = format!(
            "<robot name=\"fast\"><link name=\"l0\"/>{}{}{}</robot>",
            joint(0, 3.0, ""),
            joint(1, 1.0, &follows),
            joint(2, 5.0, "")
        );
        let robot = Robot::parse(&text, "fast.urdf").unwrap();
        let arm = Arm::new(&robot, "l0", "l3").unwrap();
        assert_eq!(arm.velocity_limits(), [limit, 5.0]);
    }
}

/// A mimic joint whose source joint is at its bound is exactly within its limits, however its ratio rounds.
#[test]
fn mimic_joints_stay_within_requested_limits() {
    use kinopt::model::{Limits, Model};
    use kinopt::robot::{Mimic, Robot};
    use kinopt::spatial::{Placement, Vector3};
    let mut random = Random::split_mix(12);
    for _ in 0..100 {
        let mut builder = Model::builder("pair");
        let (at, z) = (Placement::identity(), Vector3::new(0.0, 0.0, 1.0));
        let lead = builder.revolute("lead", None, at, z, Limits::new(-3.0, 3.0));
        let limits = Limits::new(-0.2 - random.unit(), 0.2 + random.unit());
        let follow = builder.revolute("follow", Some(lead), at, z, limits);
        builder.frame("base", None, at);
        builder.frame("tip", Some(follow), at);
        let mimic = Mimic {
            joint: follow,
            master: lead,
            ratio: 1.3 + random.unit(),
            offset: 0.1 * random.unit(),
        };
        let robot = Robot::new(builder.build().unwrap(), vec![mimic]).unwrap();
        let robot = robot.with_mimic_limits().unwrap();
        let arm = Arm::new(&robot, "base", "tip").unwrap();
        let bounds = arm.limits().next().unwrap();
        for end in [bounds.lower, bounds.upper] {
            let mut q = [0.0; 2];
            arm.configuration(&[end], &mut q).unwrap();
            assert!(limits.contains(q[1]), "{limits:?} {q:?}");
        }
    }
}

/// A whole turn of a source joint is no whole turn of its mimic joint, so the result is not moved by whole turns.
#[test]
fn any_source_joint_keeps_its_turn() {
    let joint = |k: usize, kind: &str, axis: &str, more: &str| {
        format!(
            r#"<joint name="j{k}" type="revolute"><parent link="l{}"/><child link="l{k}"/><origin xyz="{kind}"/><axis xyz="{axis}"/>
            <limit lower="-20" upper="20" effort="1" velocity="1"/>{more}</joint><link name="l{k}"/>"#,
            k - 1
        )
    };
    let text = [
        joint(1, "0 0 0.3", "0 0 1", ""),
        joint(2, "0.3 0 0", "0 1 0", ""),
        joint(
            3,
            "0 0.1 0.4",
            "0 1 0",
            r#"<mimic joint="j1" multiplier="0.4"/>"#,
        ),
        joint(
            4,
            "0.3 0 0.1",
            "1 0 0",
            r#"<mimic joint="j2" multiplier="-0.3"/>"#,
        ),
        joint(5, "0.1 0 0.2", "0 0 1", ""),
    ];
    let text = format!(
        r#"<robot name="r"><link name="l0"/>{}</robot>"#,
        text.concat()
    );
    let robot = Robot::parse(&text, "leaders.urdf").unwrap();
    let goal = kinopt::arm::PoseBounds::position();
    let arm = Arm::builder(&robot, "l0", "l5").with_goal(goal);
    let arm = arm.with_atlas(false).build().unwrap();
    let mut random = Random::split_mix(9);
    let mut reached = 0;
    for _ in 0..30 {
        let q: Vec<f64> = (0..arm.joint_count())
            .map(|_| 2.0 * random.unit() - 1.0)
            .collect();
        let target = arm.base_from_tool(&q).unwrap();
        let start: Vec<f64> = q.iter().map(|q| q + 13.0).collect();
        let solution = arm.solve(target, &start).unwrap();
        let reached_pose = arm.base_from_tool(&solution.q).unwrap();
        let distance = (reached_pose.translation - target.translation).norm();
        assert_eq!(solution.reached, distance <= 1e-6, "{distance}");
        reached += usize::from(solution.reached);
    }
    assert!(reached >= 20, "{reached} of 30");
}

/// If no attempt reaches, the result is the end of the attempt from the start, whatever the number of attempts.
#[test]
fn miss_returns_the_attempt_from_the_start() {
    let mut missed = 0;
    for number in 0..40 {
        let Some((arm, text, tip)) = follower_arm(number) else {
            continue;
        };
        let robot = Robot::parse(&text, "followers.urdf").unwrap();
        let own_way = Arm::builder(&robot, "l0", &tip).with_atlas(false);
        let own_way = own_way.with_attempts(1).build().unwrap();
        let mut random = Random::split_mix(number);
        let start = random.configuration(&arm);
        let mut goal = arm.base_from_tool(&random.configuration(&arm)).unwrap();
        goal.translation = goal.translation * 1.3;
        let all = arm.solve(goal, &start).unwrap();
        if all.reached {
            continue;
        }
        missed += 1;
        let once = own_way.solve(goal, &start).unwrap();
        assert_eq!(all.q, once.q, "{number}");
    }
    assert!(missed > 8, "{missed}");
}

/// A mimic joint in another branch restricts its source joint in the arm on request.
#[test]
fn mimic_outside_the_chain_restricts_on_request() {
    let joint = |name: &str, child: &str, end: f64, more: &str| {
        format!(
            "<link name=\"{child}\"/><joint name=\"{name}\" type=\"revolute\"><parent link=\"l0\"/>\
             <child link=\"{child}\"/><axis xyz=\"0 0 1\"/><origin xyz=\"0.1 0 0\"/>\
             <limit lower=\"-{end}\" upper=\"{end}\" effort=\"1\" velocity=\"1\"/>{more}</joint>"
        )
    };
    for (ratio, max_move) in [(1.0, 0.5), (-2.0, 0.25), (0.25, 1.5)] {
        let follows = format!("<mimic joint=\"a\" multiplier=\"{ratio}\"/>");
        let text = format!(
            "<robot name=\"r\"><link name=\"l0\"/>{}{}</robot>",
            joint("a", "l1", 1.5, ""),
            joint("b", "l2", 0.5, &follows),
        );
        let robot = Robot::parse(&text, "r.urdf").unwrap();
        let arm = Arm::new(&robot, "l0", "l1").unwrap();
        assert_eq!(arm.limits().next().unwrap().upper, 1.5);
        let robot = robot.with_mimic_limits().unwrap();
        let arm = Arm::new(&robot, "l0", "l1").unwrap();
        let limits: Vec<_> = arm
            .limits()
            .map(|limit| (limit.lower, limit.upper))
            .collect();
        assert_eq!(limits, [(-max_move, max_move)]);
        let beyond = arm.base_from_tool(&[1.49]).unwrap();
        let solution = arm.solve(beyond, &[0.0]).unwrap();
        assert_eq!(solution.q, [solution.q[0].min(max_move)]);
        let mut q = [0.0; 2];
        arm.configuration(&solution.q, &mut q).unwrap();
        assert!(robot.model().is_within_limits(&q), "{q:?}");
    }
}

/// `joint_values` returns the values that `configuration` wrote, in the arm's order.
#[test]
fn joint_values_round_trip() {
    for number in 0..12 {
        let Some((arm, text, _)) = follower_arm(number) else {
            continue;
        };
        let robot = Robot::parse(&text, "followers.urdf").unwrap();
        let mut random = Random::split_mix(number);
        let values = random.configuration(&arm);
        let mut q = robot.model().neutral();
        arm.configuration(&values, &mut q[..]).unwrap();
        let mut back = Vec::new();
        arm.joint_values(&q, &mut back).unwrap();
        assert_eq!(back, values);
        for (id, value) in arm.joint_ids().iter().zip(&values) {
            assert_eq!(q[robot.model().coordinate(*id).unwrap()], *value);
        }
        assert!(arm.joint_values(&q[1..], &mut back).is_err());
    }
}
