//! Promise: if a continuous collision-free joint path exists, its tool poses are followed without jump and without
//! contact, also between poses. An arm reaches through a window in a wall.

use kinopt::Solution;
use kinopt::arm::{Arm, JointPath};
use kinopt::collision::{Checker, CollisionModel, World};
use kinopt::spatial::{Placement, Vector3};
use support::arms::{distance, robot};
use support::random::{Random, case_count};

/// Number of obstacles of a constructed case, and of poses along its path.
const OBSTACLES: usize = 10;
const STEPS: usize = 80;
/// Largest distance of some obstacle from a constructed path, metres.
const MAX_OBSTACLE_DISTANCE: f64 = 0.05;

struct Panda {
    arm: Arm,
    checker: Checker,
    rest: Vec<f64>,
}

fn panda() -> Panda {
    let robot = robot("franka_panda");
    let bodies = CollisionModel::of(&robot).unwrap();
    let checker = Checker::covered(bodies.with_pairs_sampled(200, 1).unwrap());
    let rest = robot.model().neutral();
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    Panda {
        arm: arm.with_checker(&checker, &rest).unwrap(),
        checker,
        rest,
    }
}

impl Panda {
    fn among(&self, world: &World) -> Self {
        Self {
            arm: self.arm.with_world(world, None).unwrap(),
            checker: self.checker.clone().with_world(world).unwrap(),
            rest: self.rest.clone(),
        }
    }

    fn whole(&self, q: &[f64]) -> Vec<f64> {
        let mut whole = self.rest.clone();
        self.arm.configuration(q, &mut whole).unwrap();
        whole
    }

    fn motion_is_free(&self, from: &[f64], to: &[f64]) -> bool {
        let mut workspace = self.checker.workspace();
        let motion = self
            .checker
            .check_motion(&mut workspace, &self.whole(from), &self.whole(to));
        motion.unwrap().blocked_by.is_none()
    }

    /// True if an obstacle is near a configuration.
    fn is_close(&self, q: &[f64]) -> bool {
        let mut workspace = self.checker.workspace();
        let nearest = self
            .checker
            .nearest(&mut workspace, &self.whole(q), MAX_OBSTACLE_DISTANCE);
        let obstacle = |name: &str| name.starts_with("thing");
        nearest
            .unwrap()
            .is_some_and(|pair| obstacle(&pair.first) || obstacle(&pair.second))
    }

    /// Checks that motions between solutions are free and that no step is a jump.
    fn assert_kept_clear(&self, start: &[f64], track: &JointPath<Vec<Solution>>) {
        assert!(track.jumps.is_empty(), "{:?}", track.jumps);
        let mut last = start;
        for solution in &track.report {
            assert!(self.motion_is_free(last, &solution.q));
            assert!(distance(last, &solution.q) < 0.3);
            last = &solution.q;
        }
    }
}

/// Configurations along a path of sinusoidal joint motions.
fn waves(random: &mut Random, arm: &Arm) -> Vec<Vec<f64>> {
    let swings: Vec<_> = (arm.limits())
        .map(|limits| {
            let width = limits.upper - limits.lower;
            let middle = limits.lower + width * random.within(0.3, 0.7);
            let swing = width * random.within(-0.12, 0.12);
            (middle, swing, random.within(0.0, 3.0))
        })
        .collect();
    let at = |share: f64| {
        let value =
            |(middle, swing, phase): &(f64, f64, f64)| middle + swing * (phase + 3.0 * share).sin();
        swings.iter().map(value).collect()
    };
    (0..=STEPS).map(|k| at(k as f64 / STEPS as f64)).collect()
}

fn obstacles(random: &mut Random) -> World {
    let mut world = World::new();
    for index in 0..OBSTACLES {
        let (around, distance) = (random.within(-3.1, 3.1), random.within(0.3, 0.9));
        let at = Vector3::new(
            distance * around.cos(),
            distance * around.sin(),
            random.within(0.1, 1.1),
        );
        let name = format!("thing {index}");
        let [a, b, c] = [(); 3].map(|()| random.within(0.05, 0.3));
        match index % 3 {
            0 => world.add_box(&name, [a, b, c], at),
            1 => world.add_cylinder(&name, 0.5 * a, b, at),
            _ => world.add_sphere(&name, 0.5 * c, at),
        }
        .unwrap();
    }
    world
}

