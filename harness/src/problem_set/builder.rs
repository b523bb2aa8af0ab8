//! Says what is asked, before the cases.

use kinopt::Model;
use kinopt::arm::Mechanism;
use kinopt::model::{FrameId, ParameterMap};
use kinopt::robot::Mimic;

use super::ProblemSet;
use crate::HarnessError;

/// What counts as solved unless said otherwise: a millionth of the size, and a microradian.
const TOLERANCE: f64 = 1e-6;

/// Collects what all cases share; [`build`](Self::build) checks it.
#[derive(Clone, Debug)]
pub struct ProblemSetBuilder {
    model: Model,
    mimics: Vec<Mimic>,
    frames: Vec<FrameId>,
    turns: bool,
    size: Option<f64>,
    tolerance: f64,
}

impl ProblemSetBuilder {
    pub(super) fn new(mechanism: &impl Mechanism) -> Self {
        Self {
            model: mechanism.model().clone(),
            mimics: mechanism.followers().to_vec(),
            frames: Vec::new(),
            turns: false,
            size: None,
            tolerance: TOLERANCE,
        }
    }

    /// The position of one more frame has a target.
    #[must_use]
    pub fn point(mut self, frame: FrameId) -> Self {
        self.frames.push(frame);
        self
    }

    /// The position and orientation of one more frame have a target. Orientations then count for
    /// all frames of the set.
    #[must_use]
    pub fn pose(mut self, frame: FrameId) -> Self {
        self.frames.push(frame);
        self.turns = true;
        self
    }

    /// The model's own length, in metres. Default: its reach.
    #[must_use]
    pub fn size(mut self, size: f64) -> Self {
        self.size = Some(size);
        self
    }

    /// What counts as solved: this share of the size, and as many radians; within (0, 0.1].
    /// Default 1e-6.
    #[must_use]
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Checks everything; cases come next.
    ///
    /// # Errors
    /// A tolerance out of range; mimic joints that follow in a ring.
    pub fn build(self) -> Result<ProblemSet, HarnessError> {
        if !(self.tolerance > 0.0 && self.tolerance <= 0.1) {
            let tolerance = self.tolerance;
            return Err(HarnessError::Tolerance { tolerance });
        }
        let mut map = ParameterMap::builder(&self.model);
        for mimic in &self.mimics {
            map = map.with_coupled(mimic.joint, mimic.master, mimic.ratio, mimic.offset);
        }
        let map = map.build()?;
        let size = self.size.filter(|size| *size > 0.0 && size.is_finite());
        Ok(ProblemSet {
            size: size
                .unwrap_or_else(|| self.model.reach())
                .max(f64::MIN_POSITIVE),
            model: self.model,
            mimics: self.mimics,
            map,
            frames: self.frames,
            turns: self.turns,
            tolerance: self.tolerance,
            cases: Vec::new(),
            seed: 0,
        })
    }
}
