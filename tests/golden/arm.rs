//! Arms: poses, batches, tracks, servos, Cartesian paths and collision avoidance.

use kinopt::Solution;
use kinopt::arm::{Arm, ArmBuilder, JointPath, PoseBounds, Search};
use kinopt::collision::{Checker, World};
use kinopt::motion::path::{CartesianPath, PathSolver, TimingLimits};
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::random::Random;

use super::record::{Case, Record};

pub(crate) const CASES: &[Case] = &[
    Case::double("arm_solve", solve),
    Case::double("arm_search", search),
    Case::double("arm_batch", batch),
    Case::double("arm_mimic_joints", mimic_joints),
    Case::double("arm_track", track),
    Case::double("arm_servo", servo),
    Case::double("arm_path", path),
    Case::double("arm_avoidance", avoidance),
];

fn built(builder: ArmBuilder<'_>) -> Arm {
    builder.with_atlas(false).build().unwrap()
}

fn arm(name: &str) -> Arm {
    built(Arm::builder(&robot(name), "base", "flange"))
}

/// `count` targets, the last of them out of reach, and starts.
fn queries(arm: &Arm, seed: u64, count: usize) -> (Vec<Placement<f64>>, Vec<f64>) {
    let mut random = Random::split_mix(seed);
    let mut pose = || arm.base_from_tool(&random.configuration(arm)).unwrap();
    let mut targets: Vec<_> = (0..count).map(|_| pose()).collect();
    targets[count - 1].translation = targets[count - 1].translation * 1.5;
    targets[count - 1].translation.x += 1.0;
    let starts = (0..count).flat_map(|_| random.configuration(arm)).collect();
    (targets, starts)
}

fn solved(arm: &Arm, seed: u64, count: usize) -> Vec<Solution> {
    let (targets, starts) = queries(arm, seed, count);
    let queries = targets.iter().zip(starts.chunks(arm.joint_count()));
    let results = queries.map(|(target, start)| arm.solve(*target, start).unwrap());
    results.collect()
}

fn solve(record: &mut Record) {
    record.solutions("panda", &solved(&arm("franka_panda"), 1, 8));
    record.solutions("cobra", &solved(&arm("adept_cobra_s600"), 2, 5));
    let ur5e = robot("universal_ur5e");
    let bounds = PoseBounds::within([0.05, 0.0, 0.02, 0.2, 0.1, 0.3]);
    let bounded = built(Arm::builder(&ur5e, "base", "flange").with_goal(bounds));
    record.solutions("bounds", &solved(&bounded, 3, 5));
}

fn search(record: &mut Record) {
    let iiwa = robot("kuka_iiwa14");
    let builder = || Arm::builder(&iiwa, "base", "flange").with_attempts(16);
    let nearest = built(builder().with_search(Search::Nearest));
    record.solutions("nearest", &solved(&nearest, 4, 3));
}

fn batch(record: &mut Record) {
    for name in ["universal_ur5e", "franka_panda"] {
        let arm = arm(name);
        let (targets, starts) = queries(&arm, 6, 40);
        let solutions = arm.solve_batch_parallel(&targets, &starts).unwrap();
        record.solutions(name, &solutions);
    }
}

fn mimic_joints(record: &mut Record) {
    let nao = robot("aldebaran_nao");
    let legs = built(Arm::builder(&nao, "left_sole", "right_sole").with_attempts(6));
    record.solutions("legs", &solved(&legs, 7, 3));
}

/// A straight line of the tool from a configuration, `step` metres at a time.
fn line(arm: &Arm, start: &[f64], step: [f64; 3], count: u32) -> Vec<Placement<f64>> {
    let from = arm.base_from_tool(start).unwrap();
    let pose = |k: u32| {
        let translation = from.translation + Vector3::from(step) * f64::from(k);
        Placement::new(from.rotation, translation)
    };
    (0..count).map(pose).collect()
}

const PANDA_START: [f64; 7] = [0.0, 0.3, 0.1, -1.8, 0.1, 2.0, 0.4];

