//! Promise: sampling disables no pair of links that can collide, although a thousand samples may miss its contacts.

use kinopt::collision::{Checker, CollisionModel, Resolution, SphereModel};
use kinopt::robot::Robot;
use support::arms::robot;
use support::lines::ROBOTS;
use support::random::case_count;

/// Pairs that collide in more than this fraction of configurations count as always in contact.
const MIN_CONTACT_FRACTION: f64 = 0.9;

#[test]
fn disabled_pair_collides_never_or_always() {
    let count = case_count(10_000, 1_000);
    for (name, ..) in ROBOTS {
        let robot = robot(name);
        let all = CollisionModel::of(&robot).unwrap();
        let sampled = all.clone().with_pairs_sampled(1000, 0).unwrap();
        let mut left_out = all;
        for [a, b] in sampled.pairs() {
            left_out = left_out.with_ignored(*a, *b).unwrap();
        }
        // Shapes in exact contact count as well.
        let checker = Checker::new(left_out).with_margin(2e-9).unwrap();
        let mut workspace = checker.workspace();
        let (model, map) = (robot.model(), robot.map());
        let mut x = vec![0.0; map.variables()];
        let mut found = std::collections::BTreeMap::new();
        for seed in 0..count as u64 {
            let mut q = model.random_configuration(1_000_000 + seed);
            map.reduce(&q, &mut x).unwrap();
            map.expand_within_limits(&x, &mut q).unwrap();
            for pair in checker.collisions_with(&mut workspace, &q).unwrap() {
                let depths: &mut Vec<f64> = found.entry((pair.first, pair.second)).or_default();
                depths.push(pair.distance);
            }
        }
        for (pair, depths) in found {
            let share = depths.len() as f64 / count as f64;
            let deepest = depths.iter().copied().fold(0.0, f64::min);
            assert!(
                share > MIN_CONTACT_FRACTION,
                "{name}: {pair:?} touch in {share} of all configurations, by up to {deepest} m"
            );
        }
    }
}

/// A sphere on a prismatic joint of 1 m, inside a box for a fraction `share` of it, at the end of a rotating lever.
fn held_for(share: f64, lever: f64) -> CollisionModel {
    let text = format!(
        r#"<robot name="slide"><link name="base"><collision><origin xyz="{} 0 {lever}"/><geometry><box size="2 2 2"/></geometry></collision></link>
        <link name="rod"><collision><origin xyz="0 9 0"/><geometry><sphere radius="0.1"/></geometry></collision></link><link name="ball"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
        <joint name="slide" type="prismatic"><parent link="base"/><child link="rod"/><axis xyz="1 0 0"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>
        <joint name="turn" type="continuous"><parent link="rod"/><child link="ball"/><origin xyz="0 0 {lever}"/><axis xyz="1 0 0"/></joint></robot>"#,
        share - 1.1
    );
    let robot = Robot::parse(&text, "slide.urdf").unwrap();
    CollisionModel::of(&robot).unwrap()
}

/// Pairs that collide in 95 % of configurations are disabled. Without a lever the prismatic samples need to vary, too.
#[test]
fn nearly_always_colliding_pair_is_disabled() {
    for (share, left_out) in [(0.9, false), (0.935, false), (0.965, true), (1.0, true)] {
        for lever in [2.0, 0.0] {
            let all = held_for(share, lever);
            assert_eq!(all.pairs().len(), 1);
            let sampled = all.with_pairs_sampled(4000, 3).unwrap();
            assert_eq!(sampled.pairs().is_empty(), left_out, "{share} {lever}");
        }
    }
}

/// On a robot without moving joints, separated links stay separated.
#[test]
fn immobile_separated_pair_is_disabled() {
    let text = r#"<robot name="still"><link name="base"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
        <link name="tip"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
        <joint name="slide" type="prismatic"><parent link="base"/><child link="tip"/><origin xyz="0.5 0 0"/><axis xyz="1 0 0"/>
        <limit lower="0" upper="0" effort="1" velocity="1"/></joint></robot>"#;
    let robot = Robot::parse(text, "still.urdf").unwrap();
    let all = CollisionModel::of(&robot).unwrap();
    let all = all.with_checked("base", "tip").unwrap();
    let sampled = all.with_pairs_sampled(100, 1).unwrap();
    assert!(sampled.pairs().is_empty());
}

/// Given spheres do not change the checked pairs.
#[test]
fn given_spheres_do_not_change_the_pairs() {
    let mut fewer = 0;
    for (name, ..) in ROBOTS {
        let robot = robot(name);
        let all = CollisionModel::of(&robot).unwrap();
        let sampled = all.clone().with_pairs_sampled(1000, 0).unwrap();
        let spheres = SphereModel::of(&all, Resolution::PerLink(1)).unwrap();
        let checker = Checker::sampled_with_spheres(all.clone(), spheres);
        assert_eq!(checker.model().pairs(), sampled.pairs(), "{name}");
        fewer += usize::from(sampled.pairs().len() < all.pairs().len());
    }
    assert!(fewer > 1);
}
