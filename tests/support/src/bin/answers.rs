//! Solves queries given as numbers, so that other languages can compare their results with the library's exactly.
//! Numbers are little-endian f64 on standard input and output.
//!
//! - `answers arm FILE.urdf BASE TIP`: each query is a target as a row-major 4 × 4 matrix and a start configuration.
//!   The result is the joint values.
//! - `answers rig FILE.json BONE...`: each query is three coordinates per bone, the target of its tip. Each query
//!   starts at the rest pose.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

use std::io::{Read, Write};

use kinopt::io::rig::Rig;
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::Point;
use kinopt::{Arm, Problem, Solver};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let mut bytes = Vec::new();
    std::io::stdin().read_to_end(&mut bytes).unwrap();
    let numbers: Vec<f64> = bytes
        .chunks_exact(8)
        .map(|eight| f64::from_le_bytes(eight.try_into().unwrap()))
        .collect();
    let answers = match arguments[..] {
        ["arm", file, base, tip] => arm(file, base, tip, &numbers),
        ["rig", file, ref bones @ ..] => rig(file, bones, &numbers),
        _ => {
            eprintln!("answers arm FILE BASE TIP | answers rig FILE BONE...");
            std::process::exit(2);
        }
    };
    let bytes: Vec<u8> = answers.iter().flat_map(|q| q.to_le_bytes()).collect();
    std::io::stdout().write_all(&bytes).unwrap();
}

fn arm(file: &str, base: &str, tip: &str, numbers: &[f64]) -> Vec<f64> {
    let robot = Robot::read(file).unwrap();
    let arm = Arm::new(&robot, base, tip).unwrap();
    let questions = numbers.chunks_exact(16 + arm.joint_count());
    let solve = |question: &[f64]| {
        let (m, start) = question.split_at(16);
        let column = |j: usize| Vector3::new(m[j], m[4 + j], m[8 + j]);
        let rotation = Matrix3::from_columns(column(0), column(1), column(2));
        let target = Placement::new(rotation, column(3));
        arm.solve(target, start).unwrap().q
    };
    questions.flat_map(solve).collect()
}

fn rig(file: &str, bones: &[&str], numbers: &[f64]) -> Vec<f64> {
    let skeleton = Rig::read(file).unwrap().skeleton;
    let rest = skeleton.model().neutral();
    let solver = Solver::default();
    let solve = |targets: &[f64]| {
        let mut tasks = Problem::builder(skeleton.model());
        for (bone, target) in bones.iter().zip(targets.chunks_exact(3)) {
            let tip = skeleton.tip(skeleton.bone(bone).unwrap());
            tasks.add(Point::new(tip, [target[0], target[1], target[2]]));
        }
        solver.solve_once(&tasks.build().unwrap(), &rest).unwrap().q
    };
    numbers
        .chunks_exact(3 * bones.len())
        .flat_map(solve)
        .collect()
}
