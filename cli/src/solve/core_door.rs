//! The general solvers, asked one frame at a time.

use std::time::Instant;

use kinopt::ik::Drag;
use kinopt::model::FrameId;
use kinopt::problem::{Derivatives, ProblemBuilder, TaskId};
use kinopt::solver::Silent;
use kinopt::task::{Point, Quantity, Task};
use kinopt::{Problem, Workspace};
use rayon::prelude::*;

use super::answer::{Answer, AskedTask, LongStep, Path, Question};
use super::arguments::Arguments;
use super::arm_door::microseconds;
use super::base::{Base, TargetTask};
use super::door::Door;
use super::figure::{Finder, Found};
use super::held::Held;
use super::weights::Weights;
use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;

/// A solver and the problem it is asked again and again.
pub(super) struct CoreDoor<'a> {
    loaded: &'a LoadedModel,
    finder: Finder,
    derivatives: Derivatives,
    tolerances: (f64, f64),
    base: Base,
    tip: FrameId,
    tip_name: String,
    turns: bool,
    held: Held,
    weights: Weights,
}

/// The problem and the memory of one thread.
pub(super) struct CoreDesk {
    body: Drag,
    target: TargetTask,
    held: Vec<(FrameId, TaskId<Point>)>,
    /// What is held still stands as here.
    start: Vec<f64>,
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
        let tip = loaded.target_frame(tip_name, BareName::Tip)?;
        let base = Base::named(loaded, base)?;
        let held = Held::of(loaded, arguments, &[tip])?;
        let all = [vec![(tip_name.to_owned(), tip)], held.tips.clone()].concat();
        let weights = Weights::of(loaded, &arguments.weights, &all)?;
        Ok(Self {
            loaded,
            finder: Finder::new(loaded, arguments),
            derivatives: arguments.derivatives(),
            tolerances: arguments.tolerances(loaded),
            base,
            tip,
            tip_name: tip_name.to_owned(),
            turns,
            held,
            weights,
        })
    }

    fn builder(&self, start: &[f64]) -> Outcome<ProblemBuilder<'_>> {
        let mut builder = Problem::builder(&self.loaded.model);
        builder
            .parameters(self.held.parameters(self.loaded, start)?)
            .derivatives(self.derivatives)
            .tolerance(Quantity::Metres, self.tolerances.0)
            .tolerance(Quantity::Radians, self.tolerances.1);
        Ok(builder)
    }

    /// A desk for questions that start at `start`, which what is held still stays as.
    fn desk_at(&self, start: &[f64]) -> Outcome<CoreDesk> {
        let mut builder = self.builder(start)?;
        let name = format!("target {}", self.tip_name);
        let name = (name, self.weights.weight(self.tip));
        // Aimed anew for every question.
        let anywhere = kinopt::spatial::Placement::identity();
        let target = self
            .base
            .add_target(&mut builder, self.tip, anywhere, self.turns, name);
        let held = self.held.tips.iter().map(|(name, frame)| {
            let point = Point::new(*frame, [0.0; 3]);
            let task = Task::new(point).times(self.weights.weight(*frame));
            let task = builder.add(task.named(format!("hold {name}")));
            (*frame, task)
        });
        let held = held.collect();
        for posture in self.held.posture(self.loaded, start) {
            builder.add(posture);
        }
        Ok(CoreDesk {
            body: self.finder.body(builder.build()?, start)?,
            target,
            held,
            start: start.to_vec(),
            workspace: Workspace::new(),
        })
    }

    /// Puts the held tips where `start` has them.
    fn hold(&self, desk: &mut CoreDesk, start: &[f64]) {
        if desk.held.is_empty() {
            return;
        }
        let placements = self.loaded.all_frames(start);
        for (frame, task) in &desk.held {
            let placed = placements.get(frame.index());
            if let (Ok(point), Some(placed)) = (desk.body.target_mut(*task), placed) {
                point.set_target(placed.translation);
            }
        }
    }
}

impl Door for CoreDoor<'_> {
    type Desk = CoreDesk;

    fn desk(&self) -> Outcome<CoreDesk> {
        self.desk_at(&self.loaded.rest())
    }

    fn answer(&self, desk: &mut CoreDesk, question: &Question) -> Outcome<Answer> {
        if self.held.holds_still() && desk.start != question.start {
            *desk = self.desk_at(&question.start)?;
        }
        let (place, start) = (question.base_from_tip, &question.start);
        self.base.aim(&mut desk.body, desk.target, place)?;
        self.hold(desk, start);
        let (started, workspace) = (Instant::now(), &mut desk.workspace);
        let found = self
            .finder
            .find(&mut desk.body, start, workspace, &mut Silent)?;
        Ok(found.answer(microseconds(started)))
    }

    fn path(&self, questions: &[Question], told: &dyn Fn()) -> Outcome<Path> {
        let Some(first) = questions.first() else {
            return Ok(Path::default());
        };
        let mut desk = self.desk_at(&first.start)?;
        self.hold(&mut desk, &first.start);
        let mut body = self.finder.follower(desk.body);
        let angles: Vec<bool> = self.loaded.is_angle().collect();
        let joints = self.loaded.joint_names();
        let (mut answers, mut jumps) = (Vec::with_capacity(questions.len()), Vec::new());
        for (step, question) in questions.iter().enumerate() {
            let before = body.q().to_vec();
            self.base
                .aim(&mut body, desk.target, question.base_from_tip)?;
            let started = Instant::now();
            let solution = self.finder.follow(&mut body).clone();
            let found = Found {
                solution,
                way: None,
                elsewhere: None,
            };
            answers.push(found.answer(microseconds(started)));
            if step > 0 {
                jumps.extend(LongStep::between(step, &before, body.q(), &angles, &joints));
            }
            told();
        }
        Ok(Path {
            answers,
            jumps: Some(jumps),
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
        let held = self.held.tips.iter().map(|(name, _)| AskedTask {
            frame: name.clone(),
            held: true,
        });
        std::iter::once(tip).chain(held).collect()
    }
}
