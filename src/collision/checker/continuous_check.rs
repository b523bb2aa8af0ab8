//! Whether the way between two configurations is free, by a bound on how far anything moves: not by samples and hope.

use super::parts::Pair;
use super::scene_placements::SceneRoom;
use super::{Checker, CheckerWorkspace};
use crate::collision::{ROUNDING, Separation};
use crate::kinematics::KinematicsError;
use crate::search::Collision;
use crate::spatial::{Placement, Vector3};

/// So near to the margin nothing is told apart from touching, metres.
const RESOLUTION: f64 = 1e-6;

/// Steps of more than such a share of what is left are long enough.
const LONG: f64 = 0.2;

/// How much of a way is free.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Way {
    /// The share of the way from its begin that is surely free: 1 where all is.
    pub free: f64,
    /// What ends it, [on the way](Collision::on_the_way).
    pub blocked_by: Option<Collision>,
}

/// What is kept apart, and how long it surely stays so.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watched {
    what: What,
    /// How far it can come together on the whole way, metres.
    motion: f64,
    /// So far on the way it is surely apart.
    free: f64,
}

/// What comes no further in a step than its room over its motion, which is little, and the direction in which it is apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slow {
    pub(super) pair: Pair,
    pub(super) normal: Vector3<f64>,
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
    /// micrometre of the margin counts as blocked.
    ///
    /// # Errors
    /// Configurations of the wrong length or not finite, or a quaternion of length zero.
    pub fn way(
        &self,
        workspace: &mut CheckerWorkspace,
        from: &[f64],
        to: &[f64],
    ) -> Result<Way, KinematicsError> {
        // Checks both.
        workspace.place(to)?;
        workspace.place(from)?;
        let mut watched = std::mem::take(&mut workspace.watched);
        let mut between = std::mem::take(&mut workspace.between);
        self.watch(workspace, (from, to), &mut watched);
        between.resize(from.len(), 0.0);
        let mut free = 0.0;
        let way = loop {
            let reached = self.model.model().interpolate(from, to, free, &mut between);
            debug_assert!(reached.is_ok(), "both ends were checked");
            match self.advance(workspace, &between, free, &mut watched) {
                Ok(None) => {
                    if let Err(error) = self.slide(workspace, (from, to), free, &mut watched) {
                        break Err(error);
                    }
                }
                Ok(blocked_by) => break Ok(Way { free, blocked_by }),
                Err(error) => break Err(error),
            }
            watched.retain(|one| one.free < 1.0);
            let Some(next) = watched.iter().map(|one| one.free).reduce(f64::min) else {
                break Ok(Way {
                    free: 1.0,
                    blocked_by: None,
                });
            };
            free = next;
        };
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
        here: f64,
        watched: &mut [Watched],
    ) -> Result<Option<Collision>, KinematicsError> {
        let mut slow = std::mem::take(&mut workspace.slow);
        slow.clear();
        let (placements, room) = workspace.place(q)?;
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
            let nearest = match one.what {
                What::Part(part) => {
                    self.scene.find_standing(part, placements, within, room);
                    let mut nearest: Option<(Pair, f64)> = None;
                    for place in 0..room.near.len() {
                        let (standing, found) = room.near[place];
                        let pair = Pair::Standing(part, standing as usize);
                        if nearest.is_none_or(|(_, known)| found.distance < known) {
                            nearest = Some((pair, found.distance));
                        }
                        slow.push((index, self.slow(pair, &found, placements, room)));
                    }
                    nearest
                }
                What::Pair(pair) => {
                    let separation = self.scene.apart(pair, placements, within, room);
                    separation.map(|found| {
                        let pair = Pair::Parts(pair[0], pair[1]);
                        slow.push((index, self.slow(pair, &found, placements, room)));
                        (pair, found.distance)
                    })
                }
            };
            let Some((pair, distance)) = nearest else {
                one.free = 1.0;
                continue;
            };
            let room = distance - margin;
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
        }
        workspace.slow = slow;
        Ok(blocked.map(|(pair, distance)| self.collision(pair, distance).met_on_the_way()))
    }

    /// What is apart along a direction: all shapes of both, not only those that are nearest.
    fn slow(
        &self,
        pair: Pair,
        found: &Separation,
        placements: &[Placement<f64>],
        room: &mut SceneRoom,
    ) -> Slow {
        let gap = self.scene.gap_along(pair, found.normal, placements, room);
        Slow {
            pair,
            normal: found.normal,
            room: gap.map_or(0.0, |gap| gap.min(found.distance) - self.margin_on_ways()),
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