fn track(record: &mut Record) {
    let arm = arm("franka_panda");
    // The end is out of reach.
    let line = line(&arm, &PANDA_START, [0.01, 0.004, 0.002], 60);
    let track = arm.track(&line, &PANDA_START).unwrap();
    record.solutions("track", &track.report);
    let mut follower = arm.follower(&PANDA_START).unwrap();
    let mut solutions = Vec::new();
    for target in &line {
        let mut solution = Solution::default();
        follower.advance(*target, &mut solution).unwrap();
        solutions.push(solution);
    }
    record.solutions("follower", &solutions);
}

fn servo(record: &mut Record) {
    let arm = arm("franka_panda");
    let line = line(&arm, &PANDA_START, [0.002, 0.001, -0.001], 300);
    let mut servo = arm.servo(&PANDA_START, 0.002).unwrap();
    let (mut q, mut velocity, mut statuses) = (Vec::new(), Vec::new(), String::new());
    for target in line {
        let step = servo.step(target).unwrap();
        q.extend_from_slice(step.q);
        velocity.extend_from_slice(step.velocity);
        statuses += &format!("{:?} ", step.status);
    }
    record.numbers("q", q);
    record.numbers("velocity", velocity);
    record.text("status", &statuses);
}

fn path(record: &mut Record) {
    let arm = arm("universal_ur5e");
    let start = [0.3, -1.2, 1.4, -1.6, -1.5, 0.0];
    let line = line(&arm, &start, [0.01, -0.02, 0.005], 30);
    let path = CartesianPath::new(line).unwrap();
    let solution = PathSolver::new(&arm).with_samples(48).solve(&path).unwrap();
    record.numbers("q", solution.q.iter().copied());
    let deviation = solution.report.largest_deviation;
    record.numbers(
        "length and deviation",
        [solution.report.length, deviation.metres, deviation.radians],
    );
    record.counts("reconfigurations", solution.jumps.iter().map(|r| r.index));
    record.counts(
        "missed",
        solution.report.missed.iter().map(|missed| missed.index),
    );
    let limits = TimingLimits::new(&[2.0; 6], &[6.0; 6]);
    // Without stops at reconfigurations.
    let rows = JointPath::<()> {
        q: solution.q,
        nq: solution.nq,
        ..JointPath::default()
    };
    let trajectory = rows.trajectory(&limits).unwrap();
    record.numbers("duration", [trajectory.duration()]);
    let times = (0..40).map(|k| trajectory.duration() * f64::from(k) / 39.0);
    record.numbers(
        "trajectory",
        times.flat_map(|time| trajectory.report.at(time).q),
    );
}

fn avoidance(record: &mut Record) {
    let panda = robot("franka_panda");
    let mut world = World::new();
    let obstacles = [
        [0.7, 0.4, 0.4],
        [-0.3, 0.4, 0.6],
        [0.2, -0.5, 0.3],
        [-0.2, -0.4, 0.7],
    ];
    for (k, position) in obstacles.into_iter().enumerate() {
        let position = Vector3::from(position);
        let added = match k % 2 {
            0 => world.add_box(&format!("box {k}"), [0.2, 0.15, 0.25], position),
            _ => world.add_sphere(&format!("sphere {k}"), 0.12, position),
        };
        added.unwrap();
    }
    let checker = Checker::of(&panda).unwrap().with_world(&world).unwrap();
    let rest = panda.model().neutral();
    let arm = built(Arm::builder(&panda, "base", "flange").with_attempts(24));
    let arm = arm
        .with_checker(&checker.with_margin(0.01).unwrap(), &rest)
        .unwrap();
    let solutions = solved(&arm, 8, 8);
    record.solutions("solve", &solutions);
    let mut contacts = String::new();
    for contact in solutions.iter().flat_map(Solution::collisions) {
        contacts += &format!(
            "{} {} {:?} ",
            contact.first, contact.second, contact.distance
        );
    }
    record.text("contacts", &contacts);
    let line = line(&arm, &PANDA_START, [0.004, 0.004, 0.0], 40);
    record.solutions("track", &arm.track(&line, &PANDA_START).unwrap().report);
}