/// A collision-free joint path near obstacles.
fn constructed(random: &mut Random, alone: &Panda) -> (Panda, Vec<Vec<f64>>) {
    loop {
        let (panda, path) = (alone.among(&obstacles(random)), waves(random, &alone.arm));
        let free = |path: &[Vec<f64>]| {
            path.windows(2)
                .all(|two| panda.motion_is_free(&two[0], &two[1]))
        };
        if path.iter().any(|q| panda.is_close(q)) && free(&path) {
            return (panda, path);
        }
    }
}

#[test]
fn free_path_is_followed_without_contact() {
    let mut random = Random::new(100);
    let alone = panda();
    let (mut whole, count) = (0, case_count(100, 4));
    for _ in 0..count {
        let (panda, path) = constructed(&mut random, &alone);
        let poses = path.iter().map(|q| panda.arm.base_from_tool(q).unwrap());
        let poses: Vec<Placement<f64>> = poses.collect();
        let track = panda.arm.track(&poses, &path[0]).unwrap();
        panda.assert_kept_clear(&path[0], &track);
        let missed = track
            .report
            .iter()
            .filter(|solution| !solution.reached)
            .count();
        whole += usize::from(missed == 0);
    }
    assert!(
        whole * 100 >= 90 * count,
        "{whole} of {count} followed to their ends"
    );
}

/// A wall with a square window about a point; sides in metres.
fn wall_with_window(middle: Vector3<f64>, window: f64) -> World {
    const WALL: [f64; 2] = [0.03, 1.6];
    let [thick, whole] = WALL;
    let mut world = World::new();
    let rim = 0.5 * (whole - window);
    let offset = 0.5 * (window + rim);
    for (name, size, offset) in [
        ("left", [thick, rim, whole], Vector3::new(0.0, offset, 0.0)),
        (
            "right",
            [thick, rim, whole],
            Vector3::new(0.0, -offset, 0.0),
        ),
        (
            "above",
            [thick, window, rim],
            Vector3::new(0.0, 0.0, offset),
        ),
        (
            "below",
            [thick, window, rim],
            Vector3::new(0.0, 0.0, -offset),
        ),
    ] {
        world.add_box(name, size, middle + offset).unwrap();
    }
    world
}

#[test]
fn arm_reaches_through_a_window_and_returns() {
    let alone = panda();
    let start = [
        0.0,
        -0.6,
        0.0,
        -2.6,
        0.0,
        2.0 + std::f64::consts::FRAC_PI_2,
        0.785,
    ];
    let begin = alone.arm.base_from_tool(&start).unwrap();
    // Along the tool's axis, which is horizontal.
    let ahead = begin.rotation.z;
    assert!(ahead.x > 0.99, "{ahead:?}");
    for window in [0.4, 0.34, 0.3] {
        let panda = alone.among(&wall_with_window(begin.translation + ahead * 0.2, window));
        let deep = |k: usize| {
            let by = 0.3 * (1.0 - (k as f64 / 60.0 - 1.0).abs());
            Placement::new(begin.rotation, begin.translation + ahead * by)
        };
        let poses: Vec<Placement<f64>> = (0..=120).map(deep).collect();
        let track = panda.arm.track(&poses, &start).unwrap();
        panda.assert_kept_clear(&start, &track);
        let missed = track
            .report
            .iter()
            .filter(|solution| !solution.reached)
            .count();
        assert_eq!(missed, 0, "a window of {window} m");
        // The flange is behind the wall, and no link touches it.
        let deepest = panda.arm.solve(poses[60], &start).unwrap();
        assert!(deepest.reached, "{}", deepest.explain());
        assert!(panda.arm.collisions(&deepest.q).unwrap().is_empty());
    }
}
