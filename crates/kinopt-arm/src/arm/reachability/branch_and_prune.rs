//! Search over boxes of joint values that excludes them one by one.

use kinopt_kinematics::clock::Instant;
use kinopt_kinematics::spatial::{Placement, Vector3};

use super::affine_form::AffineForm;
use super::axis_chain::AxisChain;
use super::ball_bound::AxisPoint;
use super::joint_box::JointBox;
use super::linear_test::LinearTest;

/// Largest half width in radians or metres below which balls no longer exclude what affine forms do not.
const BALLS_ABOVE: f64 = 0.3;
/// A box is narrowed again if it shrank to less than this fraction of its volume.
const NARROW_AGAIN: f64 = 0.5;
/// Largest number of times that a box is narrowed before it is divided.
const MAX_NARROWINGS: usize = 20;
/// Allowance for rounding errors, as a fraction of the arm's extent plus the distance of the target.
const ROUNDING: f64 = 1e-12;
/// Boxes between two looks at the clock.
const BOXES_PER_CLOCK: usize = 64;

/// End of a search over boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::arm) enum BoxSearchEnd {
    /// All boxes are excluded.
    Empty {
        /// Number of boxes.
        boxes: usize,
    },
    /// The limit of boxes, the deadline or a near-solution ended the search.
    Stopped {
        /// Number of boxes.
        boxes: usize,
    },
}

/// Search for a proof that no configuration reaches a target.
#[derive(Clone, Debug)]
pub(in crate::arm) struct BoxSearch {
    pub(super) chain: AxisChain,
    pub(super) probes: Vec<AxisPoint>,
    /// Number of joints between the base and the link of `points`.
    pub(super) cut: usize,
    /// Compared points in the frame of their link, at most [`MAX_POINTS`](super::affine_form::MAX_POINTS).
    pub(super) points: Vec<Vector3<f64>>,
    /// Distance of two points that counts as none, metres.
    pub(super) tolerance: f64,
    /// Length of the arm, metres.
    pub(super) extent: f64,
    pub(super) deadline: Option<Instant>,
}

impl BoxSearch {
    /// Returns true if balls show that a target is out of reach of all configurations, without any division into boxes.
    pub(in crate::arm) fn is_far(&self, base_from_tool: &Placement<f64>) -> bool {
        let base_from_last_joint = *base_from_tool * self.chain.last_joint_from_tool.inverse();
        self.balls_exclude(&self.chain.limits, &base_from_last_joint)
    }

    /// Divides the limits into boxes, depth first, until all are excluded.
    pub(in crate::arm) fn run(
        &self,
        base_from_tool: &Placement<f64>,
        max_boxes: usize,
    ) -> BoxSearchEnd {
        self.run_within(self.chain.limits, base_from_tool, max_boxes)
    }

    /// Divides a box of joint values as [`run`](Self::run) does the limits.
    pub(super) fn run_within(
        &self,
        limits: JointBox,
        base_from_tool: &Placement<f64>,
        max_boxes: usize,
    ) -> BoxSearchEnd {
        let base_from_last_joint = *base_from_tool * self.chain.last_joint_from_tool.inverse();
        let mut boxes = 0;
        let mut stack = vec![limits];
        while let Some(mut joint_box) = stack.pop() {
            let mut narrowings = 0;
            loop {
                let is_late = boxes % BOXES_PER_CLOCK == 0
                    && self
                        .deadline
                        .is_some_and(|deadline| Instant::now() >= deadline);
                if boxes >= max_boxes || is_late {
                    return BoxSearchEnd::Stopped { boxes };
                }
                boxes += 1;
                let Some((narrowed, widest)) = self.narrow(&joint_box, &base_from_last_joint)
                else {
                    break;
                };
                narrowings += 1;
                let shrank = narrowed.volume_ratio(&joint_box) < NARROW_AGAIN;
                joint_box = narrowed;
                if shrank && narrowings < MAX_NARROWINGS {
                    continue;
                }
                let Some(joint) = widest else {
                    return BoxSearchEnd::Stopped { boxes };
                };
                stack.extend(joint_box.halves(joint));
                break;
            }
        }
        BoxSearchEnd::Empty { boxes }
    }

