//! Transitions and conditions with resolved names.

use super::definition::{
    ConditionDefinition, Interruption, ParameterDefault, TransitionDefinition,
};
use super::error::StateMachineProblem;
use super::lookup::{Checked, MachineNames, at, finite};
use crate::animation::Easing;

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
        given: &TransitionDefinition,
        names: &MachineNames<'_>,
    ) -> Checked<Self> {
        let from = match &given.from {
            Some(from) => Some(names.state(|| format!("{path}.from"), from)?),
            None => None,
        };
        if from.is_none() && given.when.is_empty() {
            let path = format!("{path}.when");
            return Err(at(path, StateMachineProblem::Unconditional));
        }
        let durations = [
            ("seconds", Some(given.seconds)),
            ("after", given.after),
            ("after_seconds", given.after_seconds),
        ];
        for (key, seconds) in durations {
            if let Some(seconds) = seconds.filter(|s| !(s.is_finite() && *s >= 0.0)) {
                let problem = StateMachineProblem::BadDuration { seconds };
                return Err(at(format!("{path}.{key}"), problem));
            }
        }
        let conditions = given.when.iter().enumerate();
        let conditions = conditions
            .map(|(index, given)| Condition::new(&format!("{path}.when[{index}]"), given, names));
        Ok(Self {
            from,
            to: names.state(|| format!("{path}.to"), &given.to)?,
            seconds: given.seconds,
            easing: given.easing,
            in_step: given.in_step,
            after: given.after,
            after_seconds: given.after_seconds,
            conditions: conditions.collect::<Checked<_>>()?,
            interruption: given.interruption,
        })
    }
}

impl Condition {
    fn new(path: &str, given: &ConditionDefinition, names: &MachineNames<'_>) -> Checked<Self> {
        let place = || format!("{path}.parameter");
        let (parameter, default) = names.parameter(place, &given.parameter)?;
        for (key, bound) in [("above", given.above), ("below", given.below)] {
            if let Some(bound) = bound {
                finite(|| format!("{path}.{key}"), f64::from(bound))?;
            }
        }
        if let Some((above, below)) = given.above.zip(given.below).filter(|(a, b)| a >= b) {
            return Err(at(path, StateMachineProblem::NoNumber { above, below }));
        }
        let wrong = |expected| {
            let problem = StateMachineProblem::WrongCondition {
                parameter: given.parameter.clone(),
                kind: default.kind(),
                expected,
            };
            Err(at(path, problem))
        };
        let bounds = given.above.is_some() || given.below.is_some();
        match (default, given.is) {
            (ParameterDefault::Number(_), None) if bounds => Ok(Self::Between {
                parameter,
                above: given.above.unwrap_or(f32::NEG_INFINITY),
                below: given.below.unwrap_or(f32::INFINITY),
            }),
            (ParameterDefault::Number(_), _) => wrong("`above`, `below` or both"),
            (ParameterDefault::Flag(_), Some(value)) if !bounds => {
                Ok(Self::Is { parameter, value })
            }
            (ParameterDefault::Flag(_), _) => wrong("`is` and nothing else"),
            (ParameterDefault::Trigger(_), None) if !bounds => Ok(Self::Triggered { parameter }),
            (ParameterDefault::Trigger(_), _) => wrong("neither bounds nor `is`"),
        }
    }
}
