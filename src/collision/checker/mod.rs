//! Whether a robot keeps clear of a world and of itself.

mod clearance;
mod close_pairs;
mod continuous_check;
mod error;
mod keep_clear;
mod motion_bound;
mod of_robot;
mod parts;
mod placed_shapes;
mod scene_placements;
mod sliding_bound;
mod sphere_cover;
mod touches;
mod workspace;
mod workspace_pool;

use std::sync::Arc;

pub use clearance::Clearance;
pub use continuous_check::Way;
pub use error::CheckerError;
pub use keep_clear::WayChecker;
pub(crate) use parts::FIRST_PLANE;
pub use workspace::CheckerWorkspace;

use super::world::Change;
use super::{CollisionModel, ROUNDING, SphereModel, World};
use crate::kinematics::KinematicsError;
use crate::model::FrameId;
use crate::search::Collision;
use parts::{Pair, Scene};
use touches::Touches;

/// A robot's shapes among the obstacles of a world: which pairs come nearer to each other than a margin.
///
/// Its parts are the links that have shapes and the obstacles that are attached to frames. Every part is kept from every
/// obstacle that stands in the world, and from the parts that its [model](CollisionModel::pairs) keeps it apart from; an
/// attached obstacle from all parts but those that may hold it: on its own body, on those that it carries (a hand's
/// fingers), and on the one that carries it beside others (a finger's hand). What [may touch](World::allow_touch) is passed over. What is nearer by no more than a nanometre is
/// as far as it should be: shapes that exactly meet are so apart, and rounding decides nothing.
/// It never changes; changed copies share what stays.
///
/// ```
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
    /// How much farther than the margin what moves keeps off on ways, metres.
    stand_off: f64,
    scene: Arc<Scene>,
    /// Links whose spheres nearly always meet, by their places in the model.
    close_pairs: Arc<[[usize; 2]]>,
}

impl Checker {
    /// A robot by itself, with a margin of 0. Where all its shapes are spheres, they are its sphere model.
    #[must_use]
    pub fn new(model: CollisionModel) -> Self {
        let spheres = SphereModel::of_spheres(&model).map(Arc::new);
        let world = World::new();
        Self {
            // A world without obstacles fits every robot.
            scene: Arc::new(Scene::new(&model, &world).unwrap_or_default()),
            model: Arc::new(model),
            spheres,
            world,
            margin: 0.0,
            stand_off: 0.0,
            close_pairs: Arc::default(),
        }
    }

    /// The same with spheres that cover the robot's shapes, by which [arms](crate::Arm) check eight configurations at once,
    /// and which tell most pairs of links apart before their shapes are looked at. Those of a model that leaves [gaps](SphereModel::gap)
    /// are grown by them.
    #[must_use]
    pub fn with_spheres(mut self, spheres: SphereModel) -> Self {
        let spheres = spheres.grown_to_cover();
        let scene = Arc::unwrap_or_clone(self.scene);
        self.scene = Arc::new(scene.covered_by(&spheres));
        let mut checker = self.with_close_pairs_found(&spheres);
        checker.spheres = Some(Arc::new(spheres));
        checker
    }

    /// The same robot in another world, as that stands now. Where that is a changed copy of the one before, what did not change is shared: it takes
    /// as long as what did.
    ///
    /// # Errors
    /// An obstacle that is attached to a frame that the robot does not have, or that may touch what is not there; the error lists the
    /// valid names.
    pub fn with_world(mut self, world: &World) -> Result<Self, CheckerError> {
        let changes = self.world.changes(world);
        let mut scene = self.scene.changed(&changes);
        let touching = [&self.world, world].map(|world| world.touching().next().is_some());
        let of_touch = touching != [false; 2] && changes.iter().any(Change::is_of_names);
        if of_touch || changes.iter().any(Change::is_of_attached) {
            scene = scene.with_attached(&self.model, world)?;
            if let Some(spheres) = &self.spheres {
                scene = scene.covered_by(spheres);
            }
        }
        self.scene = Arc::new(scene);
        self.world = world.clone();
        Ok(self)
    }

