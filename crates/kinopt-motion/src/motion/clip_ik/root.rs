//! Displacement of the root so that all limbs are long enough: minimal and smooth.

use glam::DVec3;

use super::ClipIkError;
use crate::motion::trajectory::{MotionProblem, MotionSolver, RateCost};
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::{FrameId, Limits, Model};
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::task::{Description, Inputs, Point, Quantity, Residual, RowBlock};

/// Time constant of the smoothing, seconds.
const SMOOTHING_S: f64 = 0.1;
/// Weight of the missing length of a limb relative to a displacement of the root.
const SHORTFALL_WEIGHT: f64 = 100.0;

/// Required displacement from a limb's upper end to its target, and the length of the limb.
#[derive(Clone, Copy, Debug)]
pub(super) struct RootDemand {
    /// From the limb's upper end to its target, without displacement of the root.
    pub(super) offset: Vector3<f64>,
    pub(super) length: f64,
}

/// r = max(0, ‖d − a‖ − ℓ) of one limb, for a displacement d of the root.
#[derive(Clone, Copy, Debug)]
struct LimbReach {
    root: FrameId,
    demand: RootDemand,
}

impl Residual for LimbReach {
    fn inputs(&self) -> Inputs {
        Inputs::frames([self.root])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _: &[S], residual: &mut [S]) {
        let offset = frames[0].translation - Vector3::constant(self.demand.offset);
        let shortfall = offset.norm() - S::constant(self.demand.length);
        let zero = S::constant(0.0);
        residual[0] = S::select(zero.less_than(shortfall), shortfall, zero);
    }

    fn description(&self) -> Description {
        Description::new("limb long enough")
    }
}

/// Returns the displacement of the root by frame.
///
/// `preferred` is the preferred displacement by frame; the result differs from it where a limb would be too short.
/// `demands` has the demands of each limb by frame. Fixed first or last frames have no displacement.
pub(super) fn root_displacements(
    preferred: &[DVec3],
    demands: Vec<Vec<RootDemand>>,
    [first_fixed, last_fixed]: [bool; 2],
    time_step_s: f64,
) -> Result<Vec<DVec3>, ClipIkError> {
    let frames = preferred.len();
    let too_short = |frame: usize| {
        let moved = Vector3::from(preferred[frame].to_array());
        demands
            .iter()
            .any(|limb| (moved - limb[frame].offset).norm() > limb[frame].length)
    };
    let unchanged = preferred.iter().all(|moved| *moved == DVec3::ZERO);
    if frames == 0 || (unchanged && !(0..frames).any(too_short)) {
        return Ok(preferred.to_vec());
    }
    // In lengths of the longest limb, so that the result does not depend on the unit of length.
    let lengths = demands.iter().flatten().map(|demand| demand.length);
    let size = lengths.fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { 1.0 };
    let preferred: Vec<DVec3> = preferred.iter().map(|moved| *moved / size).collect();
    let normalised = |demand: RootDemand| RootDemand {
        offset: demand.offset * (1.0 / size),
        length: demand.length / size,
    };
    let mut builder = Model::builder("root");
    let (mut joint, placement) = (None, Placement::identity());
    for (name, axis) in ["x", "y", "z"].into_iter().zip(Vector3::UNITS) {
        joint = Some(builder.prismatic(name, joint, placement, axis, Limits::UNBOUNDED));
    }
    let root = builder.frame("root", joint, placement);
    let model = builder.build()?;
    let mut motion = MotionProblem::builder(&model, frames, time_step_s);
    let targets = preferred.clone();
    let tracking = motion.add(Point::new(root, [0.0; 3]));
    motion.follow(tracking, move |frame, point| {
        point.set_target(targets[frame].to_array());
    });
    for limb in demands {
        let limb: Vec<RootDemand> = limb.into_iter().map(normalised).collect();
        let demand = limb[0];
        let task =
            kinopt_solver::task::Task::new(LimbReach { root, demand }).scale(SHORTFALL_WEIGHT);
        let task = motion.add(task);
        motion.follow(task, move |frame, residual| residual.demand = limb[frame]);
    }
    motion.rate_cost(RateCost::acceleration(SMOOTHING_S * SMOOTHING_S));
    let rest = model.neutral();
    if first_fixed {
        motion.first(&rest);
    }
    if last_fixed {
        motion.last(&rest);
    }
    let motion = motion.build()?;
    let start: Vec<f64> = preferred
        .iter()
        .flat_map(|moved| moved.to_array())
        .collect();
    let solved = MotionSolver::default().solve_near(&motion, &start)?;
    let mut kinematics = ForwardKinematics::new(&model);
    let position = |q: &[f64]| {
        let placed = kinematics.place(q)?;
        Ok(DVec3::from(placed[root.index()].translation.to_array()) * size)
    };
    solved.rows().map(position).collect()
}
