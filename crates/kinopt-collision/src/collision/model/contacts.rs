//! Collision pairs of MJCF files.

use super::CollisionModel;
use super::planes::{LinkHalfSpace, fixed_placement};
pub(super) use kinopt_kinematics::model::FrameId;
pub(super) use kinopt_robot::robot::Contacts;

impl CollisionModel {
    /// The model with the collision pairs that MuJoCo checks, and with the planes of the file. Links are MuJoCo's
    /// bodies.
    #[doc(hidden)]
    pub fn with_contacts(mut self, contacts: &Contacts) -> Self {
        let links = self.links.iter().enumerate();
        let pairs = links.flat_map(|(at, a)| self.links[at + 1..].iter().map(move |b| [*a, *b]));
        let pairs = pairs.filter(|[a, b]| contacts.are_checked(a.index(), b.index()));
        self.pairs = pairs.collect();
        let excluded_in_part =
            |[a, b]: &[FrameId; 2]| contacts.are_partly_checked(a.index(), b.index());
        let partly_excluded: Vec<_> = self
            .pairs
            .iter()
            .filter(|pair| excluded_in_part(pair))
            .collect();
        if let [[a, b], others @ ..] = partly_excluded.as_slice() {
            let [a, b] = [self.name_of(*a), self.name_of(*b)];
            let suffix = match others.len() {
                0 => String::new(),
                1 => " (and one more pair)".to_owned(),
                count => format!(" (and {count} more pairs)"),
            };
            self.notes.push(format!(
                "links `{a}` and `{b}`{suffix}: all geoms are checked, although contact bits exclude some of them"
            ));
        }
        for plane in &contacts.planes {
            let Some(link) = self.model.frame_ids().nth(plane.body) else {
                continue;
            };
            let Some(world_from_link) = fixed_placement(&self.model, link) else {
                let on = self.name_of(link);
                self.notes.push(format!(
                    "{}: left out, as `{on}` moves: a half-space must be fixed",
                    plane.name
                ));
                continue;
            };
            let at = world_from_link * plane.body_from_plane;
            let links = self.links.iter().copied();
            let allowed_links =
                links.filter(|link| !contacts.is_plane_checked(plane, link.index()));
            let allowed_links = allowed_links.collect();
            self.planes
                .push(LinkHalfSpace::new(&self.model, link, at, allowed_links));
        }
        self
    }
}
