//! Drags of rigs out of reach, into their limits and back: largest jump of a joint between two frames, and processor
//! time of a frame. Then the cost of whole bodies with unreachable targets: `cargo run --release -p kinopt-benches
//! --bin drags -- [--solver] [FILE.json | FILE.urdf …]`, with `--solver` also with independent searches.
#![allow(clippy::print_stdout)]

use kinopt::animation::Armature;
use kinopt::ik::{Drag, Restarts};
use kinopt::io::rig::Rig;
use kinopt::model::Limits;
use kinopt::robot::Robot;
use kinopt::skeleton::BoneId;
use kinopt::{Solution, Solver, Workspace};
use kinopt_benches::{BodyMiss, DragScene, ThreadTime, at_ease, figure};
use std::error::Error;
use std::path::Path;

/// Number of frames of one drag.
const FRAMES: u32 = 5000;
/// Smallest displacement of a joint in a frame that counts as a jump, in radians.
const MIN_JUMP: f64 = 0.2;

/// Statistics of the frames of a drag.
#[derive(Default)]
struct DragStatistics {
    jumps: usize,
    max_displacement: f64,
    reached: usize,
    steps: usize,
    evaluations: usize,
    micros: Vec<f64>,
}

impl DragStatistics {
    fn add_frame(&mut self, started: ThreadTime, solution: &Solution, q: &mut [f64]) {
        self.micros.push(started.micros());
        let moves = solution.q.iter().zip(&*q);
        let max_displacement = moves.fold(0.0, |max: f64, (a, b)| max.max((a - b).abs()));
        self.jumps += usize::from(max_displacement > MIN_JUMP);
        self.max_displacement = self.max_displacement.max(max_displacement);
        self.reached += usize::from(solution.reached);
        self.steps += solution.iterations;
        self.evaluations += solution.counts.residuals;
        q.copy_from_slice(&solution.q);
    }

    fn print(mut self, label: &str) {
        self.micros.sort_by(f64::total_cmp);
        let quantile = |share: f64| self.micros[((self.micros.len() - 1) as f64 * share) as usize];
        println!(
            "  {label:<22} {:>5} leaps, furthest {:>6.3} rad, {:>4} reached, {:>7.1} steps, \
             {:>7.1} evaluations a frame, p50 {:>8.1} µs, p99 {:>9.1} µs, max {:>9.1} µs",
            self.jumps,
            self.max_displacement,
            self.reached,
            self.steps as f64 / f64::from(FRAMES),
            self.evaluations as f64 / f64::from(FRAMES),
            quantile(0.5),
            quantile(0.99),
            quantile(1.0),
        );
    }
}

fn by_solver(scene: &DragScene, solver: &Solver) -> Result<DragStatistics, Box<dyn Error>> {
    let (problem, hand) = scene.problem()?;
    let mut targets = problem.targets();
    let mut workspace = Workspace::new();
    let mut q = scene.start.clone();
    let mut statistics = DragStatistics::default();
    for frame in 0..FRAMES {
        let point = targets.get_mut(hand)?;
        point.set_target(scene.target(frame, FRAMES));
        let instance = problem.with_targets(&targets)?;
        let started = ThreadTime::now();
        let solution = solver.solve(instance, &q, &mut workspace)?;
        statistics.add_frame(started, solution, &mut q);
    }
    Ok(statistics)
}

fn by_drag(scene: &DragScene) -> Result<DragStatistics, Box<dyn Error>> {
    let (problem, hand) = scene.problem()?;
    let mut drag = Drag::new(problem, &scene.start)?;
    let mut q = scene.start.clone();
    let mut statistics = DragStatistics::default();
    for frame in 0..FRAMES {
        let point = drag.target_mut(hand)?;
        point.set_target(scene.target(frame, FRAMES));
        let started = ThreadTime::now();
        let solution = drag.advance();
        statistics.add_frame(started, solution, &mut q);
    }
    Ok(statistics)
}