    /// The same with another margin: how far all pairs are to be apart at least, metres.
    ///
    /// # Errors
    /// A number that is negative or not finite.
    pub fn with_margin(mut self, metres: f64) -> Result<Self, CheckerError> {
        crate::bad_option::BadOption::check("margin", metres, crate::bad_option::NOT_NEGATIVE)?;
        self.margin = metres;
        Ok(self)
    }

    getters! {
        /// The robot's shapes.
        pub fn model(&self) -> &CollisionModel = &self.model;
        /// The spheres that cover them, where there are any.
        pub fn spheres(&self) -> Option<&SphereModel> = self.spheres.as_deref();
        /// The world, as it stood when it was given.
        pub fn world(&self) -> &World = &self.world;
        /// How far all pairs are to be apart at least, metres.
        pub fn margin(&self) -> f64 = self.margin;
    }

    /// The pairs that are nearer to each other than the margin at a configuration of the model, the deepest first, by the exact
    /// distances of shapes.
    ///
    /// # Errors
    /// A configuration of the wrong length, or one that is not finite.
    pub fn collisions(&self, q: &[f64]) -> Result<Vec<Collision>, KinematicsError> {
        self.collisions_with(&mut self.workspace(), q)
    }

    /// As [`collisions`](Self::collisions), with a workspace that is used again.
    ///
    /// # Errors
    /// As there.
    pub fn collisions_with(
        &self,
        workspace: &mut CheckerWorkspace,
        q: &[f64],
    ) -> Result<Vec<Collision>, KinematicsError> {
        let (placements, room) = workspace.place(self, q)?;
        let mut found = Vec::new();
        self.scene
            .visit(placements, self.margin, room, |pair, separation| {
                if separation.distance < self.least() {
                    found.push(self.collision(pair, separation.distance));
                }
                true
            });
        found.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        Ok(found)
    }

    /// Whether all pairs are at least the margin apart.
    ///
    /// # Errors
    /// As [`collisions`](Self::collisions).
    pub fn is_free(
        &self,
        workspace: &mut CheckerWorkspace,
        q: &[f64],
    ) -> Result<bool, KinematicsError> {
        let (placements, room) = workspace.place(self, q)?;
        let mut free = true;
        self.scene
            .visit(placements, self.margin, room, |_, separation| {
                free &= separation.distance >= self.least();
                free
            });
        Ok(free)
    }

    /// The nearest two things and how far they are apart, if that is at most `within` metres.
    ///
    /// # Errors
    /// As [`collisions`](Self::collisions).
    pub fn nearest(
        &self,
        workspace: &mut CheckerWorkspace,
        q: &[f64],
        within: f64,
    ) -> Result<Option<Collision>, KinematicsError> {
        let (placements, room) = workspace.place(self, q)?;
        let mut nearest: Option<(Pair, f64)> = None;
        self.scene
            .visit(placements, within, room, |pair, separation| {
                if nearest.is_none_or(|(_, known)| separation.distance < known) {
                    nearest = Some((pair, separation.distance));
                }
                true
            });
        Ok(nearest.map(|(pair, distance)| self.collision(pair, distance)))
    }

    /// The numbers of what stands that a link may touch, in order: planes of the model, and obstacles of the world.
    pub(crate) fn passes_of(&self, link: FrameId) -> Vec<u64> {
        match self.model.links().binary_search(&link) {
            Ok(part) => self.scene.passes(part).to_vec(),
            // Of a link without shapes, which has spheres alone.
            Err(_) => Touches::passes_of(&self.model, &self.world, link),
        }
    }

    /// The same, but what moves on a way keeps off by so many metres more than the margin, so that what stops there can leave.
    pub(crate) fn with_stand_off(mut self, metres: f64) -> Self {
        self.stand_off = metres;
        self
    }

    /// What is at least so far apart keeps the margin, metres.
    fn least(&self) -> f64 {
        self.margin - ROUNDING
    }

    fn collision(&self, pair: Pair, distance: f64) -> Collision {
        let [(first, first_kind), (second, second_kind)] = self.scene.bodies(pair);
        Collision::new(first, second, distance).between(first_kind, second_kind)
    }

    /// Memory for checks, one at a time.
    #[must_use]
    pub fn workspace(&self) -> CheckerWorkspace {
        CheckerWorkspace::new(self)
    }
}
