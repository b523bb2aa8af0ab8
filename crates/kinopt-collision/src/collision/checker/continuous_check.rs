//! Continuous collision checking of a joint-space motion, by conservative advancement.

use super::parts::Pair;
use super::scene_placements::SceneWorkspace;
use super::{Checker, CheckerWorkspace};
use crate::collision::{ROUNDING, Separation};
use kinopt_kinematics::kinematics::KinematicsError;
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_solver::search::Collision;

/// Distance from the margin below which a pair counts as touching, metres.
pub(super) const RESOLUTION: f64 = 1e-6;

/// Distance from the margin below which a pair is an initial contact of a motion, metres. It covers the tolerance of
/// locked feet.
const CONTACT_TOLERANCE: f64 = 1e-5;

/// Share of the remaining motion above which a step counts as long.
const LONG_STEP_SHARE: f64 = 0.2;

/// Largest number of steps. A motion that takes more is not proven collision-free.
const MAX_STEPS: usize = 10_000;

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
pub(super) struct NearPair {
    pair: Pair,
    /// Distance at the start, metres.
    distance: f64,
    /// Required distance without the initial contact, metres.
    margin: f64,
}

impl MotionCheck {
    /// True if a pair is in contact at the start by more than rounding.
    #[doc(hidden)]
    pub fn begins_touching(&self) -> bool {
        self.initial_penetration > ROUNDING
    }
}

impl NearPair {
    /// Required distance in the motion, metres: slightly less than at the start.
    fn margin_in_motion(&self) -> f64 {
        self.distance.min(self.margin) - 2.0 * RESOLUTION
    }

    /// Required distance at the end of the motion, metres.
    ///
    /// A pair that keeps the margin at the start must keep it at the end. Any other pair must be as far apart as at the
    /// start; a pair that barely touches may lose a micrometre.
    fn margin_at_end(&self) -> f64 {
        match self.distance >= self.margin - ROUNDING {
            true => self.margin - ROUNDING,
            false => (self.distance - ROUNDING).min(self.margin - RESOLUTION),
        }
    }
}

/// A monitored pair or part, with the part of the motion for which it is proven collision-free.
#[derive(Clone, Copy, Debug)]
pub(super) struct MonitoredItem {
    kind: ItemKind,
    /// Upper bound of its approach in the whole motion, metres.
    motion: f64,
    /// Share of the motion up to which it is proven collision-free.
    free: f64,
    /// Closest pair and its distance at the last measurement, metres.
    nearest: Option<(Pair, f64)>,
}

/// A measured pair with a direction that separates it, for longer steps past each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlidingPair {
    pub(super) pair: Pair,
    pub(super) normal: Vector3<f64>,
    /// Required distance, metres.
    pub(super) margin: f64,
    /// Gap along the normal beyond the required distance, metres.
    pub(super) slack: f64,
}

#[derive(Clone, Copy, Debug)]
enum ItemKind {
    /// A part and all fixed obstacles.
    Part(usize),
    Pair([usize; 2]),
}

