//! The general solvers, asked one frame at a time.

use std::time::Instant;

use kinopt::model::FrameId;
use kinopt::problem::{Derivatives, ProblemBuilder, TaskId};
use kinopt::task::{Point, Quantity, Task};
use kinopt::{Problem, Solver, Workspace};
use rayon::prelude::*;

use super::answer::{Answer, AskedTask, Path, Question};
use super::arguments::Arguments;
use super::arm_door::microseconds;
use super::base::{Base, TargetTask};
use super::door::Door;
use super::tasks::pinned_tips;
use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;

/// A solver and the problem it is asked again and again.
pub(super) struct CoreDoor<'a> {
    loaded: &'a LoadedModel,
    solver: Solver,
    derivatives: Derivatives,
    tolerances: (f64, f64),
    base: Base,
    tip: FrameId,
    tip_name: String,
    turns: bool,
    held: Vec<(String, FrameId)>,
}

/// The problem and the memory of one thread.
pub(super) struct CoreDesk {
    problem: Problem,
    target: TargetTask,
    held: Vec<(FrameId, TaskId<Point>)>,
    workspace: Workspace,
}

impl<'a> CoreDoor<'a> {
    pub(super) fn new(
        loaded: &'a LoadedModel,
        arguments: &Arguments,
        base: Option<&str>,
        tip_name: &str,
        turns: bool,
    ) -> Outcome<Self> {
        let tip = loaded.frame(tip_name, BareName::Tip)?;
        let base = Base::named(loaded, base)?;
        Ok(Self {
            loaded,
            solver: arguments.general_solver(),
            derivatives: arguments.derivatives(),
            tolerances: arguments.tolerances(loaded),
            base,
            tip,
            tip_name: tip_name.to_owned(),
            turns,
            held: if arguments.free {
                Vec::new()
            } else {
                pinned_tips(loaded, &[tip])
            },
        })
    }

    fn builder(&self) -> ProblemBuilder<'_> {
        let mut builder = Problem::builder(&self.loaded.model);
        builder
            .parameters(self.loaded.parameters())
            .derivatives(self.derivatives)
            .tolerance(Quantity::Metres, self.tolerances.0)
            .tolerance(Quantity::Radians, self.tolerances.1);
        builder
    }
}

impl Door for CoreDoor<'_> {
    type Desk = CoreDesk;

    fn desk(&self) -> Outcome<CoreDesk> {
        let mut builder = self.builder();
        let name = format!("target {}", self.tip_name);
        // Aimed anew for every question.
        let anywhere = kinopt::spatial::Placement::identity();
        let target = self
            .base
            .add_target(&mut builder, self.tip, anywhere, self.turns, name);
        let held = self.held.iter().map(|(name, frame)| {
            let point = Point::new(*frame, [0.0; 3]);
            let task = builder.add(Task::new(point).named(format!("hold {name}")));
            (*frame, task)
        });
        let held = held.collect();
        Ok(CoreDesk {
            problem: builder.build()?,
            target,
            held,
            workspace: Workspace::new(),
        })
    }

    fn answer(&self, desk: &mut CoreDesk, question: &Question) -> Outcome<Answer> {
        self.base
            .aim(&mut desk.problem, desk.target, question.base_from_tip);
        if !desk.held.is_empty() {
            let placements = self.loaded.all_frames(&question.start);
            for (frame, task) in &desk.held {
                let placed = placements.get(frame.index());
                if let (Some(point), Some(placed)) = (desk.problem.residual_mut(*task), placed) {
                    point.set_target(placed.translation);
                }
            }
        }
        let started = Instant::now();
        let solution = self
            .solver
            .solve(&desk.problem, &question.start, &mut desk.workspace)?;
        let micros = microseconds(started);
        Ok(Answer {
            q: solution.q.clone(),
            alternatives: Vec::new(),
            solution: solution.clone(),
            micros: Some(micros),
        })
    }

    fn path(&self, questions: &[Question], told: &dyn Fn()) -> Outcome<Path> {
        let mut desk = self.desk()?;
        let mut answers: Vec<Answer> = Vec::with_capacity(questions.len());
        for question in questions {
            let mut question = question.clone();
            if let Some(last) = answers.last() {
                question.start.clone_from(&last.q);
            }
            answers.push(self.answer(&mut desk, &question)?);
            told();
        }
        Ok(Path {
            answers,
            jumps: None,
        })
    }

    fn batch(&self, questions: &[Question], parallel: bool) -> Outcome<(Vec<Answer>, f64)> {
        let started = Instant::now();
        // Problems are not shared, so each thread makes one of its own at the first question.
        let answer = |desk: &mut Option<CoreDesk>, question: &Question| {
            let desk = match desk {
                Some(desk) => desk,
                None => desk.insert(self.desk()?),
            };
            let answer = self.answer(desk, question)?;
            Ok(Answer {
                micros: None,
                ..answer
            })
        };
        let answers: Outcome<Vec<Answer>> = if parallel {
            let questions = questions.par_iter();
            questions.map_init(|| None, answer).collect()
        } else {
            let mut desk = None;
            let questions = questions.iter();
            questions
                .map(|question| answer(&mut desk, question))
                .collect()
        };
        Ok((answers?, microseconds(started)))
    }

    fn tasks(&self) -> Vec<AskedTask> {
        let tip = AskedTask {
            frame: self.tip_name.clone(),
            held: false,
        };
        let held = self.held.iter().map(|(name, _)| AskedTask {
            frame: name.clone(),
            held: true,
        });
        std::iter::once(tip).chain(held).collect()
    }
}
