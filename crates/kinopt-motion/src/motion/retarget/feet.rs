//! Feet of an online retargeter: ground contact and orientation.

use super::RetargetError;
use super::frame_problem::FrameProblem;
use super::limbs::Limbs;
use super::on_terrain::SoleGround;
use super::over_ground::{Footing, OverGround};
use super::sole::Sole;
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::problem::{Problem, ProblemBuilder, Targets, TaskId};

/// Weight of ground penetration per metre, relative to the largest weight of a point.
const PENETRATION_WEIGHT: f64 = 15.0;

/// Feet of an online retargeter.
#[derive(Clone, Debug)]
pub(super) struct Feet {
    feet: Vec<Foot>,
    /// For each limb, its height above the ground in contact, metres.
    clearances: Vec<f64>,
    landing_weight: f64,
    weight: f64,
}

#[derive(Clone, Debug)]
struct Foot {
    sole: Sole,
    /// True if the foot has the subject's orientation, except during contact.
    is_oriented: bool,
    task: TaskId<OverGround>,
    /// Ground height under each ball while its limb is in contact, metres.
    heights: Vec<f64>,
    /// Tilts of the foot at the last touchdown, and at the last sample.
    tilts: Vec<f64>,
    last_tilts: Vec<f64>,
    /// True if the foot is locked at its tilt before it would have penetrated the ground.
    ///
    /// An ankle lock alone lets a leg at its limits tip the foot.
    orientation_locked: bool,
    /// Pose of the foot's frame.
    pose: Placement<f64>,
}

impl Foot {
    fn is_locked(&self, anchors: &[Option<Vector3<f64>>]) -> bool {
        let mut limbs = self.sole.balls.iter().map(|(_, limb)| anchors[*limb]);
        limbs.all(|anchor| anchor.is_some())
    }
}

impl Feet {
    pub(super) fn new(limbs: &Limbs, landing_weight: f64, tasks: &mut ProblemBuilder<'_>) -> Self {
        let max_weight = limbs.max_weight();
        let foot = |sole: &Sole| Foot {
            task: tasks.add(OverGround::new(sole, PENETRATION_WEIGHT, max_weight)),
            heights: vec![0.0; sole.balls.len()],
            tilts: vec![0.0; sole.level.len()],
            last_tilts: vec![0.0; sole.level.len()],
            orientation_locked: false,
            pose: Placement::identity(),
            is_oriented: limbs.orients(sole),
            sole: sole.clone(),
        };
        Self {
            feet: limbs.soles.iter().map(foot).collect(),
            clearances: limbs.all.iter().map(|limb| limb.clearance).collect(),
            landing_weight,
            weight: PENETRATION_WEIGHT * max_weight,
        }
    }

    /// Sets the task of each foot. A foot with all limbs in contact is locked.
    ///
    /// `grounds` is the terrain under each foot, or empty for level ground. Other feet stay above the ground, or above the ground under their contacts. They become flatter with increasing
    /// contact.
    pub(super) fn set_targets(
        &self,
        targets: &mut Targets,
        anchors: &[Option<Vector3<f64>>],
        contacts: &[f64],
        grounds: &[SoleGround],
    ) -> Result<(), RetargetError> {
        for (k, foot) in self.feet.iter().enumerate() {
            let ground = grounds.get(k);
            let balls = &foot.sole.balls;
            let ground_height = |(ball, limb): (usize, usize)| match anchors[limb] {
                Some(_) => foot.heights[ball],
                None => ground.map_or(0.0, |ground| ground.heights[ball]),
            };
            let limbs = balls.iter().map(|(_, limb)| *limb).enumerate();
            let contact_level = balls.iter().map(|(_, limb)| contacts[*limb]);
            let contact_level = contact_level.fold(0.0, f64::max).min(1.0);
            let footing = match foot.is_locked(anchors) {
                true => Footing::Locked {
                    tilts: foot.tilts.clone(),
                    orientation_locked: foot.orientation_locked,
                    heights: Vec::new(),
                },
                false => Footing::Above {
                    heights: limbs.map(ground_height).collect(),
                    tilts: ground
                        .map(|ground| ground.tilts.clone())
                        .unwrap_or_default(),
                    levelling: match foot.is_oriented {
                        true => elementary::pow(self.landing_weight, contact_level) - 1.0,
                        false => elementary::pow(self.landing_weight, contact_level),
                    },
                },
            };
            targets.get_mut(foot.task)?.set(&footing);
        }
        Ok(())
    }

