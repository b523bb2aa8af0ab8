//! Explanation of a solution in words.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::{ActiveLimit, BoundKind, Collision, Side, Solution};
use crate::solver::Termination;
use crate::task::Role;
use kinopt_kinematics::model::LengthUnit;
use kinopt_kinematics::plural::counted;
use kinopt_kinematics::scalar::elementary;

/// Largest number of active move limits that are listed one by one. A drag that follows its target over several frames
/// has most joints at one.
const MAX_LISTED_MOVES: usize = 3;
/// Number of joints that are named if there are more.
const NAMED_MOVES: usize = 2;

impl Solution {
    /// Explains a solution: the errors of unreached tasks, the active limits, and the reason for the end of the search.
    #[must_use]
    pub fn explain(&self) -> String {
        if self.q.is_empty() && self.attempts == 0 {
            return "No query was solved yet.".to_owned();
        }
        let mut text = String::new();
        // Writing to a String cannot fail.
        let _ = self.write_explanation(&mut text);
        text.truncate(text.trim_end().len());
        text
    }

    fn length_unit(&self) -> LengthUnit {
        let names = self.names.as_deref();
        names.map_or_else(LengthUnit::default, |names| names.length_unit)
    }

    fn write_explanation(&self, text: &mut String) -> std::fmt::Result {
        write!(
            text,
            "{} after {} and {}",
            if self.reached {
                "Reached"
            } else {
                "Not reached"
            },
            counted(self.iterations, "iteration"),
            counted(self.attempts, "attempt"),
        )?;
        if self.reached {
            if let Some(early) = self.ended_early() {
                write!(text, "; {early}")?;
            }
            text.push('.');
            return Ok(());
        }
        if self.goals_reached() {
            return self.write_collisions(text);
        }
        writeln!(text, ": {}.", self.reason())?;
        self.write_unreached_tasks(text)?;
        if !self.collisions.is_empty() {
            text.push_str("  Collisions:\n");
            self.write_pairs(text)?;
        }
        self.write_levels(text)?;
        self.write_verdict(text)?;
        self.write_limits(text)
    }

    /// Lists the collisions of a solution whose required tasks are met.
    fn write_collisions(&self, text: &mut String) -> std::fmt::Result {
        writeln!(
            text,
            ": all required tasks are met, but no collision-free solution was found."
        )?;
        self.write_pairs(text)
    }

    /// Lists the pairs that are too close, or that would be after the step.
    fn write_pairs(&self, text: &mut String) -> std::fmt::Result {
        let unit = self.length_unit().symbol();
        for pair in &self.collisions {
            let size = Significant(pair.distance.abs());
            let penetrates = pair.distance < 0.0;
            if pair.on_the_way {
                let measure = if penetrates {
                    "penetration"
                } else {
                    "clearance"
                };
                writeln!(text, "  {pair} block the motion: {measure} {size} {unit}.")?;
                continue;
            }
            let relation = if penetrates {
                "penetrates"
            } else {
                "is nearer than the margin to"
            };
            let Collision { first, second, .. } = pair;
            let [first_kind, second_kind] = [pair.first_kind, pair.second_kind];
            writeln!(
                text,
                "  {first_kind} `{first}` {relation} {second_kind} `{second}`: {size} {unit}."
            )?;
        }
        Ok(())
    }

