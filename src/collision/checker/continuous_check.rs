//! Whether the way between two configurations is free, by a bound on how far anything moves: not by samples and hope.

use super::parts::Pair;
use super::scene_placements::SceneRoom;
use super::{Checker, CheckerWorkspace};
use crate::collision::{ROUNDING, Separation};
use crate::kinematics::KinematicsError;
use crate::search::Collision;
use crate::spatial::{Placement, Vector3};

/// So near to the margin nothing is told apart from touching, metres.
pub(super) const RESOLUTION: f64 = 1e-6;

/// What is so near to the margin where a way from contact begins is in contact, metres: feet that are held are off by a tolerance.
const CONTACT: f64 = 1e-5;

/// Steps of more than such a share of what is left are long enough.
const LONG: f64 = 0.2;

/// A way that takes more steps is not surely free: each may be no longer than a micrometre.
const STEPS: usize = 10_000;

/// How much of a way is free.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Way {
    /// The share of the way from its begin that is surely free: 1 where all is.
    pub free: f64,
    /// What ends it, [on the way](Collision::on_the_way).
    pub blocked_by: Option<Collision>,
    /// How much nearer than the margin what is nearest is where a way from contact begins, metres; 0 where nothing is.
    pub begins_deep: f64,
}

/// What is nearer than the margin where a way begins, or hardly farther.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    pair: Pair,
    /// How far apart it is there, metres.
    distance: f64,
    /// How far apart it is to be elsewhere.
    margin: f64,
}

impl Way {
    /// Whether something touches where it begins, by more than rounding.
    pub(crate) fn begins_touching(&self) -> bool {
        self.begins_deep > ROUNDING
    }
}

impl Contact {
    /// How far apart it is to be on the way: hardly nearer than it begins.
    fn on_the_way(&self) -> f64 {
        self.distance.min(self.margin) - 2.0 * RESOLUTION
    }

    /// And at its end: free where it begins so, else as far apart as there; of what only just touches a micrometre is none.
    fn at_the_end(&self) -> f64 {
        match self.distance >= self.margin - ROUNDING {
            true => self.margin - ROUNDING,
            false => (self.distance - ROUNDING).min(self.margin - RESOLUTION),
        }
    }
}

/// What is kept apart, and how long it surely stays so.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watched {
    what: What,
    /// How far it can come together on the whole way, metres.
    motion: f64,
    /// So far on the way it is surely apart.
    free: f64,
    /// What of it was nearest when it was last measured, metres.
    nearest: Option<(Pair, f64)>,
}

/// What comes no further in a step than its room over its motion, which is little, and the direction in which it is apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slow {
    pub(super) pair: Pair,
    pub(super) normal: Vector3<f64>,
    /// How far apart it is to stay, metres.
    pub(super) margin: f64,
    /// How far beyond the margin it is, metres.
    pub(super) room: f64,
}

#[derive(Clone, Copy, Debug)]
enum What {
    /// A part and all that stands.
    Part(usize),
    Pair([usize; 2]),
}

impl Checker {
    /// How much of the way from one configuration to another is free, on which all joints move evenly
    /// ([`Model::interpolate`](crate::Model::interpolate)).
    ///
    /// Conservative advancement (Mirtich 1996, "Impulse-based dynamic simulation", ch. 3), for each pair by itself: where it is d beyond the
    /// margin, it does not come to it before d of its motion is used up, and the motion of any place of a part is bounded by what
    /// the joints turn times how far they are from it; joints above both of a pair move neither against the other. A way that comes within a
    /// micrometre of the margin counts as blocked, and so does one so close along something for so long that ten thousand steps do not
    /// get past it.
    ///
    /// # Errors
    /// Configurations of the wrong length or not finite, or a quaternion of length zero.
    pub fn way(
        &self,
        workspace: &mut CheckerWorkspace,
        from: &[f64],
        to: &[f64],
    ) -> Result<Way, KinematicsError> {
        self.way_past(workspace, (from, to), false)
    }

    /// As [`way`](Self::way), but what is nearer than the margin where it begins may be as near all along it, and comes no nearer: a hand
    /// that touches a table leaves it, and a foot stands on the floor.
    ///
    /// # Errors
    /// As of `way`.
    pub fn way_from_contact(
        &self,
        workspace: &mut CheckerWorkspace,
        from: &[f64],
        to: &[f64],
    ) -> Result<Way, KinematicsError> {
        self.way_past(workspace, (from, to), true)
    }

