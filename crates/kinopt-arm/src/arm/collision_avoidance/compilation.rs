//! Compilation of a checker for the chain of an arm.

use super::avoidance::CollisionAvoidance;
use super::check_time::CheckTime;
use super::path_steps::STAND_OFF;
use super::simd_checks::{ArmJoints, SimdChecks};
use crate::arm::ArmError;
use crate::arm::arm::Arm;
use kinopt_collision::collision::Checker;
use kinopt_kinematics::kinematics::ForwardKinematics;

impl CollisionAvoidance {
    /// Compiles a checker, sharing compiled parts of `previous`, of an arm of the same chain.
    pub(super) fn new(
        arm: &Arm,
        checker: &Checker,
        q_model: &[f64],
        previous: Option<&Self>,
    ) -> Result<Self, ArmError> {
        let model = checker.model().model();
        let (given, expected) = (
            model.configuration_len(),
            arm.coordinates.degrees_of_freedom,
        );
        if given != expected {
            return Err(ArmError::ForeignChecker { given, expected });
        }
        let mut rest = q_model.to_vec();
        let mut q = vec![0.0; arm.joint_count()];
        // The lengths were checked above.
        let _ = arm.joint_values(&rest, &mut q[..]);
        let _ = arm.configuration(&q, &mut rest);
        // Clamped to their limits, with the joints that the arm locks.
        let _ = arm.joint_values(&rest, &mut q[..]);
        let placements = ForwardKinematics::<f64>::new(model).place(&rest)?.to_vec();
        let arm_joints = ArmJoints {
            model,
            joints: &arm.serial.joints,
            base: arm.coordinates.base,
        };
        let rest_collisions = checker.collisions(&rest)?;
        let check_time = CheckTime::default();
        check_time.measured(arm.options.time_limit, || checker.collisions(&rest))?;
        let never_free = rest_collisions
            .iter()
            .any(|pair| arm_joints.is_fixed(pair, checker));
        let chain = arm.serial.chain.as_ref();
        let updated = previous.and_then(|previous| previous.simd_checks_in(checker, &rest));
        let built = || {
            let (chain, spheres) = chain.zip(checker.spheres())?;
            SimdChecks::new(chain, &q, &placements, &arm_joints, checker, spheres)
        };
        let simd_checks = updated.or_else(built);
        let joints_to =
            |index: usize| arm_joints.joints_to(checker.model().links().get(index).copied());
        let is_movable = |pair: &&[usize; 2]| joints_to(pair[0]) != joints_to(pair[1]);
        Ok(Self {
            close_pairs: (checker.close_pairs().iter().filter(is_movable).copied()).collect(),
            cautious: checker.clone().with_stand_off(STAND_OFF),
            checker: checker.clone(),
            rest,
            never_free,
            simd_checks,
            check_time,
        })
    }

    /// SIMD checks for a checker that differs only in its world.
    fn simd_checks_in(&self, checker: &Checker, rest: &[f64]) -> Option<SimdChecks> {
        let is_unchanged = checker.margin() == self.checker.margin() && rest == self.rest;
        let simd_checks = self.simd_checks.as_ref().filter(|_| is_unchanged)?;
        simd_checks.in_world(&self.checker, checker)
    }
}
