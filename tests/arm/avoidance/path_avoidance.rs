//! Promise: a path of an arm with collision avoidance is collision-free at and between its poses. A blocked step is cut
//! short and names the obstacle, and the arm returns with the path.

use kinopt::arm::{Arm, ServoStatus};
use kinopt::collision::World;
use kinopt::spatial::{Placement, Vector3};
use support::arms::distance;
use support::checked_arms::panda_in;
use support::random::cases;

const Q: [f64; 7] = [0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8];

/// From the tool's pose to the side and back, in `steps` steps each.
fn out_and_back(arm: &Arm, offset: Vector3<f64>, steps: usize) -> Vec<Placement<f64>> {
    let begin = arm.base_from_tool(&Q).unwrap();
    let order = (0..=steps).chain((0..steps).rev());
    let at = |k: usize| {
        Placement::new(
            begin.rotation,
            begin.translation + offset * (k as f64 / steps as f64),
        )
    };
    order.map(at).collect()
}

/// True if no sample between two configurations is in contact.
fn is_free_between(arm: &Arm, from: &[f64], to: &[f64]) -> bool {
    (0..=20).all(|k| {
        let share = f64::from(k) / 20.0;
        let q: Vec<f64> = from
            .iter()
            .zip(to)
            .map(|(a, b)| a + share * (b - a))
            .collect();
        arm.collisions(&q).unwrap().is_empty()
    })
}

/// A wall to the left of the tool at `gap` metres.
fn wall(arm: &Arm, gap: f64) -> World {
    let tool = arm.base_from_tool(&Q).unwrap().translation;
    let mut world = World::new();
    let position = Vector3::new(tool.x, tool.y + gap + 0.25, tool.z);
    world.add_box("wall", [0.6, 0.5, 0.6], position).unwrap();
    world
}

#[test]
fn path_into_a_wall_stops_and_returns() {
    let alone = panda_in(&World::new());
    for case in cases(10, 2) {
        let arm = panda_in(&wall(&alone, 0.16 + 0.01 * case as f64));
        let path = out_and_back(&arm, Vector3::new(0.0, 0.3, 0.0), 60);
        let track = arm.track(&path, &Q).unwrap();
        assert!(track.jumps.is_empty(), "{:?}", track.jumps);
        let mut last = Q.to_vec();
        for solution in &track.report {
            assert!(is_free_between(&arm, &last, &solution.q));
            assert!(distance(&last, &solution.q) < 0.2);
            last.clone_from(&solution.q);
        }
        // In the wall the path misses and names it; outside it continues.
        let deepest = &track.report[60];
        assert!(!deepest.reached);
        assert_eq!(deepest.collisions()[0].second, "wall");
        let missed = track.report.iter().filter(|s| !s.reached).count();
        assert!(
            track.report[0].reached && track.report[120].reached,
            "{missed}"
        );
    }
}

#[test]
fn servo_stops_at_a_wall_and_leaves_it() {
    let alone = panda_in(&World::new());
    let arm = panda_in(&wall(&alone, 0.18));
    let path = out_and_back(&arm, Vector3::new(0.0, 0.3, 0.0), 60);
    let mut servo = arm.servo(&Q, 0.01).unwrap();
    let (mut last, mut blocked) = (Q.to_vec(), 0);
    for target in path.iter().chain(std::iter::repeat_n(&path[0], 40)) {
        let step = servo.step(*target).unwrap();
        blocked += usize::from(step.status == ServoStatus::Blocked);
        assert!(is_free_between(&arm, &last, step.q));
        last = step.q.to_vec();
    }
    assert!(blocked > 10, "{blocked}");
    assert!(servo.step(path[0]).unwrap().reached());
}

