//! Analytic solution for a limb of two bones.

use super::Geometric;
use super::goal::goals;
use super::joint_groups::joint_points;
use super::joint_points::JointGroup;
use super::joints_to_points::JointFit;
use super::sweeps::{self, Limits, Sweep};
use super::triangle::triangle;
use crate::ik::{Restarts, Solution};
use crate::problem::ProblemInstance;
use crate::search::SolveError;
use crate::solver::{Observer, Stopping};
use kinopt_kinematics::spatial::Vector3;

const NAME: &str = "the two-bone solution";

/// Largest number of sweeps, for limbs whose limits or joints keep the points from their targets.
const MAX_SWEEPS: usize = 20;

/// The side of the line to the target on which the bones meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Elbow {
    /// The second bone rotates counter-clockwise from the first about the elbow's last axis.
    ///
    /// For a hinge that is 0 if the bones are aligned, the angle is ≥ 0. Only that joint and the root's joints move.
    Positive,
    /// The second bone rotates clockwise from the first.
    Negative,
    /// As far as possible towards this point (the pole, in world coordinates).
    ///
    /// For limbs with three joint axes that meet at the root, which leave the plane of the bones free.
    Towards(Vector3<f64>),
}

/// Analytic inverse kinematics of two bones with one target, by the law of cosines.
///
/// The problem must have one point task. The free joints that move it must be at two points, such as a shoulder and an
/// elbow. On rigs and redundant robots, lock the other joints by
/// [`ParameterMap::builder`](kinopt_kinematics::model::ParameterMap::builder) and `with_only`.
///
/// The joints are set from the base outwards, within their limits. This is in closed form if two axes meet in a point,
/// and by coordinate descent otherwise. The solution is exact if the root's joints can point anywhere and the limits
/// allow it; otherwise an error remains. For an unreachable target the bones are stretched or folded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoBone {
    elbow: Elbow,
}

impl TwoBone {
    /// A solver with the elbow on this side.
    #[must_use]
    pub fn new(elbow: Elbow) -> Self {
        Self { elbow }
    }
}

impl Geometric for TwoBone {
    fn name(&self) -> &'static str {
        "two_bone"
    }

    fn solve_question(
        &self,
        instance: ProblemInstance<'_>,
        start: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<Solution, SolveError> {
        let goals = goals(instance, NAME)?;
        let points = joint_points(instance, &goals, NAME)?;
        let linkage = points.linkage();
        let (Some(&[upper, lower]), &[pin]) = (linkage.as_chain(), points.pins()) else {
            return Err(SolveError::NotTwoBones {
                model: instance.problem.names().model.clone(),
                bones: points.rest().len().saturating_sub(1),
                tips: points.pins().len(),
            });
        };
        let positions = points.rest().to_vec();
        let fit = JointFit::new(instance, points);
        let mut limb = TwoBoneLimb {
            elbow: self.elbow,
            lengths: [upper, lower],
            target: pin.target,
            points: positions,
            elbow_joint: fit.joints_for(TIP).last().copied(),
            shoulder: JointGroup {
                joints: fit.joints_for(MID).to_vec(),
                points: vec![TIP],
                centre: Some(ROOT),
            },
            fit,
        };
        let limits = Limits {
            stopping: Stopping::default().with_max_iterations(MAX_SWEEPS),
            restarts: Restarts::none(),
        };
        sweeps::solve(instance, start, limits, &mut limb, observer)
    }
}

/// Indices of the three points of a limb.
const ROOT: usize = 0;
const MID: usize = 1;
const TIP: usize = 2;

struct TwoBoneLimb<'a> {
    elbow: Elbow,
    lengths: [f64; 2],
    target: Vector3<f64>,
    /// Target positions of root, mid point and tip.
    points: Vec<Vector3<f64>>,
    /// The elbow's last joint.
    elbow_joint: Option<usize>,
    /// The joints at the root; they rotate the bent limb as one body.
    shoulder: JointGroup,
    fit: JointFit<'a>,
}

impl TwoBoneLimb<'_> {
    /// Computes the triangle for the target from the present joints.
    fn compute_points(&mut self, x: &[f64]) {
        self.fit.points_at(x, &mut self.points);
        let towards = match self.elbow {
            Elbow::Towards(pole) => pole - self.points[ROOT],
            Elbow::Positive | Elbow::Negative => self.points[MID] - self.points[ROOT],
        };
        let solution = triangle(self.points[ROOT], self.lengths, self.target, towards);
        self.points[MID] = solution.mid;
        self.points[TIP] = solution.tip;
    }
}

impl Sweep for TwoBoneLimb<'_> {
    fn begin(&mut self, x: &[f64]) {
        self.compute_points(x);
    }

    fn accepts_start(&self) -> bool {
        false
    }

    fn sweep(&mut self, x: &mut [f64]) {
        let positive = match self.elbow {
            Elbow::Towards(_) => {
                self.compute_points(x);
                return self.fit.move_to(&mut self.points, x, |_, _| ());
            }
            Elbow::Positive => true,
            Elbow::Negative => false,
        };
        // The elbow alone sets the distance of the tip from the root; the root's joints then rotate the limb as one
        // body.
        let distance = (self.points[TIP] - self.points[ROOT]).norm();
        if let Some(elbow_joint) = self.elbow_joint {
            self.fit
                .set_distance(elbow_joint, [ROOT, TIP], (distance, positive), x);
        }
        self.fit.position_group(&self.shoulder, &self.points, x);
    }
}
