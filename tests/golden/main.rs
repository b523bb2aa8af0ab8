//! Golden results: representative values of the whole library, compared exactly with recorded files.
//!
//! Promise: equal input gives bitwise equal results in every run, at any number of threads and on every machine of
//! `docs/internals/reproducibility.md`. A change of these values is intended or a defect; the promises of the other
//! binaries say what is right.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod animation;
mod arm;
mod collision;
mod determinism;
mod files;
mod motion;
mod record;
mod solver;
mod web;

use record::Case;

/// All cases, by area.
const AREAS: [&[Case]; 7] = [
    arm::CASES,
    solver::CASES,
    collision::CASES,
    motion::CASES,
    animation::CASES,
    files::CASES,
    web::CASES,
];

#[test]
fn arm_values_are_the_recorded_ones() {
    record::check(arm::CASES);
}

#[test]
fn solver_values_are_the_recorded_ones() {
    record::check(solver::CASES);
}

#[test]
fn collision_values_are_the_recorded_ones() {
    record::check(collision::CASES);
}

#[test]
fn motion_values_are_the_recorded_ones() {
    record::check(motion::CASES);
}

#[test]
fn animation_values_are_the_recorded_ones() {
    record::check(animation::CASES);
}

#[test]
fn file_values_are_the_recorded_ones() {
    record::check(files::CASES);
}

#[test]
fn web_values_are_the_recorded_ones() {
    record::check(web::CASES);
}

#[test]
fn every_value_file_belongs_to_a_case() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/values");
    let names: Vec<&str> = AREAS
        .iter()
        .copied()
        .flatten()
        .map(|case| case.name)
        .collect();
    for entry in std::fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().file_name().into_string().unwrap();
        let name = file.split('.').next().unwrap();
        assert!(names.contains(&name), "{file} has no case");
    }
}
