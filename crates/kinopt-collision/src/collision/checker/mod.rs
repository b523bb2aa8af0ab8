//! Collision checker of a robot against a world and itself.

mod allowed_collisions;
mod clearance;
mod close_pairs;
mod continuous_check;
mod motion_bound;
mod motion_checker;
mod of_robot;
mod parts;
mod placed_shapes;
mod scene_placements;
mod sliding_bound;
mod sphere_cover;
mod workspace;
mod workspace_pool;

use std::sync::Arc;

pub use clearance::Clearance;
pub use continuous_check::MotionCheck;
pub use motion_checker::MotionChecker;
#[doc(hidden)]
pub use parts::FIRST_PLANE;
pub use workspace::CheckerWorkspace;

use super::world::Change;
use super::{CollisionModel, ROUNDING, SphereModel, World};
use crate::collision::WorldError;
use allowed_collisions::AllowedCollisions;
use kinopt_kinematics::kinematics::KinematicsError;
use kinopt_kinematics::model::FrameId;
use kinopt_solver::search::Collision;
use parts::{Pair, Scene};

/// Collision checker of a robot's shapes against the obstacles of a world and against each other.
///
/// The parts are the links with shapes and the obstacles attached to frames. These pairs are checked:
///
/// - each part and each fixed obstacle;
/// - the [enabled pairs](CollisionModel::pairs) of links;
/// - an attached obstacle and each part, except the body that holds it and the children of that body, such as the
///   fingers of a hand. The parent of that body is also excluded if it has several children, such as the hand of a
///   finger that holds the obstacle.
///
/// [Allowed collisions](World::allow_collision) are excluded. A pair counts as in contact only if its distance is more
/// than 1e-9 m below the margin, so that rounding does not decide about shapes in exact contact.
///
/// A checker is immutable. The copies that its methods return share unchanged data.
///
/// ```
/// # std::env::set_current_dir("../..")?;
/// use kinopt::collision::{Checker, World};
/// use kinopt::robot::Robot;
/// use kinopt::spatial::Vector3;
///
/// let robot = Robot::read("models/franka_panda.urdf")?;
/// let mut world = World::new();
/// world.add_box("table", [1.0, 1.0, 0.1], Vector3::new(0.6, 0.0, 0.2))?;
/// let checker = Checker::of(&robot)?.with_world(&world)?.with_margin(0.01)?;
/// let q = [0.0, 1.4, 0.0, -1.0, 0.0, 1.6, 0.8, 0.04, 0.04];
/// let collisions = checker.collisions(&q)?;
/// assert!(collisions.iter().any(|pair| pair.second == "table" && pair.depth() > 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Checker {
    model: Arc<CollisionModel>,
    spheres: Option<Arc<SphereModel>>,
    world: World,
    margin: f64,
    /// Distance added to the margin in motions, for pairs that move relative to each other, metres.
    stand_off: f64,
    scene: Arc<Scene>,
    /// Pairs of links whose sphere covers nearly always overlap, as link indices of the model.
    close_pairs: Arc<[[usize; 2]]>,
}

impl Checker {
    /// A checker of a robot without a world, with a margin of 0.
    ///
    /// If all shapes are spheres, they become the sphere model.
    #[must_use]
    pub fn new(model: CollisionModel) -> Self {
        let spheres = SphereModel::of_spheres(&model).map(Arc::new);
        let world = World::new();
        Self {
            // A world without obstacles is valid for every robot.
            scene: Arc::new(Scene::new(&model, &world).unwrap_or_default()),
            model: Arc::new(model),
            spheres,
            world,
            margin: 0.0,
            stand_off: 0.0,
            close_pairs: Arc::default(),
        }
    }

    /// The checker with spheres that cover the robot's shapes.
    ///
    /// With spheres, arms check eight configurations at once, and most pairs of links are rejected
    /// without an exact distance. If the sphere model has [gaps](SphereModel::gap), its spheres are enlarged by them.
    #[must_use]
    pub fn with_spheres(mut self, spheres: SphereModel) -> Self {
        let spheres = spheres.grown_to_cover();
        let scene = Arc::unwrap_or_clone(self.scene);
        self.scene = Arc::new(scene.covered_by(&spheres));
        let mut checker = self.with_close_pairs_found(&spheres);
        checker.spheres = Some(Arc::new(spheres));
        checker
    }

    /// The checker in another world, of which it keeps a snapshot.
    ///
    /// If `world` is a changed copy of the previous world, unchanged data is shared. The time is then proportional to
    /// the changes.
    ///
    /// # Errors
    /// Returns an error if an obstacle is attached to a frame that the robot does not have. Returns an error if an
    /// obstacle is allowed to collide with an unknown name. The error lists the valid names.
    pub fn with_world(mut self, world: &World) -> Result<Self, WorldError> {
        let changes = self.world.changes(world);
        let mut scene = self.scene.changed(&changes);
        let has_allowed_collisions =
            [&self.world, world].map(|world| world.with_allowed_collisions().next().is_some());
        let allowed_collisions_changed =
            has_allowed_collisions != [false; 2] && changes.iter().any(Change::is_of_names);
        if allowed_collisions_changed || changes.iter().any(Change::is_of_attached) {
            scene = scene.with_attached(&self.model, world)?;
            if let Some(spheres) = &self.spheres {
                scene = scene.covered_by(spheres);
            }
        }
        self.scene = Arc::new(scene);
        self.world = world.clone();
        Ok(self)
    }

