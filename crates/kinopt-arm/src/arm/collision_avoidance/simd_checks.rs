//! Spheres and solids of an arm for SIMD checks.

use std::sync::Arc;

use crate::simd_ik::Chain;
use crate::simd_spheres::{BodyChain, ChainBody, Passed, SolidMoved, Solids};
use kinopt_collision::collision::{Checker, FIRST_PLANE, SphereModel};
use kinopt_kinematics::model::{FrameId, JointId, Model};
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::search::{BodyKind, Collision};

/// Additional margin of the SIMD checks, metres: they round placements differently from the exact check.
const SLACK: f64 = 1e-9;

/// Spheres and solids for SIMD checks, in the base frame.
#[derive(Debug)]
pub(super) struct SimdChecks {
    pub(super) bodies: Arc<BodyChain>,
    pub(super) solids: Solids,
    pub(super) base_from_world: Placement<f64>,
}

/// Joints and base of the arm in the checker's model.
pub(super) struct ArmJoints<'a> {
    pub(super) model: &'a Model,
    pub(super) joints: &'a [JointId],
    pub(super) base: Option<FrameId>,
}

impl ArmJoints<'_> {
    /// Joints of the arm above a frame.
    fn above(&self, frame: Option<FrameId>) -> Vec<JointId> {
        let mut above = Vec::new();
        let mut joint = frame.and_then(|frame| self.model.frames()[frame.index()].joint);
        while let Some(id) = joint {
            above.extend(self.joints.contains(&id).then_some(id));
            joint = self.model.joints()[id.index()].parent;
        }
        above
    }

    /// Number of the arm's joints between its base and a frame.
    pub(super) fn joints_to(&self, frame: Option<FrameId>) -> usize {
        let (a, b) = (self.above(self.base), self.above(frame));
        let only_in = |a: &[JointId], b: &[JointId]| a.iter().filter(|id| !b.contains(id)).count();
        only_in(&a, &b) + only_in(&b, &a)
    }

    /// Returns true if no joint of the arm moves the two bodies relative to each other.
    pub(super) fn is_fixed(&self, pair: &Collision, checker: &Checker) -> bool {
        let joints_to = |name: &str, kind: BodyKind| match kind {
            BodyKind::Link => self.joints_to(self.model.frame(name).ok()),
            BodyKind::Obstacle => {
                let obstacle = checker.world().obstacle(name).ok();
                let frame = obstacle.and_then(|obstacle| obstacle.attached.as_deref());
                self.joints_to(frame.and_then(|name| self.model.frame(name).ok()))
            }
        };
        joints_to(&pair.first, pair.first_kind) == joints_to(&pair.second, pair.second_kind)
    }
}

impl SimdChecks {
    /// Returns `None` if the arm moves the world relative to its base, carries an obstacle, or has a link without
    /// spheres.
    pub(super) fn new(
        chain: &Chain,
        q: &[f64],
        placements: &[Placement<f64>],
        arm_joints: &ArmJoints<'_>,
        checker: &Checker,
        spheres: &SphereModel,
    ) -> Option<Self> {
        if arm_joints.joints_to(None) > 0 || checker.world().attached().next().is_some() {
            return None;
        }
        let base_from_world = match arm_joints.base {
            Some(base) => placements[base.index()].inverse(),
            None => Placement::identity(),
        };
        let bodies = spheres.groups().iter().map(|group| {
            let body = ChainBody {
                joints: arm_joints.joints_to(Some(group.link)),
                bound: group.bound,
                spheres: group.spheres.clone(),
            };
            (body, base_from_world * placements[group.link.index()])
        });
        let bodies: Vec<_> = bodies.collect();
        // Pairs that no joint of the arm moves are checked once, by their shapes.
        let is_movable = |pair: &[usize; 2]| bodies[pair[0]].0.joints != bodies[pair[1]].0.joints;
        // Use the checker's pairs and links: the spheres may be older.
        let model = checker.model();
        let close = checker.close_pairs();
        let close = |pair: &&[FrameId; 2]| close.contains(&pair.map(|link| model.place_of(link)));
        let group_index = |link: &FrameId| spheres.groups().iter().position(|g| g.link == *link);
        if !model.links().iter().all(|link| group_index(link).is_some()) {
            return None;
        }
        let pairs = model.pairs().iter().filter(|pair| !close(pair));
        let pairs = pairs.filter_map(|[a, b]| Some([group_index(a)?, group_index(b)?]));
        let pairs = pairs.filter(is_movable).collect();
        let planes = checker.model().planes().iter().map(|plane| &plane.obstacle);
        let solids = checker.world().numbered();
        let solids = solids.chain((FIRST_PLANE..).zip(planes));
        let solids = solids.map(|(number, o)| (number, &o.shape, base_from_world * o.placement));
        let bodies = BodyChain::new(chain, q, bodies, pairs);
        Some(Self {
            solids: Solids::new(
                solids,
                &bodies,
                allowed_collisions(spheres, checker),
                checker.margin() + SLACK,
            ),
            bodies: Arc::new(bodies),
            base_from_world,
        })
    }

    /// The same in another world; `None` if the arm carries an obstacle there, or all solids must be rebuilt.
    pub(super) fn in_world(&self, before: &Checker, after: &Checker) -> Option<Self> {
        if after.world().attached().next().is_some() {
            return None;
        }
        let allowed_collisions = allowed_collisions(after.spheres()?, after);
        let changes = before.world().changes(after.world());
        let moved = changes.iter().map(|change| SolidMoved {
            number: change.number,
            before: change.before.map(|obstacle| &obstacle.shape),
            after: (change.after).map(|o| (&o.shape, self.base_from_world * o.placement)),
        });
        let moved: Vec<SolidMoved<'_>> = moved.collect();
        Some(Self {
            solids: self
                .solids
                .changed(&moved, &self.bodies, &allowed_collisions)?,
            bodies: Arc::clone(&self.bodies),
            base_from_world: self.base_from_world,
        })
    }
}

/// Allowed collisions of the bodies of a sphere model.
fn allowed_collisions(spheres: &SphereModel, checker: &Checker) -> Passed {
    let groups = spheres.groups().iter();
    Passed::new(groups.map(|group| checker.passes_of(group.link)))
}
