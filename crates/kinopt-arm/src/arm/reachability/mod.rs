//! Decision whether a target can be reached: a configuration, or a proof that none exists.

mod affine_form;
mod axis_chain;
mod ball_bound;
mod branch_and_prune;
mod cell_search;
mod joint_box;
mod linear_test;

use super::arm::Arm;
use super::{Axis, PoseBounds, QueryError};
use axis_chain::AxisChain;
use ball_bound::AxisPoint;
pub(super) use branch_and_prune::{BoxSearch, BoxSearchEnd};
pub(super) use cell_search::{CellSearch, Interval, OrientationCell};
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::ik::Solution;

/// Distance of the compared points from their frame's origin, as a fraction of the arm's extent.
///
/// It weighs rotations against positions. Of 0.15, 0.3 and 0.5 the first needs the fewest boxes.
const LEVER: f64 = 0.15;
/// Answer to the question whether any configuration within the joint limits reaches a target.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Reachability {
    /// A configuration reaches the target. It is free of collisions if the arm has a checker.
    Reachable(Solution),
    /// No configuration within the joint limits reaches the target within the arm's tolerances, whatever the obstacles.
    Unreachable {
        /// Number of boxes of joint values that the proof excludes one by one.
        boxes: usize,
        /// Closest pose found.
        closest: Solution,
    },
    /// Neither a configuration nor a proof was found.
    Undecided {
        /// Number of boxes of joint values that were examined.
        boxes: usize,
        /// Closest pose found.
        closest: Solution,
    },
}

impl Reachability {
    /// Returns `Some(true)` for a reachable target, `Some(false)` for one that is proven unreachable, and `None` if
    /// that is undecided.
    #[must_use]
    pub fn is_reachable(&self) -> Option<bool> {
        match self {
            Self::Reachable(_) => Some(true),
            Self::Unreachable { .. } => Some(false),
            Self::Undecided { .. } => None,
        }
    }

    /// The solution, or the closest pose found.
    #[must_use]
    pub fn solution(&self) -> &Solution {
        match self {
            Self::Reachable(solution) => solution,
            Self::Unreachable { closest, .. } | Self::Undecided { closest, .. } => closest,
        }
    }

    /// The solution, or the closest pose found, by value.
    #[must_use]
    pub fn into_solution(self) -> Solution {
        match self {
            Self::Reachable(solution) => solution,
            Self::Unreachable { closest, .. } | Self::Undecided { closest, .. } => closest,
        }
    }

    /// Number of boxes of joint values that were examined; 0 for a reachable target.
    #[must_use]
    pub fn boxes(&self) -> usize {
        match self {
            Self::Reachable(_) => 0,
            Self::Unreachable { boxes, .. } | Self::Undecided { boxes, .. } => *boxes,
        }
    }
}

impl Arm {
    /// Decides whether any configuration within the joint limits reaches a target: by a solution, or by a proof that
    /// there is none.
    ///
    /// The proof divides the joint limits into boxes. A box is excluded if bounds on the motion of points of the arm
    /// keep them away from the target by more than the arm's tolerances. The bounds are those of affine forms (Stolfi
    /// and de Figueiredo, "Self-Validated Numerical Methods and Applications", 1997) of the arm's forward kinematics,
    /// met halfway along the arm. Rounding errors are allowed for by a margin, not by directed rounding.
    ///
    /// `max_boxes` limits the work; a box takes a few microseconds, and a target far from being reachable often needs
    /// one. The arm's time limit also holds. Targets near the border of the reachable set need the most boxes and may
    /// remain undecided. Collisions count for solutions only: a target may be reachable, but not without a
    /// collision, which is undecided.
    ///
    /// Proofs need a chain of at most eight joints without mimic joints and without unlimited prismatic joints, and a
    /// goal that is a pose, a position, or a pose with a free rotation about an axis. Otherwise a target that is not
    /// reached is undecided after 0 boxes.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # use kinopt::arm::Arm;
    /// # use kinopt::robot::Robot;
    /// # use kinopt::spatial::{Matrix3, Placement, Vector3};
    /// let robot = Robot::read("models/franka_panda.urdf")?;
    /// let arm = Arm::new(&robot, "base", "flange")?;
    /// // The flange is 0.8 m in front and points back to the base.
    /// let backwards = Matrix3::from_roll_pitch_yaw([0.0, -1.57, 0.0]);
    /// let target = Placement::new(backwards, Vector3::new(0.8, 0.0, 0.3));
    /// let answer = arm.reachability(target, arm.default_start(), 100_000)?;
    /// assert_eq!(answer.is_reachable(), Some(false));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve).
    pub fn reachability(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
        start: &[f64],
        max_boxes: usize,
    ) -> Result<Reachability, QueryError> {
        let target = base_from_tool.into();
        let solution = self.solve(target, start)?;
        if solution.reached {
            return Ok(Reachability::Reachable(solution));
        }
        let end = self
            .box_search()
            .map(|search| search.run(&target, max_boxes));
        Ok(match end {
            Some(BoxSearchEnd::Empty { boxes }) => Reachability::Unreachable {
                boxes,
                closest: solution.proven_unreachable(boxes),
            },
            Some(BoxSearchEnd::Stopped { boxes }) => Reachability::Undecided {
                boxes,
                closest: solution,
            },
            None => Reachability::Undecided {
                boxes: 0,
                closest: solution,
            },
        })
    }

    /// Search for proofs that targets are out of reach; `None` for a chain or a goal without proofs.
    pub(super) fn box_search(&self) -> Option<BoxSearch> {
        let chain = AxisChain::new(self.serial.chain.as_ref()?)?;
        let extent = self.serial.extent;
        let lever = LEVER * extent;
        let (points, cut) = compared_points(&self.options.goal, lever, &chain)?;
        Some(BoxSearch {
            probes: match self.options.goal == PoseBounds::pose() {
                true => AxisPoint::on_axes(&chain),
                false => points
                    .iter()
                    .map(|&point| AxisPoint { cut, point })
                    .collect(),
            },
            chain,
            cut,
            points,
            // A point is at most the extent and the lever away from the tool's origin.
            tolerance: self.options.position_tolerance
                + (extent + lever) * self.options.orientation_tolerance,
            extent,
            deadline: self.deadline(),
        })
    }
}

/// Points whose positions follow from a target, in the frame of the link after the first `cut` joints, and `cut`.
///
/// Those of a pose belong to a link near the middle of the arm, so that both halves are short. Goals with a free
/// component are positions of points of the tool. `None` for other goals.
fn compared_points(
    goal: &PoseBounds,
    lever: f64,
    chain: &AxisChain,
) -> Option<(Vec<Vector3<f64>>, usize)> {
    let joints = chain.joints.len();
    let axes = [Axis::X, Axis::Y, Axis::Z];
    let origin = Vector3::zero();
    if *goal == PoseBounds::pose() {
        let points = [origin]
            .into_iter()
            .chain(axes.map(|axis| unit(axis) * lever));
        return Some((points.collect(), joints / 2 + 1));
    }
    let mut of_tool = vec![origin];
    if *goal != PoseBounds::position() {
        let is_free = |axis: &Axis| *goal == PoseBounds::free_about(*axis);
        of_tool.push(unit(axes.into_iter().find(is_free)?) * lever);
    }
    let of_last_joint = of_tool
        .iter()
        .map(|&point| chain.last_joint_from_tool.apply(point));
    Some((of_last_joint.collect(), joints))
}

fn unit(axis: Axis) -> Vector3<f64> {
    let mut components = [0.0; 3];
    components[axis as usize] = 1.0;
    components.into()
}
