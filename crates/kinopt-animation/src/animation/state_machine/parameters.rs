//! Parameters of a run.

use super::condition::Condition;
use super::definition::ParameterDefault;
use super::run::StateMachineRun;
use crate::animation::LayerError;
use kinopt_kinematics::model::UnknownName;

/// Current value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ParameterValue {
    /// Number.
    Number(f32),
    /// Flag.
    Flag(bool),
    /// True if a trigger is set and no transition has cleared it.
    Trigger(bool),
}

impl StateMachineRun {
    /// Index of the parameter of a kind and name.
    fn parameter(&self, kind: &'static str, name: &str) -> Result<usize, LayerError> {
        let parameters = self.machine.parameters.iter();
        let mut candidates = parameters.clone();
        let index =
            candidates.position(|(parameter, default)| parameter == name && default.kind() == kind);
        index.ok_or_else(|| {
            let valid = parameters.filter(|(_, default)| default.kind() == kind);
            let valid = valid.map(|(parameter, _)| parameter.as_str());
            LayerError::UnknownName(UnknownName::new(kind, name, valid))
        })
    }

    /// Sets a number.
    ///
    /// # Errors
    /// No number has the name (the error lists the numbers), or the value is not finite.
    pub fn set_number(&mut self, name: &str, value: f32) -> Result<(), LayerError> {
        let index = self.parameter("number", name)?;
        if !value.is_finite() {
            let parameter = name.to_owned();
            return Err(LayerError::NonFiniteParameter { parameter, value });
        }
        self.values[index] = ParameterDefault::Number(value);
        Ok(())
    }

    /// Sets a flag.
    ///
    /// # Errors
    /// No flag has the name; the error lists the flags.
    pub fn set_flag(&mut self, name: &str, value: bool) -> Result<(), LayerError> {
        let index = self.parameter("flag", name)?;
        self.values[index] = ParameterDefault::Flag(value);
        Ok(())
    }

    /// Sets a trigger until a transition clears it.
    ///
    /// # Errors
    /// No trigger has the name; the error lists the triggers.
    pub fn trigger(&mut self, name: &str) -> Result<(), LayerError> {
        let index = self.parameter("trigger", name)?;
        self.triggered[index] = true;
        Ok(())
    }

    /// Clears a trigger that no transition has cleared.
    ///
    /// # Errors
    /// No trigger has the name; the error lists the triggers.
    pub fn clear_trigger(&mut self, name: &str) -> Result<(), LayerError> {
        let index = self.parameter("trigger", name)?;
        self.triggered[index] = false;
        Ok(())
    }

    /// All parameters by name, with their current values.
    pub fn parameters(&self) -> impl Iterator<Item = (&str, ParameterValue)> {
        let names = self.machine.parameters.iter().map(|(name, _)| &**name);
        let values = self.values.iter().zip(&self.triggered);
        names.zip(values.map(|(value, triggered)| match value {
            ParameterDefault::Number(value) => ParameterValue::Number(*value),
            ParameterDefault::Flag(value) => ParameterValue::Flag(*value),
            ParameterDefault::Trigger(_) => ParameterValue::Trigger(*triggered),
        }))
    }

    pub(super) fn is_satisfied(&self, condition: Condition) -> bool {
        match condition {
            Condition::Between {
                parameter,
                above,
                below,
            } => match self.values[parameter] {
                ParameterDefault::Number(value) => above < value && value < below,
                _ => false,
            },
            Condition::Is { parameter, value } => {
                self.values[parameter] == ParameterDefault::Flag(value)
            }
            Condition::Triggered { parameter } => self.triggered[parameter],
        }
    }
}
