//! Collision shapes of a robot or character, and the enabled collision pairs of its links.

mod bodies;
mod capsules;
#[cfg(feature = "mjcf")]
mod contacts;
mod descent;
mod error;
mod from_robot;
mod link_shapes;
mod meshes;
mod pairs;
mod pieces;
#[cfg_attr(not(feature = "mjcf"), allow(dead_code))] // Only MJCF files have planes.
mod planes;
mod sampling;
#[cfg(feature = "serde")]
mod serialised;
mod srdf;

pub(crate) use bodies::{Bodies, unconnected_pairs};
pub use error::CollisionModelError;
pub use from_robot::CollisionModelBuilder;
pub use meshes::MeshUse;
pub(crate) use planes::LinkHalfSpace;

use super::Shape;
use kinopt_kinematics::model::{FrameId, FrameRef, Model, ParameterMap, UnknownName};
use kinopt_kinematics::spatial::Placement;
use kinopt_robot::robot::Robot;

/// A collision shape on a frame of a model.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CollisionObject {
    /// Name of the shape, or the link's name and a number, as in `forearm_0`.
    pub name: String,
    /// Frame that carries the shape: a link, or the tail of a bone.
    pub link: FrameId,
    /// Placement of the shape in the frame of the link.
    pub link_from_shape: Placement<f64>,
    /// Shape.
    pub shape: Shape,
}

impl CollisionObject {
    /// A shape on a link, with its placement in the link's frame.
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

/// Collision shapes on the links of a model, and the enabled collision pairs.
///
/// Initially all pairs of links with shapes are enabled. Exceptions are links of one body (joined by fixed joints) and
/// of adjacent bodies (joined by one moving joint). An MJCF file instead enables the pairs that MuJoCo checks, and
/// moving links must stay above the planes of its world. These methods change the pairs:
/// [`with_srdf`](Self::with_srdf), [`with_pairs_sampled`](Self::with_pairs_sampled),
/// [`with_ignored`](Self::with_ignored) and [`with_checked`](Self::with_checked).
///
/// ```
/// # std::env::set_current_dir("../..")?;
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
    serde(
        try_from = "serialised::CollisionModelDocument",
        into = "serialised::CollisionModelDocument"
    )
)]
pub struct CollisionModel {
    model: Model,
    /// Maps variables to configurations: sampled configurations satisfy the mimic joints.
    map: ParameterMap,
    objects: Vec<CollisionObject>,
    /// Links with objects, in the order of the model.
    links: Vec<FrameId>,
    /// Sorted; in each pair the lower index first.
    pairs: Vec<[FrameId; 2]>,
    planes: Vec<LinkHalfSpace>,
    notes: Vec<String>,
}

impl CollisionModel {
    /// The collision shapes of a robot's links, with meshes as their convex hulls.
    ///
    /// Mesh files are searched next to the robot's file, and for `package://` also in the folders above it.
    /// [`builder`](Self::builder) offers options.
    ///
    /// # Errors
    /// Returns an error if a mesh is missing or malformed, or if a shape is invalid.
    pub fn of(robot: &Robot) -> Result<Self, CollisionModelError> {
        Self::builder(robot).build()
    }

    /// Returns a builder for the collision model of a robot.
    #[must_use]
    pub fn builder(robot: &Robot) -> CollisionModelBuilder<'_> {
        CollisionModelBuilder::new(robot)
    }

    /// A model from given shapes.
    ///
    /// # Errors
    /// Returns an error if a frame does not belong to the model, or if a shape is a half-space or a height field.
    /// Returns an error if a placement is not rigid or is farther than 10⁹ m from its link.
    pub fn new(model: &Model, objects: Vec<CollisionObject>) -> Result<Self, CollisionModelError> {
        let map = ParameterMap::identity(model);
        Self::assemble(model, map, objects, Vec::new())
    }

    #[doc(hidden)] // Also used for skins.
    pub fn assemble(
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
        let pairs = bodies::unconnected_pairs(model, &links);
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

    /// The kinematic model.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Collision shapes of all links.
    #[must_use]
    pub fn objects(&self) -> &[CollisionObject] {
        &self.objects
    }

    /// Links with shapes, in the order of the model.
    #[must_use]
    pub fn links(&self) -> &[FrameId] {
        &self.links
    }

    /// Enabled collision pairs, sorted; in each pair the lower index first.
    #[must_use]
    pub fn pairs(&self) -> &[[FrameId; 2]] {
        &self.pairs
    }

    /// Messages about shapes that were left out or repaired.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The shapes of a link.
    pub fn objects_of(&self, link: FrameId) -> impl Iterator<Item = &CollisionObject> {
        self.objects
            .iter()
            .filter(move |object| object.link == link)
    }

    pub(crate) fn name_of(&self, link: FrameId) -> &str {
        &self.model.frames()[link.index()].name
    }

    /// Finds a link with shapes or planes.
    fn link(&self, link: FrameRef<'_>) -> Result<FrameId, UnknownName> {
        let names = self.links.iter().map(|link| self.name_of(*link));
        let unknown = |name: &str| UnknownName::new("link with collision shapes", name, names);
        let mut planes = self.planes.iter().map(|plane| plane.link);
        match link {
            FrameRef::Name(name) => {
                let mut links = self.links.iter().copied().chain(planes);
                let named_link = links.find(|link| self.name_of(*link) == name);
                named_link.ok_or_else(|| unknown(name))
            }
            FrameRef::Id(id) if self.links.contains(&id) || planes.any(|link| link == id) => Ok(id),
            FrameRef::Id(id) => {
                let frame = self.model.frames().get(id.index());
                Err(unknown(frame.map_or("?", |frame| frame.name.as_str())))
            }
        }
    }
}
