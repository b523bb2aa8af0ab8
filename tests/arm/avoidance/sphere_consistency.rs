//! Promise: spheres only accelerate an arm. The nearest and all solutions equal those of an arm that checks
//! shapes alone, for any sphere resolution.

use kinopt::arm::{Arm, Search};
use kinopt::collision::{Checker, CollisionModel, Resolution, SphereModel, World};
use kinopt::robot::Robot;
use kinopt::spatial::Placement;
use support::arms::robot;
use support::checked_arms::add_boxes;
use support::random::{Random, cases};

/// Few attempts, so that all of them can be checked by shapes.
const ATTEMPTS: u32 = 32;

/// An arm with coarse spheres and one without any give equal solutions.
#[test]
fn solutions_do_not_depend_on_spheres() {
    let robot = robot("franka_panda");
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_pairs_sampled(200, 1).unwrap();
    let spheres = SphereModel::of(&bodies, Resolution::MaxProtrusion(0.1)).unwrap();
    let rest = vec![0.0; robot.model().configuration_len()];
    let alone = Checker::new(bodies);
    let covered = alone.clone().with_spheres(spheres);
    let mut random = Random::new(9);
    let (mut reported, mut unclear) = (0, 0);
    for _ in cases(60, 24) {
        let mut world = World::new();
        add_boxes(&mut world, &mut random);
        let arms = [&alone, &covered].map(|checker| {
            let builder = Arm::builder(&robot, "base", "flange").with_search(Search::Nearest);
            let arm = builder.with_attempts(ATTEMPTS).build().unwrap();
            let checker = checker.clone().with_world(&world).unwrap();
            arm.with_checker(&checker, &rest).unwrap()
        });
        let [goal, start] = [(); 2].map(|()| random.configuration(&arms[0]));
        let target: Placement<f64> = arms[0].base_from_tool(&goal).unwrap();
        let [by_shapes, by_both] = arms.each_ref().map(|arm| {
            let nearest = arm.solve(target, &start).unwrap();
            let nearest = nearest.reached.then_some(nearest.q);
            let all = arm.solve_all_from(target, &start).unwrap().solutions;
            let all = all.into_iter().map(|solution| solution.q);
            nearest.into_iter().chain(all).collect::<Vec<_>>()
        });
        assert_eq!(by_shapes, by_both);
        for q in &by_both {
            let mut clear = [false];
            arms[1].clear_by_spheres(q, &mut clear).unwrap();
            reported += 1;
            unclear += usize::from(!clear[0]);
        }
    }
    assert!(reported > 5 && unclear > 2, "{unclear} of {reported}");
}

/// A bar that rotates above a post, 0.3 rad from its start.
const BAR: &str = r#"<robot name="bar"><link name="post"><collision><origin xyz="0.4777 0.1478 0"/>
    <geometry><box size="0.02 0.02 0.1"/></geometry></collision></link>
    <link name="bar"><collision><origin xyz="0.3 0 0"/><geometry><box size="0.6 0.02 0.02"/></geometry></collision></link>
    <joint name="turn" type="continuous"><parent link="post"/><child link="bar"/><axis xyz="0 0 1"/></joint></robot>"#;

/// Spheres are placed with their links.
#[test]
fn spheres_are_placed_with_their_links() {
    let robot = Robot::parse(BAR, "bar.urdf").unwrap();
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_checked("post", "bar").unwrap();
    let spheres = SphereModel::of(&bodies, Resolution::MaxProtrusion(0.03)).unwrap();
    let checker = Checker::new(bodies).with_spheres(spheres);
    for (turn, touches) in [(0.3, true), (0.2, false), (-0.3, false)] {
        let found = checker.collisions(&[turn]).unwrap();
        assert_eq!(!found.is_empty(), touches, "{turn}: {found:?}");
    }
}
