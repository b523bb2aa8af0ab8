//! Scorer of the motions of a robot.

use super::body_points::{BodyPoints, PointTrack, ScoredChain};
use super::definitions::{ENDS, JERK_POINTS};
use super::feet::ScoredFeet;
use super::ground::ground_penetration;
use super::heading::Heading;
use super::joint_excess::limit_excess;
use super::limb_angles::{ComparedLimb, unit};
use super::smoothness::{joint_jerk, point_jerk};
use super::subject::{Subject, rotated};
use super::{
    CollisionShare, EndError, JerkScore, LimbAngle, MotionScore, ScoreError, ScoreWeights, Spread,
};
use crate::motion::ContactDetection;
use crate::motion::retarget::{BodyMap, Capture, FootShapes, UpAxis};
use kinopt_kinematics::bad_option::{BadOption, NOT_NEGATIVE, POSITIVE, Range};
use kinopt_robot::robot::Robot;
use kinopt_solver::problem::{AnyClearanceCheck, CollisionAvoidance};

const FINITE: Range = (f64::is_finite, "a finite number");

/// Scorer of the motions of a robot, from any program.
///
/// ```
/// # std::env::set_current_dir("../..")?;
/// use kinopt::motion::score::MotionScorer;
/// use kinopt::robot::{BaseJoint, Robot};
///
/// let robot = Robot::read("models/aldebaran_nao.urdf")?.with_base_joint(BaseJoint::FREE)?;
/// // 1 s at rest, at the height of the stance.
/// let score = MotionScorer::new(&robot).score(&robot.neutral().repeat(31), 30.0)?;
/// assert_eq!((score.jerk.joints.max, score.limits.share), (0.0, 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MotionScorer<'r> {
    robot: &'r Robot,
    points: BodyPoints,
    limbs: Vec<ComparedLimb>,
    subject: Option<Subject>,
    shapes: FootShapes,
    contacts: ContactDetection,
    heading: Heading,
    start: f64,
    ground: f64,
    weights: ScoreWeights,
    check: Option<Box<dyn AnyClearanceCheck>>,
}

impl<'r> MotionScorer<'r> {
    /// Creates a scorer without a subject. Feet, hands and head are those of built-in maps, or found by names. Shapes
    /// are the primitive collision shapes of the robot's file.
    #[must_use]
    pub fn new(robot: &'r Robot) -> Self {
        Self::of_points(robot, BodyPoints::of_model(robot.model()))
    }

    fn of_points(robot: &'r Robot, points: BodyPoints) -> Self {
        Self {
            robot,
            limbs: ComparedLimb::all_of(&points),
            points,
            subject: None,
            shapes: FootShapes::of(robot),
            contacts: ContactDetection::default(),
            heading: Heading::default(),
            start: 0.0,
            ground: 0.0,
            weights: ScoreWeights::default(),
            check: None,
        }
    }

    /// Creates a scorer with the person of a capture. The map assigns its joints to frames of the robot. `up` is the
    /// upward axis of the capture, unless the map has one.
    ///
    /// # Errors
    /// Returns an error if the capture or the robot lacks a name of the map.
    pub fn of_subject(
        robot: &'r Robot,
        capture: &Capture,
        map: &BodyMap,
        up: UpAxis,
    ) -> Result<Self, ScoreError> {
        let points = BodyPoints::of_map(robot.model(), map, capture)?;
        let subject = Subject::new(&points, capture, map.up.unwrap_or(up));
        let mut scorer = Self::of_points(robot, points);
        scorer.subject = Some(subject);
        Ok(scorer)
    }

    /// Sets the shapes whose penetration of the ground is measured.
    #[must_use]
    pub fn with_shapes(mut self, shapes: FootShapes) -> Self {
        self.shapes = shapes;
        self
    }

    /// Sets the detection of the subject's contacts. The speed is for a body with legs 0.9 m long.
    #[must_use]
    pub fn with_contacts(mut self, contacts: ContactDetection) -> Self {
        self.contacts = contacts;
        self
    }