    /// The active limits of the allowed moves.
    fn moves(&self) -> impl Iterator<Item = ActiveLimit<'_>> {
        let limits = self.active_limits();
        limits.filter(|limit| limit.kind == BoundKind::Move)
    }

    /// The event that ended the search of a reached solution early.
    fn ended_early(&self) -> Option<&'static str> {
        let has_soft_tasks = self.rows.iter().any(|rows| rows.role == Role::Preference);
        Some(match (self.termination, has_soft_tasks) {
            (Termination::TimeLimit, false) => {
                "the time limit ended the search for other solutions early"
            }
            (Termination::TimeLimit, true) => {
                "the time limit ended the descent of the soft tasks early"
            }
            (Termination::Cancelled, _) => "the observer ended the descent of the soft tasks early",
            (Termination::NonFinite, _) => "the error of a soft task is not a finite number",
            _ => return None,
        })
    }

    fn reason(&self) -> &'static str {
        match self.termination {
            Termination::Reached | Termination::Stationary if !self.pulling.is_empty() => {
                "no free joint can lower the weighted sum of required and soft tasks from here"
            }
            Termination::Reached | Termination::Stationary => {
                "no free joint can lower the error from here"
            }
            Termination::SmallStep => "steps became too small to change anything",
            Termination::Stalled => "progress became too slow",
            Termination::IterationLimit => "the iteration limit was reached",
            Termination::CannotContinue => {
                "no attempt found a solution within the allowed moves from the start"
            }
            Termination::TimeLimit => "the time limit was reached",
            Termination::Cancelled => "the observer stopped the search",
            Termination::NonFinite => "a residual or a derivative is not a finite number",
        }
    }

    fn write_unreached_tasks(&self, text: &mut String) -> std::fmt::Result {
        for task in self.tasks().filter(|t| t.role == Role::Goal && !t.reached) {
            let verb = if task.is_loop {
                "is open by"
            } else {
                "misses by"
            };
            write!(text, "  {} {verb} ", task.name)?;
            let unreached_rows = task.rows.iter().filter(|rows| !rows.reached);
            for (k, rows) in unreached_rows.enumerate() {
                let joiner = if k > 0 { " and " } else { "" };
                write!(text, "{joiner}{}", Significant(rows.error))?;
                let unit = rows.quantity.unit(self.length_unit());
                if !unit.is_empty() {
                    write!(text, " {unit}")?;
                }
            }
            writeln!(text, ".")?;
        }
        Ok(())
    }

    /// Names the priority levels that are not met, if there are several levels.
    fn write_levels(&self, text: &mut String) -> std::fmt::Result {
        let goals = || {
            let tasks = self.tasks();
            tasks.filter(|task| task.role == Role::Goal && !task.is_loop)
        };
        let unreached_levels = goals().filter(|task| !task.reached).map(|task| task.level);
        let unreached_levels: BTreeSet<usize> = unreached_levels.collect();
        let (Some(&first), Some(last)) = (
            unreached_levels.first(),
            goals().map(|task| task.level).max(),
        ) else {
            return Ok(());
        };
        let above = goals()
            .map(|task| task.level)
            .filter(|level| *level < first);
        match (above.max(), first < last) {
            (Some(above), _) if unreached_levels.len() == 1 => writeln!(
                text,
                "  Level {first} gives way: the levels up to {above} are met and allow no smaller error."
            ),
            (Some(above), _) => {
                let unreached_levels: Vec<String> =
                    unreached_levels.iter().map(usize::to_string).collect();
                writeln!(
                    text,
                    "  Levels {} give way: the levels up to {above} are met, and each level allows no smaller error of the next.",
                    unreached_levels.join(", ")
                )
            }
            (None, true) => writeln!(
                text,
                "  Level {first} has the highest priority: lower levels do not increase its error."
            ),
            (None, false) => Ok(()),
        }
    }

    /// States whether the target is out of reach or the solution may be a local minimum.
    fn write_verdict(&self, text: &mut String) -> std::fmt::Result {
        if let (Some(out_of_reach), Some(names)) = (self.beyond, self.names.as_deref()) {
            let unit = self.length_unit().symbol();
            if let (Some(task), Some(Some(anchor))) = (
                names.tasks.get(out_of_reach.task),
                names.anchors.get(out_of_reach.task),
            ) {
                let (distance, reach) = (
                    Significant(out_of_reach.distance),
                    Significant(out_of_reach.reach),
                );
                return writeln!(
                    text,
                    "  Out of reach: {task} should be {distance} {unit} from `{}`, where its chain \
                     begins, and the chain reaches {reach} {unit}.",
                    anchor.joint
                );
            }
        }
        if let Some(boxes) = self.excluded_boxes {
            return writeln!(
                text,
                "  Out of reach: no configuration within the joint limits reaches the target. Bounds over {} of joint \
                 values prove it.",
                match boxes {
                    1 => "one box".to_owned(),
                    _ => format!("{boxes} boxes"),
                }
            );
        }
        if !self.pulling.is_empty() {
            for (k, name) in self.pulling_preferences().enumerate() {
                write!(text, "{}{name}", if k > 0 { ", " } else { "  " })?;
            }
            let verb = if self.pulling.len() == 1 {
                "pulls"
            } else {
                "pull"
            };
            return writeln!(
                text,
                " {verb} against the required tasks: weighted soft tasks can increase their errors."
            );
        }
        match (self.agreeing, self.attempts) {
            (0, _) => Ok(()),
            // A motion that is still limited by its moves is no failure yet.
            (1, 1) if self.moves().next().is_some() => Ok(()),
            (1, 1) => writeln!(
                text,
                "  Only one attempt was made: another start may do better."
            ),
            (1, _) => writeln!(
                text,
                "  No other attempt ended here: it may be a local minimum, and another start may do \
                 better."
            ),
            (agreeing, attempts) => writeln!(
                text,
                "  {agreeing} of {attempts} attempts ended with this error: a closer solution is \
                 unlikely."
            ),
        }
    }

    fn write_limits(&self, text: &mut String) -> std::fmt::Result {
        // A search that was cut short proves nothing about limits.
        let cut_short = matches!(
            self.termination,
            Termination::Stalled | Termination::IterationLimit | Termination::TimeLimit
        );
        let moves = self.moves().count();
        let mut limits = self.active_limits().peekable();
        if moves > MAX_LISTED_MOVES {
            let named = self.moves().take(NAMED_MOVES);
            let named: Vec<String> = named.map(|limit| format!("`{}`", limit.joint)).collect();
            write!(
                text,
                "  It is held back by the end of the allowed move of {} and {} more joints",
                named.join(", "),
                moves - named.len()
            )?;
            match limits.count() - moves {
                0 => write!(text, ".")?,
                hard => write!(text, ", and by {}.", counted(hard, "joint limit"))?,
            }
        } else if limits.peek().is_none() {
            let verdict = match cut_short {
                true => "No joint limit is active so far",
                false => "No joint limit holds it back",
            };
            write!(text, "  {verdict}.")?;
        } else {
            let verdict = match cut_short {
                true => "So far it is held back by",
                false => "It is held back by",
            };
            write!(text, "  {verdict} ")?;
            for (k, limit) in limits.enumerate() {
                let side = match limit.side {
                    Side::Lower => "lower",
                    Side::Upper => "upper",
                };
                let joiner = if k > 0 { ", " } else { "" };
                let value = Significant(limit.value);
                let kind = match limit.kind {
                    BoundKind::Limit => "limit",
                    BoundKind::Move => "end of the allowed move",
                };
                write!(text, "{joiner}the {side} {kind} {value} ")?;
                if limit.is_angle {
                    write!(text, "rad ({}°)", Significant(limit.value.to_degrees()))?;
                } else {
                    text.push_str(self.length_unit().symbol());
                }
                write!(text, " of `{}`", limit.joint)?;
            }
            text.push('.');
        }
        if cut_short {
            write!(text, " More time or iterations may help.")?;
        }
        Ok(())
    }
}

/// A number with four significant digits; small errors do not print as zero.
struct Significant(f64);

impl std::fmt::Display for Significant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let value = self.0;
        let size = value.abs();
        let decimals = match size {
            _ if size == 0.0 || !value.is_finite() => return write!(f, "{value}"),
            _ if !(1e-3..1e6).contains(&size) => return write!(f, "{value:.3e}"),
            _ => (3.0 - elementary::log10(size).floor()).max(0.0) as usize,
        };
        write!(f, "{value:.decimals$}")
    }
}
