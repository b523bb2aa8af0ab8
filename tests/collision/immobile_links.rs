//! Promise: immobile links are checked once, by their shapes. A base may be slightly above its floor although its
//! spheres protrude into it. With a base in the floor no solution is free and none is searched for.
//!
//! A plain solution that is collision-free by shapes is kept, for any sphere resolution.

use kinopt::Arm;
use kinopt::collision::{Checker, CollisionModel, Resolution, Shape, SphereModel, World};
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::checked_arms::add_boxes;
use support::random::{Random, cases};

struct Panda {
    checker: Checker,
    rest: Vec<f64>,
}

impl Panda {
    fn covered(max_protrusion: f64) -> Self {
        let robot = robot("franka_panda");
        let bodies = CollisionModel::of(&robot).unwrap();
        let bodies = bodies.with_pairs_sampled(200, 1).unwrap();
        let spheres = SphereModel::of(&bodies, Resolution::MaxProtrusion(max_protrusion)).unwrap();
        Self {
            checker: Checker::new(bodies).with_spheres(spheres),
            rest: vec![0.0; robot.model().configuration_len()],
        }
    }

    fn plain() -> Arm {
        Arm::new(&robot("franka_panda"), "base", "flange").unwrap()
    }

    fn among(&self, world: &World) -> Arm {
        let checker = self.checker.clone().with_world(world).unwrap();
        let arm = Self::plain();
        arm.with_checker(&checker, &self.rest).unwrap()
    }

    /// Height of the lowest immobile link, metres.
    fn lowest(&self) -> f64 {
        let under = self.checker.clone().with_world(&floor(10.0)).unwrap();
        let model = under.model().model();
        let reported = under.collisions(&self.rest).unwrap();
        let standing = reported.iter().filter(|pair| {
            let link = model.frame(&pair.first).unwrap();
            model.frames()[link.index()].joint.is_none()
        });
        standing
            .map(|pair| 10.0 + pair.distance)
            .fold(f64::INFINITY, f64::min)
    }
}

fn floor(height: f64) -> World {
    let mut world = World::new();
    let placement = Placement::translation(Vector3::new(0.0, 0.0, height));
    world.add("floor", Shape::half_space(), placement).unwrap();
    world
}

#[test]
fn base_just_above_floor_keeps_sphere_checks() {
    let mut random = Random::new(4);
    let panda = Panda::covered(0.03);
    let arm = panda.among(&floor(panda.lowest() - 1e-3));
    let (mut free, mut clear_ones) = (0, 0);
    for _ in cases(1000, 200) {
        let q = random.configuration(&arm);
        let mut clear = [false];
        arm.clear_by_spheres(&q, &mut clear).unwrap();
        let is_free = arm.collisions(&q).unwrap().is_empty();
        assert!(is_free || !clear[0]);
        free += usize::from(is_free);
        clear_ones += usize::from(clear[0]);
    }
    assert!(3 * clear_ones > 2 * free, "{clear_ones} of {free}");
}

#[test]
fn base_in_its_floor_starts_no_search() {
    let mut random = Random::new(5);
    let panda = Panda::covered(0.03);
    let (plain, arm) = (Panda::plain(), panda.among(&floor(panda.lowest() + 0.02)));
    for _ in cases(100, 20) {
        let (goal, start) = (random.configuration(&arm), random.configuration(&arm));
        let target = arm.base_from_tool(&goal).unwrap();
        let solution = arm.solve(target, &start).unwrap();
        let alone = plain.solve(target, &start).unwrap();
        assert!(!solution.reached);
        assert_eq!(
            (solution.q.as_slice(), solution.attempts),
            (&alone.q[..], alone.attempts)
        );
        assert_eq!(solution.goals_reached(), alone.reached);
        let reported = solution.collisions().iter();
        let base =
            reported.filter(|pair| pair.second == "floor" && (pair.depth() - 0.02).abs() < 1e-9);
        assert_eq!(base.count(), 1, "{:?}", solution.collisions());
        let mut clear = [true];
        arm.clear_by_spheres(&start, &mut clear).unwrap();
        assert!(!clear[0]);
    }
}

#[test]
fn free_plain_solution_is_kept() {
    let mut random = Random::new(6);
    let panda = Panda::covered(0.1);
    let plain = Panda::plain();
    let (mut unchanged, mut by_shapes) = (0, 0);
    for _ in cases(500, 100) {
        let mut world = floor(-0.1);
        add_boxes(&mut world, &mut random);
        let arm = panda.among(&world);
        let (goal, start) = (random.configuration(&arm), random.configuration(&arm));
        let target = arm.base_from_tool(&goal).unwrap();
        let alone = plain.solve(target, &start).unwrap();
        if !alone.reached || !arm.collisions(&alone.q).unwrap().is_empty() {
            continue;
        }
        let mut clear = [false];
        arm.clear_by_spheres(&alone.q, &mut clear).unwrap();
        by_shapes += usize::from(!clear[0]);
        unchanged += 1;
        let solution = arm.solve(target, &start).unwrap();
        assert!(
            solution.reached && solution.q == alone.q,
            "{}",
            solution.explain()
        );
        assert_eq!(solution.attempts, alone.attempts);
    }
    assert!(
        by_shapes > 5 && unchanged > by_shapes,
        "{by_shapes} of {unchanged}"
    );
}
