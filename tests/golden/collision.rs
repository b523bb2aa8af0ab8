//! Distances, checkers, sphere models and worlds.

use kinopt::collision::{Checker, CollisionModel, Resolution, SphereModel, World, separation};
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::robot;
use support::convex_shapes::Solid;
use support::random::Random;

use super::record::{Case, Record};

pub(crate) const CASES: &[Case] = &[
    Case::double("collision_distances", distances),
    Case::double("collision_checker", checker),
    Case::double("collision_spheres", spheres),
];

fn placement(random: &mut Random, size: f64) -> Placement<f64> {
    let mut vector = |size: f64| Vector3::from([(); 3].map(|()| random.within(-size, size)));
    let turn = rotation_exp(vector(2.0));
    Placement::new(turn, vector(size))
}

/// All pairs of kinds, apart and in contact.
fn distances(record: &mut Record) {
    let mut random = Random::new(52);
    let mut numbers = Vec::new();
    for first in 0..5 {
        for second in 0..5 {
            let shapes = [first, second].map(|kind| Solid::of_kind(kind, &mut random).shape());
            for size in [0.1, 0.6, 2.0] {
                let [a, b] = [(); 2].map(|()| placement(&mut random, size));
                let found = separation(&shapes[0], &a, &shapes[1], &b);
                numbers.push(found.distance);
                numbers.extend(found.on_first.to_array());
                numbers.extend(found.on_second.to_array());
            }
        }
    }
    record.numbers("distances and points", numbers);
}

fn world() -> World {
    let mut world = World::new();
    world
        .add_box("table", [1.0, 1.0, 0.1], Vector3::new(0.5, 0.0, 0.1))
        .unwrap();
    world
        .add_sphere("ball", 0.15, Vector3::new(0.4, 0.3, 0.5))
        .unwrap();
    let corners = [
        [0.0, 0.0, 0.0],
        [0.2, 0.0, 0.0],
        [0.0, 0.3, 0.0],
        [0.1, 0.1, 0.4],
    ];
    let at = Placement::translation([-0.4, -0.2, 0.4].into());
    world
        .add_convex("rock", &corners.map(Vector3::from), at)
        .unwrap();
    world
}

fn checker(record: &mut Record) {
    let panda = robot("franka_panda");
    let model = panda.model();
    let checker = Checker::of(&panda).unwrap().with_world(&world()).unwrap();
    let checker = checker.with_margin(0.05).unwrap();
    let (mut distances, mut free, mut names) = (Vec::new(), Vec::new(), String::new());
    let mut workspace = checker.workspace();
    let mut last = model.neutral();
    for seed in 0..20 {
        let q = model.random_configuration(seed);
        for found in checker.collisions(&q).unwrap() {
            distances.push(found.distance);
            names += &format!("{} {} ", found.first, found.second);
        }
        let check = checker.check_motion(&mut workspace, &last, &q).unwrap();
        free.push(check.free);
        last = q;
    }
    record.numbers("distances", distances);
    record.numbers("free fractions of motions", free);
    record.text("pairs", &names);
}

fn spheres(record: &mut Record) {
    let panda = robot("franka_panda");
    let model = CollisionModel::of(&panda).unwrap();
    let model = model.with_pairs_sampled(200, 1).unwrap();
    let spheres = SphereModel::of(&model, Resolution::MaxProtrusion(0.02)).unwrap();
    record.counts("spheres", [spheres.count(), spheres.pairs().len()]);
    record.numbers(
        "protrusion and gap",
        [spheres.max_protrusion(), spheres.gap()],
    );
    record.text("file", &spheres.to_yaml());
}
