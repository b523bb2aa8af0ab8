//! Success rate and time of whole-body queries for hands among obstacles, compared with queries without obstacles:
//! `cargo run --release -p kinopt-benches --bin body_obstacles -- ROBOT.urdf [questions] [hands]`, with Unitree's G1.
//!
//! The robot is balanced on its feet, in front of a table and under a shelf. Its shapes are the capsules of
//! `whole_body/g1-capsules.json`. Targets are hand poses of random balanced, collision-free configurations, so every
//! query is reachable.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::path::Path;

use kinopt::collision::{Checker, CollisionModel, CollisionObject, Shape, World};
use kinopt::model::Model;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::{Solver, Workspace};
use kinopt_benches::{BodyCase, ThreadTime};
use serde_json::Value;

type Capsule = ([f64; 3], [f64; 3], f64);

fn shapes(model: &Model, file: &Path) -> Result<CollisionModel, Box<dyn Error>> {
    let document: Value = serde_json::from_str(&std::fs::read_to_string(file)?)?;
    let mut objects = Vec::new();
    for (link, capsules) in document.as_object().ok_or("capsules are by link")? {
        let capsules: Vec<Capsule> = serde_json::from_value(capsules.clone())?;
        for (index, (from, to, radius)) in capsules.into_iter().enumerate() {
            let [from, to] = [from, to].map(Vector3::from);
            let axis = to - from;
            let direction = axis * (1.0 / axis.norm());
            let smallest = (0..3).min_by(|a, b| {
                direction.to_array()[*a]
                    .abs()
                    .total_cmp(&direction.to_array()[*b].abs())
            });
            let across = direction.cross(Vector3::UNITS[smallest.unwrap_or(0)]);
            let across = across * (1.0 / across.norm());
            let rotation = Matrix3::from_columns(across, direction.cross(across), direction);
            objects.push(CollisionObject::new(
                format!("{link} {index}"),
                model.frame(link)?,
                Placement::new(rotation, (from + to) * 0.5),
                Shape::capsule(radius, axis.norm())?,
            ));
        }
    }
    let model = CollisionModel::new(model, objects)?;
    Ok(model.with_pairs_sampled(2000, 1)?)
}

fn world(floor: f64) -> Result<World, Box<dyn Error>> {
    let mut world = World::new();
    world.add_plane(
        "floor",
        Placement::translation(Vector3::new(0.0, 0.0, floor - 0.01)),
    )?;
    let above_floor = |x, y, z| Vector3::new(x, y, floor + z);
    world.add_box("table", [0.6, 1.4, 0.04], above_floor(0.5, 0.0, 0.72))?;
    world.add_box("shelf", [0.35, 0.9, 0.02], above_floor(0.45, 0.0, 1.15))?;
    world.add_box("side", [0.35, 0.02, 0.5], above_floor(0.45, 0.45, 0.98))?;
    world.add_box("box", [0.12, 0.12, 0.2], above_floor(0.45, -0.3, 0.84))?;
    world.add_cylinder("bottle", 0.04, 0.25, above_floor(0.45, 0.25, 0.865))?;
    Ok(world)
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let robot = arguments.first().ok_or("which robot?")?;
    let count: usize = arguments.get(1).map_or(Ok(200), |n| n.parse())?;
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/whole_body"));
    let mut case = BodyCase::read(&folder.join("g1.json"), Path::new(robot))?;
    if arguments.get(2).is_some_and(|hands| hands == "1") {
        case.hands.truncate(1);
    }
    let model = case.robot.model();
    let body = shapes(model, &folder.join("g1-capsules.json"))?;
    let floor = case
        .support
        .iter()
        .map(|corner| corner.z)
        .fold(f64::INFINITY, f64::min);
    let checker = Checker::new(body).with_world(&world(floor)?)?;
    println!(
        "{} parts, {} pairs of them",
        checker.model().links().len(),
        checker.model().pairs().len()
    );
    println!("standing: {:?}", checker.collisions(&case.standing)?);

    let mut collision_free = Vec::new();
    let mut sampled = 0;
    while collision_free.len() < count {
        sampled += 4 * count;
        collision_free = case.balanced(sampled)?;
        let mut workspace = checker.workspace();
        collision_free.retain(|q| checker.is_free(&mut workspace, q).unwrap_or(false));
    }
    println!(
        "{} of {sampled} balanced configurations are free",
        collision_free.len()
    );
    collision_free.truncate(count);
    let plain = case.problem()?;
    let avoiding = case.problem_clear_of(&checker)?;
    let mut workspace = checker.workspace();
    let started = ThreadTime::now();
    for q in &collision_free {
        checker.is_free(&mut workspace, q)?;
    }
    println!("a check: {:.2} us", started.micros() / count as f64);
    let mut medians = Vec::new();
    for (name, body) in [("plain", &plain), ("clear", &avoiding)] {
        let targets = case.hands_at(&collision_free)?;
        let targets: Vec<_> = targets
            .iter()
            .map(|placements| body.targets(placements))
            .collect::<Result<_, _>>()?;
        let (solver, mut memory) = (Solver::default(), Workspace::new());
        let mut micros = vec![f64::INFINITY; count];
        let (mut reached, mut goals, mut touching, mut attempts) = (0, 0, 0, 0);
        for round in 0..3 {
            for (k, targets) in targets.iter().enumerate() {
                let instance = body.problem.with_targets(targets)?;
                let started = ThreadTime::now();
                let solution = solver.solve(instance, &case.standing, &mut memory)?;
                micros[k] = micros[k].min(started.micros());
                if round == 0 {
                    let pairs = checker.collisions(&solution.q)?;
                    reached += usize::from(solution.reached);
                    goals += usize::from(solution.goals_reached());
                    attempts += solution.attempts;
                    touching +=
                        usize::from(solution.reached && pairs.iter().any(|p| p.depth() > 1e-6));
                    if name == "clear" && !solution.reached && std::env::var_os("TELL").is_some() {
                        println!("{k}: {}", solution.explain());
                    }
                }
            }
        }
        micros.sort_by(f64::total_cmp);
        let quantile = |share: f64| micros[((count - 1) as f64 * share) as usize];
        println!(
            "{name}: {reached} of {count} reached ({goals} with their goals met), {touching} of them touching; median {:.1} us, mean {:.1}, p90 {:.1}, p99 {:.1}; {:.2} attempts",
            quantile(0.5),
            micros.iter().sum::<f64>() / count as f64,
            quantile(0.9),
            quantile(0.99),
            attempts as f64 / count as f64
        );
        medians.push(quantile(0.5));
    }
    println!("median {:.2} times plain", medians[1] / medians[0]);
    Ok(())
}
