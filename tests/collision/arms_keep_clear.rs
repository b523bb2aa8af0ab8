//! Promise: a solution of an arm that keeps clear touches nothing, by the exact distances of shapes; where none is found
//! it says what is touched. Eight configurations in lanes and shapes one by one never contradict each other.

use kinopt::arm::{Arm, PoseOutcome, Search};
use kinopt::collision::{Checker, CollisionModel, Fineness, Shape, SphereModel, World};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3, rotation_exp};
use support::arms::robot;
use support::random::Random;
use support::sample::cases;

struct Panda {
    arm: Arm,
    checker: Checker,
    q_model: Vec<f64>,
}

fn panda(search: Search) -> Panda {
    let robot = robot("franka_panda");
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_pairs_sampled(200, 1).unwrap();
    let spheres = SphereModel::of(&bodies, Fineness::Overhang(0.03)).unwrap();
    let arm = Arm::builder(&robot, "base", "flange").with_search(search);
    Panda {
        q_model: vec![0.0; robot.model().configuration_len()],
        arm: arm.build().unwrap(),
        checker: Checker::new(bodies).with_spheres(spheres),
    }
}

/// A configuration within an arm's limits.
pub(crate) fn drawn(arm: &Arm, random: &mut Random) -> Vec<f64> {
    let limits = arm.limits();
    limits.map(|l| random.within(l.lower, l.upper)).collect()
}

impl Panda {
    fn among(self, world: &World, margin: f64) -> Self {
        let checker = self.checker.with_world(world).unwrap();
        let checker = checker.with_margin(margin).unwrap();
        Self {
            arm: self.arm.with_checker(&checker, &self.q_model).unwrap(),
            checker,
            ..self
        }
    }

    fn drawn(&self, random: &mut Random) -> Vec<f64> {
        drawn(&self.arm, random)
    }

    /// A configuration that touches nothing.
    fn free(&self, random: &mut Random) -> Vec<f64> {
        loop {
            let q = self.drawn(random);
            if self.arm.collisions(&q).unwrap().is_empty() {
                return q;
            }
        }
    }
}

/// Boxes, cylinders, capsules, balls, a hull and a floor around the arm.
fn cluttered(random: &mut Random) -> World {
    let mut world = World::new();
    for index in 0..8 {
        let [a, b, c] = [(); 3].map(|()| random.within(0.05, 0.25));
        let corner = |k: u32| {
            let side = |bit, length: f64| if k & bit == 0 { -length } else { length };
            Vector3::new(side(1, a), side(2, b), side(4, c)) * 0.5
        };
        let shape = match index % 5 {
            0 => Shape::cuboid([a, b, c]),
            1 => Shape::cylinder(a, b),
            2 => Shape::capsule(0.5 * a, b),
            3 => Shape::sphere(a),
            _ => Shape::convex(&(0..8).map(corner).collect::<Vec<_>>()),
        };
        let around = random.within(-3.1, 3.1);
        let far = random.within(0.35, 0.8);
        let place = Vector3::new(
            far * around.cos(),
            far * around.sin(),
            random.within(0.1, 1.0),
        );
        let turn = [(); 3].map(|()| random.within(-2.0, 2.0));
        let at = Placement::new(rotation_exp(turn.into()), place);
        world
            .add(&format!("thing {index}"), shape.unwrap(), at)
            .unwrap();
    }
    let below = Vector3::new(0.0, 0.0, -0.1);
    world
        .add("floor", Shape::half_space(), Placement::translation(below))
        .unwrap();
    world
}

