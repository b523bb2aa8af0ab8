//! Retargeting of a capture to a model.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::character::CharacterMotion;
use super::collision_free_frames::CollisionFreeFrames;
use super::contacts::{LimbContact, plant_limbs};
use super::frame_targets::FrameTargets;
use super::limbs::Limbs;
use super::obstacles::Obstacles;
use super::on_terrain::SoleGround;
use super::retarget_report::{LostContact, Measures};
use super::sole::Sole;
use super::terrain::Terrain;
use super::unit::{ScaledObstacles, Unit};
use super::{
    BodyFollower, BodyMap, Capture, ContactDetection, FootShapes, RetargetError, RetargetReport,
    Touching, UpAxis,
};
use crate::motion::contact::NOMINAL_LEG_LENGTH_M;
use crate::motion::score::{Heading, MotionScorer, ScoreError};
use crate::motion::trajectory::{MotionError, Windows};
use kinopt_kinematics::Trajectory;
use kinopt_kinematics::bad_option::{BadOption, NOT_NEGATIVE, POSITIVE};
use kinopt_kinematics::kinematics::{ForwardKinematics, KinematicsError};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_robot::robot::Robot;
use kinopt_solver::problem::CollisionAvoidance;

/// Options of retargeting.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RetargetOptions {
    /// Upward axis of the capture, unless the map has one.
    pub up: UpAxis,
    /// Criteria of contact of the feet. The speed limit is for a body with legs 0.9 m long, and scales with the leg
    /// length. The height is in the model's unit.
    pub contacts: ContactDetection,
    /// Shapes of feet, used for the ground height and to avoid ground penetration.
    ///
    /// `None` uses the primitive collision shapes of the robot's file.
    pub shapes: Option<FootShapes>,
    /// Factor of a point's weight at touchdown.
    ///
    /// During contact the point is locked at its touchdown position, because its target may be unreachable for other
    /// proportions.
    pub landing_weight: f64,
    /// Steps and slopes onto which the motion of a recorded capture is moved; `None` for level ground.
    pub terrain: Option<Terrain>,
    /// For whole trajectories: cost of an acceleration of 1 rad/s², in metres of position error. For a model in its own
    /// unit, metres of a body with legs 0.9 m long.
    pub acceleration: f64,
    /// For whole trajectories: tolerance of each window, relative to its cost.
    pub tolerance: f64,
    /// For whole trajectories: windows of the solver.
    pub windows: Windows,
}

impl Default for RetargetOptions {
    fn default() -> Self {
        Self {
            up: UpAxis::Z,
            contacts: ContactDetection::default(),
            shapes: None,
            landing_weight: 4.0,
            terrain: None,
            acceleration: 1e-4,
            tolerance: 0.03,
            windows: Windows::new(120, 30),
        }
    }
}

impl RetargetOptions {
    /// Sets the upward axis of the capture, unless the map has one.
    #[must_use]
    pub fn with_up(mut self, up: UpAxis) -> Self {
        self.up = up;
        self
    }

    /// Sets the contact detection.
    #[must_use]
    pub fn with_contacts(mut self, contacts: ContactDetection) -> Self {
        self.contacts = contacts;
        self
    }

    /// Sets the shapes of feet.
    #[must_use]
    pub fn with_shapes(mut self, shapes: impl Into<Option<FootShapes>>) -> Self {
        self.shapes = shapes.into();
        self
    }

    /// Sets the factor of a point's weight at touchdown.
    #[must_use]
    pub fn with_landing_weight(mut self, weight: f64) -> Self {
        self.landing_weight = weight;
        self
    }

    /// Sets the terrain onto which the motion is moved.
    #[must_use]
    pub fn with_terrain(mut self, terrain: impl Into<Option<Terrain>>) -> Self {
        self.terrain = terrain.into();
        self
    }

    /// Sets the weight of an acceleration of 1 rad/s², in metres of position.
    #[must_use]
    pub fn with_acceleration(mut self, metres: f64) -> Self {
        self.acceleration = metres;
        self
    }

    /// Sets the tolerance of each window, relative to its cost.
    #[must_use]
    pub fn with_tolerance(mut self, ratio: f64) -> Self {
        self.tolerance = ratio;
        self
    }

    /// Sets the windows of whole trajectories.
    #[must_use]
    pub fn with_windows(mut self, windows: Windows) -> Self {
        self.windows = windows;
        self
    }
}

