//! The lane engine, through the arm's front door.

use kinopt::Solution;
use kinopt::arm::{Arm, ArmError, Goal, Joints, Search};
use kinopt::model::{FrameId, Model, ModelBuilder};
use kinopt::robot::Mimic;
use kinopt::spatial::Placement;

use crate::{Adapter, Answer, Budget, ProblemSet, Question, Trace};

/// [`Arm`] with the search [`Search::First`]: one frame on one chain. It marks nothing.
#[derive(Debug, Default)]
pub struct LaneEngineAdapter {
    seated: Option<Seated>,
    solution: Solution,
}

/// An arm made for one problem set and budget.
#[derive(Debug)]
struct Seated {
    arm: Arm,
    /// Where each joint of the arm stands in a configuration of the model.
    coordinates: Vec<usize>,
}

/// A tree with a frame that stands in the world.
struct Rooted {
    model: Model,
    mimics: Vec<Mimic>,
    world: String,
}

impl Joints for Rooted {
    fn tree(&self) -> &Model {
        &self.model
    }

    fn followers(&self) -> &[Mimic] {
        &self.mimics
    }
}

impl Rooted {
    fn new(set: &ProblemSet) -> Result<Self, String> {
        let mut world = "world".to_owned();
        while set.model().frame(&world).is_ok() {
            world.push('\'');
        }
        let mut builder = ModelBuilder::from_model(set.model());
        builder.frame(world.clone(), None, Placement::identity());
        Ok(Self {
            model: builder.build().map_err(|error| error.to_string())?,
            mimics: set.mimics().to_vec(),
            world,
        })
    }
}

fn arm(set: &ProblemSet, rooted: &Rooted, budget: Budget) -> Result<Arm, ArmError> {
    let tip = set.frame_names().next().unwrap_or_default();
    let goal = if set.turns() {
        Goal::pose()
    } else {
        Goal::position()
    };
    Arm::builder(rooted, &rooted.world, tip)?
        .with_goal(goal)
        .with_search(Search::First)
        .with_seed(set.seed())
        .with_position_tolerance(set.length_tolerance())
        .with_orientation_tolerance(set.tolerance())
        .with_time_limit(budget.time_limit)
        .build()
}

impl Adapter for LaneEngineAdapter {
    fn name(&self) -> &str {
        "lane engine"
    }

    fn family(&self) -> &str {
        "kinopt"
    }

    fn setting(&self) -> String {
        "kinopt::Arm, search `first`, its own attempts and atlas".to_owned()
    }

    fn prepare(&mut self, set: &ProblemSet, budget: Budget) -> Result<(), String> {
        self.seated = None;
        let frames: &[FrameId] = set.frames();
        if frames.len() != 1 {
            return Err(format!("takes one frame, not {}", frames.len()));
        }
        let rooted = Rooted::new(set)?;
        let arm = arm(set, &rooted, budget).map_err(|error| error.to_string())?;
        let ids = arm.joint_ids().iter();
        let coordinates = ids.filter_map(|&id| set.model().coordinate(id)).collect();
        self.seated = Some(Seated { arm, coordinates });
        Ok(())
    }

    fn solve(&mut self, question: &Question<'_>, _trace: &Trace) -> Answer {
        let stay = || Answer::at(question.start.to_vec());
        let (Some(seated), [target]) = (&mut self.seated, question.targets) else {
            return stay();
        };
        let at = |&coordinate: &usize| question.start.get(coordinate).copied();
        let start: Vec<f64> = seated.coordinates.iter().filter_map(at).collect();
        let solved = seated.arm.solve_into(*target, &start, &mut self.solution);
        if solved.is_err() {
            return stay();
        }
        let mut q = question.start.to_vec();
        for (&coordinate, &value) in seated.coordinates.iter().zip(&self.solution.q) {
            if let Some(entry) = q.get_mut(coordinate) {
                *entry = value;
            }
        }
        Answer {
            q: question.set.within_limits(&q),
            ..Answer::from(&self.solution)
        }
    }
}