/// A table whose top is `deep` metres above the lowest point of the arm; the arm, and a path straight up.
fn in_a_table(deep: f64, margin: f64) -> (Arm, Vec<Placement<f64>>) {
    let alone = panda_in(&World::new());
    let mut near = World::new();
    let tool = alone.base_from_tool(&Q).unwrap();
    let top = Vector3::new(0.0, 0.0, -0.5);
    near.add_box("table", [0.4, 0.4, 1.0], tool.translation + top)
        .unwrap();
    // Height of the table from the initial contacts.
    let touching = panda_in(&near).collisions(&Q).unwrap();
    let touching = touching.iter().map(|pair| pair.distance);
    let depth = touching.fold(0.0, f64::min);
    near.move_to(
        "table",
        tool.translation + top + Vector3::new(0.0, 0.0, depth + deep),
    )
    .unwrap();
    let arm = panda_in(&World::new()).with_world(&near, margin).unwrap();
    let path = (0..=100).map(|k| {
        let up = Vector3::new(0.0, 0.0, 0.002 * f64::from(k));
        Placement::new(tool.rotation, tool.translation + up)
    });
    (arm, path.collect())
}

/// Distance of the nearest pair at a configuration, metres.
fn nearest(arm: &Arm, q: &[f64]) -> f64 {
    let pairs = arm.collisions(q).unwrap();
    pairs.first().map_or(f64::INFINITY, |pair| pair.distance)
}

/// A path that leads away leaves an initial contact of any depth, and no path deepens it.
#[test]
fn initial_contact_is_left_and_never_deepened() {
    for (deep, margin) in [
        (0.0, 0.0),
        (3e-8, 0.0),
        (1e-3, 0.0),
        (0.02, 0.0),
        (1e-5, 0.01),
    ] {
        let (arm, path) = in_a_table(deep - margin, margin);
        let begins = nearest(&arm, &Q).min(margin);
        let message = format!("{deep} m deep");
        let (mut q, mut reached) = (Q.to_vec(), 0);
        let mut last = begins;
        let track = arm.track(&path, &Q).unwrap();
        for solution in &track.report {
            let now = nearest(&arm, &solution.q);
            // Contacts below 1 µm count as grazing.
            assert!(
                now >= last.min(margin - 1e-6) - 2e-9,
                "{message}: {now} after {last}"
            );
            assert_eq!(solution.reached, now >= margin && solution.goals_reached());
            assert_eq!(solution.collisions().is_empty(), now >= margin);
            assert!(distance(&q, &solution.q) < 0.2);
            (q, last) = (solution.q.clone(), now);
            reached += usize::from(solution.reached);
        }
        assert!(reached > 80, "{message}: {reached} of 101");
        let mut servo = arm.servo(&Q, 0.01).unwrap();
        let mut last = begins;
        for (k, target) in path.iter().enumerate() {
            let step = servo.step(*target).unwrap();
            let now = nearest(&arm, step.q);
            assert!(
                now >= last.min(margin - 1e-6) - 2e-9,
                "{message}: {now} after {last}"
            );
            assert_eq!(step.collisions.is_empty(), now >= margin, "{message}, {k}");
            assert!(!step.reached() || now >= margin, "{message}, {k}");
            last = now;
        }
        let mut step = servo.step(path[100]).unwrap();
        for _ in 0..40 {
            step = servo.step(path[100]).unwrap();
        }
        assert!(step.reached(), "{message}: {:?}", step.status);
        // In contact no target is reached, and targets farther inside cause no motion.
        if deep > 1e-6 {
            let (arm, path) = in_a_table(deep - margin, margin);
            let mut servo = arm.servo(&Q, 0.01).unwrap();
            let step = servo.step(path[0]).unwrap();
            assert!(!step.reached() && step.position_error < 1e-6);
            assert_eq!(step.collisions[0].second, "table");
            for k in 1..=50 {
                let mut down = path[0];
                down.translation.z -= 0.001 * f64::from(k);
                let step = servo.step(down).unwrap();
                assert_eq!(step.status, ServoStatus::Touching, "{message}, {k}");
                assert!(nearest(&arm, step.q) > begins - 1e-7, "{message}, {k}");
            }
        }
    }
}
