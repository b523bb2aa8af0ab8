//! Comparison of solvers on equal queries, with a table for each robot.

use std::path::{Path, PathBuf};
use std::time::Duration;

use kinopt_benches::Sequence;
use kinopt_rivals::{Failure, Judge, Row, Workload, print, rival};
use lexopt::prelude::*;

const USAGE: &str = "\
usage: kinopt-rivals [options]
  --robot FILE.urdf --targets FILE.json
                    another robot and its questions (without: the shipped Panda and UR5e)
  --queries N       how many questions to ask (default 200)
  --block N         questions a solver answers before it is the next one's turn (default 20);
                    with 1 every call finds the caches full of what the others left
  --rounds N        how often everything is asked; the fastest time of each counts (default 3)
  --limit MS        time that one question may take, milliseconds (default 50)
  --only WORD       only solvers whose name has this in it, and kinopt
  --python PROGRAM  a Python that has helpers/requirements.txt installed, for OptIK";

struct Settings {
    robot: Option<PathBuf>,
    targets: Option<PathBuf>,
    queries: usize,
    block: usize,
    rounds: usize,
    limit: Duration,
    only: Option<String>,
    python: Option<String>,
}

fn settings() -> Result<Option<Settings>, Failure> {
    let mut settings = Settings {
        robot: None,
        targets: None,
        queries: 200,
        block: 20,
        rounds: 3,
        limit: Duration::from_millis(50),
        only: None,
        python: None,
    };
    let mut arguments = lexopt::Parser::from_env();
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("robot") => settings.robot = Some(arguments.value()?.into()),
            Long("targets") => settings.targets = Some(arguments.value()?.into()),
            Long("queries") => settings.queries = arguments.value()?.parse()?,
            Long("block") => settings.block = arguments.value()?.parse::<usize>()?.max(1),
            Long("rounds") => settings.rounds = arguments.value()?.parse::<usize>()?.max(1),
            Long("limit") => {
                settings.limit = Duration::from_secs_f64(1e-3 * arguments.value()?.parse::<f64>()?);
            }
            Long("only") => settings.only = Some(arguments.value()?.string()?),
            Long("python") => settings.python = Some(arguments.value()?.string()?),
            Long("help") => return Ok(None),
            other => return Err(other.unexpected().into()),
        }
    }
    Ok(Some(settings))
}

fn compare(workload: &Workload, settings: &Settings) -> Result<(), Failure> {
    let mut rivals = rival::all(workload, settings.limit, settings.python.as_deref())?;
    if let Some(only) = &settings.only {
        rivals.retain(|r| r.name().contains(only) || r.name().contains("kinopt"));
    }
    let queries = &workload.queries;
    let mut rows: Vec<Row> = rivals
        .iter()
        .map(|rival| Row::new(rival.name(), queries.len()))
        .collect();
    let judge = Judge(&workload.chain);
    // A random order for each block, so that no solver always follows the same one.
    let mut random = Sequence::new(0.125);
    let mut order: Vec<usize> = (0..rivals.len()).collect();
    for round in 0..settings.rounds {
        // Blocks are shifted in each round: the first query of a block has cold caches.
        let shift = settings.block * round / settings.rounds;
        for end in (settings.block - shift..queries.len() + settings.block).step_by(settings.block)
        {
            let block = end.saturating_sub(settings.block)..end.min(queries.len());
            order.sort_by_cached_key(|_| (random.unit() * 1e9) as u64);
            for &solver in &order {
                for index in block.clone() {
                    let query = &queries[index];
                    let answer = rivals[solver].answer(query)?;
                    let accepts = |q: &Vec<f64>| judge.accepts(&query.target, q);
                    let accepted = answer.solutions.iter().any(accepts);
                    rows[solver].note(index, answer.took, !answer.solutions.is_empty(), accepted);
                }
            }
        }
    }
    print(&rows);
    Ok(())
}

fn main() -> Result<(), Failure> {
    let Some(settings) = settings()? else {
        println!("{USAGE}");
        return Ok(());
    };
    let count = settings.queries;
    let workloads = match (&settings.robot, &settings.targets) {
        (Some(robot), Some(targets)) => vec![Workload::from_file(robot, targets, count)?],
        (None, None) => {
            let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
            vec![
                Workload::random(&models.join("franka_panda.urdf"), "base", "hand", count)?,
                Workload::random(&models.join("universal_ur5e.urdf"), "base", "flange", count)?,
            ]
        }
        _ => return Err(format!("--robot and --targets go together\n{USAGE}").into()),
    };
    for workload in &workloads {
        let name = workload.urdf.file_stem().unwrap_or_default();
        let count = workload.queries.len();
        println!("\n### {}, {count} questions\n", name.to_string_lossy());
        compare(workload, &settings)?;
    }
    Ok(())
}
