//! Measurement of one solver on one problem, and its verdict.

use std::time::Duration;

use crate::clock;
use crate::trace::Mark;
use crate::{Adapter, Answer, Judge, ProblemInstance, Record, Trace};

/// Shorter solves are repeated, and the shortest time counts.
const MAX_REPEATED_TIME: Duration = Duration::from_millis(2);
const REPEATS: usize = 2;
/// Shorter solves are timed in groups, to exclude the cost of reading the clock.
const MAX_GROUPED_TIME: Duration = Duration::from_micros(50);
const GROUP_SIZE: u32 = 16;

/// Result of one adapter on one problem, untraced and traced.
pub(super) struct Measured {
    answer: Answer,
    untraced: Duration,
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
    pub(super) fn new(adapter: &mut dyn Adapter, instance: &ProblemInstance<'_>) -> Self {
        let mut solve = || adapter.solve(instance, &Trace::off());
        let (answer, mut untraced) = clock::time(&mut solve);
        let group = if untraced < MAX_GROUPED_TIME {
            GROUP_SIZE
        } else {
            1
        };
        for _ in 0..REPEATS {
            if untraced < MAX_REPEATED_TIME {
                let (_, elapsed) = clock::time(|| (0..group).for_each(|_| drop(solve())));
                untraced = untraced.min(elapsed / group);
            }
        }
        let trace = Trace::on();
        // The result of the traced solve is not used.
        let _ = adapter.solve(instance, &trace);
        let (marks, traced) = trace.finish();
        Self {
            answer,
            untraced,
            marks,
            traced,
        }
    }

    pub(super) fn judged(
        self,
        problem: usize,
        instance: &ProblemInstance<'_>,
        judge: &mut Judge<'_>,
        accuracies: &[f64],
    ) -> Judged {
        let untraced = self.untraced.as_secs_f64() * 1e6;
        let traced = self.traced.as_secs_f64() * 1e6;
        let stretch = if traced > 0.0 { untraced / traced } else { 1.0 };
        let mut micros_to: Vec<Option<f64>> = vec![None; accuracies.len()];
        let mut note = |error: f64, micros: f64| {
            for (reached_at, &accuracy) in micros_to.iter_mut().zip(accuracies) {
                if reached_at.is_none() && error <= accuracy {
                    *reached_at = Some(micros);
                }
            }
        };
        let mut course: Vec<(usize, f64)> = Vec::new();
        for (step, mark) in self.marks.iter().enumerate() {
            let verdict = judge.verdict(instance.problem, instance.targets, &mark.configuration);
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
        let verdict = judge.verdict(instance.problem, instance.targets, &answer.q);
        if verdict.within_limits {
            note(verdict.error, untraced);
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
            micros: untraced,
            late: instance.budget.is_late(self.untraced),
            micros_to,
        };
        Judged { record, course }
    }
}
