//! Promise: the tables of docs/reference/options.md name every option of a builder or setter, and no others.

use std::collections::BTreeSet;

/// Names in code marks in the column `Rust` of a section's table.
fn named(section: &str) -> BTreeSet<String> {
    let page = std::fs::read_to_string("../docs/reference/options.md").unwrap();
    let (_, part) = page.split_once(&format!("\n## {section}\n")).unwrap();
    let part = part.split("\n## ").next().unwrap();
    let rows = part.lines().filter(|line| line.starts_with('|'));
    let rows: Vec<Vec<&str>> = rows.map(|line| line.split('|').collect()).collect();
    let column = rows[0].iter().position(|cell| cell.trim() == "Rust");
    let cells = rows[2..].iter().map(|row| row[column.unwrap()]);
    let names = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2));
    names.map(str::to_owned).collect()
}

/// Public functions of a source file whose names have the given prefix. `before` is what precedes them in the table.
fn public(source: &str, begin: &str, before: &str) -> BTreeSet<String> {
    let text = std::fs::read_to_string(format!("../{source}")).unwrap();
    let after = text.split("pub fn ").skip(1);
    let names = after.map(|rest| rest.split(['(', '<']).next().unwrap());
    let names = names.filter(|name| name.starts_with(begin));
    names.map(|name| format!("{before}{name}")).collect()
}

/// Asserts that table and code name the same options, except for `besides`.
fn assert_same(section: &str, sources: &[(&str, &str)], besides: &[&str]) {
    let setters = sources
        .iter()
        .flat_map(|(source, before)| public(source, "with_", before));
    let mut there: BTreeSet<String> = setters.collect();
    assert!(!there.is_empty(), "{section}");
    there.extend(besides.iter().map(|name| (*name).to_owned()));
    assert_eq!(named(section), there, "{section}");
}

#[test]
fn option_tables_equal_the_code() {
    assert_same(
        "Arms",
        &[("crates/kinopt-arm/src/arm/builder.rs", "")],
        &["Arm::with_checker", "Arm::with_srdf"],
    );
    assert_same(
        "Followers and servos",
        &[("crates/kinopt-arm/src/arm/servo/mod.rs", "")],
        &[],
    );
    let reach_maps = [("crates/kinopt-arm/src/arm/reach_map/build.rs", "")];
    assert_same("Reach maps", &reach_maps, &["build_parallel"]);
    let solvers = [
        ("crates/kinopt-solver/src/ik/solver.rs", "Solver::"),
        ("crates/kinopt-solver/src/solver/stopping.rs", "Stopping::"),
        ("crates/kinopt-solver/src/search/restarts.rs", "Restarts::"),
        (
            "crates/kinopt-solver/src/solver/levenberg_marquardt.rs",
            "LevenbergMarquardt::",
        ),
        (
            "crates/kinopt-solver/src/solver/gauss_newton.rs",
            "GaussNewton::",
        ),
        (
            "crates/kinopt-solver/src/solver/projected_gradient.rs",
            "ProjectedGradient::",
        ),
    ];
    assert_same("Solvers", &solvers, &["Solver::new"]);
    assert_same("Drags", &[("crates/kinopt-solver/src/ik/drag.rs", "")], &[]);
    let paths = [("crates/kinopt-arm/src/path/solver.rs", "")];
    let of_paths = [
        "CartesianPath::along",
        "CartesianPath::with_traversal",
        "CartesianPath::read",
        "JointPath::times",
    ];
    assert_same("Paths", &paths, &of_paths);
    let limits = [("crates/kinopt-arm/src/path/timing/limits.rs", "")];
    assert_same("Trajectories", &limits, &[]);
}

#[test]
fn problem_and_task_tables_equal_the_code() {
    let mut there = public("crates/kinopt-solver/src/problem/builder.rs", "", "");
    there.remove("build");
    there.insert("keep_clear".to_owned());
    assert_eq!(named("Problems"), there);
    let mut there = public("crates/kinopt-solver/src/task/weighted.rs", "", "");
    there.remove("new");
    assert_eq!(named("Tasks"), there);
}
