//! Instruction counts of the hottest stages by callgrind, compared with `benches/instructions.tsv`:
//!
//! ```text
//! cargo run --release -p kinopt-benches --bin instructions                # all counted stages
//! cargo run --release -p kinopt-benches --bin instructions -- CCD lane    # names that contain a word
//! cargo run --release -p kinopt-benches --bin instructions -- --update    # and keep the counts
//! ```
//!
//! Counts do not depend on the load of the machine, so a change of one per cent is visible. They depend on the compiler
//! and on the instruction sets of valgrind (AVX2 and FMA, not AVX-512), which the baseline records. An instruction is
//! not a time. Counts are reported, but never part of a gate. Each stage runs twice under valgrind, a few and several
//! times; the difference excludes start and set-up.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

use kinopt_benches::{Baseline, Stage, stages};

/// Numbers of runs of a stage under valgrind: the difference counts.
const FEW_RUNS: u64 = 5;
const MANY_RUNS: u64 = 25;

/// Counted stages; other stages have similar code.
const COUNTED_STAGES: [&str; 39] = [
    "forward kinematics, 22 bones",
    "forward kinematics, 60 bones",
    "Jacobian, analytic, 22 bones",
    "Jacobian, dual numbers, 22 bones",
    "Jacobian, user-defined residual, 22 bones",
    "gradient, reverse mode, 22 bones",
    "iteration, Levenberg-Marquardt",
    "SIMD solver, first solution of one query",
    "SIMD solver, first solutions of a batch",
    "arm of seven joints, track",
    "arm of seven joints, target out of reach",
    "spheres of a Panda, itself alone",
    "spheres of a Panda, 30 primitives",
    "shapes of a Panda, 30 primitives",
    "solve near, arm of six joints",
    "derivative backward, arm of six joints",
    "derivative of an arm by its target, six joints",
    "solve from rest, arm of six joints",
    "solve from anywhere, arm of six joints",
    "solve near, humanoid, four poses",
    "solve from rest, humanoid, four poses",
    "solve from anywhere, humanoid, four poses",
    "derivative backward, humanoid, four poses",
    "solve near, humanoid with a posture",
    "derivative backward, humanoid with a posture",
    "two levels, the second out of reach, 22 bones, a frame",
    "two bones, bare",
    "two bones, turn-lift-bend arm, whole solve",
    "CCD sweep, 22 bones, 5 tips",
    "FABRIK pass, 22 bones, 5 tips",
    "FABRIK pass, bare chain of 20 points",
    "clip of 22 bones and 40 keys, one sample",
    "clip of a body of 67 bones, at 60 Hz",
    "clip of 67 bones, all channels, at 60 Hz",
    "clip of 67 bones, all channels keyed apart, at 60 Hz",
    "linear blend, positions of 1000 vertices",
    "linear blend, normals of 1000 vertices",
    "packed linear blend, 1000 vertices",
    "packed dual quaternions, 1000 vertices",
];

const INSTALL_HINT: &str = "valgrind is not installed: `apt-get install valgrind` on Debian and Ubuntu, \
    `dnf install valgrind` on Fedora, `pacman -S valgrind` on Arch (Linux only in practice)";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match &*arguments.iter().map(String::as_str).collect::<Vec<_>>() {
        ["run", stage, times] => run(stage, times.parse()?),
        ["processor"] => {
            println!("{}", processor());
            Ok(())
        }
        words => compare(words),
    }
}

/// Runs one stage `times` times, under valgrind.
fn run(name: &str, times: u64) -> Result<(), Box<dyn Error>> {
    let stage = stages().into_iter().find(|stage| stage.name == name);
    let mut run = stage.ok_or("no such stage")?.build()?;
    for _ in 0..times {
        run();
    }
    Ok(())
}

/// Architecture, and the instruction sets that the SIMD solver detects.
fn processor() -> String {
    let mut text = std::env::consts::ARCH.to_owned();
    #[cfg(target_arch = "x86_64")]
    {
        let sets = [
            ("avx2", std::is_x86_feature_detected!("avx2")),
            ("fma", std::is_x86_feature_detected!("fma")),
            ("avx512f", std::is_x86_feature_detected!("avx512f")),
        ];
        let available: Vec<&str> = sets.iter().filter(|set| set.1).map(|set| set.0).collect();
        text = format!("{text}, {}", available.join(" "));
    }
    text
}