    fn balls_exclude(&self, joint_box: &JointBox, base_from_last_joint: &Placement<f64>) -> bool {
        let tolerance = self.tolerance_at(base_from_last_joint);
        let mut probes = self.probes.iter();
        probes.any(|probe| probe.excludes(&self.chain, joint_box, base_from_last_joint, tolerance))
    }

    /// Distance of two points that counts as none, with an allowance for rounding, metres.
    fn tolerance_at(&self, base_from_last_joint: &Placement<f64>) -> f64 {
        let distance = base_from_last_joint.translation.norm();
        self.tolerance + ROUNDING * (self.extent + distance)
    }

    /// Narrows a box to the part that may contain solutions, with the joint that makes the bounds widest, if the bounds
    /// can still improve. Returns `None` if the box is excluded.
    fn narrow(
        &self,
        joint_box: &JointBox,
        base_from_last_joint: &Placement<f64>,
    ) -> Option<(JointBox, Option<usize>)> {
        let joints = self.chain.joints.len();
        let tolerance = self.tolerance_at(base_from_last_joint);
        let is_large = joint_box
            .half_width
            .iter()
            .any(|width| *width > BALLS_ABOVE);
        if is_large && self.balls_exclude(joint_box, base_from_last_joint) {
            return None;
        }
        let (chain, cut) = (&self.chain, self.cut);
        let of_arm = AffineForm::of_arm(chain, cut, &self.points, joint_box);
        let of_target =
            AffineForm::of_target(chain, cut, &self.points, joint_box, base_from_last_joint);
        let mut difference = of_arm.minus(&of_target);
        difference.widen(tolerance);
        if chain.cell_translations > 0 && difference.is_away_along_an_axis() {
            return None;
        }
        let test = LinearTest::new(&difference, joints);
        if test.excludes() {
            return None;
        }
        let factors = test.narrowed()?;
        let mut narrowed = *joint_box;
        for joint in 0..joints {
            narrowed.narrow(joint, factors.lower[joint], factors.upper[joint]);
        }
        Some((narrowed, difference.most_nonlinear()))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "tests")]
mod tests {
    use std::f64::consts::PI;

    use super::super::joint_box::JointBox;
    use super::{AxisChain, AxisPoint, BoxSearch, BoxSearchEnd, Placement, Vector3};
    use crate::simd_ik::{Chain, ChainJoint};
    use kinopt_kinematics::model::{JointKind, Limits, Model};
    use kinopt_kinematics::random::RandomStream;
    use kinopt_kinematics::spatial::rotation_exp;

    const CHAINS: u64 = 60;
    const BOXES: u64 = 300;

    /// The kinds of a prismatic and a revolute joint.
    fn kinds() -> [JointKind; 2] {
        let mut builder = Model::builder("one of each");
        let (at, axis, limits) = (
            Placement::identity(),
            Vector3::UNITS[0],
            Limits::new(0.0, 1.0),
        );
        builder.prismatic("prismatic", None, at, axis, limits);
        builder.revolute("revolute", None, at, axis, limits);
        let model = builder.build().unwrap();
        [0, 1].map(|joint| model.joints()[joint].kind)
    }

    struct Sampler(RandomStream);

    impl Sampler {
        fn between(&mut self, lower: f64, upper: f64) -> f64 {
            lower + (upper - lower) * self.0.unit()
        }

        fn vector(&mut self, size: f64) -> Vector3<f64> {
            [0.0; 3].map(|_: f64| self.between(-size, size)).into()
        }

        fn placement(&mut self) -> Placement<f64> {
            Placement::new(rotation_exp(self.vector(2.0)), self.vector(0.3))
        }

