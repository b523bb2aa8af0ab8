//! Spheres that cover a robot's shapes: what is checked fast.

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
use crate::bad_option::{BadOption, POSITIVE};
use crate::model::FrameId;

/// Spheres by the names of links.
type NamedSpheres = Vec<(String, Vec<Ball>)>;

/// How fine spheres are.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Fineness {
    /// As few spheres as are found that stick out no further than this, in metres.
    Overhang(f64),
    /// Sticking out as little as is found with at most so many spheres a link.
    PerLink(usize),
}

/// Spheres that together cover every shape of a [`CollisionModel`], inside and all, by link.
///
/// What no sphere touches no shape touches; a sphere touches at most [`overhang`](Self::overhang) before a shape
/// does. Those that are [read](Self::read) may leave [gaps](SphereGroup::gap).
///
/// ```
/// use kinopt::collision::{CollisionModel, Fineness, SphereModel};
/// use kinopt::robot::Robot;
///
/// let robot = Robot::read("models/universal_ur5e.urdf")?;
/// let model = CollisionModel::of(&robot)?;
/// let spheres = SphereModel::of(&model, Fineness::Overhang(0.02))?;
/// assert!(spheres.overhang() <= 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "serialised::Parts", into = "serialised::Parts")
)]
pub struct SphereModel {
    groups: Vec<SphereGroup>,
    pairs: Vec<[usize; 2]>,
    overhang: f64,
    notes: Vec<String>,
}

/// The spheres of one link.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SphereGroup {
    /// The link.
    pub link: FrameId,
    /// Its name.
    pub name: String,
    /// Around all its spheres, in the link's frame.
    pub bound: Ball,
    /// In the link's frame.
    pub spheres: Vec<Ball>,
    /// No point of the link's shapes lies farther outside all spheres, metres: 0 of spheres that cover them, more of some
    /// that others made.
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

    /// The same, of spheres that leave so much uncovered, metres.
    fn with_gap(self, gap: f64) -> Self {
        Self { gap, ..self }
    }
}

impl SphereModel {
    /// Covers the shapes of a model. Links whose shapes are spheres keep those.
    ///
    /// Convex shapes are covered with what is in them, and so are closed meshes; of open ones the surface alone.
    ///
    /// # Errors
    /// A length or a number that is not positive, or so fine that a link would need millions of cells.
    pub fn of(model: &CollisionModel, fineness: Fineness) -> Result<Self, BadOption> {
        let value = match fineness {
            Fineness::Overhang(overhang) => overhang,
            Fineness::PerLink(count) => count as f64,
        };
        BadOption::check(fineness.name(), value, POSITIVE)?;
        let mut groups = Vec::with_capacity(model.links().len());
        let mut overhang: f64 = 0.0;
        for &link in model.links() {
            let objects: Vec<_> = model.objects_of(link).collect();
            let (spheres, out) = link_cover::cover(&objects, fineness)?;
            overhang = overhang.max(out);
            groups.push(SphereGroup::new(link, model.name_of(link), spheres));
        }
        Ok(Self::assemble(model, groups, overhang))
    }

    /// The spheres of a model whose shapes are all spheres, as they are; `None` where any is not.
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

    fn assemble(model: &CollisionModel, groups: Vec<SphereGroup>, overhang: f64) -> Self {
        let at = |link| groups.iter().position(|group| group.link == link);
        let pairs = model
            .pairs()
            .iter()
            .filter_map(|[a, b]| Some([at(*a)?, at(*b)?]));
        Self {
            pairs: pairs.collect(),
            groups,
            overhang,
            notes: Vec::new(),
        }
    }

    /// The same grown by what they leave uncovered, so that they cover.
    pub(super) fn grown_to_cover(mut self) -> Self {
        let mut most: f64 = 0.0;
        for group in &mut self.groups {
            let gap = std::mem::take(&mut group.gap);
            for ball in group.spheres.iter_mut().chain([&mut group.bound]) {
                ball.radius += gap;
            }
            most = most.max(gap);
        }
        self.overhang += most;
        self
    }

    getters! {
        /// By link, in the model's order.
        pub fn groups(&self) -> &[SphereGroup] = &self.groups;
        /// Which groups are kept apart, by their places in [`groups`](Self::groups).
        pub fn pairs(&self) -> &[[usize; 2]] = &self.pairs;
        /// No sphere sticks out of its link's shapes any further, in metres.
        pub fn overhang(&self) -> f64 = self.overhang;
        /// No point of the shapes lies farther outside all spheres of its link, metres: 0 where they cover all shapes.
        pub fn gap(&self) -> f64 = self.groups.iter().fold(0.0, |most, group| group.gap.max(most));
        /// What of the file that they were read from was left out, one text each.
        pub fn notes(&self) -> &[String] = &self.notes;
        /// How many spheres there are.
        pub fn count(&self) -> usize = self.groups.iter().map(|group| group.spheres.len()).sum();
    }
}

impl Fineness {
    fn name(self) -> &'static str {
        match self {
            Self::Overhang(_) => "overhang",
            Self::PerLink(_) => "spheres per link",
        }
    }
}