    /// Past what it begins in contact with, or not.
    fn way_past(
        &self,
        workspace: &mut CheckerWorkspace,
        (from, to): (&[f64], &[f64]),
        past_contacts: bool,
    ) -> Result<Way, KinematicsError> {
        // Checks both.
        workspace.place(self, to)?;
        workspace.place(self, from)?;
        let mut watched = std::mem::take(&mut workspace.watched);
        let mut between = std::mem::take(&mut workspace.between);
        self.watch(workspace, (from, to), &mut watched);
        between.resize(from.len(), 0.0);
        workspace.contacts.clear();
        let (mut free, mut steps) = (0.0, 0);
        let mut way = loop {
            let reached = self.model.model().interpolate(from, to, free, &mut between);
            debug_assert!(reached.is_ok(), "both ends were checked");
            match self.advance(workspace, &between, (free, past_contacts), &mut watched) {
                Ok(None) => {
                    if let Err(error) = self.slide(workspace, (from, to), free, &mut watched) {
                        break Err(error);
                    }
                }
                Ok(blocked_by) => {
                    break Ok(Way {
                        free,
                        blocked_by,
                        begins_deep: 0.0,
                    });
                }
                Err(error) => break Err(error),
            }
            watched.retain(|one| one.free < 1.0);
            let next = watched.iter().min_by(|a, b| a.free.total_cmp(&b.free));
            let Some(next) = next else {
                break Ok(Way {
                    free: 1.0,
                    blocked_by: None,
                    begins_deep: 0.0,
                });
            };
            steps += 1;
            if let (Some((pair, distance)), true) = (next.nearest, steps >= STEPS) {
                break Ok(Way {
                    free,
                    blocked_by: Some(self.collision(pair, distance).met_on_the_way()),
                    begins_deep: 0.0,
                });
            }
            free = next.free;
        };
        if let Ok(way) = &mut way
            && !workspace.contacts.is_empty()
        {
            let reached = (self.model.model()).interpolate(from, to, way.free, &mut between);
            debug_assert!(reached.is_ok(), "both ends were checked");
            if let Some(nearer) = self.come_nearer(workspace, &between)? {
                way.free = 0.0;
                way.blocked_by = way.blocked_by.take().or(Some(nearer));
            }
            let contacts = workspace.contacts.iter();
            let depths = contacts.map(|one| self.margin - one.distance);
            way.begins_deep = depths.fold(0.0, f64::max);
        }
        workspace.watched = watched;
        workspace.between = between;
        way
    }

    /// How far apart all is to stay that moves against each other, metres.
    pub(super) fn margin_on_ways(&self) -> f64 {
        self.margin + self.stand_off
    }

    /// All that is kept apart, and how far it can come together on a way.
    fn watch(
        &self,
        workspace: &mut CheckerWorkspace,
        way: (&[f64], &[f64]),
        watched: &mut Vec<Watched>,
    ) {
        let (bound, room) = (self.scene.motion_bound(), &mut workspace.bound);
        // Lengths and numbers were checked.
        let bounded = bound.take(self.model.model(), way, room).is_ok();
        let watch = |what, motion: f64| Watched {
            what,
            motion: if bounded { motion } else { f64::INFINITY },
            free: 0.0,
            nearest: None,
        };
        watched.clear();
        let parts = 0..self.scene.frames().len();
        watched.extend(parts.map(|part| watch(What::Part(part), bound.of_part(part, room))));
        let pairs = self.scene.pairs().iter();
        watched.extend(pairs.map(|&pair| watch(What::Pair(pair), bound.of_pair(pair, room))));
    }

