//! Which links of an MJCF file touch each other, by MuJoCo's rules.
//!
//! MuJoCo's documentation, "Computation", "Selection" of collisions: geoms of bodies that are welded to each other never touch,
//! nor a body's and its parent's unless that is welded to the world, nor what `exclude` names, nor geoms whose bits do not meet;
//! what `pair` names does, whatever else is said.

use crate::spatial::Placement;

/// `contype` and `conaffinity`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ContactBits {
    pub(crate) own: u32,
    pub(crate) of_others: u32,
}

/// What a body says about contacts; links are counted as bodies are.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactBody {
    /// The body that it is welded to, or itself; 0 is the world.
    pub(crate) weld: usize,
    /// Of the body that `weld` stands on.
    pub(crate) weld_parent: usize,
    /// Of its shapes.
    pub(crate) bits: Vec<ContactBits>,
}

/// A half-space that stands on a body, its z axis outwards.
#[derive(Clone, Debug)]
pub(crate) struct ContactPlane {
    pub(crate) name: String,
    pub(crate) body: usize,
    pub(crate) body_from_plane: Placement<f64>,
    pub(crate) bits: ContactBits,
    /// Bodies that are kept over it, whatever else is said.
    pub(crate) paired: Vec<usize>,
}

/// Which links are kept apart.
#[derive(Clone, Debug, Default)]
pub(crate) struct Contacts {
    pub(crate) bodies: Vec<ContactBody>,
    pub(crate) planes: Vec<ContactPlane>,
    /// Bodies, the lower first.
    pub(crate) excluded: Vec<[usize; 2]>,
    pub(crate) paired: Vec<[usize; 2]>,
    /// Whether a body and its parent touch too.
    pub(crate) parents_count: bool,
}

impl ContactBits {
    /// MuJoCo's own for what says nothing.
    pub(crate) const USUAL: Self = Self {
        own: 1,
        of_others: 1,
    };

    fn meet(self, other: Self) -> bool {
        self.own & other.of_others != 0 || other.own & self.of_others != 0
    }
}

impl Contacts {
    /// Whether two links are kept apart.
    pub(crate) fn are_apart(&self, a: usize, b: usize) -> bool {
        self.paired.contains(&[a.min(b), a.max(b)])
            || self.bodies_meet(a, b) && self.meeting(a, b).any(|meet| meet)
    }

    /// Whether some shapes of two links that are kept apart could go through each other.
    pub(crate) fn are_apart_in_part(&self, a: usize, b: usize) -> bool {
        self.are_apart(a, b) && !self.meeting(a, b).all(|meet| meet)
    }

    /// Whether a link is kept over a plane.
    pub(crate) fn is_over(&self, plane: &ContactPlane, link: usize) -> bool {
        plane.paired.contains(&link)
            || self.bodies_meet(plane.body, link)
                && self.bits_of(link).iter().any(|bits| bits.meet(plane.bits))
    }

    fn meeting(&self, a: usize, b: usize) -> impl Iterator<Item = bool> + '_ {
        let (first, second) = (self.bits_of(a), self.bits_of(b));
        first
            .iter()
            .flat_map(move |one| second.iter().map(move |other| one.meet(*other)))
    }

    fn bits_of(&self, body: usize) -> &[ContactBits] {
        self.bodies.get(body).map_or(&[], |body| &body.bits)
    }

    fn bodies_meet(&self, a: usize, b: usize) -> bool {
        let (Some(first), Some(second)) = (self.bodies.get(a), self.bodies.get(b)) else {
            return false;
        };
        let is_above = |one: &ContactBody, other: &ContactBody| {
            one.weld != 0 && other.weld != 0 && other.weld_parent == one.weld
        };
        let adjacent = is_above(first, second) || is_above(second, first);
        first.weld != second.weld
            && (self.parents_count || !adjacent)
            && !self.excluded.contains(&[a.min(b), a.max(b)])
    }
}
