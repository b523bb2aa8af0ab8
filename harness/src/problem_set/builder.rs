//! Builder of problem sets.

use kinopt::Model;
use kinopt::arm::ArmModel;
use kinopt::model::{FrameId, ParameterMap};
use kinopt::robot::Mimic;

use super::ProblemSet;
use crate::HarnessError;

/// Default tolerance: a millionth of the size, and a microradian.
const TOLERANCE: f64 = 1e-6;

/// Common parameters of all cases; [`build`](Self::build) validates them.
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
    pub(super) fn new(mechanism: &impl ArmModel) -> Self {
        Self {
            model: mechanism.model().clone(),
            mimics: mechanism.followers().to_vec(),
            frames: Vec::new(),
            turns: false,
            size: None,
            tolerance: TOLERANCE,
        }
    }

    /// Adds a target for the position of a frame.
    #[must_use]
    pub fn point(mut self, frame: FrameId) -> Self {
        self.frames.push(frame);
        self
    }

    /// Adds a target for the position and orientation of a frame. Orientations then count for all frames of the set.
    #[must_use]
    pub fn pose(mut self, frame: FrameId) -> Self {
        self.frames.push(frame);
        self.turns = true;
        self
    }

    /// Sets the size of the model, in metres. Default: its reach.
    #[must_use]
    pub fn size(mut self, size: f64) -> Self {
        self.size = Some(size);
        self
    }

    /// Sets the tolerance: relative to the size, and in radians; within (0, 0.1]. Default 1e-6.
    #[must_use]
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Validates the parameters and creates a set without cases.
    ///
    /// # Errors
    /// Returns an error for a tolerance out of range, and for a cycle of mimic joints.
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
