//! Relative weights of frames.

use kinopt::model::{FrameId, UnknownName};
use kinopt_bindings::problem_file::body::FrameWeight;

use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;

/// Given weights, by frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Weights(Vec<(FrameId, f64)>);

impl Weights {
    /// Typed weights; each frame must be in `known`, which has the typed names.
    pub(super) fn of(
        loaded: &LoadedModel,
        given: &[FrameWeight],
        known: &[(String, FrameId)],
    ) -> Outcome<Self> {
        let mut weights: Vec<(FrameId, f64)> = Vec::new();
        for FrameWeight { frame, weight } in given {
            let id = loaded.target_frame(frame)?;
            if !known.iter().any(|(_, other)| *other == id) {
                let names = known.iter().map(|(name, _)| name.as_str());
                return Err(UnknownName::new("target, ray or held tip", frame, names).into());
            }
            if weights.iter().any(|(other, _)| *other == id) {
                return Err(usage!("--weight of `{frame}` is given twice"));
            }
            weights.push((id, *weight));
        }
        Ok(Self(weights))
    }

    /// Factor of a frame's errors; 1 if not given.
    pub(super) fn weight(&self, frame: FrameId) -> f64 {
        self.given(frame).unwrap_or(1.0)
    }

    /// Weight of a frame, if given.
    pub(super) fn given(&self, frame: FrameId) -> Option<f64> {
        let entry = self.0.iter().find(|(other, _)| *other == frame);
        entry.map(|(_, weight)| *weight)
    }
}
