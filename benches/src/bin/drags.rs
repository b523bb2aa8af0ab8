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
const LEAP: f64 = 0.2;

/// Statistics of the frames of a drag.
#[derive(Default)]
struct Course {
    leaps: usize,
    furthest: f64,
    reached: usize,
    steps: usize,
    evaluations: usize,
    micros: Vec<f64>,
}

impl Course {
    fn take(&mut self, begun: ThreadTime, solution: &Solution, q: &mut [f64]) {
        self.micros.push(begun.micros());
        let moves = solution.q.iter().zip(&*q);
        let furthest = moves.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        self.leaps += usize::from(furthest > LEAP);
        self.furthest = self.furthest.max(furthest);
        self.reached += usize::from(solution.reached);
        self.steps += solution.iterations;
        self.evaluations += solution.counts.residuals;
        q.copy_from_slice(&solution.q);
    }

    fn print(mut self, who: &str) {
        self.micros.sort_by(f64::total_cmp);
        let at = |share: f64| self.micros[((self.micros.len() - 1) as f64 * share) as usize];
        println!(
            "  {who:<22} {:>5} leaps, furthest {:>6.3} rad, {:>4} reached, {:>7.1} steps, \
             {:>7.1} evaluations a frame, p50 {:>8.1} µs, p99 {:>9.1} µs, max {:>9.1} µs",
            self.leaps,
            self.furthest,
            self.reached,
            self.steps as f64 / f64::from(FRAMES),
            self.evaluations as f64 / f64::from(FRAMES),
            at(0.5),
            at(0.99),
            at(1.0),
        );
    }
}

fn by_solver(scene: &DragScene, solver: &Solver) -> Result<Course, Box<dyn Error>> {
    let (problem, hand) = scene.problem()?;
    let mut targets = problem.targets();
    let mut workspace = Workspace::new();
    let mut q = scene.start.clone();
    let mut course = Course::default();
    for frame in 0..FRAMES {
        let point = targets.get_mut(hand)?;
        point.set_target(scene.target(frame, FRAMES));
        let question = problem.with_targets(&targets)?;
        let begun = ThreadTime::now();
        let solution = solver.solve(question, &q, &mut workspace)?;
        course.take(begun, solution, &mut q);
    }
    Ok(course)
}

fn by_drag(scene: &DragScene) -> Result<Course, Box<dyn Error>> {
    let (problem, hand) = scene.problem()?;
    let mut drag = Drag::new(problem, &scene.start)?;
    let mut q = scene.start.clone();
    let mut course = Course::default();
    for frame in 0..FRAMES {
        let point = drag.target_mut(hand)?;
        point.set_target(scene.target(frame, FRAMES));
        let begun = ThreadTime::now();
        let solution = drag.advance();
        course.take(begun, solution, &mut q);
    }
    Ok(course)
}

fn main() -> Result<(), Box<dyn Error>> {
    let files: Vec<String> = std::env::args().skip(1).collect();
    let peers = files.iter().any(|argument| argument == "--solver");
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
    let (skeleton_, rest) = (&rig.skeleton, rig.skeleton.model().neutral());
    let hand = skeleton_.bone("left_hand")?;
    let humanoid =
        |held: &[BoneId]| DragScene::of_skeleton("humanoid", skeleton_, hand, held, rest.clone());
    scenes.push(humanoid(&rig.constrained).with_posture());
    // These bones as an animation file would have them.
    let bare = Armature::of_skeleton(skeleton_).skeleton("bare", |_| [Limits::UNBOUNDED; 3])?;
    let hand = bare.bone("left_hand")?;
    let start = bare.model().neutral();
    let name = "humanoid as a scene has it";
    scenes.push(DragScene::of_bare_figure(name, &bare, hand, start)?);
    for scene in &scenes {
        println!("{}, {FRAMES} frames", scene.name);
        if peers {
            by_solver(scene, &Solver::default())?.print("solver");
            let once = Solver::default().with_restarts(Restarts::none());
            by_solver(scene, &once)?.print("solver, one attempt");
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
        for (who, solver) in [
            ("solver", Solver::default()),
            (
                "one attempt",
                Solver::default().with_restarts(Restarts::none()),
            ),
        ] {
            for (what, problem) in &body.problems {
                let mut micros: Vec<f64> = Vec::new();
                for _ in 0..5 {
                    let begun = ThreadTime::now();
                    solver.solve(problem, &body.start, &mut workspace)?;
                    micros.push(begun.micros());
                }
                micros.sort_by(f64::total_cmp);
                let solution = workspace.solution();
                println!(
                    "  {}, {} variables, {what}, {who}: cost {:.9e}, {} attempts, {} steps, {} residuals, \
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