/// Capture fitted to a model: targets and contacts of the driven points in each capture frame.
#[derive(Clone, Debug)]
pub struct Retargeting<'r> {
    pub(super) robot: &'r Robot,
    /// Solved body: the robot, or for a model in its own unit a copy scaled to the size of a person.
    pub(super) body: Cow<'r, Robot>,
    pub(super) unit: Unit,
    pub(super) options: RetargetOptions,
    pub(super) limbs: Limbs,
    pub(super) frame_rate: f64,
    /// Number of joints of a capture frame.
    pub(super) joints: usize,
    /// Targets of the solved body, by capture frame.
    pub(super) targets: Arc<[Vector3<f64>]>,
    /// Directions of the driven axes of feet and hands, by capture frame.
    pub(super) directions: Arc<[Vector3<f64>]>,
    /// Levels at which hands hold an object, by capture frame and driven point; empty without an object.
    pub(super) grasps: Arc<[f64]>,
    /// Poses of a held object, by capture frame; empty without one.
    pub(super) object_poses: Arc<[Placement<f64>]>,
    /// Terrain under the soles, by capture frame; empty for level ground.
    grounds: Arc<[SoleGround]>,
    /// Targets in the robot's unit, by capture frame.
    pub(super) model_targets: Arc<[Vector3<f64>]>,
    pub(super) limb_contacts: Vec<LimbContact>,
    /// Transfer of rotations to a character.
    pub(super) character: Option<Arc<CharacterMotion>>,
    /// Scorer next to the person.
    scorer: MotionScorer<'r>,
    pub(super) obstacles: Option<Obstacles>,
    pub(super) cancelled: Option<Arc<AtomicBool>>,
}

impl<'r> Retargeting<'r> {
    /// Fits a capture to a robot by a map: scales limbs, and finds the ground and contacts.
    ///
    /// # Errors
    /// Returns an error if the capture or the robot lacks a name of the map, or if a frame is driven twice. Returns an
    /// error if a number is out of range.
    pub fn new(
        robot: &'r Robot,
        map: &BodyMap,
        capture: &Capture,
        options: RetargetOptions,
    ) -> Result<Self, RetargetError> {
        BadOption::check("landing_weight", options.landing_weight, POSITIVE)?;
        BadOption::check("acceleration", options.acceleration, NOT_NEGATIVE)?;
        options.contacts.check()?;
        let model = robot.model();
        let up = map.up.unwrap_or(options.up);
        let shapes = options.shapes.clone();
        let shapes = shapes.unwrap_or_else(|| FootShapes::of(robot));
        let mut limbs = Limbs::new(model, map, capture, up, &model.neutral(), &shapes)?;
        let scorer = MotionScorer::of_subject(robot, capture, map, up).map_err(as_score_error)?;
        let scorer = scorer
            .with_shapes(shapes.clone())
            .with_contacts(options.contacts)
            .with_heading(Heading::Fixed(0.0));
        let frame_rate = capture.frame_rate();
        let mut options = options;
        let unit = Unit::of(model, &limbs);
        let body = unit.body(robot)?;
        if !unit.is_identity() {
            let (map, shapes) = unit.map_and_shapes(map, &shapes);
            let model = body.model();
            limbs = Limbs::new(model, &map, capture, up, &model.neutral(), &shapes)?;
            options.contacts.height *= unit.scale();
        }
        if limbs.leg > 0.0 {
            options.contacts.speed *= limbs.leg / NOMINAL_LEG_LENGTH_M;
        }
        let mut targets = Vec::with_capacity(capture.frames() * limbs.all.len());
        let mut positions = Vec::new();
        let mut directions = Vec::new();
        let joints = capture.names().len();
        for frame in 0..capture.frames() {
            let captured = capture.frame(frame).unwrap_or_default();
            let rotations = capture
                .posed()
                .and_then(|posed| posed.rotations.get(frame * joints..(frame + 1) * joints));
            limbs.write_targets(captured, rotations, &mut positions);
            targets.extend_from_slice(&positions);
            limbs.write_directions(captured, rotations, &mut directions);
        }
        let terrain = options.terrain.as_ref();
        let (limb_contacts, grounds) =
            plant_limbs(&options.contacts, &limbs, frame_rate, terrain, &mut targets);
        let grounds = terrain.map_or(Vec::new(), |terrain| {
            let (targets, directions) = (&mut targets, &mut directions);
            limbs.follow_terrain(
                terrain,
                frame_rate,
                &limb_contacts,
                &grounds,
                targets,
                directions,
            )
        });
        let targets: Arc<[Vector3<f64>]> = targets.into();
        let model_targets = match unit.is_identity() {
            true => Arc::clone(&targets),
            false => targets
                .iter()
                .map(|target| *target * unit.inverse_scale())
                .collect(),
        };
        Ok(Self {
            robot,
            body,
            unit,
            model_targets,
            directions: directions.into(),
            grounds: grounds.into(),
            grasps: Arc::new([]),
            object_poses: Arc::new([]),
            options,
            limbs,
            frame_rate,
            joints: capture.names().len(),
            targets,
            limb_contacts,
            character: None,
            scorer,
            obstacles: None,
            cancelled: None,
        })
    }

