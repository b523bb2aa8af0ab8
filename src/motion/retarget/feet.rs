//! The feet of a body that follows: over the ground, and over what they stand on.

use super::RetargetError;
use super::limbs::Limbs;
use super::over_ground::{Footing, OverGround};
use super::retargeting::told;
use super::sole::Sole;
use crate::kinematics::ForwardKinematics;
use crate::model::{FrameId, Model};
use crate::problem::{Problem, ProblemBuilder, Targets, TaskId};
use crate::scalar::elementary;
use crate::spatial::Vector3;

/// What a metre below the ground costs, for the most that any place counts.
const OVER: f64 = 15.0;

/// The soles of a follower.
#[derive(Clone, Debug)]
pub(super) struct Feet {
    all: Vec<Foot>,
    /// Of each limb: how high it is over the ground that it stands on.
    clearances: Vec<f64>,
    kinematics: ForwardKinematics,
    landing_weight: f64,
    weight: f64,
}

#[derive(Clone, Debug)]
struct Foot {
    sole: Sole,
    task: TaskId<OverGround>,
    /// How high what each ball stands on is, where its limb stands.
    heights: Vec<f64>,
    /// How the foot was tilted when its last limb came to stand.
    tilts: Vec<f64>,
}

impl Feet {
    pub(super) fn new(
        model: &Model,
        limbs: &Limbs,
        landing_weight: f64,
        tasks: &mut ProblemBuilder<'_>,
    ) -> Result<Self, RetargetError> {
        let heaviest = limbs.heaviest();
        let foot = |sole: &Sole| Foot {
            task: tasks.add(OverGround::new(sole, OVER, heaviest)),
            heights: vec![0.0; sole.balls.len()],
            tilts: vec![0.0; sole.level.len()],
            sole: sole.clone(),
        };
        let frames: Vec<FrameId> = limbs.soles.iter().map(|sole| sole.frame).collect();
        Ok(Self {
            all: limbs.soles.iter().map(foot).collect(),
            clearances: limbs.all.iter().map(|limb| limb.clearance).collect(),
            kinematics: ForwardKinematics::of_frames(model, &frames).map_err(told)?,
            landing_weight,
            weight: OVER * heaviest,
        })
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
            let footing = match balls.iter().all(|(_, limb)| anchors[*limb].is_some()) {
                true => Footing::Held {
                    tilts: foot.tilts.clone(),
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

    /// Takes what limbs that have come to stand do for what their balls stand on: no higher than these are.
    pub(super) fn land(
        &mut self,
        q: &[f64],
        new: &[usize],
        anchors: &[Option<Vector3<f64>>],
    ) -> Result<(), RetargetError> {
        let placed = self.kinematics.place(q).map_err(told)?;
        for (foot, placed) in self.all.iter_mut().zip(placed) {
            for (height, (ball, limb)) in foot.heights.iter_mut().zip(&foot.sole.balls) {
                if let (true, Some(anchor)) = (new.contains(limb), anchors[*limb]) {
                    *height = ball.height(placed).min(anchor.z - self.clearances[*limb]);
                }
            }
            if foot.sole.balls.iter().any(|(_, limb)| new.contains(limb)) {
                foot.tilts = foot.sole.tilts(placed);
            }
        }
        Ok(())
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
