//! Continuous collision checking of a joint-space motion, by conservative advancement.

use super::parts::Pair;
use super::scene_placements::SceneWorkspace;
use super::{Checker, CheckerWorkspace};
use crate::collision::{ROUNDING, Separation};
use crate::kinematics::KinematicsError;
use crate::search::Collision;
use crate::spatial::{Placement, Vector3};

/// Distance from the margin below which a pair counts as touching, metres.
pub(super) const RESOLUTION: f64 = 1e-6;

/// Distance from the margin below which a pair is an initial contact of a motion, metres. It covers the tolerance of
/// locked feet.
const CONTACT: f64 = 1e-5;

/// Share of the remaining motion above which a step counts as long.
const LONG: f64 = 0.2;

/// Largest number of steps. A motion that takes more is not proven collision-free.
const STEPS: usize = 10_000;

/// Result of a continuous collision check of a motion.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionCheck {
    /// Share of the motion from its start that is proven collision-free, from 0 to 1.
    pub free: f64,
    /// The pair that ends the collision-free part, marked as [`on_the_way`](Collision::on_the_way).
    pub blocked_by: Option<Collision>,
    /// Initial penetration below the required margin, in metres; 0 if the start is collision-free.
    ///
    /// It is always 0 in results of [`Checker::check_motion`].
    pub initial_penetration: f64,
}

/// A pair nearer than the margin at the start of a motion, or barely farther.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    pair: Pair,
    /// Distance at the start, metres.
    distance: f64,
    /// Required distance without the initial contact, metres.
    margin: f64,
}

impl MotionCheck {
    /// True if a pair is in contact at the start by more than rounding.
    pub(crate) fn begins_touching(&self) -> bool {
        self.initial_penetration > ROUNDING
    }
}

impl Contact {
    /// Required distance in the motion, metres: slightly less than at the start.
    fn on_the_way(&self) -> f64 {
        self.distance.min(self.margin) - 2.0 * RESOLUTION
    }

    /// Required distance at the end of the motion, metres.
    ///
    /// A pair that keeps the margin at the start must keep it at the end. Any other pair must be as far apart as at the
    /// start; a pair that barely touches may lose a micrometre.
    fn at_the_end(&self) -> f64 {
        match self.distance >= self.margin - ROUNDING {
            true => self.margin - ROUNDING,
            false => (self.distance - ROUNDING).min(self.margin - RESOLUTION),
        }
    }
}

/// A monitored pair or part, with the part of the motion for which it is proven collision-free.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watched {
    what: What,
    /// Upper bound of its approach in the whole motion, metres.
    motion: f64,
    /// Share of the motion up to which it is proven collision-free.
    free: f64,
    /// Closest pair and its distance at the last measurement, metres.
    nearest: Option<(Pair, f64)>,
}

/// A measured pair with a direction that separates it, for longer steps past each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slow {
    pub(super) pair: Pair,
    pub(super) normal: Vector3<f64>,
    /// Required distance, metres.
    pub(super) margin: f64,
    /// Gap along the normal beyond the required distance, metres.
    pub(super) room: f64,
}

#[derive(Clone, Copy, Debug)]
enum What {
    /// A part and all fixed obstacles.
    Part(usize),
    Pair([usize; 2]),
}

impl Checker {
    /// Checks the motion between two configurations, along which all joints move uniformly
    /// ([`Model::interpolate`](crate::Model::interpolate)).
    ///
    /// The method is conservative advancement (Mirtich 1996, "Impulse-based dynamic simulation", ch. 3), for each pair
    /// separately. A pair at distance d beyond the margin cannot reach it before its motion bound uses up d. The motion
    /// of each point of a part is bounded by the joint rotations times their distances from the part. Joints above both
    /// parts of a pair do not count.
    ///
    /// A motion counts as blocked if a pair comes within a micrometre of the margin. It also counts as blocked if ten
    /// thousand steps do not complete it.
    ///
    /// # Errors
    /// Returns an error if a configuration has the wrong length or is not finite, or if a quaternion has length zero.
    pub fn check_motion(
        &self,
        workspace: &mut CheckerWorkspace,
        from: &[f64],
        to: &[f64],
    ) -> Result<MotionCheck, KinematicsError> {
        self.way_past(workspace, (from, to), false)
    }

