//! Promise: so it is for checkers of bodies drawn at random, with joints of every kind and shapes of every kind, while their worlds are
//! edited in every order, their margins, spheres and pairs are changed and one workspace is asked about all: contacts, the nearest,
//! ways, clearances; and for worlds themselves, with what they refuse.
#![allow(clippy::unwrap_used)]

use kinopt::collision::{
    Checker, CheckerWorkspace, Clearance, CollisionModel, CollisionObject, MotionCheck,
    SphereModel, World,
};
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::Model;
use kinopt::problem::{ClearanceCheck, CollisionAvoidance};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{InequalityResidual, Residual};
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::every_joint::{model, place, vector};
use crate::shape_mixes::{KINDS, shape};

/// Frames of the body that carry shapes.
pub(crate) const LINKS: [&str; 7] = ["hand", "foot", "head", "tray", "back", "middle", "arm"];

/// Some shapes on some frames of a body, several on some, of the first so many kinds.
pub(crate) fn shapes(model: &Model, random: &mut Random, kinds: usize) -> CollisionModel {
    let mut objects = Vec::new();
    for link in LINKS {
        let frame = model.frame(link).unwrap();
        for k in 0..[1, 1, 2, 3, 0][random.below(5)] {
            let kind = random.below(kinds);
            let (own, at) = (shape(random, kind, 0.2), place(random, 0.1));
            objects.push(CollisionObject::new(format!("{link}_{k}"), frame, at, own));
        }
    }
    CollisionModel::new(model, objects).unwrap()
}

/// A sphere about each shape, so many times as large as the one around it: those of less than 1 leave gaps.
pub(crate) fn spheres(bodies: &CollisionModel, share: f64) -> SphereModel {
    let mut text = "collision_spheres:\n".to_owned();
    for &link in bodies.links() {
        text += &format!("  {}:\n", bodies.model().frames()[link.index()].name);
        for object in bodies.objects_of(link) {
            let ball = object.shape.bounding_sphere();
            let [x, y, z] = object.link_from_shape.apply(ball.centre).to_array();
            let radius = share * ball.radius;
            text += &format!("    - {{center: [{x}, {y}, {z}], radius: {radius}}}\n");
        }
    }
    SphereModel::parse(text.as_bytes(), "spheres.yaml", bodies).unwrap()
}

impl Digest {
    fn world(&mut self, world: &World) {
        for own in world.obstacles() {
            self.text(&own.name);
            self.placement(&own.placement);
            let ball = own.shape.bounding_sphere();
            self.noted(&(&own.attached, &own.allowed_collisions, ball));
        }
        self.noted(&(
            world.len(),
            world.is_empty(),
            world.revision(),
            world.notes(),
        ));
    }

    fn way_told<E: ToString>(&mut self, way: Result<MotionCheck, E>) {
        match way {
            Ok(way) => {
                self.doubles([way.free, way.initial_penetration]);
                self.noted(&way.blocked_by);
            }
            Err(error) => self.text(error.to_string()),
        }
    }
}

/// A name of an obstacle, of a link, or of nothing.
fn name(random: &mut Random, world: &World) -> String {
    match random.below(10) {
        0 => LINKS[random.below(LINKS.len())].to_owned(),
        1 => ["nothing", " ", ""][random.below(3)].to_owned(),
        _ if world.is_empty() => "none".to_owned(),
        _ => {
            let at = random.below(world.len());
            world.obstacles().nth(at).unwrap().name.clone()
        }
    }
}

/// One change of a world, or what it refuses.
pub(crate) fn edit(digest: &mut Digest, world: &mut World, random: &mut Random, size: f64) {
    let (one, other) = (name(random, world), name(random, world));
    let at = match random.below(25) {
        0 => Placement::translation(Vector3::new(0.0, f64::NAN, 0.0)),
        _ => place(random, 1.2),
    };
    let result = match random.below(14) {
        0..4 => {
            let kind = random.below(KINDS);
            let own = shape(random, kind, size);
            world.add(&format!("thing {}", world.revision()), own, at)
        }
        4 => world.add(&one, shape(random, 0, size), at),
        5 | 6 => world.move_to(&one, at),
        7 => world.remove(&one),
        8 => world.attach(&one, LINKS[random.below(LINKS.len())], at),
        9 => world.detach(&one, at),
        10 | 11 => world.allow_collision(&one, &other),
        12 => world.allow_collision(&one, LINKS[random.below(LINKS.len())]),
        _ => {
            let touching = world
                .obstacles()
                .find(|own| !own.allowed_collisions.is_empty());
            let pair = touching.map(|own| [own.name.clone(), own.allowed_collisions[0].clone()]);
            let [one, other] = pair.unwrap_or([one, other]);
            world.forbid_collision(&other, &one)
        }
    };
    digest.refusal(result);
}

/// What is attached, and to what.
fn held(world: &World) -> Vec<Option<String>> {
    let attached = world.obstacles().map(|own| own.attached.clone());
    attached.filter(Option::is_some).collect()
}