fn main() -> Result<(), Box<dyn Error>> {
    let files: Vec<String> = std::env::args().skip(1).collect();
    let compares_solver = files.iter().any(|argument| argument == "--solver");
    let mut scenes = Vec::new();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let (skeleton, tips) = figure(2, 4);
    let start = at_ease(&skeleton);
    scenes.push(DragScene::of_skeleton(
        "figure of 22 bones",
        &skeleton,
        tips[1],
        &tips,
        start,
    ));
    let mut rigs = vec![
        models.join("humanoid/humanoid.json"),
        models.join("robot-arm/robot-arm.json"),
    ];
    rigs.extend(
        files
            .iter()
            .filter(|f| f.ends_with(".json"))
            .map(Into::into),
    );
    for path in rigs {
        let rig = Rig::read(&path)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let hand = rig.skeleton.bone("left_hand").ok();
        let hand = hand
            .or(rig.skeleton.bone_ids().last())
            .ok_or("a rig with bones")?;
        let rest = rig.skeleton.model().neutral();
        scenes.push(DragScene::of_skeleton(
            &name,
            &rig.skeleton,
            hand,
            &rig.constrained,
            rest,
        ));
    }
    let rig = Rig::read(models.join("humanoid/humanoid.json"))?;
    let (humanoid_skeleton, rest) = (&rig.skeleton, rig.skeleton.model().neutral());
    let hand = humanoid_skeleton.bone("left_hand")?;
    let humanoid = |held: &[BoneId]| {
        DragScene::of_skeleton("humanoid", humanoid_skeleton, hand, held, rest.clone())
    };
    scenes.push(humanoid(&rig.constrained).with_posture());
    // These bones as an animation file would have them.
    let bare =
        Armature::of_skeleton(humanoid_skeleton).skeleton("bare", |_| [Limits::UNBOUNDED; 3])?;
    let hand = bare.bone("left_hand")?;
    let start = bare.model().neutral();
    let name = "humanoid as a scene has it";
    scenes.push(DragScene::of_bare_figure(name, &bare, hand, start)?);
    for scene in &scenes {
        println!("{}, {FRAMES} frames", scene.name);
        if compares_solver {
            by_solver(scene, &Solver::default())?.print("solver");
            let single_attempt = Solver::default().with_restarts(Restarts::none());
            by_solver(scene, &single_attempt)?.print("solver, one attempt");
        }
        by_drag(scene)?.print("drag");
    }

    println!("bodies that miss");
    let mut bodies = vec![BodyMiss::of_figure("figure of 22 bones", &skeleton, &tips)];
    for file in files.iter().filter(|f| f.ends_with(".urdf")) {
        bodies.push(BodyMiss::of_robot(file, &Robot::read(file)?)?);
    }
    for body in &bodies {
        let mut workspace = Workspace::new();
        for (label, solver) in [
            ("solver", Solver::default()),
            (
                "one attempt",
                Solver::default().with_restarts(Restarts::none()),
            ),
        ] {
            for (description, problem) in &body.problems {
                let mut micros: Vec<f64> = Vec::new();
                for _ in 0..5 {
                    let started = ThreadTime::now();
                    solver.solve(problem, &body.start, &mut workspace)?;
                    micros.push(started.micros());
                }
                micros.sort_by(f64::total_cmp);
                let solution = workspace.solution();
                println!(
                    "  {}, {} variables, {description}, {label}: cost {:.9e}, {} attempts, {} steps, {} residuals, \
                     {} Jacobians, {} gradients, {:?}, {:.0} µs",
                    body.name,
                    problem.variables(),
                    solution.cost,
                    solution.attempts,
                    solution.iterations,
                    solution.counts.residuals,
                    solution.counts.jacobians,
                    solution.counts.gradients,
                    solution.termination,
                    micros[2],
                );
            }
        }
    }
    Ok(())
}
