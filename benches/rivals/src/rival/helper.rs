//! Solvers in helper processes, because they cannot be linked into this one.
//!
//! Each request is a line of numbers: the pose x y z qw qx qy qz, then the start. Each reply is a line: the nanoseconds
//! of the solver's call, measured by the helper, then the values of all solutions, one after another. No measured time
//! includes the pipe.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

use super::{Answer, Rival};
use crate::{Failure, Query, TOLERANCE, Workload};

struct Helper {
    name: &'static str,
    process: Child,
    questions: ChildStdin,
    answers: BufReader<ChildStdout>,
}

/// OptIK through its Python wheel, built by its author.
pub fn optik<'a>(
    workload: &Workload,
    limit: Duration,
    python: &str,
) -> Result<Box<dyn Rival + 'a>, Failure> {
    let mut command = Command::new(python);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("helpers/optik_helper.py");
    command.arg(script).arg(&workload.urdf);
    command.args([&workload.base, &workload.tip]);
    command.args([limit.as_secs_f64().to_string(), TOLERANCE.to_string()]);
    start("OptIK", command)
}

/// ik-geo, which links another NLopt than this process.
pub fn ik_geo<'a>(workload: &Workload) -> Result<Box<dyn Rival + 'a>, Failure> {
    let mut command = Command::new(std::env::current_exe()?.with_file_name("ik_geo_helper"));
    command.arg(&workload.urdf);
    command.args([&workload.base, &workload.tip]);
    start("ik-geo, closed form", command)
}

fn start<'a>(name: &'static str, mut command: Command) -> Result<Box<dyn Rival + 'a>, Failure> {
    let mut process = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    let questions = process.stdin.take().ok_or("no pipe to the helper")?;
    let answers = process.stdout.take().ok_or("no pipe from the helper")?;
    let mut answers = BufReader::new(answers);
    let mut ready = String::new();
    answers.read_line(&mut ready)?;
    if ready.trim() != "ready" {
        process.wait()?;
        return Err(if ready.is_empty() {
            "its helper did not start".into()
        } else {
            ready.trim().into()
        });
    }
    Ok(Box::new(Helper {
        name,
        process,
        questions,
        answers,
    }))
}

impl Rival for Helper {
    fn name(&self) -> String {
        self.name.into()
    }

    fn answer(&mut self, query: &Query) -> Result<Answer, Failure> {
        let numbers = query.pose.iter().chain(&query.start);
        let line: Vec<String> = numbers.map(|number| format!("{number:e}")).collect();
        writeln!(self.questions, "{}", line.join(" "))?;
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        let mut words = line.split_whitespace();
        let nanos = words.next().ok_or("the helper ended")?.parse()?;
        let q: Vec<f64> = words.map(str::parse).collect::<Result<_, _>>()?;
        Ok(Answer {
            took: Duration::from_nanos(nanos),
            solutions: q.chunks(query.start.len()).map(<[f64]>::to_vec).collect(),
        })
    }
}

impl Drop for Helper {
    fn drop(&mut self) {
        // The process would also end when the pipe closes.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