fn compare(words: &[&str]) -> Result<(), Box<dyn Error>> {
    let update = words.contains(&"--update");
    let names: Vec<&&str> = words
        .iter()
        .filter(|word| !word.starts_with("--"))
        .collect();
    if Command::new("valgrind").arg("--version").output().is_err() {
        return Err(INSTALL_HINT.into());
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("instructions.tsv");
    let before = match std::fs::read_to_string(&file) {
        Ok(text) => Baseline::parse(&text)?,
        Err(_) => Baseline::default(),
    };
    let mut now = Baseline {
        compiler: compiler()?,
        processor: String::from_utf8(under_valgrind("none", &["processor"])?.stdout)?
            .trim()
            .to_owned(),
        counts: before.counts.clone(),
    };
    println!("{}; {}", now.compiler, now.processor);
    for (current, recorded) in [
        (&now.compiler, &before.compiler),
        (&now.processor, &before.processor),
    ] {
        if current != recorded && !recorded.is_empty() {
            println!("the baseline is of {recorded}: differences may be the machine's");
        }
    }
    println!(
        "{:<44} {:>10} {:>13} {:>13} {:>8}",
        "stage", "one", "baseline", "now", "change"
    );
    for stage in stages() {
        let is_selected = names.is_empty() || names.iter().any(|word| stage.name.contains(**word));
        if !COUNTED_STAGES.contains(&stage.name) || !is_selected {
            continue;
        }
        let count = count(&stage)?;
        let (baseline, change) = match before.counts.get(stage.name) {
            Some(before) => (
                format!("{before:.1}"),
                format!("{:+.1} %", 100.0 * (count / before - 1.0)),
            ),
            None => ("-".to_owned(), "new".to_owned()),
        };
        println!(
            "{:<44} {:>10} {baseline:>13} {count:>13.1} {change:>8}",
            stage.name, stage.unit
        );
        now.counts.insert(stage.name.to_owned(), count);
    }
    if update {
        // Removes stages that are not counted any more.
        now.counts
            .retain(|stage, _| COUNTED_STAGES.contains(&&**stage));
        std::fs::write(&file, now.to_text())?;
        println!("kept in {}", file.display());
    }
    Ok(())
}

/// Instructions for one element of a stage.
fn count(stage: &Stage) -> Result<f64, Box<dyn Error>> {
    let few_runs = collected(stage.name, FEW_RUNS)?;
    let many_runs = collected(stage.name, MANY_RUNS)?;
    let runs = (MANY_RUNS - FEW_RUNS) * stage.elements;
    Ok((many_runs as f64 - few_runs as f64) / runs as f64)
}

/// Number of instructions that callgrind collected in one process.
fn collected(stage: &str, times: u64) -> Result<u64, Box<dyn Error>> {
    let output = under_valgrind("callgrind", &["run", stage, &times.to_string()])?;
    let log = String::from_utf8_lossy(&output.stderr).into_owned();
    let line = log.lines().find_map(|line| line.split_once("Collected :"));
    let (_, number) = line.ok_or_else(|| format!("callgrind tells no count:\n{log}"))?;
    Ok(number.trim().parse()?)
}

fn under_valgrind(tool: &str, arguments: &[&str]) -> Result<std::process::Output, Box<dyn Error>> {
    let program: PathBuf = std::env::current_exe()?;
    let mut command = Command::new("valgrind");
    command.arg(format!("--tool={tool}"));
    if tool == "callgrind" {
        command.arg("--callgrind-out-file=/dev/null");
    }
    let output = command.arg(program).args(arguments).output()?;
    match output.status.success() {
        true => Ok(output),
        false => Err(String::from_utf8_lossy(&output.stderr).into()),
    }
}

fn compiler() -> Result<String, Box<dyn Error>> {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let output = Command::new(rustc).arg("-V").output()?;
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}
