//! Feet of an online retargeter: ground contact and orientation.

use super::RetargetError;
use super::frame_problem::ProblemOfFrame;
use super::limbs::Limbs;
use super::over_ground::{Footing, OverGround};
use super::sole::Sole;
use crate::problem::{Problem, ProblemBuilder, Targets, TaskId};
use crate::scalar::elementary;
use crate::spatial::{Placement, Vector3};

/// Weight of ground penetration per metre, relative to the largest weight of a point.
const OVER: f64 = 15.0;

/// Feet of an online retargeter.
#[derive(Clone, Debug)]
pub(super) struct Feet {
    all: Vec<Foot>,
    /// For each limb, its height above the ground in contact, metres.
    clearances: Vec<f64>,
    landing_weight: f64,
    weight: f64,
}

#[derive(Clone, Debug)]
struct Foot {
    sole: Sole,
    task: TaskId<OverGround>,
    /// Ground height under each ball while its limb is in contact, metres.
    heights: Vec<f64>,
    /// Tilts of the foot at the last touchdown, and at the last sample.
    tilts: Vec<f64>,
    last_tilts: Vec<f64>,
    /// True if the foot is locked at its tilt before it would have penetrated the ground.
    ///
    /// An ankle lock alone lets a leg at its limits tip the foot.
    firmly: bool,
    /// Pose of the foot's frame.
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

    /// Sets the task of each foot. A foot with all limbs in contact is locked.
    ///
    /// Other feet stay above the ground, or above the ground under their contacts. They become flatter with increasing
    /// contact.
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

    /// Stores the poses of all feet at x.
    pub(super) fn place(&mut self, frame: &mut ProblemOfFrame, x: &[f64]) {
        for foot in &mut self.all {
            if let Some(placed) = frame.first_frame(x, foot.task.index()) {
                foot.placed = placed;
            }
        }
    }

    /// Updates the ground heights of new contacts: at most the height of the foot's balls.
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

    /// Locks the orientation of feet that would penetrate the ground by more than `deeper` metres. Returns whether
    /// there are new ones.
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

    /// Raises the ground of unlocked feet that penetrate it by more than `deeper` metres. Returns whether there are
    /// any.
    ///
    /// `residual` is that of all tasks.
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

    /// Returns whether a foot penetrates the ground by more than `deeper` metres. `residual` is that of all tasks.
    pub(super) fn is_sunk(&self, problem: &Problem, residual: &[f64], deeper: f64) -> bool {
        let deepest = -deeper * self.weight;
        self.all.iter().any(|foot| {
            let rows = problem.compiled_tasks()[foot.task.index()].rows.clone();
            let mut over = residual[rows].iter().take(foot.sole.balls.len());
            over.any(|row| *row < deepest)
        })
    }
}
