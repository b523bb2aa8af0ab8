//! Worlds: named obstacles, each a shape with a place.

mod add;
mod error;
mod file;
mod ground_height;
mod json;
mod moveit;
mod moveit_allowed;
mod moveit_frames;
mod names;
mod numbered;
mod pose;
mod scaled;
mod touch;

use std::collections::BTreeSet;
use std::sync::Arc;

pub use error::WorldError;
pub(crate) use numbered::Change;

use self::names::Names;
use self::numbered::Numbered;
use super::shape::{LARGEST, Shape};
use crate::spatial::Placement;

/// An obstacle of a [`World`].
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Obstacle {
    /// Its name, of which there is one in a world.
    pub name: String,
    /// What it is.
    pub shape: Shape,
    /// Where it stands: in the world, or in the frame that it is attached to.
    pub placement: Placement<f64>,
    /// The frame of the robot that it moves with, as something grasped does.
    pub attached: Option<String>,
    /// The links of the robot, and the obstacles, that it may touch ([`World::allow_touch`]).
    pub may_touch: Vec<String>,
}

impl Obstacle {
    /// An obstacle by itself, in the world or attached to a frame.
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
            may_touch: Vec::new(),
        }
    }
}

/// Named obstacles in the order in which they were added. Cheap to clone: copies share what neither changes, so that what is made of one
/// is made of the other for what is different.
#[derive(Clone, Debug, Default)]
pub struct World {
    obstacles: Numbered,
    names: Names,
    /// The numbers of those that are attached to frames, in order.
    attached: Vec<u64>,
    /// The numbers of those that may touch something, in order.
    touching: Vec<u64>,
    /// The next number.
    next: u64,
    revision: u64,
    /// What of its file was not taken.
    notes: Vec<String>,
    /// Names of what obstacles may touch that need not be there, as a planning scene has them.
    may_be_missing: BTreeSet<String>,
}

impl World {
    /// A world without obstacles.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    getters! {
        /// How many obstacles there are.
        pub fn len(&self) -> usize = self.obstacles.len();
        /// Whether there are none.
        pub fn is_empty(&self) -> bool = self.len() == 0;
        /// A number that every change raises, so that what was made of a world knows whether it is still so.
        pub fn revision(&self) -> u64 = self.revision;
        /// All obstacles in the order in which they were added.
        pub fn obstacles(&self) -> impl ExactSizeIterator<Item = &Obstacle> = self.obstacles.iter().map(|(_, o)| &**o);
        /// All with their numbers, by which they are in order.
        pub(crate) fn numbered(&self) -> impl ExactSizeIterator<Item = (u64, &Arc<Obstacle>)> = self.obstacles.iter();
    }

    /// What is to be known of it, one text each: what the file that it was read from says and is not taken up, and what was found about the
    /// shapes of its obstacles and taken all the same ([`Shape::notes`]), as that a mesh is open and so has no inside.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let of_shapes = self.obstacles().flat_map(|obstacle| {
            let notes = obstacle.shape.notes().iter();
            notes.map(|note| format!("obstacle {:?}: {note}", obstacle.name))
        });
        self.notes.iter().cloned().chain(of_shapes).collect()
    }

    /// Those that are attached to frames, in order.
    pub(crate) fn attached(&self) -> impl Iterator<Item = &Obstacle> {
        let attached = self.attached.iter();
        attached.filter_map(|number| Some(&**self.obstacles.get(*number)?))
    }

    /// Looks an obstacle up.
    ///
    /// # Errors
    /// There is none of that name; the error lists those there are.
    pub fn obstacle(&self, name: &str) -> Result<&Obstacle, WorldError> {
        let number = self.number(name)?;
        let found = self.obstacles.get(number);
        found.map_or_else(|| Err(self.unknown(name)), |obstacle| Ok(&**obstacle))
    }

    fn find(&self, name: &str) -> Option<u64> {
        let has = |number| self.obstacles.get(number).is_some_and(|o| o.name == name);
        self.names.find(name, has)
    }

    /// The number of an obstacle, if there is one of the name.
    pub(crate) fn number_of(&self, name: &str) -> Option<u64> {
        self.find(name)
    }

    fn number(&self, name: &str) -> Result<u64, WorldError> {
        self.find(name).ok_or_else(|| self.unknown(name))
    }

    fn unknown(&self, name: &str) -> WorldError {
        WorldError::unknown(name, self.obstacles())
    }

    /// What is not the same in another world; what copies share costs nothing.
    pub(crate) fn changes<'a>(&'a self, to: &'a Self) -> Vec<Change<'a>> {
        self.obstacles.changes(&to.obstacles)
    }

    /// Puts all in another order.
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

    /// Adds one whose name is not there.
    fn push(&mut self, obstacle: Arc<Obstacle>) {
        let number = self.next;
        self.names.insert(&obstacle.name, number);
        if obstacle.attached.is_some() {
            self.attached.push(number);
        }
        if !obstacle.may_touch.is_empty() {
            self.touching.push(number);
        }
        self.obstacles.push(number, obstacle);
        self.next += 1;
        self.revision += 1;
    }

    /// Moves an obstacle; of an attached one the placement in its frame.
    ///
    /// # Errors
    /// There is none of that name, or the placement is not rigid.
    pub fn move_to(
        &mut self,
        name: &str,
        placement: impl Into<Placement<f64>>,
    ) -> Result<(), WorldError> {
        let placement = rigid(name, placement.into())?;
        self.edit(name, |obstacle| obstacle.placement = placement)
    }

    /// Takes an obstacle out, and with it what it may touch and what may touch it.
    ///
    /// # Errors
    /// There is none of that name; the error lists those there are.
    pub fn remove(&mut self, name: &str) -> Result<(), WorldError> {
        let number = self.number(name)?;
        self.names.remove(name, number);
        self.obstacles.remove(number);
        self.attached.retain(|attached| *attached != number);
        self.forget_touch_of(name, number);
        self.revision += 1;
        Ok(())
    }

    /// Makes an obstacle move with a frame of the robot, at `frame_from_object` in it. Whether the robot has the
    /// frame shows when both come together.
    ///
    /// # Errors
    /// There is no obstacle of that name, or the placement is not rigid.
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

    /// Leaves an obstacle in the world again, at `world_from_object`.
    ///
    /// # Errors
    /// There is none of that name, it is attached to nothing, or the placement is not rigid.
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
        if let Some(own) = self.obstacles.get_mut(number) {
            let own = Arc::make_mut(own);
            change(own);
            keep_number(&mut self.attached, number, own.attached.is_some());
            keep_number(&mut self.touching, number, !own.may_touch.is_empty());
        }
        self.revision += 1;
        Ok(())
    }
}

/// Keeps a number among others in order, or takes it out.
fn keep_number(numbers: &mut Vec<u64>, number: u64, keep: bool) {
    match (numbers.binary_search(&number), keep) {
        (Err(at), true) => numbers.insert(at, number),
        (Ok(at), false) => {
            numbers.remove(at);
        }
        _ => {}
    }
}

/// A placement that is rigid to the bits that files leave.
fn rigid(name: &str, placement: Placement<f64>) -> Result<Placement<f64>, WorldError> {
    match placement.check_rigid(1e-6) {
        Ok(()) if placement.translation.norm() > LARGEST => Err(WorldError::TooFar {
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