impl Checker {
    /// Checks the motion between two configurations, along which all joints move uniformly
    /// ([`Model::interpolate`](kinopt_kinematics::Model::interpolate)).
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
        self.check_motion_with(workspace, (from, to), false)
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
        self.check_motion_with(workspace, (from, to), true)
    }

    /// Checks a motion, with or without tolerance of initial contacts.
    fn check_motion_with(
        &self,
        workspace: &mut CheckerWorkspace,
        (from, to): (&[f64], &[f64]),
        tolerates_contacts: bool,
    ) -> Result<MotionCheck, KinematicsError> {
        // Validates both configurations.
        workspace.place(self, to)?;
        workspace.place(self, from)?;
        let mut monitored_items = std::mem::take(&mut workspace.monitored_items);
        let mut configuration = std::mem::take(&mut workspace.configuration);
        self.monitor_all(workspace, (from, to), &mut monitored_items);
        configuration.resize(from.len(), 0.0);
        workspace.contacts.clear();
        let (mut free, mut steps) = (0.0, 0);
        let mut check = loop {
            let reached = self
                .model
                .model()
                .interpolate(from, to, free, &mut configuration);
            debug_assert!(reached.is_ok(), "both ends were checked");
            match self.advance(
                workspace,
                &configuration,
                (free, tolerates_contacts),
                &mut monitored_items,
            ) {
                Ok(None) => {
                    if let Err(error) =
                        self.extend_sliding_steps(workspace, (from, to), free, &mut monitored_items)
                    {
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
            monitored_items.retain(|monitored| monitored.free < 1.0);
            let first = monitored_items
                .iter()
                .min_by(|a, b| a.free.total_cmp(&b.free));
            let Some(first) = first else {
                break Ok(MotionCheck {
                    free: 1.0,
                    blocked_by: None,
                    initial_penetration: 0.0,
                });
            };
            steps += 1;
            if let (Some((pair, distance)), true) = (first.nearest, steps >= MAX_STEPS) {
                break Ok(MotionCheck {
                    free,
                    blocked_by: Some(self.collision(pair, distance).met_on_the_way()),
                    initial_penetration: 0.0,
                });
            }
            free = first.free;
        };
        if let Ok(check) = &mut check
            && !workspace.contacts.is_empty()
        {
            let reached =
                (self.model.model()).interpolate(from, to, check.free, &mut configuration);
            debug_assert!(reached.is_ok(), "both ends were checked");
            if let Some(nearer) = self.closer_contact(workspace, &configuration)? {
                check.free = 0.0;
                check.blocked_by = check.blocked_by.take().or(Some(nearer));
            }
            let contacts = workspace.contacts.iter();
            let depths = contacts.map(|contact| self.margin - contact.distance);
            check.initial_penetration = depths.fold(0.0, f64::max);
        }
        workspace.monitored_items = monitored_items;
        workspace.configuration = configuration;
        check
    }

    /// Required distance of pairs that move relative to each other, metres.
    pub(super) fn motion_margin(&self) -> f64 {
        self.margin + self.stand_off
    }

    /// Collects all checked pairs with their motion bounds.
    fn monitor_all(
        &self,
        workspace: &mut CheckerWorkspace,
        motion_ends: (&[f64], &[f64]),
        monitored_items: &mut Vec<MonitoredItem>,
    ) {
        let (bound, bound_workspace) = (self.scene.motion_bound(), &mut workspace.bound);
        // Lengths and numbers are already validated.
        let bounded = bound
            .take(self.model.model(), motion_ends, bound_workspace)
            .is_ok();
        let item_monitor = |kind, motion: f64| MonitoredItem {
            kind,
            motion: if bounded { motion } else { f64::INFINITY },
            free: 0.0,
            nearest: None,
        };
        monitored_items.clear();
        let parts = 0..self.scene.frames().len();
        monitored_items.extend(
            parts.map(|part| {
                item_monitor(ItemKind::Part(part), bound.of_part(part, bound_workspace))
            }),
        );
        let pairs = self.scene.pairs().iter();
        monitored_items.extend(
            pairs.map(|&pair| {
                item_monitor(ItemKind::Pair(pair), bound.of_pair(pair, bound_workspace))
            }),
        );
    }

    /// Measures again what is proven only up to this share of the motion. Returns the closest blocking pair, if any.
    fn advance(
        &self,
        workspace: &mut CheckerWorkspace,
        q: &[f64],
        (share, tolerates_contacts): (f64, bool),
        monitored_items: &mut [MonitoredItem],
    ) -> Result<Option<Collision>, KinematicsError> {
        let mut sliding = std::mem::take(&mut workspace.sliding_pairs);
        let mut contacts = std::mem::take(&mut workspace.contacts);
        sliding.clear();
        let (placements, scene_workspace) = workspace.place(self, q)?;
        self.scene.begin(scene_workspace);
        let mut blocked: Option<(Pair, f64)> = None;
        for (index, monitored) in monitored_items.iter_mut().enumerate() {
            if monitored.free > share {
                continue;
            }
            let margin = match monitored.motion == 0.0 {
                true => self.margin,
                false => self.motion_margin(),
            };
            // Pairs farther apart cannot reach the margin until the end.
            let max_distance = margin + RESOLUTION + monitored.motion * (1.0 - share);
            // Required distance of a pair; records initial contacts.
            let mut margin_for = |pair: Pair, distance: f64| {
                let is_initial = share == 0.0 && tolerates_contacts;
                if is_initial && distance < margin + CONTACT_TOLERANCE {
                    contacts.push(NearPair {
                        pair,
                        distance,
                        margin,
                    });
                }
                margin_of(&contacts, pair, margin)
            };
            let nearest = match monitored.kind {
                ItemKind::Part(part) => {
                    self.scene.find_fixed_obstacles(
                        part,
                        placements,
                        max_distance,
                        scene_workspace,
                    );
                    let mut nearest: Option<(Pair, f64, f64)> = None;
                    for near_index in 0..scene_workspace.near.len() {
                        let (obstacle, separation) = scene_workspace.near[near_index];
                        let pair = Pair::FixedObstacle(part, obstacle as usize);
                        let margin = margin_for(pair, separation.distance);
                        let slack = separation.distance - margin;
                        if nearest.is_none_or(|(.., min)| slack < min) {
                            nearest = Some((pair, separation.distance, slack));
                        }
                        sliding.push((
                            index,
                            self.sliding_pair(
                                pair,
                                &separation,
                                margin,
                                placements,
                                scene_workspace,
                            ),
                        ));
                    }
                    nearest
                }
                ItemKind::Pair(pair) => {
                    let separation =
                        self.scene
                            .separation(pair, placements, max_distance, scene_workspace);
                    separation.map(|separation| {
                        let pair = Pair::Parts(pair[0], pair[1]);
                        let margin = margin_for(pair, separation.distance);
                        let slack = separation.distance - margin;
                        sliding.push((
                            index,
                            self.sliding_pair(
                                pair,
                                &separation,
                                margin,
                                placements,
                                scene_workspace,
                            ),
                        ));
                        (pair, separation.distance, slack)
                    })
                }
            };
            let Some((pair, distance, slack)) = nearest else {
                monitored.free = 1.0;
                continue;
            };
            // A pair without relative motion keeps its distance. Rounding decides if it touches exactly.
            if monitored.motion == 0.0 && slack >= -ROUNDING {
                monitored.free = 1.0;
                continue;
            }
            // The motion of an unbounded shape is unbounded once it rotates.
            if !slack.is_finite() || !monitored.motion.is_finite() || slack < RESOLUTION {
                if blocked.is_none_or(|(_, min)| distance < min) {
                    blocked = Some((pair, distance));
                }
                continue;
            }
            monitored.free = share + slack / monitored.motion;
            monitored.nearest = Some((pair, distance));
        }
        workspace.sliding_pairs = sliding;
        workspace.contacts = contacts;
        Ok(blocked.map(|(pair, distance)| self.collision(pair, distance).met_on_the_way()))
    }

    /// The first contact that is nearer at a configuration than its required distance at the end.
    fn closer_contact(
        &self,
        workspace: &mut CheckerWorkspace,
        q: &[f64],
    ) -> Result<Option<Collision>, KinematicsError> {
        let contacts = std::mem::take(&mut workspace.contacts);
        let (placements, scene_workspace) = workspace.place(self, q)?;
        self.scene.begin(scene_workspace);
        let mut closer = None;
        for contact in &contacts {
            let margin = contact.margin_at_end();
            let distance = match contact.pair {
                Pair::FixedObstacle(part, obstacle) => {
                    self.scene
                        .find_fixed_obstacles(part, placements, margin, scene_workspace);
                    let mut near = scene_workspace.near.iter();
                    let separation = near.find(|(other, _)| *other as usize == obstacle);
                    separation.map(|(_, separation)| separation.distance)
                }
                Pair::Parts(a, b) => {
                    let separation =
                        self.scene
                            .separation([a, b], placements, margin, scene_workspace);
                    separation.map(|separation| separation.distance)
                }
            };
            if let Some(distance) = distance.filter(|distance| *distance < margin) {
                closer = Some(self.collision(contact.pair, distance).met_on_the_way());
                break;
            }
        }
        workspace.contacts = contacts;
        Ok(closer)
    }

    /// The gap along the normal between all shapes of both, not only the nearest ones.
    fn sliding_pair(
        &self,
        pair: Pair,
        separation: &Separation,
        margin: f64,
        placements: &[Placement<f64>],
        scene_workspace: &mut SceneWorkspace,
    ) -> SlidingPair {
        let gap = self
            .scene
            .gap_along(pair, separation.normal, placements, scene_workspace);
        SlidingPair {
            pair,
            normal: separation.normal,
            margin,
            slack: gap.map_or(0.0, |gap| gap.min(separation.distance) - margin),
        }
    }

    /// Extends the step of pairs that slide past each other.
    fn extend_sliding_steps(
        &self,
        workspace: &mut CheckerWorkspace,
        motion_ends: (&[f64], &[f64]),
        share: f64,
        monitored_items: &mut [MonitoredItem],
    ) -> Result<(), KinematicsError> {
        let measured = std::mem::take(&mut workspace.sliding_pairs);
        let mut result = Ok(());
        for pairs in measured.chunk_by(|a, b| a.0 == b.0) {
            let monitored = &mut monitored_items[pairs[0].0];
            if monitored.free >= share + LONG_STEP_SHARE * (1.0 - share) {
                continue;
            }
            match self.max_sliding_share(
                workspace,
                motion_ends,
                share,
                monitored.free,
                pairs,
                RESOLUTION,
            ) {
                Ok(end_share) => monitored.free = end_share,
                Err(error) => result = Err(error),
            }
        }
        workspace.sliding_pairs = measured;
        result
    }
}

/// Required distance of a pair in the motion, metres; less for initial contacts.
fn margin_of(contacts: &[NearPair], pair: Pair, margin: f64) -> f64 {
    let contact = contacts.iter().find(|contact| contact.pair == pair);
    contact.map_or(margin, NearPair::margin_in_motion)
}