    /// Stores the poses of all feet at x.
    pub(super) fn store_poses(&mut self, frame: &mut FrameProblem, x: &[f64]) {
        for foot in &mut self.feet {
            if let Some(pose) = frame.first_frame(x, foot.task.index()) {
                foot.pose = pose;
            }
        }
    }

    /// Updates the ground heights of new contacts: at most the height of the foot's balls.
    pub(super) fn update_ground_heights(
        &mut self,
        new: &[usize],
        anchors: &[Option<Vector3<f64>>],
    ) {
        for foot in &mut self.feet {
            for (height, (ball, limb)) in foot.heights.iter_mut().zip(&foot.sole.balls) {
                if let (true, Some(anchor)) = (new.contains(limb), anchors[*limb]) {
                    let lowest = ball.height(&foot.pose);
                    *height = lowest.min(anchor.z - self.clearances[*limb]);
                }
            }
            if foot.sole.balls.iter().any(|(_, limb)| new.contains(limb)) {
                foot.tilts = foot.sole.tilts(&foot.pose);
                foot.last_tilts.clone_from(&foot.tilts);
                foot.orientation_locked = false;
            }
        }
    }

    /// Locks the orientation of feet that would penetrate the ground by more than `max_penetration` metres. Returns
    /// whether there are new ones.
    pub(super) fn lock_orientations(
        &mut self,
        anchors: &[Option<Vector3<f64>>],
        max_penetration: f64,
    ) -> bool {
        let mut any = false;
        for foot in self.feet.iter_mut().filter(|foot| foot.is_locked(anchors)) {
            let mut balls = foot.sole.balls.iter().zip(&foot.heights);
            let penetrates =
                balls.any(|((ball, _), height)| ball.height(&foot.pose) < height - max_penetration);
            if penetrates && !foot.orientation_locked {
                (foot.orientation_locked, any) = (true, true);
                foot.tilts.clone_from(&foot.last_tilts);
            } else {
                foot.last_tilts = foot.sole.tilts(&foot.pose);
            }
        }
        any
    }

    /// Raises the ground of unlocked feet that penetrate it by more than `max_penetration` metres. Returns whether
    /// there are any.
    ///
    /// `residual` is that of all tasks.
    pub(super) fn raise_ground(
        &self,
        targets: &mut Targets,
        problem: &Problem,
        residual: &[f64],
        max_penetration: f64,
    ) -> bool {
        let mut any = false;
        for foot in &self.feet {
            let rows = problem.compiled_tasks()[foot.task.index()].rows.clone();
            let task = targets.get_mut(foot.task);
            any |= task.is_ok_and(|task| task.raise_ground(&residual[rows], max_penetration));
        }
        any
    }

    /// Returns whether a foot penetrates the ground by more than `max_penetration` metres. `residual` is that of all
    /// tasks.
    pub(super) fn penetrates(
        &self,
        problem: &Problem,
        residual: &[f64],
        max_penetration: f64,
    ) -> bool {
        let threshold = -max_penetration * self.weight;
        self.feet.iter().any(|foot| {
            let rows = problem.compiled_tasks()[foot.task.index()].rows.clone();
            let mut ground_rows = residual[rows].iter().take(foot.sole.balls.len());
            ground_rows.any(|row| *row < threshold)
        })
    }
}
