//! Sphere approximation of a robot's collision shapes, for fast checks.

mod candidates;
mod cells;
mod cover;
mod enclosing;
mod gap;
mod link_cover;
mod ranked;
mod read;
mod rows;
#[cfg(feature = "serde")]
mod serialised;
mod shrink;
mod solid;
mod urdf;
mod yaml;

pub(crate) use enclosing::enclosing;

use super::{Ball, CollisionModel, ShapeKind};
use kinopt_kinematics::bad_option::{BadOption, POSITIVE};
use kinopt_kinematics::model::FrameId;

/// Spheres by link name.
type NamedSpheres = Vec<(String, Vec<Ball>)>;

/// Resolution of a sphere model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Resolution {
    /// Largest allowed [protrusion](SphereModel::max_protrusion), metres. The number of spheres is reduced as far as the
    /// search can.
    MaxProtrusion(f64),
    /// Largest number of spheres a link. The protrusion is reduced as far as the search can.
    PerLink(usize),
}

/// Spheres that together cover every shape of a [`CollisionModel`] including its inside, by link.
///
/// If no sphere is in contact, no shape is. A sphere is in contact at most [`max_protrusion`](Self::max_protrusion) metres before
/// its shape. Models that are [read](Self::read) from a file may leave [gaps](SphereGroup::gap).
///
/// ```
/// # std::env::set_current_dir("../..")?;
/// use kinopt::collision::{CollisionModel, Resolution, SphereModel};
/// use kinopt::robot::Robot;
///
/// let robot = Robot::read("models/universal_ur5e.urdf")?;
/// let model = CollisionModel::of(&robot)?;
/// let spheres = SphereModel::of(&model, Resolution::MaxProtrusion(0.02))?;
/// assert!(spheres.max_protrusion() <= 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        try_from = "serialised::SphereModelDocument",
        into = "serialised::SphereModelDocument"
    )
)]
pub struct SphereModel {
    groups: Vec<SphereGroup>,
    pairs: Vec<[usize; 2]>,
    max_protrusion: f64,
    notes: Vec<String>,
}

/// Spheres of one link.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SphereGroup {
    /// Link.
    pub link: FrameId,
    /// Name of the link.
    pub name: String,
    /// Bounding sphere of all spheres, in the link's frame, metres.
    pub bound: Ball,
    /// Spheres in the link's frame, metres.
    pub spheres: Vec<Ball>,
    /// Upper bound of the distance from a point of the link's shapes to the union of the spheres, metres.
    ///
    /// It is 0 if the spheres cover the shapes. Models read from a file may have positive gaps.
    pub gap: f64,
}

impl SphereGroup {
    fn new(link: FrameId, name: &str, spheres: Vec<Ball>) -> Self {
        Self {
            link,
            name: name.to_owned(),
            bound: enclosing(&spheres),
            spheres,
            gap: 0.0,
        }
    }

    /// The group with the given gap, metres.
    fn with_gap(self, gap: f64) -> Self {
        Self { gap, ..self }
    }
}

impl SphereModel {
    /// Covers the shapes of a model. Links made of spheres keep those.
    ///
    /// The cover includes the inside of convex shapes and closed meshes, and the surface of open meshes.
    ///
    /// # Errors
    /// Returns an error if the protrusion or the number of spheres is not positive. Returns an error if the protrusion
    /// is so small that a link would need millions of cells.
    pub fn of(model: &CollisionModel, resolution: Resolution) -> Result<Self, BadOption> {
        let value = match resolution {
            Resolution::MaxProtrusion(max_protrusion) => max_protrusion,
            Resolution::PerLink(count) => count as f64,
        };
        BadOption::check(resolution.name(), value, POSITIVE)?;
        let mut groups = Vec::with_capacity(model.links().len());
        let mut max_protrusion: f64 = 0.0;
        for &link in model.links() {
            let objects: Vec<_> = model.objects_of(link).collect();
            let (spheres, protrusion) = link_cover::cover(&objects, resolution)?;
            max_protrusion = max_protrusion.max(protrusion);
            groups.push(SphereGroup::new(link, model.name_of(link), spheres));
        }
        Ok(Self::assemble(model, groups, max_protrusion))
    }

    /// The spheres of a model whose shapes are all spheres; `None` if any shape is not a sphere.
    #[must_use]
    pub fn of_spheres(model: &CollisionModel) -> Option<Self> {
        let group = |link: &FrameId| {
            let sphere = model
                .objects_of(*link)
                .map(|object| match object.shape.kind() {
                    ShapeKind::Sphere { radius } => Some(Ball {
                        centre: object.link_from_shape.translation,
                        radius: *radius,
                    }),
                    _ => None,
                });
            let spheres = sphere.collect::<Option<_>>()?;
            Some(SphereGroup::new(*link, model.name_of(*link), spheres))
        };
        let groups = model.links().iter().map(group).collect::<Option<_>>()?;
        Some(Self::assemble(model, groups, 0.0))
    }

    fn assemble(model: &CollisionModel, groups: Vec<SphereGroup>, max_protrusion: f64) -> Self {
        let group_index = |link| groups.iter().position(|group| group.link == link);
        let pairs = model
            .pairs()
            .iter()
            .filter_map(|[a, b]| Some([group_index(*a)?, group_index(*b)?]));
        Self {
            pairs: pairs.collect(),
            groups,
            max_protrusion,
            notes: Vec::new(),
        }
    }

    /// The model with each group's spheres enlarged by its gap, so that they cover the shapes.
    pub(super) fn grown_to_cover(mut self) -> Self {
        let mut max_gap: f64 = 0.0;
        for group in &mut self.groups {
            let gap = std::mem::take(&mut group.gap);
            for ball in group.spheres.iter_mut().chain([&mut group.bound]) {
                ball.radius += gap;
            }
            max_gap = max_gap.max(gap);
        }
        self.max_protrusion += max_gap;
        self
    }

    /// Groups by link, in the order of the model.
    #[must_use]
    pub fn groups(&self) -> &[SphereGroup] {
        &self.groups
    }

    /// Enabled collision pairs, as indices into [`groups`](Self::groups).
    #[must_use]
    pub fn pairs(&self) -> &[[usize; 2]] {
        &self.pairs
    }

    /// Maximum protrusion of a sphere from the shapes of its link, metres.
    #[must_use]
    pub fn max_protrusion(&self) -> f64 {
        self.max_protrusion
    }

    /// Maximum [gap](SphereGroup::gap) of all links, metres; 0 if the spheres cover all shapes.
    #[must_use]
    pub fn gap(&self) -> f64 {
        self.groups
            .iter()
            .fold(0.0, |max, group| group.gap.max(max))
    }

    /// Messages about parts of the file that were left out.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Number of spheres.
    #[must_use]
    pub fn count(&self) -> usize {
        self.groups.iter().map(|group| group.spheres.len()).sum()
    }
}

impl Resolution {
    fn name(self) -> &'static str {
        match self {
            Self::MaxProtrusion(_) => "max_protrusion",
            Self::PerLink(_) => "spheres per link",
        }
    }
}
