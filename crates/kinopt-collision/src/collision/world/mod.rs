//! Worlds of named obstacles, each with a shape and a placement.

mod add;
mod allowed_collisions;
mod error;
mod file;
mod height_at;
mod json;
mod moveit;
mod moveit_allowed;
mod moveit_frames;
mod names;
mod numbered;
mod pose;
mod scaled;

use std::collections::BTreeSet;
use std::sync::Arc;

pub use error::WorldError;
pub(crate) use numbered::Change;

use self::names::NameTable;
use self::numbered::Numbered;
use super::shape::{MAX_LENGTH, Shape};
use kinopt_kinematics::spatial::Placement;

/// An obstacle of a [`World`].
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Obstacle {
    /// Name, unique in its world.
    pub name: String,
    /// Shape.
    pub shape: Shape,
    /// Placement in the world, or in the frame that the obstacle is attached to.
    pub placement: Placement<f64>,
    /// Frame of the robot that the obstacle moves with, for instance a grasped object; `None` for a fixed obstacle.
    pub attached: Option<String>,
    /// Names of the links and obstacles that it is allowed to collide with ([`World::allow_collision`]).
    pub allowed_collisions: Vec<String>,
}

impl Obstacle {
    /// An obstacle that is fixed in the world, or attached to a frame.
    #[must_use]
    pub fn new(
        name: impl Into<String>,
        shape: Shape,
        placement: impl Into<Placement<f64>>,
        attached: Option<String>,
    ) -> Self {
        Self {
            name: name.into(),
            shape,
            placement: placement.into(),
            attached,
            allowed_collisions: Vec::new(),
        }
    }
}

/// Named obstacles in the order in which they were added.
///
/// Cheap to clone: copies share all data that neither of them changes. A checker of a changed copy rebuilds only the
/// changed data.
#[derive(Clone, Debug, Default)]
pub struct World {
    obstacles: Numbered,
    names: NameTable,
    /// Sorted numbers of the obstacles that are attached to frames.
    attached: Vec<u64>,
    /// Sorted numbers of the obstacles with allowed collisions.
    with_allowed_collisions: Vec<u64>,
    /// Number of the next obstacle.
    next: u64,
    revision: u64,
    /// Messages about parts of the file that were left out.
    notes: Vec<String>,
    /// Names in allowed collisions that need not exist, as in MoveIt's planning scenes.
    may_be_missing: BTreeSet<String>,
}