    /// Sets the heading of the motion relative to the capture.
    #[must_use]
    pub fn with_heading(mut self, heading: Heading) -> Self {
        self.heading = heading;
        self
    }

    /// Sets the time of the capture at which the motion begins, seconds.
    #[must_use]
    pub fn with_start(mut self, seconds: f64) -> Self {
        self.start = seconds;
        self
    }

    /// Sets the height of the ground, metres.
    #[must_use]
    pub fn with_ground(mut self, height: f64) -> Self {
        self.ground = height;
        self
    }

    /// Sets the weights of the total.
    #[must_use]
    pub fn with_weights(mut self, weights: ScoreWeights) -> Self {
        self.weights = weights;
        self
    }

    /// Sets the checker of collisions.
    #[must_use]
    pub fn with_collisions<C: CollisionAvoidance>(mut self, checker: &C) -> Self {
        self.check = Some(Box::new(checker.check()));
        self
    }

    /// Names of the compared limbs, in the order of [`limb_angles`](Self::limb_angles). Empty without a subject.
    #[must_use]
    pub fn limbs(&self) -> Vec<&'static str> {
        match self.subject {
            Some(_) => self.limbs.iter().map(|limb| limb.name).collect(),
            None => Vec::new(),
        }
    }

    /// Returns the angle between each limb of the subject and of the robot, degrees. The angles are sorted by sample,
    /// then in the order of [`limbs`](Self::limbs). Samples after the end of the capture are left out.
    ///
    /// # Errors
    /// Returns the errors of [`score`](Self::score).
    pub fn limb_angles(&self, q: &[f64], frame_rate: f64) -> Result<Vec<f64>, ScoreError> {
        self.check_motion(q, frame_rate)?;
        let model = self.points.model_track(self.robot.model(), q)?;
        Ok(match self.compared(&model, frame_rate)? {
            Some((subject, _)) => (0..subject.samples)
                .flat_map(|sample| {
                    let (subject, model) = (&subject, &model);
                    let limbs = self.limbs.iter();
                    limbs.map(move |limb| limb.angle(subject, model, sample))
                })
                .collect(),
            None => Vec::new(),
        })
    }

    /// Scores configurations at a rate in samples per second. A free base has a quaternion w, x, y, z.
    ///
    /// # Errors
    /// Returns an error if the numbers are not configurations of the robot, or if an option is out of its range. Returns an
    /// error if the motion begins after the end of the capture.
    pub fn score(&self, q: &[f64], frame_rate: f64) -> Result<MotionScore, ScoreError> {
        self.check_motion(q, frame_rate)?;
        let body = self.robot.model();
        let model = self.points.model_track(body, q)?;
        let compared = self.compared(&model, frame_rate)?;
        let subject = compared.as_ref().map(|(subject, _)| subject);
        let leg = model.leg_length(&self.points);
        let scale = subject.map_or(1.0, |subject| match subject.leg_length(&self.points) {
            subject_leg if subject_leg > 0.0 && leg > 0.0 => leg / subject_leg,
            _ => 1.0,
        });
        let feet = ScoredFeet {
            points: &self.points,
            model: &model,
            subject,
            detection: self.contacts,
            frame_rate,
            leg,
            scale,
        };
        let jerk_points: Vec<usize> = (JERK_POINTS.iter())
            .filter_map(|name| self.points.index(name))
            .collect();
        let subject_jerk = subject.map(|subject| {
            let jerk = point_jerk(subject, &jerk_points, frame_rate);
            Spread {
                mean: jerk.mean * scale,
                p95: jerk.p95 * scale,
                max: jerk.max * scale,
            }
        });
        let mut score = MotionScore {
            frames: q.len() / body.configuration_len(),
            frame_rate,
            heading: compared
                .as_ref()
                .map_or(0.0, |(_, heading)| heading.to_degrees()),
            limbs: subject.map_or_else(Vec::new, |subject| self.limb_errors(subject, &model)),
            ends: subject.map_or_else(Vec::new, |subject| self.end_errors(subject, &model)),
            feet: feet.motion(),
            penetration: ground_penetration(body, &self.shapes, q, self.ground)?,
            jerk: JerkScore {
                joints: joint_jerk(body, q, frame_rate)?,
                ends: point_jerk(&model, &jerk_points, frame_rate),
                subject_ends: subject_jerk,
            },
            limits: limit_excess(self.robot, q, frame_rate),
            collisions: self.collisions(q),
            ..MotionScore::default()
        };
        score.terms = self.weights.terms(&score);
        score.total = score.terms.iter().map(|term| term.points).sum();
        Ok(score)
    }

    fn check_motion(&self, q: &[f64], frame_rate: f64) -> Result<(), ScoreError> {
        BadOption::check("frames a second", frame_rate, POSITIVE)?;
        BadOption::check("start", self.start, NOT_NEGATIVE)?;
        BadOption::check("ground", self.ground, FINITE)?;
        if let Heading::Fixed(angle) = self.heading {
            BadOption::check("heading", angle, FINITE)?;
        }
        self.contacts.check()?;
        let expected = self.robot.model().configuration_len();
        match expected > 0 && !q.is_empty() && q.len().is_multiple_of(expected) {
            true => Ok(()),
            false => Err(ScoreError::NotConfigurations {
                numbers: q.len(),
                expected,
                model: self.robot.name().to_owned(),
            }),
        }
    }

    /// Subject at the samples of a motion, in the motion's heading, and the angle of the heading, radians.
    fn compared(
        &self,
        model: &PointTrack,
        frame_rate: f64,
    ) -> Result<Option<(PointTrack, f64)>, ScoreError> {
        let Some(subject) = &self.subject else {
            return Ok(None);
        };
        let track = subject.sampled(model.samples, frame_rate, self.start)?;
        let directions = (0..track.samples).flat_map(|sample| {
            let track = &track;
            self.limbs.iter().map(move |limb| {
                let both = [track, model].map(|track| unit(limb.direction(track, sample)));
                (both[0], both[1])
            })
        });
        let angle = self.heading.angle(directions);
        Ok(Some((rotated(&track, angle), angle)))
    }

    fn limb_errors(&self, subject: &PointTrack, model: &PointTrack) -> Vec<LimbAngle> {
        let limbs = self.limbs.iter().map(|limb| {
            let angles = (0..subject.samples).map(|sample| limb.angle(subject, model, sample));
            LimbAngle {
                limb: limb.name.to_owned(),
                angle: Spread::of(angles.collect()),
            }
        });
        limbs.collect()
    }

    fn end_errors(&self, subject: &PointTrack, model: &PointTrack) -> Vec<EndError> {
        let ends = ENDS.iter().filter_map(|definition| {
            let chain = ScoredChain::of(definition, &self.points)?;
            let lengths = [subject, model]
                .map(|track| track.chain_length(&chain.base, chain.middle, chain.end));
            if lengths.iter().any(|length| *length <= 0.0) {
                return None;
            }
            let errors = (0..subject.samples).map(|sample| {
                let relative = |track: &PointTrack, length: f64| {
                    (track.at(sample, chain.end) - track.mean(sample, &chain.base)) * (1.0 / length)
                };
                (relative(model, lengths[1]) - relative(subject, lengths[0])).norm()
            });
            Some(EndError {
                end: definition.name.to_owned(),
                error: Spread::of(errors.collect()),
            })
        });
        ends.collect()
    }

    /// Collisions at all samples; `None` without a checker.
    fn collisions(&self, q: &[f64]) -> Option<CollisionShare> {
        let mut check = self.check.clone()?;
        let rows = q.chunks_exact(self.robot.model().configuration_len());
        let (count, mut colliding, mut depth) = (rows.len(), 0, 0.0_f64);
        for q in rows {
            let pairs = check.collisions(q);
            colliding += usize::from(!pairs.is_empty());
            depth = pairs
                .iter()
                .fold(depth, |depth, pair| depth.max(-pair.distance));
        }
        Some(CollisionShare {
            share: colliding as f64 / count.max(1) as f64,
            depth,
        })
    }
}