#[test]
fn what_is_reached_touches_nothing_and_nearly_all_is_reached() {
    let mut random = Random::new(14);
    let mut panda = panda(Search::Start);
    let (mut asked, mut reached) = (0, 0);
    for margin in [0.0, 0.01] {
        for _ in 0..cases(500, 30) {
            panda = panda.among(&cluttered(&mut random), margin);
            let (goal, start) = (panda.free(&mut random), panda.drawn(&mut random));
            let target = panda.arm.base_from_tool(&goal).unwrap();
            let solution = panda.arm.solve(target, &start).unwrap();
            let touched = panda.arm.collisions(&solution.q).unwrap();
            asked += 1;
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
    assert!(reached * 100 >= asked * 97, "{reached} of {asked}");
}

#[test]
fn the_nearest_solution_that_is_free_is_as_near_as_any_that_is() {
    let mut random = Random::new(3);
    let mut near = panda(Search::Nearest);
    let mut any = panda(Search::Start);
    for _ in 0..cases(40, 6) {
        let world = cluttered(&mut random);
        (near, any) = (near.among(&world, 0.0), any.among(&world, 0.0));
        let (goal, start) = (near.free(&mut random), near.drawn(&mut random));
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

/// What is spent before something is found to be in the way counts as well.
#[test]
fn a_search_that_goes_on_tells_all_that_it_spent() {
    let mut random = Random::new(8);
    let near = panda(Search::Nearest);
    let plain = near.arm.with_search(Search::Nearest).unwrap();
    let near = near.among(&cluttered(&mut random), 0.0);
    let searched_on = (0..60).find_map(|_| {
        let (goal, start) = (near.free(&mut random), near.drawn(&mut random));
        let target = near.arm.base_from_tool(&goal).unwrap();
        let first = plain.solve(target, &start).unwrap();
        let touches = !near.arm.collisions(&first.q).unwrap().is_empty();
        touches.then(|| (first, near.arm.solve(target, &start).unwrap()))
    });
    let (first, clear) = searched_on.unwrap();
    assert!(clear.iterations > first.iterations);
    assert!(clear.attempts > first.attempts);
}

/// An answer that is free is of an attempt after those that led to the plain one, which touches.
#[test]
fn the_winner_is_numbered_over_all_attempts_of_its_question() {
    for search in [Search::Start, Search::Nearest] {
        let mut random = Random::new(8);
        let near = panda(search);
        let plain = near.arm.with_search(search).unwrap();
        let near = near.among(&cluttered(&mut random), 0.0);
        let mut went_on = 0;
        for _ in 0..cases(240, 90) {
            let (goal, start) = (near.free(&mut random), near.drawn(&mut random));
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

/// As many attempts as are asked for, once for the plain answer and once for one that is free.
#[test]
fn no_more_attempts_are_made_than_are_asked_for() {
    for attempts in [1, 3] {
        let mut random = Random::new(8);
        let alone = panda(Search::Start);
        let few = Arm::builder(&robot("franka_panda"), "base", "flange")
            .with_search(Search::Start)
            .with_attempts(attempts)
            .build()
            .unwrap();
        let few = Panda { arm: few, ..alone }.among(&cluttered(&mut random), 0.0);
        let mut went_on = 0;
        for _ in 0..240 {
            let (goal, start) = (few.free(&mut random), few.drawn(&mut random));
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
fn a_target_in_an_obstacle_is_reached_nowhere_and_says_so() {
    let goal = [0.3, 0.2, 0.1, -1.8, 0.1, 2.0, 0.5];
    let alone = panda(Search::Start);
    let target = alone.arm.base_from_tool(&goal).unwrap();
    let mut world = World::new();
    world
        .add_box("crate", [0.3; 3], target.translation)
        .unwrap();
    let panda = alone.among(&world, 0.0);
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
    // A batch asks the same.
    let batch = panda.arm.solve_batch(&[target], &goal).unwrap();
    assert_eq!(batch[0].q, solution.q);
    assert_eq!(batch[0].collisions(), solution.collisions());
    // What is out of reach is not called touching.
    let far = Placement::translation(Vector3::new(3.0, 0.0, 0.0));
    let solution = panda.arm.solve(far, &goal).unwrap();
    assert!(!solution.reached && !solution.goals_reached());
}

#[test]
fn the_same_question_has_the_same_answer() {
    let mut random = Random::new(7);
    let world = cluttered(&mut random);
    let panda_a = panda(Search::Start).among(&world, 0.0);
    let panda_b = panda(Search::Start).among(&world, 0.0);
    for _ in 0..cases(60, 10) {
        let (goal, start) = (panda_a.free(&mut random), panda_a.drawn(&mut random));
        let target = panda_a.arm.base_from_tool(&goal).unwrap();
        let a = panda_a.arm.solve(target, &start).unwrap();
        let b = panda_b.arm.solve(target, &start).unwrap();
        assert_eq!((a.q, a.reached, a.attempts), (b.q, b.reached, b.attempts));
    }
}

#[test]
fn a_batch_answers_as_one_question_after_another() {
    let mut random = Random::new(8);
    let panda = panda(Search::Start).among(&cluttered(&mut random), 0.01);
    let (mut targets, mut starts) = (Vec::new(), Vec::new());
    for _ in 0..cases(300, 40) {
        targets.push(panda.arm.base_from_tool(&panda.free(&mut random)).unwrap());
        starts.extend(panda.drawn(&mut random));
    }
    let together = panda.arm.solve_batch(&targets, &starts).unwrap();
    for ((target, start), batched) in targets.iter().zip(starts.chunks(7)).zip(together) {
        let alone = panda.arm.solve(*target, start).unwrap();
        assert_eq!((batched.q, batched.reached), (alone.q, alone.reached));
    }
}

#[test]
fn what_is_clear_by_its_spheres_touches_nothing() {
    let mut random = Random::new(9);
    let panda = panda(Search::Start).among(&cluttered(&mut random), 0.01);
    let count = cases(1001, 101);
    let q: Vec<f64> = (0..count).flat_map(|_| panda.drawn(&mut random)).collect();
    let mut clear = vec![false; count];
    panda.arm.clear_by_spheres(&q, &mut clear).unwrap();
    for (place, (q, clear)) in q.chunks(7).zip(&clear).enumerate() {
        // Its neighbours in the lanes say nothing about it.
        let mut alone = [false];
        panda.arm.clear_by_spheres(q, &mut alone).unwrap();
        assert_eq!(alone, [*clear], "{place}");
        assert!(!clear || panda.arm.collisions(q).unwrap().is_empty());
    }
    assert!(clear.iter().any(|clear| *clear));
    let mut bad = q[..7].to_vec();
    bad[3] = f64::NAN;
    let refused = panda.arm.clear_by_spheres(&bad, &mut [true]);
    assert!(refused.unwrap_err().to_string().contains("joint4"));
    // Of several the joint is told, not the place among all numbers.
    let bad = [&q[..14], &bad].concat();
    let refused = panda.arm.clear_by_spheres(&bad, &mut [true; 3]);
    assert!(refused.unwrap_err().to_string().contains("joint4"));
    assert!(panda.arm.clear_by_spheres(&q[..6], &mut [true]).is_err());
}

/// Two plates three centimetres apart, the upper of which turns on a shaft.
const PLATES: &str = r#"<robot name="plates"><link name="lower"><collision><geometry><box size="0.4 0.4 0.02"/></geometry></collision></link>
    <link name="shaft"/><link name="upper"><collision><geometry><box size="0.4 0.4 0.02"/></geometry></collision></link>
    <joint name="turn" type="continuous"><parent link="lower"/><child link="shaft"/><axis xyz="0 0 1"/></joint>
    <joint name="lift" type="prismatic"><parent link="shaft"/><child link="upper"/><origin xyz="0 0 0.05"/><axis xyz="0 0 1"/>
    <limit lower="-0.025" upper="0.02"/></joint></robot>"#;

/// Links so close that spheres do not tell them apart are as far apart as the margin says, too, where an arm is clear.
#[test]
fn close_links_keep_the_margin() {
    let robot = Robot::parse(PLATES, "plates.urdf").unwrap();
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_checked("lower", "upper").unwrap();
    let spheres = SphereModel::of(&bodies, Fineness::Overhang(0.03)).unwrap();
    let checker = Checker::new(bodies).with_spheres(spheres);
    let checker = checker.with_margin(0.02).unwrap();
    let arm = Arm::builder(&robot, "lower", "upper").with_atlas(false);
    let arm = arm
        .build()
        .unwrap()
        .with_checker(&checker, &[0.0; 2])
        .unwrap();
    for (lift, is_clear) in [
        (0.0, true),
        (0.015, true),
        (-0.009, true),
        (-0.011, false),
        (-0.02, false),
    ] {
        for turn in [0.0, 0.7, 2.0] {
            let mut clear = [!is_clear];
            arm.clear_by_spheres(&[turn, lift], &mut clear).unwrap();
            let touched = arm.collisions(&[turn, lift]).unwrap();
            assert_eq!(
                (clear[0], touched.is_empty()),
                (is_clear, is_clear),
                "{turn} {lift}"
            );
        }
    }
}

#[test]
fn a_tool_or_goal_keeps_what_the_arm_is_kept_clear_of() {
    let mut random = Random::new(21);
    let world = cluttered(&mut random);
    let panda = panda(Search::Start).among(&world, 0.0);
    let tool = Placement::translation(Vector3::new(0.0, 0.0, 0.1));
    let tooled = panda.arm.with_tool(tool).unwrap();
    let mut checked = 0;
    while checked < cases(100, 15) {
        let start = panda.drawn(&mut random);
        let target = tooled.base_from_tool(&panda.free(&mut random)).unwrap();
        let solution = tooled.solve(target, &start).unwrap();
        assert_eq!(
            solution.reached,
            tooled.collisions(&solution.q).unwrap().is_empty()
        );
        checked += 1;
    }
}

#[test]
fn many_obstacles_are_found_through_their_tree_as_one_by_one() {
    // As many small boxes as a wall has, once as obstacles of their own and once as one.
    let (mut many, mut one) = (World::new(), World::new());
    for y in -6..=6 {
        for z in 0..=12 {
            let at = Vector3::new(0.45, f64::from(y) * 0.1, f64::from(z) * 0.1);
            many.add_box(&format!("brick {y} {z}"), [0.1; 3], at)
                .unwrap();
        }
    }
    one.add_box("wall", [0.1, 1.3, 1.3], Vector3::new(0.45, 0.0, 0.6))
        .unwrap();
    let bricks = panda(Search::Start).among(&many, 0.0);
    let wall = panda(Search::Start).among(&one, 0.0);
    let mut random = Random::new(5);
    for _ in 0..cases(60, 10) {
        let (goal, start) = (wall.free(&mut random), wall.drawn(&mut random));
        let target = wall.arm.base_from_tool(&goal).unwrap();
        let [a, b] = [&bricks, &wall].map(|p| p.arm.solve(target, &start).unwrap());
        assert_eq!((a.q, a.reached), (b.q, b.reached));
    }
}

#[test]
fn what_stands_in_thousands_is_found_as_it_is_part_by_part() {
    found_as_part_by_part([700, 4000], 0.01);
    // Few points that are as thick as a link.
    found_as_part_by_part([300, 120], 0.08);
}

/// Balls, a cloud of points so thick and a floor; in parts so small that each is looked at one after another.
fn found_as_part_by_part([balls, points]: [usize; 2], thick: f64) {
    let mut random = Random::new(77);
    let balls: Vec<_> = (0..balls).map(|_| beside(&mut random)).collect();
    let points: Vec<_> = (0..points).map(|_| beside(&mut random)).collect();
    let floor = Placement::translation(Vector3::new(0.0, 0.0, -0.3));
    let mut whole = World::new();
    whole.add("floor", Shape::half_space(), floor).unwrap();
    whole
        .add(
            "cloud",
            Shape::points(points.clone(), thick).unwrap(),
            Vector3::zero(),
        )
        .unwrap();
    let mut parts = vec![World::new()];
    parts[0].add("floor", Shape::half_space(), floor).unwrap();
    for (index, &at) in balls.iter().enumerate() {
        whole
            .add_sphere(&format!("ball {index}"), 0.02, at)
            .unwrap();
        if index % 350 == 0 {
            parts.push(World::new());
        }
        let part = parts.last_mut().unwrap();
        part.add_sphere(&format!("ball {index}"), 0.02, at).unwrap();
    }
    for few in points.chunks(30) {
        let part = parts.last_mut().unwrap();
        let name = format!("cloud {}", part.obstacles().len());
        part.add(
            &name,
            Shape::points(few.to_vec(), thick).unwrap(),
            Vector3::zero(),
        )
        .unwrap();
    }
    let many = panda(Search::Start).among(&whole, 0.01);
    let parts: Vec<_> = (parts.iter())
        .map(|part| panda(Search::Start).among(part, 0.01))
        .collect();
    let drawn: Vec<f64> = (0..cases(4000, 200))
        .flat_map(|_| many.drawn(&mut random))
        .collect();
    let count = drawn.len() / 7;
    let mut by_parts = vec![true; count];
    let mut clear = vec![false; count];
    for part in &parts {
        part.arm.clear_by_spheres(&drawn, &mut clear).unwrap();
        for (all, clear) in by_parts.iter_mut().zip(&clear) {
            *all &= clear;
        }
    }
    // What is remembered of the first time changes nothing.
    for _ in 0..2 {
        many.arm.clear_by_spheres(&drawn, &mut clear).unwrap();
        assert_eq!(clear, by_parts);
    }
    let free = clear.iter().filter(|clear| **clear).count();
    assert!(
        free > count / 20 && free < count - count / 20,
        "{free} of {count}"
    );
}

/// Somewhere within reach, but not at the base.
fn beside(random: &mut Random) -> Vector3<f64> {
    loop {
        let at = Vector3::new(
            random.within(-0.9, 0.9),
            random.within(-0.9, 0.9),
            random.within(-0.2, 1.0),
        );
        if at.x.hypot(at.y) > 0.35 {
            return at;
        }
    }
}

#[test]
fn a_checker_of_another_model_is_refused() {
    let panda = panda(Search::Start);
    let other = CollisionModel::of(&robot("universal_ur5e")).unwrap();
    let error = panda
        .arm
        .with_checker(&Checker::new(other), &[0.0; 6])
        .unwrap_err();
    assert!(error.to_string().contains("checker"), "{error}");
}

#[test]
fn pairs_that_are_added_after_the_spheres_were_made_are_kept_apart_too() {
    let robot = robot("franka_panda");
    let bodies = CollisionModel::of(&robot).unwrap();
    let all: Vec<_> = bodies.pairs().to_vec();
    let none = all.iter().fold(bodies.clone(), |model, [a, b]| {
        model.with_ignored(*a, *b).unwrap()
    });
    let spheres = SphereModel::of(&none, Fineness::Overhang(0.03)).unwrap();
    let checker = Checker::new(bodies).with_spheres(spheres);
    let rest = vec![0.0; robot.model().configuration_len()];
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let arm = arm.with_checker(&checker, &rest).unwrap();
    let mut random = Random::new(8);
    let mut touching = 0;
    for _ in 0..cases(200, 60) {
        let q = drawn(&arm, &mut random);
        if arm.collisions(&q).unwrap().is_empty() {
            continue;
        }
        touching += 1;
        let solution = arm.solve(arm.base_from_tool(&q).unwrap(), &q).unwrap();
        assert_eq!(
            solution.reached,
            arm.collisions(&solution.q).unwrap().is_empty()
        );
    }
    assert!(touching > 2, "{touching}");
}

#[test]
fn joints_that_the_arm_locks_stand_where_it_locks_them() {
    let mut random = Random::new(31);
    let Panda {
        checker, q_model, ..
    } = panda(Search::Start);
    let robot = robot("franka_panda");
    let builder = Arm::builder(&robot, "base", "flange").with_locked("joint3", 1.2);
    let mut arm = builder.build().unwrap();
    let mut reached = 0;
    for _ in 0..cases(300, 60) {
        let checker = checker.clone().with_world(&cluttered(&mut random)).unwrap();
        arm = arm.with_checker(&checker, &q_model).unwrap();
        let q = drawn(&arm, &mut random);
        let solution = arm.solve(arm.base_from_tool(&q).unwrap(), &q).unwrap();
        let touched = arm.collisions(&solution.q).unwrap();
        reached += usize::from(solution.reached);
        assert_eq!(solution.reached, touched.is_empty(), "{touched:?}");
    }
    assert!(reached > 5, "{reached}");
}

/// A rod that sticks out of the hand, which is no link and has no spheres: carried from the start, or taken up later. Its place in the hand
/// is none in the world, where little would touch it.
#[test]
fn what_an_arm_carries_is_kept_clear_as_well() {
    let mut random = Random::new(31);
    let [plain, empty] = [(); 2].map(|()| panda(Search::Start).among(&World::new(), 0.0));
    let mut told = [0; 2];
    for _ in 0..cases(60, 12) {
        let mut world = cluttered(&mut random);
        world
            .add_box("rod", [0.4, 0.02, 0.02], Vector3::new(0.0, 0.0, 3.0))
            .unwrap();
        let without = plain.arm.with_world(&world, None).unwrap();
        let hand = Vector3::new(0.4, 0.0, 0.05);
        world.attach("rod", "flange", hand).unwrap();
        let checker = plain.checker.clone().with_world(&world).unwrap();
        let anew = Arm::clone(&plain.arm);
        let anew = anew.with_checker(&checker, &plain.q_model).unwrap();
        let taken = without.with_world(&world, None).unwrap();
        let after = empty.arm.with_world(&world, None).unwrap();
        let (goal, start) = (plain.drawn(&mut random), plain.drawn(&mut random));
        let target = plain.arm.base_from_tool(&goal).unwrap();
        for arm in [anew, taken, after] {
            let solution = arm.solve(target, &start).unwrap();
            let touched = arm.collisions(&solution.q).unwrap();
            assert_eq!(solution.reached, touched.is_empty(), "{touched:?}");
            told[usize::from(solution.reached)] += 1;
        }
    }
    assert!(told.iter().all(|told| *told > 5), "{told:?}");
}

/// Solutions that are looked at by their shapes are counted anew for each question.
#[test]
fn questions_before_leave_as_much_to_be_looked_at() {
    let mut random = Random::new(33);
    let panda = panda(Search::Nearest).among(&cluttered(&mut random), 0.0);
    let new = panda.arm.clone();
    for turn in 0..cases(60, 20) {
        let (goal, start) = (panda.drawn(&mut random), panda.drawn(&mut random));
        let target = panda.arm.base_from_tool(&goal).unwrap();
        let [own, fresh] = [&panda.arm, &new.clone()].map(|arm| arm.solve(target, &start).unwrap());
        assert_eq!(format!("{own:?}"), format!("{fresh:?}"), "{turn}");
    }
}

/// Links are kept apart by the whole margin, whichever of two is looked at first.
#[test]
fn what_is_clear_by_its_spheres_is_clear_by_a_wide_margin() {
    let mut random = Random::new(10);
    for margin in [0.05, 0.1, 0.15] {
        let mut panda = panda(Search::Start);
        // Pairs are left out until some configuration has all others farther apart.
        loop {
            let checker = panda.checker.clone().with_margin(margin).unwrap();
            let mut q = panda.q_model.clone();
            let drawn = panda.drawn(&mut random);
            panda.arm.configuration(&drawn, &mut q).unwrap();
            let touched = checker.collisions(&q).unwrap();
            let Some(pair) = touched.first() else {
                break;
            };
            let bodies = checker.model().clone();
            let ends = (pair.first.as_str(), pair.second.as_str());
            let bodies = bodies.with_ignored(ends.0, ends.1).unwrap();
            let spheres = checker.spheres().unwrap().clone();
            panda.checker = Checker::new(bodies).with_spheres(spheres);
        }
        // A narrower one of before counts no more.
        let mut panda = panda.among(&World::new(), 0.0);
        panda.arm = panda.arm.with_world(&World::new(), margin).unwrap();
        let count = cases(1000, 200);
        let q: Vec<f64> = (0..count).flat_map(|_| panda.drawn(&mut random)).collect();
        let mut clear = vec![false; count];
        panda.arm.clear_by_spheres(&q, &mut clear).unwrap();
        let mut near = 0;
        for (q, clear) in q.chunks(7).zip(&clear) {
            let touched = panda.arm.collisions(q).unwrap();
            near += usize::from(!touched.is_empty());
            assert!(!clear || touched.is_empty(), "{margin}: {touched:?}");
        }
        assert!(
            near > 0 && clear.iter().any(|clear| *clear),
            "{margin}: {near}"
        );
    }
}

/// An arm that keeps clear of nothing does not call anything free.
#[test]
fn of_a_plain_arm_it_is_not_known_what_it_touches() {
    let plain = kinopt::Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let q = [0.0; 7];
    let told = plain.collisions(&q).unwrap_err().to_string();
    assert!(told.contains("not known"), "{told}");
    assert!(plain.clear_by_spheres(&q, &mut [true]).is_err());
    let told = plain
        .with_world(&World::new(), None)
        .unwrap_err()
        .to_string();
    assert!(!told.contains("with_checker"), "{told}");
}