    /// Measures again what is surely apart until here and no further; what is in the way, if anything is.
    fn advance(
        &self,
        workspace: &mut CheckerWorkspace,
        q: &[f64],
        (here, past_contacts): (f64, bool),
        watched: &mut [Watched],
    ) -> Result<Option<Collision>, KinematicsError> {
        let mut slow = std::mem::take(&mut workspace.slow);
        let mut contacts = std::mem::take(&mut workspace.contacts);
        slow.clear();
        let (placements, room) = workspace.place(self, q)?;
        self.scene.begin(room);
        let mut blocked: Option<(Pair, f64)> = None;
        for (index, one) in watched.iter_mut().enumerate() {
            if one.free > here {
                continue;
            }
            let margin = match one.motion == 0.0 {
                true => self.margin,
                false => self.margin_on_ways(),
            };
            // What is farther apart stays so to the end.
            let within = margin + RESOLUTION + one.motion * (1.0 - here);
            // How far it is to stay apart.
            let mut margin_for = |pair: Pair, distance: f64| {
                let begins = here == 0.0 && past_contacts;
                if begins && distance < margin + CONTACT {
                    contacts.push(Contact {
                        pair,
                        distance,
                        margin,
                    });
                }
                margin_of(&contacts, pair, margin)
            };
            let nearest = match one.what {
                What::Part(part) => {
                    self.scene.find_standing(part, placements, within, room);
                    let mut nearest: Option<(Pair, f64, f64)> = None;
                    for place in 0..room.near.len() {
                        let (standing, found) = room.near[place];
                        let pair = Pair::Standing(part, standing as usize);
                        let margin = margin_for(pair, found.distance);
                        let left = found.distance - margin;
                        if nearest.is_none_or(|(.., known)| left < known) {
                            nearest = Some((pair, found.distance, left));
                        }
                        slow.push((index, self.slow(pair, &found, margin, placements, room)));
                    }
                    nearest
                }
                What::Pair(pair) => {
                    let separation = self.scene.apart(pair, placements, within, room);
                    separation.map(|found| {
                        let pair = Pair::Parts(pair[0], pair[1]);
                        let margin = margin_for(pair, found.distance);
                        let left = found.distance - margin;
                        slow.push((index, self.slow(pair, &found, margin, placements, room)));
                        (pair, found.distance, left)
                    })
                }
            };
            let Some((pair, distance, room)) = nearest else {
                one.free = 1.0;
                continue;
            };
            // What stands stays as far apart as it is: by rounding, where both exactly meet.
            if one.motion == 0.0 && room >= -ROUNDING {
                one.free = 1.0;
                continue;
            }
            // What reaches without end may be anywhere once it turns.
            if !room.is_finite() || !one.motion.is_finite() || room < RESOLUTION {
                if blocked.is_none_or(|(_, known)| distance < known) {
                    blocked = Some((pair, distance));
                }
                continue;
            }
            one.free = here + room / one.motion;
            one.nearest = Some((pair, distance));
        }
        workspace.slow = slow;
        workspace.contacts = contacts;
        Ok(blocked.map(|(pair, distance)| self.collision(pair, distance).met_on_the_way()))
    }

    /// What of the contacts is nearer at a configuration than where it began.
    fn come_nearer(
        &self,
        workspace: &mut CheckerWorkspace,
        q: &[f64],
    ) -> Result<Option<Collision>, KinematicsError> {
        let contacts = std::mem::take(&mut workspace.contacts);
        let (placements, room) = workspace.place(self, q)?;
        self.scene.begin(room);
        let mut nearer = None;
        for one in &contacts {
            let within = one.at_the_end();
            let distance = match one.pair {
                Pair::Standing(part, standing) => {
                    self.scene.find_standing(part, placements, within, room);
                    let mut near = room.near.iter();
                    let own = near.find(|(other, _)| *other as usize == standing);
                    own.map(|(_, found)| found.distance)
                }
                Pair::Parts(a, b) => {
                    let found = self.scene.apart([a, b], placements, within, room);
                    found.map(|found| found.distance)
                }
            };
            if let Some(distance) = distance.filter(|distance| *distance < within) {
                nearer = Some(self.collision(one.pair, distance).met_on_the_way());
                break;
            }
        }
        workspace.contacts = contacts;
        Ok(nearer)
    }

    /// What is apart along a direction: all shapes of both, not only those that are nearest.
    fn slow(
        &self,
        pair: Pair,
        found: &Separation,
        margin: f64,
        placements: &[Placement<f64>],
        room: &mut SceneRoom,
    ) -> Slow {
        let gap = self.scene.gap_along(pair, found.normal, placements, room);
        Slow {
            pair,
            normal: found.normal,
            margin,
            room: gap.map_or(0.0, |gap| gap.min(found.distance) - margin),
        }
    }

    /// Takes longer steps where something slides past another.
    fn slide(
        &self,
        workspace: &mut CheckerWorkspace,
        way: (&[f64], &[f64]),
        here: f64,
        watched: &mut [Watched],
    ) -> Result<(), KinematicsError> {
        let measured = std::mem::take(&mut workspace.slow);
        let mut result = Ok(());
        for of_one in measured.chunk_by(|a, b| a.0 == b.0) {
            let one = &mut watched[of_one[0].0];
            if one.free >= here + LONG * (1.0 - here) {
                continue;
            }
            match self.slides_until(workspace, way, here, one.free, of_one, RESOLUTION) {
                Ok(until) => one.free = until,
                Err(error) => result = Err(error),
            }
        }
        workspace.slow = measured;
        result
    }
}

/// How far a pair is to stay apart: what is nearer at the begin, hardly less than there.
fn margin_of(contacts: &[Contact], pair: Pair, margin: f64) -> f64 {
    let own = contacts.iter().find(|one| one.pair == pair);
    own.map_or(margin, Contact::on_the_way)
}