    /// The checker with another margin: the required distance of all pairs, metres.
    ///
    /// # Errors
    /// Returns an error if the margin is negative or not finite.
    pub fn with_margin(mut self, metres: f64) -> Result<Self, WorldError> {
        kinopt_kinematics::bad_option::BadOption::check(
            "margin",
            metres,
            kinopt_kinematics::bad_option::NOT_NEGATIVE,
        )?;
        self.margin = metres;
        Ok(self)
    }

    /// Collision model of the robot.
    #[must_use]
    pub fn model(&self) -> &CollisionModel {
        &self.model
    }

    /// Spheres that cover the shapes, if set.
    #[must_use]
    pub fn spheres(&self) -> Option<&SphereModel> {
        self.spheres.as_deref()
    }

    /// Snapshot of the world.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Required distance of all pairs, metres.
    #[must_use]
    pub fn margin(&self) -> f64 {
        self.margin
    }

    /// The pairs nearer than the margin at a configuration, by exact distance, the smallest distance first.
    ///
    /// # Errors
    /// Returns an error if the configuration has the wrong length or is not finite.
    pub fn collisions(&self, q: &[f64]) -> Result<Vec<Collision>, KinematicsError> {
        self.collisions_with(&mut self.workspace(), q)
    }

    /// As [`collisions`](Self::collisions), with a reusable workspace.
    ///
    /// # Errors
    /// As [`collisions`](Self::collisions).
    pub fn collisions_with(
        &self,
        workspace: &mut CheckerWorkspace,
        q: &[f64],
    ) -> Result<Vec<Collision>, KinematicsError> {
        let (placements, scene_workspace) = workspace.place(self, q)?;
        let mut collisions = Vec::new();
        self.scene.visit(
            placements,
            self.margin,
            scene_workspace,
            |pair, separation| {
                if separation.distance < self.min_distance() {
                    collisions.push(self.collision(pair, separation.distance));
                }
                true
            },
        );
        collisions.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        Ok(collisions)
    }

    /// Returns true if a configuration is collision-free: no pair is nearer than the margin.
    ///
    /// # Errors
    /// As [`collisions`](Self::collisions).
    pub fn is_free(
        &self,
        workspace: &mut CheckerWorkspace,
        q: &[f64],
    ) -> Result<bool, KinematicsError> {
        let (placements, scene_workspace) = workspace.place(self, q)?;
        let mut free = true;
        self.scene
            .visit(placements, self.margin, scene_workspace, |_, separation| {
                free &= separation.distance >= self.min_distance();
                free
            });
        Ok(free)
    }

    /// The closest pair at a configuration with its distance, or `None` if it is farther apart than `max_distance`, metres.
    ///
    /// # Errors
    /// As [`collisions`](Self::collisions).
    pub fn nearest(
        &self,
        workspace: &mut CheckerWorkspace,
        q: &[f64],
        max_distance: f64,
    ) -> Result<Option<Collision>, KinematicsError> {
        let (placements, scene_workspace) = workspace.place(self, q)?;
        let mut nearest: Option<(Pair, f64)> = None;
        self.scene.visit(
            placements,
            max_distance,
            scene_workspace,
            |pair, separation| {
                if nearest.is_none_or(|(_, min_distance)| separation.distance < min_distance) {
                    nearest = Some((pair, separation.distance));
                }
                true
            },
        );
        Ok(nearest.map(|(pair, distance)| self.collision(pair, distance)))
    }

    /// Sorted numbers of the fixed solids whose collision with a link is allowed: planes of the model, and obstacles.
    #[doc(hidden)]
    pub fn passes_of(&self, link: FrameId) -> Vec<u64> {
        match self.model.links().binary_search(&link) {
            Ok(part) => self.scene.allowed_obstacles(part).to_vec(),
            // A link without shapes that has spheres only.
            Err(_) => AllowedCollisions::passes_of(&self.model, &self.world, link),
        }
    }

    /// The checker with a distance added to the margin in motions, metres.
    ///
    /// A motion that stops there can depart again.
    #[doc(hidden)]
    pub fn with_stand_off(mut self, metres: f64) -> Self {
        self.stand_off = metres;
        self
    }

    /// Smallest distance of a pair that is not in contact, metres: the margin less rounding.
    fn min_distance(&self) -> f64 {
        self.margin - ROUNDING
    }

    fn collision(&self, pair: Pair, distance: f64) -> Collision {
        let [(first, first_kind), (second, second_kind)] = self.scene.bodies(pair);
        Collision::new(first, second, distance).between(first_kind, second_kind)
    }

    /// Scratch memory for checks in one thread.
    #[must_use]
    pub fn workspace(&self) -> CheckerWorkspace {
        CheckerWorkspace::new(self)
    }
}
