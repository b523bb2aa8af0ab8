//! Enabled collision pairs of the links of an MJCF file, by MuJoCo's rules.
//!
//! Source: MuJoCo's documentation, "Computation", "Selection" of collisions. These pairs are disabled:
//! - geoms of bodies that are welded to each other;
//! - geoms of a body and its parent, unless the parent is welded to the world;
//! - pairs of bodies that `exclude` names;
//! - geoms whose contact bits do not match.
//!
//! A `pair` element enables its pair in all cases.

use kinopt_kinematics::spatial::Placement;

/// Contact bits of a geom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ContactBits {
    pub(crate) contype: u32,
    pub(crate) conaffinity: u32,
}

/// Contact properties of a body. Body indices equal link indices.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactBody {
    /// Index of the topmost body to which it is welded, or its own index. 0 is the world.
    pub(crate) weld: usize,
    /// `weld` of the parent of the body `weld`.
    pub(crate) weld_parent: usize,
    /// Contact bits of the collision geoms.
    pub(crate) bits: Vec<ContactBits>,
}

/// A half-space fixed to a body; its z axis is the outward normal.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct ContactPlane {
    #[doc(hidden)]
    pub name: String,
    #[doc(hidden)]
    pub body: usize,
    #[doc(hidden)]
    pub body_from_plane: Placement<f64>,
    pub(crate) bits: ContactBits,
    /// Bodies for which a `pair` element enables collisions with the plane.
    pub(crate) paired: Vec<usize>,
}

/// Enabled collision pairs of links and planes.
#[derive(Clone, Debug, Default)]
#[doc(hidden)]
pub struct Contacts {
    pub(crate) bodies: Vec<ContactBody>,
    #[doc(hidden)]
    pub planes: Vec<ContactPlane>,
    /// Disabled pairs of bodies, the lower index first.
    pub(crate) excluded: Vec<[usize; 2]>,
    pub(crate) paired: Vec<[usize; 2]>,
    /// Collisions of a body with its parent are enabled too.
    pub(crate) includes_parents: bool,
}

impl ContactBits {
    /// MuJoCo's default for geoms without the attributes.
    pub(crate) const DEFAULT: Self = Self {
        contype: 1,
        conaffinity: 1,
    };

    fn collides_with(self, other: Self) -> bool {
        self.contype & other.conaffinity != 0 || other.contype & self.conaffinity != 0
    }
}

impl Contacts {
    /// Reports whether collisions of two links are enabled.
    #[doc(hidden)]
    pub fn are_checked(&self, a: usize, b: usize) -> bool {
        self.paired.contains(&[a.min(b), a.max(b)])
            || self.bodies_collide(a, b) && self.geom_collisions(a, b).any(|collides| collides)
    }

    /// Reports whether collisions of two links are enabled, but disabled for some pairs of their geoms.
    #[doc(hidden)]
    pub fn are_partly_checked(&self, a: usize, b: usize) -> bool {
        self.are_checked(a, b) && !self.geom_collisions(a, b).all(|collides| collides)
    }

    /// Reports whether collisions of a link with a plane are enabled.
    #[doc(hidden)]
    pub fn is_plane_checked(&self, plane: &ContactPlane, link: usize) -> bool {
        plane.paired.contains(&link)
            || self.bodies_collide(plane.body, link)
                && self
                    .bits_of(link)
                    .iter()
                    .any(|bits| bits.collides_with(plane.bits))
    }

    fn geom_collisions(&self, a: usize, b: usize) -> impl Iterator<Item = bool> + '_ {
        let (first, second) = (self.bits_of(a), self.bits_of(b));
        first
            .iter()
            .flat_map(move |one| second.iter().map(move |other| one.collides_with(*other)))
    }

    fn bits_of(&self, body: usize) -> &[ContactBits] {
        self.bodies.get(body).map_or(&[], |body| &body.bits)
    }

    fn bodies_collide(&self, a: usize, b: usize) -> bool {
        let (Some(first), Some(second)) = (self.bodies.get(a), self.bodies.get(b)) else {
            return false;
        };
        let is_parent = |one: &ContactBody, other: &ContactBody| {
            one.weld != 0 && other.weld != 0 && other.weld_parent == one.weld
        };
        let adjacent = is_parent(first, second) || is_parent(second, first);
        first.weld != second.weld
            && (self.includes_parents || !adjacent)
            && !self.excluded.contains(&[a.min(b), a.max(b)])
    }
}