impl World {
    /// An empty world.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of obstacles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.obstacles.len()
    }

    /// True if the world has no obstacles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A number that every change increases, for detecting changes.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// All obstacles, in the order in which they were added.
    #[must_use]
    pub fn obstacles(&self) -> impl ExactSizeIterator<Item = &Obstacle> {
        self.obstacles.iter().map(|(_, o)| &**o)
    }

    /// All obstacles with their numbers, in increasing order of the numbers.
    #[must_use]
    #[doc(hidden)]
    pub fn numbered(&self) -> impl ExactSizeIterator<Item = (u64, &Arc<Obstacle>)> {
        self.obstacles.iter()
    }

    /// Messages about the world: parts of its file that were left out, and the [notes](Shape::notes) of its shapes.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let of_shapes = self.obstacles().flat_map(|obstacle| {
            let notes = obstacle.shape.notes().iter();
            notes.map(|note| format!("obstacle {:?}: {note}", obstacle.name))
        });
        self.notes.iter().cloned().chain(of_shapes).collect()
    }

    /// Attached obstacles, in the order of their numbers.
    #[doc(hidden)]
    pub fn attached(&self) -> impl Iterator<Item = &Obstacle> {
        let attached = self.attached.iter();
        attached.filter_map(|number| Some(&**self.obstacles.get(*number)?))
    }

    /// The obstacle of a name.
    ///
    /// # Errors
    /// Returns an error if there is no obstacle of that name. The error lists the names of obstacles.
    pub fn obstacle(&self, name: &str) -> Result<&Obstacle, WorldError> {
        let number = self.number(name)?;
        let obstacle = self.obstacles.get(number);
        obstacle.map_or_else(|| Err(self.unknown(name)), |obstacle| Ok(&**obstacle))
    }

    fn find(&self, name: &str) -> Option<u64> {
        let has = |number| self.obstacles.get(number).is_some_and(|o| o.name == name);
        self.names.find(name, has)
    }

    /// The number of an obstacle, or `None` if the name is unknown.
    pub(crate) fn number_of(&self, name: &str) -> Option<u64> {
        self.find(name)
    }

    fn number(&self, name: &str) -> Result<u64, WorldError> {
        self.find(name).ok_or_else(|| self.unknown(name))
    }

    fn unknown(&self, name: &str) -> WorldError {
        WorldError::unknown(name, self.obstacles())
    }

    /// Differences to another world. Chunks that both share are skipped.
    #[doc(hidden)]
    pub fn changes<'a>(&'a self, to: &'a Self) -> Vec<Change<'a>> {
        self.obstacles.changes(&to.obstacles)
    }

    /// Reorders all obstacles, which get new numbers.
    fn sort_by_key<K: Ord>(&mut self, key: impl Fn(&Obstacle) -> K) {
        let mut all: Vec<Arc<Obstacle>> =
            self.obstacles.iter().map(|(_, o)| Arc::clone(o)).collect();
        all.sort_by_key(|obstacle| key(obstacle));
        let revision = self.revision;
        let notes = std::mem::take(&mut self.notes);
        let may_be_missing = std::mem::take(&mut self.may_be_missing);
        *self = Self {
            notes,
            may_be_missing,
            ..Self::default()
        };
        for obstacle in all {
            self.push(obstacle);
        }
        self.revision = revision;
    }

    /// Adds an obstacle. Its name must be new.
    fn push(&mut self, obstacle: Arc<Obstacle>) {
        let number = self.next;
        self.names.insert(&obstacle.name, number);
        if obstacle.attached.is_some() {
            self.attached.push(number);
        }
        if !obstacle.allowed_collisions.is_empty() {
            self.with_allowed_collisions.push(number);
        }
        self.obstacles.push(number, obstacle);
        self.next += 1;
        self.revision += 1;
    }

    /// Sets the placement of an obstacle, for an attached one in its frame.
    ///
    /// # Errors
    /// Returns an error if there is no obstacle of that name, or if the placement is not rigid or farther than 10⁹ m.
    pub fn move_to(
        &mut self,
        name: &str,
        placement: impl Into<Placement<f64>>,
    ) -> Result<(), WorldError> {
        let placement = rigid(name, placement.into())?;
        self.edit(name, |obstacle| obstacle.placement = placement)
    }

    /// Removes an obstacle, together with its allowed collisions.
    ///
    /// # Errors
    /// Returns an error if there is no obstacle of that name. The error lists the names of obstacles.
    pub fn remove(&mut self, name: &str) -> Result<(), WorldError> {
        let number = self.number(name)?;
        self.names.remove(name, number);
        self.obstacles.remove(number);
        self.attached.retain(|attached| *attached != number);
        self.remove_allowed_collisions_of(name, number);
        self.revision += 1;
        Ok(())
    }

    /// Attaches an obstacle to a frame of the robot, with its placement in that frame.
    ///
    /// A [`Checker`](crate::collision::Checker) reports a frame that the robot does not have.
    ///
    /// # Errors
    /// Returns an error if there is no obstacle of that name, or if the placement is not rigid or farther than 10⁹ m.
    pub fn attach(
        &mut self,
        name: &str,
        frame: &str,
        frame_from_object: impl Into<Placement<f64>>,
    ) -> Result<(), WorldError> {
        let placement = rigid(name, frame_from_object.into())?;
        self.edit(name, |obstacle| {
            obstacle.attached = Some(frame.to_owned());
            obstacle.placement = placement;
        })
    }

    /// Detaches an obstacle and fixes it in the world, at `world_from_object`.
    ///
    /// # Errors
    /// Returns an error if there is no obstacle of that name, or if it is not attached. Returns an error if the
    /// placement is not rigid or farther than 10⁹ m.
    pub fn detach(
        &mut self,
        name: &str,
        world_from_object: impl Into<Placement<f64>>,
    ) -> Result<(), WorldError> {
        if self.obstacle(name)?.attached.is_none() {
            return Err(WorldError::NotAttached(name.to_owned()));
        }
        let placement = rigid(name, world_from_object.into())?;
        self.edit(name, |obstacle| {
            obstacle.attached = None;
            obstacle.placement = placement;
        })
    }

    fn edit(&mut self, name: &str, change: impl FnOnce(&mut Obstacle)) -> Result<(), WorldError> {
        let number = self.number(name)?;
        if let Some(obstacle) = self.obstacles.get_mut(number) {
            let obstacle = Arc::make_mut(obstacle);
            change(obstacle);
            set_contained(&mut self.attached, number, obstacle.attached.is_some());
            set_contained(
                &mut self.with_allowed_collisions,
                number,
                !obstacle.allowed_collisions.is_empty(),
            );
        }
        self.revision += 1;
        Ok(())
    }
}

/// Inserts a number into a sorted list, or removes it.
fn set_contained(numbers: &mut Vec<u64>, number: u64, is_contained: bool) {
    match (numbers.binary_search(&number), is_contained) {
        (Err(index), true) => numbers.insert(index, number),
        (Ok(index), false) => {
            numbers.remove(index);
        }
        _ => {}
    }
}

/// The placement, made exactly rigid. Deviations up to 1e-6, as from rounding in files, are accepted.
fn rigid(name: &str, placement: Placement<f64>) -> Result<Placement<f64>, WorldError> {
    match placement.check_rigid(1e-6) {
        Ok(()) if placement.translation.norm() > MAX_LENGTH => Err(WorldError::TooFar {
            name: name.to_owned(),
            metres: placement.translation.norm(),
        }),
        Ok(()) => Ok(placement.made_rigid()),
        Err(defect) => Err(WorldError::Placement {
            name: name.to_owned(),
            defect,
        }),
    }
}