    /// Enables collision avoidance with the obstacles and link pairs of a checker.
    ///
    /// A sample in collision is solved again from the previous one with collision avoidance. If that is in collision
    /// too, the step is shortened until it is collision-free.
    #[must_use]
    pub fn keep_clear<C: CollisionAvoidance + Clone + Send + Sync + 'static>(
        mut self,
        checker: &C,
    ) -> Self {
        self.obstacles = Some(match self.unit.is_identity() {
            true => Obstacles::of(checker),
            false => {
                let model = self.robot.model();
                Obstacles::of(&ScaledObstacles::new(checker.clone(), self.unit, model))
            }
        });
        self
    }

    /// Sets a flag by which another thread can cancel a solve. A cancelled solve returns
    /// [`MotionError::Cancelled`](crate::motion::trajectory::MotionError::Cancelled).
    ///
    /// Every sample and every iteration checks the flag.
    #[must_use]
    pub fn with_cancellation(mut self, cancelled: Arc<AtomicBool>) -> Self {
        self.cancelled = Some(cancelled);
        self
    }

    /// Returns whether the target has legs but a fixed base, so that it cannot walk.
    ///
    /// See [`Robot::with_base_joint`](kinopt_robot::robot::Robot::with_base_joint).
    #[must_use]
    pub fn legs_on_fixed_base(&self) -> bool {
        self.limbs.all.iter().any(|limb| limb.makes_contact) && !self.robot.moves_as_a_whole()
    }

    /// Number of capture frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.targets.len() / self.limbs.all.len()
    }

    /// Capture frames per second.
    #[must_use]
    pub fn frame_rate(&self) -> f64 {
        self.frame_rate
    }

    /// Driven frames of the model, in the order of [`targets`](Self::targets).
    #[must_use]
    pub fn driven(&self) -> Vec<FrameId> {
        self.limbs.all.iter().map(|limb| limb.frame).collect()
    }

    /// Names of the limbs whose directions are compared, in the order of [`limb_angles`](Self::limb_angles).
    #[must_use]
    pub fn limbs(&self) -> Vec<&'static str> {
        self.scorer.limbs()
    }

    /// Returns the angle between each limb of the subject and of the model, degrees. The angles are sorted by sample,
    /// then in the order of [`limbs`](Self::limbs).
    ///
    /// # Errors
    /// Returns an error if the configurations do not fit the model.
    pub fn limb_angles(
        &self,
        retargeted: &Trajectory<RetargetReport>,
    ) -> Result<Vec<f64>, RetargetError> {
        let angles = self.scorer.limb_angles(&retargeted.q, self.frame_rate);
        angles.map_err(as_score_error)
    }

    /// Ratio of the model's steps to the subject's, in the model's unit.
    #[must_use]
    pub fn stride(&self) -> f64 {
        self.limbs.stride * self.unit.inverse_scale()
    }

    /// Axis along which the model's root is above its contact points in the neutral configuration. It is z unless
    /// the model's file has another upward axis; `None` if it cannot be determined.
    #[must_use]
    pub fn model_stands_along(&self) -> Option<UpAxis> {
        self.limbs.model_up
    }

    /// Returns the target positions of the driven points in a capture frame, in the model's unit.
    #[must_use]
    pub fn targets(&self, frame: usize) -> Option<&[Vector3<f64>]> {
        let n = self.limbs.all.len();
        self.model_targets.get(frame * n..(frame + 1) * n)
    }

    /// Returns the target positions of the solved body, in its unit.
    fn body_targets(&self, frame: usize) -> &[Vector3<f64>] {
        let n = self.limbs.all.len();
        let targets = self.targets.get(frame * n..(frame + 1) * n);
        targets.unwrap_or_default()
    }

    /// Returns the directions of the driven axes of feet and hands in a capture frame.
    pub(super) fn frame_directions(&self, frame: usize) -> &[Vector3<f64>] {
        let n = self.directions.len() / self.frames().max(1);
        self.directions
            .get(frame * n..(frame + 1) * n)
            .unwrap_or_default()
    }

    /// Returns the level at which each driven point holds an object in a capture frame; empty without an object.
    pub(super) fn frame_grasps(&self, frame: usize) -> &[f64] {
        let n = self.limbs.all.len();
        self.grasps
            .get(frame * n..(frame + 1) * n)
            .unwrap_or_default()
    }

    /// Returns the terrain under the soles in a capture frame; empty for level ground.
    pub(super) fn frame_grounds(&self, frame: usize) -> &[SoleGround] {
        let n = self.limbs.soles.len();
        self.grounds
            .get(frame * n..(frame + 1) * n)
            .unwrap_or_default()
    }

    /// Writes the contact of each driven point in a capture frame, from 0 (free) to 1, with blends before and after.
    pub(super) fn contact_levels(&self, frame: usize, contact_levels: &mut [f64]) {
        let lead = self.options.contacts.lead_frames(self.frame_rate);
        for (limb, contact_levels) in contact_levels.iter_mut().enumerate() {
            let levels = self.neighbouring_spans(limb, frame).map(|span| {
                let distance = match frame < span.start {
                    true => span.start - frame,
                    false => (frame + 1).saturating_sub(span.end),
                };
                1.0 - distance as f64 / (lead + 1) as f64
            });
            *contact_levels = levels.fold(0.0, f64::max);
        }
    }

    /// Writes whether each driven point is in contact in a capture frame.
    fn write_contacts(&self, frame: usize, contacts: &mut [bool]) {
        for (limb, contacts) in contacts.iter_mut().enumerate() {
            *contacts = self
                .neighbouring_spans(limb, frame)
                .any(|span| span.contains(&frame));
        }
    }

    /// Returns the contact spans of a limb next to a capture frame: the last one that begins up to it, and the next.
    ///
    /// A binary search keeps the cost per capture frame independent of the length of the motion.
    fn neighbouring_spans(&self, limb: usize, frame: usize) -> impl Iterator<Item = &Range<usize>> {
        let starts_before =
            |contact: &LimbContact| (contact.limb, contact.span.start) <= (limb, frame);
        let after = self.limb_contacts.partition_point(starts_before);
        let neighbours =
            &self.limb_contacts[after.saturating_sub(1)..self.limb_contacts.len().min(after + 1)];
        let contacts = neighbours
            .iter()
            .filter(move |contact| contact.limb == limb);
        contacts.map(|contact| &contact.span)
    }

    /// Transfer of rotations, unless collisions are avoided.
    pub(super) fn rotated_character(&self) -> Option<&CharacterMotion> {
        let character = self.character.as_deref();
        character.filter(|_| self.obstacles.is_none())
    }

    /// Shared transfer of rotations, unless collisions are avoided.
    pub(super) fn rotated_character_motion(&self) -> Option<Arc<CharacterMotion>> {
        self.rotated_character()?;
        self.character.clone()
    }

    /// Creates an online retargeter that starts near the first targets, for targets that arrive one by one.
    ///
    /// # Errors
    /// Returns an error if a velocity limit is invalid.
    pub fn follower(&self) -> Result<BodyFollower, RetargetError> {
        let mut follower = BodyFollower::new(self)?;
        let first = self.body_targets(0);
        follower.set_configuration(&self.limbs.initial_configuration(&self.body, first));
        Ok(follower)
    }

    /// Retargets sample by sample, without look-ahead.
    ///
    /// # Errors
    /// Returns the errors of [`follower`](Self::follower).
    pub fn per_frame(&self) -> Result<Trajectory<RetargetReport>, RetargetError> {
        if let Some(character) = self.rotated_character() {
            let q = character.per_frame(self.cancelled.as_deref())?;
            return self.measure(q);
        }
        let (q, _) = self.follow_all()?;
        self.measure(q)
    }

    /// Returns all configurations of an online retargeter of the solved body. Returns for each sample whether collision
    /// avoidance was active.
    pub(super) fn follow_all(&self) -> Result<(Vec<f64>, Vec<bool>), RetargetError> {
        let mut follower = self.follower()?;
        let mut q = Vec::with_capacity(self.frames() * follower.q().len());
        let mut avoiding = Vec::with_capacity(self.frames());
        let mut contact_levels = vec![0.0; self.limbs.all.len()];
        for frame in 0..self.frames() {
            if (self.cancelled.as_ref()).is_some_and(|cancelled| cancelled.load(Ordering::Relaxed))
            {
                return Err(MotionError::Cancelled.into());
            }
            self.contact_levels(frame, &mut contact_levels);
            let targets = FrameTargets {
                positions: self.body_targets(frame),
                directions: self.frame_directions(frame),
                contacts: &contact_levels,
                grasps: self.frame_grasps(frame),
                grounds: self.frame_grounds(frame),
            };
            q.extend_from_slice(follower.follow(&targets)?);
            avoiding.push(
                follower
                    .avoidance()
                    .is_some_and(CollisionFreeFrames::is_avoiding),
            );
        }
        Ok((q, avoiding))
    }

    /// Returns the ground penetration of a sole, metres.
    fn depth(&self, sole: &Sole, placed: &Placement<f64>) -> f64 {
        let Some(terrain) = &self.options.terrain else {
            return -sole.lowest(placed);
        };
        let depths = sole.balls.iter().map(|(ball, _)| {
            let centre = placed.apply(ball.at);
            terrain.height(centre.x, centre.y) - ball.height(placed)
        });
        depths.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Measures the errors of configurations of the solved body, and scales them to the robot's unit.
    pub(super) fn measure(
        &self,
        mut q: Vec<f64>,
    ) -> Result<Trajectory<RetargetReport>, RetargetError> {
        let model = self.body.model();
        let mut frames = self.driven();
        let driven = frames.len();
        frames.extend(self.limbs.soles.iter().map(|sole| sole.frame));
        let mut kinematics = ForwardKinematics::of_frames(model, &frames).map_err(as_map_error)?;
        let mut measures = Measures::new(driven);
        let mut in_contact = vec![false; driven];
        let contact_limbs = self
            .limbs
            .all
            .iter()
            .enumerate()
            .filter(|(_, limb)| limb.makes_contact && !limb.is_heel);
        let contact_limbs: Vec<usize> = contact_limbs.map(|(limb, _)| limb).collect();
        let mut contacts = Vec::with_capacity(self.frames() * contact_limbs.len());
        for (frame, q) in q.chunks_exact(model.configuration_len()).enumerate() {
            let placed = kinematics.place(q).map_err(as_map_error)?;
            self.write_contacts(frame, &mut in_contact);
            for (k, limb) in self.limbs.all.iter().enumerate() {
                let position = placed[k].apply(limb.offset);
                in_contact[k] = measures.add(frame, k, position, in_contact[k]);
            }
            for (sole, placed) in self.limbs.soles.iter().zip(&placed[driven..]) {
                measures.ground_penetration =
                    measures.ground_penetration.max(self.depth(sole, placed));
            }
            contacts.extend(contact_limbs.iter().map(|&limb| in_contact[limb]));
        }
        let name = |limb: &usize| {
            model.frames()[self.limbs.all[*limb].frame.index()]
                .name
                .clone()
        };
        let lost_contacts = measures
            .lost_contacts
            .iter()
            .map(|(frame, limb)| LostContact {
                frame: *frame,
                contact_frame: name(limb),
            });
        let touching = self.touching(&q);
        let inverse_scale = self.unit.inverse_scale();
        model.scale_slides(inverse_scale, &mut q);
        let report = RetargetReport {
            touching,
            lost_contacts: lost_contacts.collect(),
            frame_rate: self.frame_rate,
            contact_frames: contact_limbs.iter().map(name).collect(),
            contact_points: contact_limbs
                .iter()
                .map(|limb| self.limbs.all[*limb].offset * inverse_scale)
                .collect(),
            contacts,
            score: self
                .scorer
                .score(&q, self.frame_rate)
                .map_err(as_score_error)?,
            slip: measures.slip * inverse_scale,
            ground_penetration: measures.ground_penetration * inverse_scale,
        };
        Ok(Trajectory {
            times: (0..self.frames())
                .map(|frame| frame as f64 / self.frame_rate)
                .collect(),
            q,
            nq: model.configuration_len(),
            report,
        })
    }
}

impl Retargeting<'_> {
    /// Returns the samples in collision; empty without collision avoidance.
    pub(super) fn touching(&self, q: &[f64]) -> Vec<Touching> {
        let Some(mut check) = self.obstacles.as_ref().map(Obstacles::check) else {
            return Vec::new();
        };
        let width = self.robot.model().configuration_len();
        let frames = q.chunks_exact(width).enumerate();
        let touching = frames.filter_map(|(frame, q)| {
            let pair = check.collisions(q).into_iter().next()?;
            Some(Touching { frame, pair })
        });
        touching.collect()
    }
}

fn as_score_error(error: ScoreError) -> RetargetError {
    match error {
        ScoreError::Map(error) => error,
        error => RetargetError::Map(error.to_string()),
    }
}

pub(super) fn as_map_error(error: KinematicsError) -> RetargetError {
    RetargetError::Map(error.to_string())
}
