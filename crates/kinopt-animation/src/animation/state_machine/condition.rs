//! Transitions and conditions with resolved names.

use super::definition::{
    ConditionDefinition, Interruption, ParameterDefault, TransitionDefinition,
};
use super::lookup::{Checked, MachineNames, error_at, finite};
use crate::animation::{Easing, LayerError};

#[derive(Clone, Debug)]
pub(super) struct Transition {
    pub(super) from: Option<usize>,
    pub(super) to: usize,
    pub(super) seconds: f64,
    pub(super) easing: Easing,
    pub(super) in_step: bool,
    pub(super) after: Option<f64>,
    pub(super) after_seconds: Option<f64>,
    pub(super) conditions: Vec<Condition>,
    pub(super) interruption: Interruption,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Condition {
    Between {
        parameter: usize,
        above: f32,
        below: f32,
    },
    Is {
        parameter: usize,
        value: bool,
    },
    Triggered {
        parameter: usize,
    },
}

impl Transition {
    /// Checks a transition against the states and parameters of the machine.
    pub(super) fn new(
        path: &str,
        definition: &TransitionDefinition,
        names: &MachineNames<'_>,
    ) -> Checked<Self> {
        let from = match &definition.from {
            Some(from) => Some(names.state(|| format!("{path}.from"), from)?),
            None => None,
        };
        if from.is_none() && definition.when.is_empty() {
            let path = format!("{path}.when");
            return Err(error_at(path, LayerError::Unconditional));
        }
        let durations = [
            ("seconds", Some(definition.seconds)),
            ("after", definition.after),
            ("after_seconds", definition.after_seconds),
        ];
        for (key, seconds) in durations {
            if let Some(seconds) = seconds.filter(|s| !(s.is_finite() && *s >= 0.0)) {
                let problem = LayerError::BadDuration { seconds };
                return Err(error_at(format!("{path}.{key}"), problem));
            }
        }
        let conditions = definition.when.iter().enumerate();
        let conditions = conditions.map(|(index, definition)| {
            Condition::new(&format!("{path}.when[{index}]"), definition, names)
        });
        Ok(Self {
            from,
            to: names.state(|| format!("{path}.to"), &definition.to)?,
            seconds: definition.seconds,
            easing: definition.easing,
            in_step: definition.in_step,
            after: definition.after,
            after_seconds: definition.after_seconds,
            conditions: conditions.collect::<Checked<_>>()?,
            interruption: definition.interruption,
        })
    }
}

impl Condition {
    fn new(
        path: &str,
        definition: &ConditionDefinition,
        names: &MachineNames<'_>,
    ) -> Checked<Self> {
        let parameter_path = || format!("{path}.parameter");
        let (parameter, default) = names.parameter(parameter_path, &definition.parameter)?;
        for (key, bound) in [("above", definition.above), ("below", definition.below)] {
            if let Some(bound) = bound {
                finite(|| format!("{path}.{key}"), f64::from(bound))?;
            }
        }
        if let Some((above, below)) = definition
            .above
            .zip(definition.below)
            .filter(|(a, b)| a >= b)
        {
            return Err(error_at(path, LayerError::NoNumber { above, below }));
        }
        let mismatch = |expected| {
            let problem = LayerError::WrongCondition {
                parameter: definition.parameter.clone(),
                kind: default.kind(),
                expected,
            };
            Err(error_at(path, problem))
        };
        let has_bounds = definition.above.is_some() || definition.below.is_some();
        match (default, definition.is) {
            (ParameterDefault::Number(_), None) if has_bounds => Ok(Self::Between {
                parameter,
                above: definition.above.unwrap_or(f32::NEG_INFINITY),
                below: definition.below.unwrap_or(f32::INFINITY),
            }),
            (ParameterDefault::Number(_), _) => mismatch("`above`, `below` or both"),
            (ParameterDefault::Flag(_), Some(value)) if !has_bounds => {
                Ok(Self::Is { parameter, value })
            }
            (ParameterDefault::Flag(_), _) => mismatch("`is` and nothing else"),
            (ParameterDefault::Trigger(_), None) if !has_bounds => {
                Ok(Self::Triggered { parameter })
            }
            (ParameterDefault::Trigger(_), _) => mismatch("neither bounds nor `is`"),
        }
    }
}
