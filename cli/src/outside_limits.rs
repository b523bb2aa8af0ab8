//! Joints outside their limits.

use std::fmt;

use serde::Serialize;

use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;

/// Joint outside its limits.
#[derive(Serialize)]
pub(crate) struct OutsideLimits {
    joint: String,
    /// Value and limits in radians or metres; `None` for a ball joint, which has a cone and a twist.
    #[serde(flatten)]
    range: Option<Range>,
}

#[derive(Serialize)]
struct Range {
    value: f64,
    lower: f64,
    upper: f64,
}

impl LoadedModel {
    /// Joints of a configuration outside their limits.
    pub(crate) fn outside_limits(&self, q: &[f64]) -> Outcome<Vec<OutsideLimits>> {
        let (model, balls) = (&self.model, self.is_of_ball());
        let numbers = model.moving_joints().iter().zip(q).zip(model.limits());
        let numbers: Vec<_> = numbers.zip(balls).collect();
        let outside = model.joints_outside_limits(q)?.into_iter().map(|id| {
            let number = numbers.iter().find(|(((joint, _), _), _)| **joint == id);
            OutsideLimits {
                joint: self.joint_name(id).to_owned(),
                range: number
                    .filter(|(_, ball)| !ball)
                    .map(|(((_, value), limits), _)| Range {
                        value: **value,
                        lower: limits.lower,
                        upper: limits.upper,
                    }),
            }
        });
        Ok(outside.collect())
    }
}

impl fmt::Display for OutsideLimits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` is outside its limits", self.joint)?;
        match &self.range {
            Some(Range {
                value,
                lower,
                upper,
            }) => {
                write!(f, ": {value} is not within [{lower}, {upper}]")
            }
            None => Ok(()),
        }
    }
}