        /// A chain of 2 to 8 joints about random axes; one of four is prismatic.
        fn chain(&mut self) -> Chain {
            let [prismatic, revolute] = kinds();
            let joints = 2 + (7.0 * self.0.unit()) as usize;
            let joints = (0..joints).map(|_| {
                let slides = self.0.unit() < 0.25;
                let (kind, largest) = match slides {
                    true => (prismatic, 0.5),
                    false => (revolute, PI),
                };
                let lower = self.between(-largest, largest);
                ChainJoint {
                    parent_from_joint: self.placement(),
                    axis: self.vector(1.0) + Vector3::new(0.0, 0.0, 1.5),
                    kind,
                    lower,
                    upper: self.between(lower, largest),
                }
            });
            let joints = joints.collect();
            let tool = self.placement();
            Chain::new(joints, tool).unwrap()
        }

        /// A box around a configuration, from wide to narrow, with the configuration often at its side.
        fn around(&mut self, q: &[f64]) -> JointBox {
            let scale = 10.0_f64.powf(self.between(-3.0, 0.3));
            let mut joint_box = JointBox::default();
            for (joint, value) in q.iter().enumerate() {
                let half_width = scale * self.0.unit();
                let position = self.between(-1.4, 1.4).clamp(-1.0, 1.0);
                joint_box.half_width[joint] = half_width;
                joint_box.centre[joint] = value - position * half_width;
            }
            joint_box
        }
    }

    fn search(chain: &Chain, cut: usize) -> BoxSearch {
        let chain = AxisChain::new(chain).unwrap();
        BoxSearch {
            probes: AxisPoint::on_axes(&chain),
            chain,
            cut,
            points: vec![
                Vector3::zero(),
                Vector3::new(0.2, 0.0, 0.0),
                Vector3::new(0.0, 0.2, 0.0),
                Vector3::new(0.0, 0.0, 0.2),
            ],
            tolerance: 0.0,
            extent: 1.0,
            deadline: None,
        }
    }

    #[test]
    fn box_keeps_configurations_that_reach_the_target() {
        let mut narrower = 0;
        for case in 0..CHAINS {
            let mut sampler = Sampler(RandomStream::new(5, case));
            let chain = sampler.chain();
            let joints = chain.joints().len();
            for _ in 0..BOXES {
                let search = search(&chain, (joints as f64 * sampler.0.unit()) as usize);
                let q: Vec<f64> = (0..joints).map(|_| sampler.between(-PI, PI)).collect();
                let base_from_tool = chain.base_from_tip(&q).unwrap();
                let base_from_last = base_from_tool * search.chain.last_joint_from_tool.inverse();
                let joint_box = sampler.around(&q);
                let (narrowed, _) = search.narrow(&joint_box, &base_from_last).unwrap();
                for (joint, value) in q.iter().enumerate() {
                    let distance = (value - narrowed.centre[joint]).abs();
                    assert!(distance <= narrowed.half_width[joint] + 1e-9);
                }
                narrower += u64::from(narrowed.volume_ratio(&joint_box) < 0.5);
            }
        }
        assert!(narrower > CHAINS * BOXES / 10, "{narrower}");
    }

    #[test]
    fn reachable_targets_are_never_excluded() {
        for case in 0..CHAINS {
            let mut sampler = Sampler(RandomStream::new(6, case));
            let chain = sampler.chain();
            let limits: Vec<(f64, f64)> = chain
                .joints()
                .iter()
                .map(|joint| (joint.lower, joint.upper))
                .collect();
            let q: Vec<f64> = limits
                .iter()
                .map(|&(lower, upper)| sampler.between(lower, upper))
                .collect();
            let target = chain.base_from_tip(&q).unwrap();
            let end = search(&chain, q.len() / 2 + 1).run(&target, 2_000);
            assert!(matches!(end, BoxSearchEnd::Stopped { .. }), "chain {case}");
        }
    }
}