/// All that a checker says of a configuration and of ways from the last.
fn asked(
    digest: &mut Digest,
    checker: &Checker,
    workspace: &mut CheckerWorkspace,
    [from, to]: [&[f64]; 2],
    random: &mut Random,
) {
    let found = checker.collisions_with(workspace, to).unwrap();
    digest.noted(&found);
    digest.noted(&checker.is_free(workspace, to));
    let within = [-0.05, 0.0, 0.1, 0.5, f64::INFINITY][random.below(5)];
    digest.noted(&checker.nearest(workspace, to, within));
    let mut between = vec![0.0; to.len()];
    let share = [0.02, 0.2, 1.0][random.below(3)];
    let model = checker.model().model();
    model.interpolate(from, to, share, &mut between).unwrap();
    digest.way_told(checker.check_motion(workspace, from, &between));
    digest.way_told(checker.way_from_contact(workspace, from, &between));
    let mut check = checker.check();
    digest.noted(&check.blocked(from, &between));
    digest.doubles([check.free_share(&between, from)]);
}

/// A clearance's rows and their slopes, for each of the kinds of questions that solvers ask.
fn cleared(digest: &mut Digest, clearance: &Clearance, model: &Model, q: &[f64]) {
    let inputs = Residual::inputs(clearance);
    let rows: usize = Residual::rows(clearance).iter().map(|row| row.count).sum();
    let mut kinematics = ForwardKinematics::<f64>::new(model);
    let all = kinematics.place(q).unwrap();
    let placed: Vec<_> = inputs
        .frame_ids()
        .iter()
        .map(|frame| all[frame.index()])
        .collect();
    let mut values = vec![0.0; rows];
    clearance.evaluate(&placed, &[], &mut values);
    digest.doubles(values.iter().copied());
    clearance.slacks(&placed, &[], &mut values);
    digest.doubles(values);
    let description = clearance.description();
    let validity = description.defect().map_or(Ok(()), Err);
    digest.noted(&(clearance.distance(), validity, description.kind()));
}

fn checkers() -> [Value; 2] {
    let (mut digest, mut worlds, mut random) = (Digest::new(), Digest::new(), Random::new(911));
    for case in 0..5 {
        let model = model(&mut random, case % 3 == 1);
        let mut own = shapes(&model, &mut random, [KINDS - 2, 4, KINDS - 2, 1][case % 4]);
        if case % 5 == 1 {
            let q = model.random_configuration(case as u64);
            own = own.with_touching_ignored(&q).unwrap();
        }
        if case % 5 == 2 {
            own = own.with_pairs_sampled(20, case as u64).unwrap();
        }
        digest.noted(&(own.links(), own.pairs()));
        let mut checker = Checker::new(own.clone());
        let share = [0.5, 0.9, 1.0, 1.1][random.below(4)];
        let around = spheres(&own, share);
        if random.below(3) > 0 {
            checker = checker.with_spheres(around.clone());
        }
        let mut clearance = Clearance::new(&checker, 0.3);
        let mut world = World::new();
        let (mut workspace, mut of_workspace) = (checker.workspace(), held(&world));
        let mut last = model.random_configuration(50 + case as u64);
        for _ in 0..5 {
            for _ in 0..[1, 4, 9][random.below(3)] {
                edit(&mut worlds, &mut world, &mut random, 0.3);
            }
            worlds.world(&world);
            match checker.clone().with_world(&world) {
                Ok(changed) => checker = changed,
                Err(error) => {
                    digest.text(error.to_string());
                    world = checker.world().clone();
                }
            }
            if random.below(3) == 0 {
                let margin = [0.0, 0.01, 0.1, -1.0, f64::NAN][random.below(5)];
                match checker.clone().with_margin(margin) {
                    Ok(changed) => checker = changed,
                    Err(error) => digest.text(error.to_string()),
                }
            }
            if random.below(5) == 0 {
                checker = checker.with_spheres(around.clone());
            }
            // A workspace is of what moves.
            let now = held(checker.world());
            if now != of_workspace || random.below(3) == 0 {
                (workspace, of_workspace) = (checker.workspace(), now);
            }
            let q = model.random_configuration(random.bits() >> 40);
            asked(
                &mut digest,
                &checker,
                &mut workspace,
                [&last, &q],
                &mut random,
            );
            asked(
                &mut digest,
                &checker,
                &mut workspace,
                [&q, &last],
                &mut random,
            );
            match random.below(2) {
                0 => clearance = Clearance::new(&checker, 0.2),
                _ => clearance.set_checker(&checker),
            }
            clearance.set_distance(random.within(0.0, 0.4));
            cleared(&mut digest, &clearance, &model, &q);
            last = q;
        }
        digest.refusal(checker.check_motion(&mut workspace, &last[1..], &last));
        digest.refusal(checker.check_motion(&mut workspace, &last, &vec![f64::NAN; last.len()]));
        digest.refusal(checker.nearest(&mut workspace, &[], 1.0));
        let times = [0.3, 2.0, 0.0][random.below(3)];
        match world.scaled(times) {
            Ok(scaled) => worlds.world(&scaled),
            Err(error) => worlds.text(error.to_string()),
        }
        for _ in 0..3 {
            let up = vector(&mut random, 1.0);
            worlds.noted(&world.height_at(vector(&mut random, 0.5), up));
        }
        let text = world.to_json();
        worlds.bytes(&text);
        worlds.world(&World::from_json(text.as_bytes(), "world.json").unwrap());
        let (one, other) = (name(&mut random, &world), name(&mut random, &world));
        worlds.noted(&world.is_collision_allowed(&one, &other));
        worlds.refusal(world.obstacle(&one));
    }
    [digest.value(), worlds.value()]
}

#[test]
fn of_mixed_checkers() {
    let [checkers, worlds] = checkers();
    check(&[
        ("checkers of mixed bodies in edited worlds", checkers),
        ("worlds edited in every order", worlds),
    ]);
}
