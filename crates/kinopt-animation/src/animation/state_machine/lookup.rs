//! Name lookups with the path of the definition for errors.

use super::definition::ParameterDefault;
use super::error::StateMachineError;
use crate::animation::LayerError;
use kinopt_kinematics::model::UnknownName;

pub(super) type Checked<T> = Result<T, StateMachineError>;

pub(super) fn error_at(path: impl Into<String>, problem: LayerError) -> StateMachineError {
    StateMachineError {
        path: path.into(),
        problem,
    }
}

pub(super) fn finite(path: impl FnOnce() -> String, value: f64) -> Checked<()> {
    if value.is_finite() {
        return Ok(());
    }
    Err(error_at(path(), LayerError::NonFiniteNumber { value }))
}

/// Index of a name.
pub(super) fn find<'a>(
    path: impl FnOnce() -> String,
    kind: &'static str,
    name: &str,
    mut valid: impl Iterator<Item = &'a str> + Clone,
) -> Checked<usize> {
    let names = valid.clone();
    valid
        .position(|candidate| candidate == name)
        .ok_or_else(|| {
            let unknown = UnknownName::new(kind, name, names);
            error_at(path(), LayerError::UnknownName(unknown))
        })
}

/// Names that transitions may use.
pub(super) struct MachineNames<'a> {
    pub(super) parameters: &'a [(String, ParameterDefault)],
    pub(super) states: Vec<&'a str>,
}

impl MachineNames<'_> {
    pub(super) fn state(&self, path: impl FnOnce() -> String, name: &str) -> Checked<usize> {
        find(path, "state", name, self.states.iter().copied())
    }

    pub(super) fn parameter(
        &self,
        path: impl FnOnce() -> String,
        name: &str,
    ) -> Checked<(usize, ParameterDefault)> {
        let names = self.parameters.iter().map(|(name, _)| name.as_str());
        let index = find(path, "parameter", name, names)?;
        Ok((index, self.parameters[index].1))
    }
}
