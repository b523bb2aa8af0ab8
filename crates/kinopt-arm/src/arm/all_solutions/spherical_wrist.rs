//! Closed form of arms whose last three axes meet in a point.

use super::angle::{Angle, LinearRoots, solve_linear};
use super::branches::BranchSigns;
use super::position::PositionSolver;
use super::screw::{Relation, Screw, common_point, relation};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Solver of an arm with a spherical wrist.
#[derive(Clone, Debug)]
pub(super) struct SphericalWrist {
    axes: [Screw; 6],
    centre: Vector3<f64>,
    position: PositionSolver,
    branch_signs: BranchSigns,
}

impl SphericalWrist {
    /// `None` if the last three axes do not meet, or two successive of them are parallel.
    pub(super) fn new(axes: [Screw; 6], tolerance: f64) -> Option<Self> {
        let centre = common_point(&axes[3..], tolerance)?;
        let is_parallel =
            |a: &Screw, b: &Screw| a.direction.cross(b.direction).norm() <= 100.0 * tolerance;
        if is_parallel(&axes[3], &axes[4]) || is_parallel(&axes[4], &axes[5]) {
            return None;
        }
        let position = PositionSolver::new([axes[0], axes[1], axes[2]], centre, tolerance)?;
        let branch_signs = match (
            relation(&axes[1], &axes[2], tolerance),
            relation(&axes[0], &axes[1], tolerance),
        ) {
            (Relation::Parallel, _) => BranchSigns::ParallelArm { centre },
            (_, Relation::Intersecting(shoulder)) => {
                BranchSigns::MeetingShoulder { centre, shoulder }
            }
            _ => BranchSigns::Wrist,
        };
        Some(Self {
            axes,
            centre,
            position,
            branch_signs,
        })
    }

    /// Branches of the structure.
    pub(super) fn branch_signs(&self) -> BranchSigns {
        self.branch_signs
    }

    /// Appends candidates for the displacement of the last link. Returns true if there is a continuous family.
    pub(super) fn solve(&self, displacement: &Placement<f64>, found: &mut Vec<[Angle; 6]>) -> bool {
        let mut wrist_family = false;
        let centre = displacement.apply(self.centre);
        let family = self.position.solve(centre, |[q1, q2, q3]| {
            let unrotated = |v: Vector3<f64>| {
                let v = self.axes[0].rotate(v, q1.negative());
                let v = self.axes[1].rotate(v, q2.negative());
                self.axes[2].rotate(v, q3.negative())
            };
            wrist_family |= self.solve_wrist([q1, q2, q3], unrotated, displacement, found);
        });
        family || wrist_family
    }

    fn solve_wrist(
        &self,
        [q1, q2, q3]: [Angle; 3],
        unrotated: impl Fn(Vector3<f64>) -> Vector3<f64>,
        displacement: &Placement<f64>,
        found: &mut Vec<[Angle; 6]>,
    ) -> bool {
        let [_, _, _, fourth, fifth, sixth] = self.axes;
        let (h4, h5, h6) = (fourth.direction, fifth.direction, sixth.direction);
        let goal = unrotated(displacement.rotation * h6);
        // h4 · R5·h6 = h4 · goal.
        let along = h5 * h5.dot(h6);
        let (a, b) = (h4.dot(h6 - along), h4.dot(h5.cross(h6)));
        let d = h4.dot(goal) - h4.dot(along);
        let LinearRoots::Two(roots) = solve_linear(a, b, d, 1.0) else {
            return false;
        };
        let mut family = false;
        for q5 in roots {
            let q4 = fourth.angle_between(fifth.rotate(h6, q5), goal);
            family |= q4.is_none();
            let q4 = q4.unwrap_or(Angle::ZERO);
            // R6·v = R5ᵀ·R4ᵀ·R123ᵀ·R·v for a direction v across the last axis.
            let v = sixth.across(h5);
            let to = unrotated(displacement.rotation * v);
            let to = fifth.rotate(fourth.rotate(to, q4.negative()), q5.negative());
            let q6 = sixth.angle_between(v, to).unwrap_or(Angle::ZERO);
            found.push([q1, q2, q3, q4, q5, q6]);
        }
        family
    }
}