    /// As [`check_motion`](Self::check_motion), but pairs nearer than the margin at the start may remain that near, and no nearer.
    ///
    /// For example, a hand in contact with a table departs from it, and a foot remains on the floor.
    ///
    /// # Errors
    /// As [`check_motion`](Self::check_motion).
    pub fn way_from_contact(
        &self,
        workspace: &mut CheckerWorkspace,
        from: &[f64],
        to: &[f64],
    ) -> Result<MotionCheck, KinematicsError> {
        self.way_past(workspace, (from, to), true)
    }

    /// Checks a motion, with or without tolerance of initial contacts.
    fn way_past(
        &self,
        workspace: &mut CheckerWorkspace,
        (from, to): (&[f64], &[f64]),
        past_contacts: bool,
    ) -> Result<MotionCheck, KinematicsError> {
        // Validates both configurations.
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
                    break Ok(MotionCheck {
                        free,
                        blocked_by,
                        initial_penetration: 0.0,
                    });
                }
                Err(error) => break Err(error),
            }
            watched.retain(|one| one.free < 1.0);
            let next = watched.iter().min_by(|a, b| a.free.total_cmp(&b.free));
            let Some(next) = next else {
                break Ok(MotionCheck {
                    free: 1.0,
                    blocked_by: None,
                    initial_penetration: 0.0,
                });
            };
            steps += 1;
            if let (Some((pair, distance)), true) = (next.nearest, steps >= STEPS) {
                break Ok(MotionCheck {
                    free,
                    blocked_by: Some(self.collision(pair, distance).met_on_the_way()),
                    initial_penetration: 0.0,
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
            way.initial_penetration = depths.fold(0.0, f64::max);
        }
        workspace.watched = watched;
        workspace.between = between;
        way
    }

    /// Required distance of pairs that move relative to each other, metres.
    pub(super) fn margin_on_ways(&self) -> f64 {
        self.margin + self.stand_off
    }

    /// Collects all checked pairs with their motion bounds.
    fn watch(
        &self,
        workspace: &mut CheckerWorkspace,
        way: (&[f64], &[f64]),
        watched: &mut Vec<Watched>,
    ) {
        let (bound, room) = (self.scene.motion_bound(), &mut workspace.bound);
        // Lengths and numbers are already validated.
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

    /// Measures again what is proven only up to this share of the motion. Returns the closest blocking pair, if any.
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
            // Pairs farther apart cannot reach the margin until the end.
            let within = margin + RESOLUTION + one.motion * (1.0 - here);
            // Required distance of a pair; records initial contacts.
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
            // A pair without relative motion keeps its distance. Rounding decides if it touches exactly.
            if one.motion == 0.0 && room >= -ROUNDING {
                one.free = 1.0;
                continue;
            }
            // The motion of an unbounded shape is unbounded once it rotates.
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

    /// The first contact that is nearer at a configuration than its required distance at the end.
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

    /// The gap along the normal between all shapes of both, not only the nearest ones.
    fn slow(
        &self,
        pair: Pair,
        found: &Separation,
        margin: f64,
        placements: &[Placement<f64>],
        room: &mut SceneWorkspace,
    ) -> Slow {
        let gap = self.scene.gap_along(pair, found.normal, placements, room);
        Slow {
            pair,
            normal: found.normal,
            margin,
            room: gap.map_or(0.0, |gap| gap.min(found.distance) - margin),
        }
    }

    /// Extends the step of pairs that slide past each other.
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

/// Required distance of a pair in the motion, metres; less for initial contacts.
fn margin_of(contacts: &[Contact], pair: Pair, margin: f64) -> f64 {
    let own = contacts.iter().find(|one| one.pair == pair);
    own.map_or(margin, Contact::on_the_way)
}
