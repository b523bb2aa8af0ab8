//! The shapes of a robot or a figure, and which of its links are kept apart.

mod bodies;
mod capsules;
#[cfg(feature = "mjcf")]
mod contacts;
mod descent;
mod error;
mod from_robot;
mod from_skin;
mod link_shapes;
mod meshes;
mod pairs;
mod pieces;
#[cfg_attr(not(feature = "mjcf"), allow(dead_code))] // MJCF files alone have planes.
mod planes;
mod sampling;
#[cfg(feature = "serde")]
mod serialised;
mod srdf;

pub(crate) use bodies::{Bodies, pairs_apart};
pub use error::CollisionModelError;
pub use from_robot::CollisionModelBuilder;
pub use meshes::MeshUse;
pub(crate) use planes::Plane;

use super::Shape;
use crate::model::{FrameId, FrameRef, Model, ParameterMap, UnknownName};
use crate::robot::Robot;
use crate::spatial::Placement;

/// A shape on a frame of a model.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CollisionObject {
    /// Its own name, or its link's and a number: `forearm_0`.
    pub name: String,
    /// The frame that carries it: a link, or a bone's tail.
    pub link: FrameId,
    /// Where it stands there.
    pub link_from_shape: Placement<f64>,
    /// What it is.
    pub shape: Shape,
}

impl CollisionObject {
    /// A shape on a link.
    pub fn new(
        name: impl Into<String>,
        link: FrameId,
        link_from_shape: impl Into<Placement<f64>>,
        shape: Shape,
    ) -> Self {
        Self {
            name: name.into(),
            link,
            link_from_shape: link_from_shape.into(),
            shape,
        }
    }
}

/// Shapes on the links of a model, and the pairs of links that must not touch.
///
/// At first all pairs of links with shapes are enabled, except those of one body (joined by fixed joints) and of
/// neighbours (joined by one moving joint). An MJCF file enables the pairs that MuJoCo
/// lets touch, and moving links are kept above the planes of its world. SRDF files
/// ([`with_srdf`](Self::with_srdf)), samples ([`with_pairs_sampled`](Self::with_pairs_sampled)) and hand
/// ([`with_ignored`](Self::with_ignored), [`with_checked`](Self::with_checked)) change that.
///
/// ```
/// use kinopt::collision::CollisionModel;
/// use kinopt::robot::Robot;
///
/// let robot = Robot::read("models/franka_panda.urdf")?;
/// let model = CollisionModel::of(&robot)?.with_pairs_sampled(100, 1)?;
/// assert!(model.is_checked("base", "hand")?);
/// assert!(!model.is_checked("link1", "link2")?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "serialised::Parts", into = "serialised::Parts")
)]
pub struct CollisionModel {
    model: Model,
    /// Followers follow in what is sampled.
    map: ParameterMap,
    objects: Vec<CollisionObject>,
    /// With objects, in the model's order.
    links: Vec<FrameId>,
    /// Sorted, the first of each before the second.
    pairs: Vec<[FrameId; 2]>,
    planes: Vec<Plane>,
    notes: Vec<String>,
}

impl CollisionModel {
    /// The collision shapes of a robot's links, meshes as their convex hulls, looked for beside the robot's file and,
    /// for `package://`, in the folders above it. [`builder`](Self::builder) has choices.
    ///
    /// # Errors
    /// A mesh that is not found or damaged, or a shape that is none.
    pub fn of(robot: &Robot) -> Result<Self, CollisionModelError> {
        Self::builder(robot).build()
    }

    /// Starts a model of a robot's shapes, with choices.
    #[must_use]
    pub fn builder(robot: &Robot) -> CollisionModelBuilder<'_> {
        CollisionModelBuilder::new(robot)
    }

    /// A model of shapes made by hand.
    ///
    /// # Errors
    /// A frame that the model does not have, a place that is not rigid, a half-space or a height field, which no
    /// link is.
    pub fn new(model: &Model, objects: Vec<CollisionObject>) -> Result<Self, CollisionModelError> {
        let map = ParameterMap::identity(model);
        Self::assemble(model, map, objects, Vec::new())
    }

    fn assemble(
        model: &Model,
        map: ParameterMap,
        objects: Vec<CollisionObject>,
        notes: Vec<String>,
    ) -> Result<Self, CollisionModelError> {
        for object in &objects {
            FrameRef::from(object.link).resolve(model)?;
            error::check(object)?;
        }
        let mut links: Vec<FrameId> = objects.iter().map(|object| object.link).collect();
        links.sort_unstable();
        links.dedup();
        let pairs = bodies::pairs_apart(model, &links);
        Ok(Self {
            model: model.clone(),
            map,
            objects,
            links,
            pairs,
            planes: Vec::new(),
            notes,
        })
    }

    getters! {
        /// The model that it is of.
        pub fn model(&self) -> &Model = &self.model;
        /// The shapes.
        pub fn objects(&self) -> &[CollisionObject] = &self.objects;
        /// The links that have shapes, in the model's order.
        pub fn links(&self) -> &[FrameId] = &self.links;
        /// The links that are kept apart: sorted, the first of each pair before the second.
        pub fn pairs(&self) -> &[[FrameId; 2]] = &self.pairs;
        /// What was left out or mended on the way here, one text each.
        pub fn notes(&self) -> &[String] = &self.notes;
    }

    /// The shapes of a link.
    pub fn objects_of(&self, link: FrameId) -> impl Iterator<Item = &CollisionObject> {
        self.objects
            .iter()
            .filter(move |object| object.link == link)
    }

    /// The name of a link.
    pub(crate) fn name_of(&self, link: FrameId) -> &str {
        &self.model.frames()[link.index()].name
    }

    /// A link with shapes.
    fn link(&self, link: FrameRef<'_>) -> Result<FrameId, UnknownName> {
        let names = self.links.iter().map(|link| self.name_of(*link));
        let unknown = |name: &str| UnknownName::new("link with collision shapes", name, names);
        let mut planes = self.planes.iter().map(|plane| plane.link);
        match link {
            FrameRef::Name(name) => {
                let mut links = self.links.iter().copied().chain(planes);
                let found = links.find(|link| self.name_of(*link) == name);
                found.ok_or_else(|| unknown(name))
            }
            FrameRef::Id(id) if self.links.contains(&id) || planes.any(|link| link == id) => Ok(id),
            FrameRef::Id(id) => {
                let frame = self.model.frames().get(id.index());
                Err(unknown(frame.map_or("?", |frame| frame.name.as_str())))
            }
        }
    }
}
