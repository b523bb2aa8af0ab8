//! The feet of a body that follows: over the ground, and over what they stand on.

use super::RetargetError;
use super::limbs::Limbs;
use super::over_ground::{Footing, OverGround};
use super::problem_of_frame::ProblemOfFrame;
use super::sole::Sole;
use crate::problem::{Problem, ProblemBuilder, Targets, TaskId};
use crate::scalar::elementary;
use crate::spatial::{Placement, Vector3};

/// What a metre below the ground costs, for the most that any place counts.
const OVER: f64 = 15.0;

/// The soles of a follower.
#[derive(Clone, Debug)]
pub(super) struct Feet {
    all: Vec<Foot>,
    /// Of each limb: how high it is over the ground that it stands on.
    clearances: Vec<f64>,
    landing_weight: f64,
    weight: f64,
}

#[derive(Clone, Debug)]
struct Foot {
    sole: Sole,
    task: TaskId<OverGround>,
    /// How high what each ball stands on is, where its limb stands.
    heights: Vec<f64>,
    /// How the foot was tilted when its last limb came to stand, and how in the last frame.
    tilts: Vec<f64>,
    last_tilts: Vec<f64>,
    /// Whether it is held as it was tilted before it would have gone into what it stands on: where a leg can do no more, a foot
    /// that is held at its ankle is tipped.
    firmly: bool,
    /// Where its frame is.
    placed: Placement<f64>,
}

impl Foot {
    fn is_held(&self, anchors: &[Option<Vector3<f64>>]) -> bool {
        let mut limbs = self.sole.balls.iter().map(|(_, limb)| anchors[*limb]);
        limbs.all(|anchor| anchor.is_some())
    }
}

impl Feet {
    pub(super) fn new(limbs: &Limbs, landing_weight: f64, tasks: &mut ProblemBuilder<'_>) -> Self {
        let heaviest = limbs.heaviest();
        let foot = |sole: &Sole| Foot {
            task: tasks.add(OverGround::new(sole, OVER, heaviest)),
            heights: vec![0.0; sole.balls.len()],
            tilts: vec![0.0; sole.level.len()],
            last_tilts: vec![0.0; sole.level.len()],
            firmly: false,
            placed: Placement::identity(),
            sole: sole.clone(),
        };
        Self {
            all: limbs.soles.iter().map(foot).collect(),
            clearances: limbs.all.iter().map(|limb| limb.clearance).collect(),
            landing_weight,
            weight: OVER * heaviest,
        }
    }

    /// Says what each foot does: it is held where all its limbs stand; else it stays over the ground, or over what those that do
    /// stand on, and is the flatter the more firmly it stands.
    pub(super) fn aim(
        &self,
        targets: &mut Targets,
        anchors: &[Option<Vector3<f64>>],
        stands: &[f64],
    ) -> Result<(), RetargetError> {
        for foot in &self.all {
            let balls = &foot.sole.balls;
            let stands_on = |(ball, limb): (usize, usize)| match anchors[limb] {
                Some(_) => foot.heights[ball],
                None => 0.0,
            };
            let limbs = balls.iter().map(|(_, limb)| *limb).enumerate();
            let firmness = balls.iter().map(|(_, limb)| stands[*limb]);
            let firmness = firmness.fold(0.0, f64::max).min(1.0);
            let footing = match foot.is_held(anchors) {
                true => Footing::Held {
                    tilts: foot.tilts.clone(),
                    firmly: foot.firmly,
                    heights: Vec::new(),
                },
                false => Footing::Over {
                    heights: limbs.map(stands_on).collect(),
                    levelling: elementary::pow(self.landing_weight, firmness),
                },
            };
            targets.get_mut(foot.task)?.set(&footing);
        }
        Ok(())
    }

    /// Takes note of where all are at x.
    pub(super) fn place(&mut self, frame: &mut ProblemOfFrame, x: &[f64]) {
        for foot in &mut self.all {
            if let Some(placed) = frame.first_frame(x, foot.task.index()) {
                foot.placed = placed;
            }
        }
    }

    /// Takes what limbs that have come to stand do for what their balls stand on: no higher than these are.
    pub(super) fn land(&mut self, new: &[usize], anchors: &[Option<Vector3<f64>>]) {
        for foot in &mut self.all {
            for (height, (ball, limb)) in foot.heights.iter_mut().zip(&foot.sole.balls) {
                if let (true, Some(anchor)) = (new.contains(limb), anchors[*limb]) {
                    let lowest = ball.height(&foot.placed);
                    *height = lowest.min(anchor.z - self.clearances[*limb]);
                }
            }
            if foot.sole.balls.iter().any(|(_, limb)| new.contains(limb)) {
                foot.tilts = foot.sole.tilts(&foot.placed);
                foot.last_tilts.clone_from(&foot.tilts);
                foot.firmly = false;
            }
        }
    }

    /// Has those held feet held firmly that would have gone by more than so many metres into what they stand on; whether there are
    /// any that were not before.
    pub(super) fn hold_firmly(&mut self, anchors: &[Option<Vector3<f64>>], deeper: f64) -> bool {
        let mut any = false;
        for foot in self.all.iter_mut().filter(|foot| foot.is_held(anchors)) {
            let mut balls = foot.sole.balls.iter().zip(&foot.heights);
            let is_sunk =
                balls.any(|((ball, _), height)| ball.height(&foot.placed) < height - deeper);
            if is_sunk && !foot.firmly {
                (foot.firmly, any) = (true, true);
                foot.tilts.clone_from(&foot.last_tilts);
            } else {
                foot.last_tilts = foot.sole.tilts(&foot.placed);
            }
        }
        any
    }

    /// Pushes those that are not held, and deeper than so many metres by the residual of all tasks, out of what they are in;
    /// whether there are any.
    pub(super) fn push_out(
        &self,
        targets: &mut Targets,
        problem: &Problem,
        residual: &[f64],
        deeper: f64,
    ) -> bool {
        let mut any = false;
        for foot in &self.all {
            let rows = problem.compiled_tasks()[foot.task.index()].rows.clone();
            let over = targets.get_mut(foot.task);
            any |= over.is_ok_and(|over| over.push_out(&residual[rows], deeper));
        }
        any
    }

    /// Whether one is deeper than so many metres; by the residual of all tasks.
    pub(super) fn is_sunk(&self, problem: &Problem, residual: &[f64], deeper: f64) -> bool {
        let deepest = -deeper * self.weight;
        self.all.iter().any(|foot| {
            let rows = problem.compiled_tasks()[foot.task.index()].rows.clone();
            let mut over = residual[rows].iter().take(foot.sole.balls.len());
            over.any(|row| *row < deepest)
        })
    }
}
