//! Problem sets for all solvers.

mod builder;
mod set_problem;

pub use builder::ProblemSetBuilder;
pub(crate) use set_problem::SetProblem;

use kinopt::arm::ArmModel;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, ParameterMap};
use kinopt::robot::Mimic;
use kinopt::spatial::Placement;
use kinopt::{Model, Problem};

use crate::HarnessError;

/// Distance of the seeds of cases; attempts count below it.
const SEEDS_PER_CASE: u64 = 1 << 16;

/// One problem: targets of the frames, and a start.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// world_from_target of each frame of the set, in metres (for rigs, the rig's unit). If only positions count, the
    /// rotation is ignored.
    pub targets: Vec<Placement<f64>>,
    /// Start configuration (shape: degrees of freedom); clamped into the limits.
    pub start: Vec<f64>,
}

/// A model, the frames with targets, tolerances, and cases.
#[derive(Clone, Debug)]
pub struct ProblemSet {
    model: Model,
    mimics: Vec<Mimic>,
    map: ParameterMap,
    frames: Vec<FrameId>,
    turns: bool,
    size: f64,
    tolerance: f64,
    cases: Vec<Case>,
    seed: u64,
}

impl ArmModel for ProblemSet {
    fn model(&self) -> &Model {
        &self.model
    }

    fn followers(&self) -> &[Mimic] {
        &self.mimics
    }
}

impl ProblemSet {
    /// Starts a set on a model, whose joints are all free, or on a robot with mimic joints.
    #[must_use]
    pub fn builder(mechanism: &impl ArmModel) -> ProblemSetBuilder {
        ProblemSetBuilder::new(mechanism)
    }

    /// Adds `count` reachable cases: the poses of the frames at random configurations within the limits. Each starts at
    /// `start`, or, if it is `None`, at another random configuration. Equal seeds give equal cases.
    ///
    /// # Errors
    /// Returns an error for a start of the wrong length.
    pub fn with_random_cases(
        mut self,
        count: usize,
        seed: u64,
        start: Option<&[f64]>,
    ) -> Result<Self, HarnessError> {
        self.seed = seed;
        let mut kinematics = ForwardKinematics::of_frames(&self.model, &self.frames)?;
        let mut cases = Vec::with_capacity(count);
        for index in 0..count {
            let seed = self.seed_of_case(index);
            let target_configuration = self.random_configuration(seed.wrapping_sub(1));
            let targets = kinematics.place(&target_configuration)?.to_vec();
            let start = match start {
                Some(start) => start.to_vec(),
                None => self.random_configuration(seed),
            };
            cases.push(Case { targets, start });
        }
        self.with_cases(cases)
    }

    /// Adds cases.
    ///
    /// # Errors
    /// Returns an error for a case with a wrong number of targets, or a start of the wrong length.
    pub fn with_cases(mut self, cases: Vec<Case>) -> Result<Self, HarnessError> {
        for mut case in cases {
            let index = self.cases.len();
            let shape = |what, given, expected| match given == expected {
                true => Ok(()),
                false => Err(HarnessError::CaseShape {
                    case: index,
                    what,
                    given,
                    expected,
                    model: self.model.name().to_owned(),
                }),
            };
            shape("targets", case.targets.len(), self.frames.len())?;
            let degrees = self.model.degrees_of_freedom();
            shape("numbers in its start", case.start.len(), degrees)?;
            case.start = self.within_limits(&case.start);
            self.cases.push(case);
        }
        Ok(self)
    }

    /// Sets the seed of all random numbers: starts of further attempts, and those of solvers.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Problem of all cases, with placeholder targets.
    ///
    /// # Errors
    /// Returns an error without frames or free joints, and for frames of another model.
    pub fn problem(&self) -> Result<Problem, HarnessError> {
        Ok(SetProblem::new(self)?.problem)
    }

    /// Model of the set.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Map from variables to configurations.
    #[must_use]
    pub fn map(&self) -> &ParameterMap {
        &self.map
    }

    /// Frames with targets.
    #[must_use]
    pub fn frames(&self) -> &[FrameId] {
        &self.frames
    }

    /// Names of the frames with targets.
    pub fn frame_names(&self) -> impl Iterator<Item = &str> {
        let frames = self.frames.iter();
        let frames = frames.filter_map(|id| self.model.frames().get(id.index()));
        frames.map(|frame| frame.name.as_str())
    }

    /// True if orientations count, false for positions only.
    #[must_use]
    pub fn turns(&self) -> bool {
        self.turns
    }

    /// Size of the model, in metres (for rigs, the rig's unit). Tolerances and accuracies are relative to it.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Tolerance: relative to the size, and in radians.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Position tolerance, in metres (for rigs, the rig's unit).
    #[must_use]
    pub fn length_tolerance(&self) -> f64 {
        self.tolerance * self.size
    }

    /// Angular tolerance in the unit of the weighted cost: infinite if orientations do not count.
    pub(crate) fn weighted_angle_tolerance(&self) -> f64 {
        if self.turns {
            self.tolerance * 0.25 * self.model.reach()
        } else {
            f64::INFINITY
        }
    }

    /// Cases of the set.
    #[must_use]
    pub fn cases(&self) -> &[Case] {
        &self.cases
    }

    /// Seed of all random numbers.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Seed of each case, with enough distance to the next for its attempts.
    pub(crate) fn seed_of_case(&self, case: usize) -> u64 {
        let case = u64::try_from(case).unwrap_or(u64::MAX).wrapping_add(1);
        self.seed
            .rotate_left(40)
            .wrapping_add(case.wrapping_mul(SEEDS_PER_CASE))
    }

    /// A configuration sampled within the limits; mimic joints follow, locked joints keep their values.
    #[must_use]
    pub fn random_configuration(&self, seed: u64) -> Vec<f64> {
        self.within_limits(&self.model.random_configuration(seed))
    }

    /// Clamps a configuration into the limits; mimic joints follow, locked joints keep their values. NaN for a wrong
    /// length.
    #[must_use]
    pub fn within_limits(&self, q: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.map.variables()];
        match self.map.reduce(q, &mut x) {
            Ok(()) => self.configuration(&x),
            Err(_) => vec![f64::NAN; self.model.degrees_of_freedom()],
        }
    }

    /// Configuration of variables, clamped into the limits. NaN for a wrong length.
    #[must_use]
    pub fn configuration(&self, x: &[f64]) -> Vec<f64> {
        let mut q = vec![0.0; self.model.degrees_of_freedom()];
        match self.map.expand_within_limits(x, &mut q) {
            Ok(()) => q,
            Err(_) => vec![f64::NAN; q.len()],
        }
    }
}
