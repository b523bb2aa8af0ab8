//! Measurement of one solver on one problem, and its verdict.

use std::time::Duration;

use crate::clock;
use crate::trace::Mark;
use crate::{Adapter, Answer, Judge, ProblemInstance, Record, Trace};

/// Shorter solves are repeated, and the shortest time counts.
const QUICK: Duration = Duration::from_millis(2);
const REPEATS: usize = 2;
/// Shorter solves are timed in groups, to exclude the cost of reading the clock.
const TINY: Duration = Duration::from_micros(50);
const TOGETHER: u32 = 16;

/// Result of one adapter on one problem, untraced and traced.
pub(super) struct Measured {
    answer: Answer,
    plain: Duration,
    marks: Vec<Mark>,
    traced: Duration,
}

/// Record with its convergence history.
pub(super) struct Judged {
    pub(super) record: Record,
    /// Iterations, and the lowest cost so far: at the start, where it decreased, and at the end.
    pub(super) course: Vec<(usize, f64)>,
}

impl Measured {
    pub(super) fn new(adapter: &mut dyn Adapter, question: &ProblemInstance<'_>) -> Self {
        let mut ask = || adapter.solve(question, &Trace::off());
        let (answer, mut plain) = clock::time(&mut ask);
        let together = if plain < TINY { TOGETHER } else { 1 };
        for _ in 0..REPEATS {
            if plain < QUICK {
                let (_, taken) = clock::time(|| (0..together).for_each(|_| drop(ask())));
                plain = plain.min(taken / together);
            }
        }
        let trace = Trace::on();
        // The result of the traced solve is not used.
        let _ = adapter.solve(question, &trace);
        let (marks, traced) = trace.finish();
        Self {
            answer,
            plain,
            marks,
            traced,
        }
    }

    pub(super) fn judged(
        self,
        problem: usize,
        question: &ProblemInstance<'_>,
        judge: &mut Judge<'_>,
        accuracies: &[f64],
    ) -> Judged {
        let plain = self.plain.as_secs_f64() * 1e6;
        let traced = self.traced.as_secs_f64() * 1e6;
        let stretch = if traced > 0.0 { plain / traced } else { 1.0 };
        let mut first_at: Vec<Option<f64>> = vec![None; accuracies.len()];
        let mut note = |error: f64, micros: f64| {
            for (first, &accuracy) in first_at.iter_mut().zip(accuracies) {
                if first.is_none() && error <= accuracy {
                    *first = Some(micros);
                }
            }
        };
        let mut course: Vec<(usize, f64)> = Vec::new();
        for (step, mark) in self.marks.iter().enumerate() {
            let verdict = judge.verdict(question.problem, question.targets, &mark.place);
            if !verdict.within_limits {
                continue;
            }
            note(verdict.error, mark.at.as_secs_f64() * 1e6 * stretch);
            let lowest = course.last().map_or(f64::INFINITY, |(_, cost)| *cost);
            if verdict.cost < lowest {
                course.push((step, verdict.cost));
            } else if let (true, true) = (step + 1 == self.marks.len(), lowest.is_finite()) {
                course.push((step, lowest));
            }
        }
        let answer = self.answer;
        let verdict = judge.verdict(question.problem, question.targets, &answer.q);
        if verdict.within_limits {
            note(verdict.error, plain);
        }
        let finite = |value: f64| value.is_finite().then_some(value);
        let record = Record {
            problem,
            solved: verdict.solved,
            claimed: answer.reached,
            within_limits: verdict.within_limits,
            error: finite(verdict.error),
            cost: finite(verdict.cost),
            tasks: verdict.tasks,
            active_limits: judge.active_limits(&answer.q),
            iterations: answer.iterations,
            attempts: answer.attempts,
            residuals: answer.counts.residuals,
            jacobians: answer.counts.jacobians,
            gradients: answer.counts.gradients,
            micros: plain,
            late: question.budget.is_late(self.plain),
            micros_to: first_at,
        };
        Judged { record, course }
    }
}
