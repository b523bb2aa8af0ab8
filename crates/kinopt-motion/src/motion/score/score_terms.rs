//! Terms of a total score, and their weights.

use super::MotionScore;
use kinopt_kinematics::bad_option::{BadOption, NOT_NEGATIVE};
use kinopt_kinematics::model::UnknownName;

use super::ScoreError;

/// Term of a total score.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ScoreTerm {
    /// Name of the term, as in [`ScoreWeights`].
    pub name: String,
    /// Measured value.
    pub value: f64,
    /// Unit of the value.
    pub unit: String,
    /// Points per unit.
    pub weight: f64,
    /// Value times weight.
    pub points: f64,
}

/// Points per unit of each term of a total score.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ScoreWeights {
    /// Points per degree of the mean direction error of the limbs.
    pub limbs: f64,
    /// Points per percent of limb length of the mean position error of hands and feet.
    pub ends: f64,
    /// Points per cm/s of the mean foot sliding speed in contact.
    pub sliding: f64,
    /// Points per mm of the mean depth below the ground.
    pub penetration: f64,
    /// Points per percent of lost contacts.
    pub lost_contacts: f64,
    /// Points per 10 m/s³ of the mean jerk of head, hands and ankles above that of the subject.
    pub jerk: f64,
    /// Points per percent of samples with a joint outside its limits.
    pub limits: f64,
    /// Points per percent of samples in collision.
    pub collisions: f64,
}

impl Default for ScoreWeights {
    fn default() -> Self {
        Self {
            limbs: 1.0,
            ends: 0.5,
            sliding: 1.0,
            penetration: 0.5,
            lost_contacts: 0.1,
            jerk: 0.1,
            limits: 0.2,
            collisions: 0.2,
        }
    }
}

/// Name, unit, weight and value of a term.
type TermDefinition = (
    &'static str,
    &'static str,
    fn(&mut ScoreWeights) -> &mut f64,
    fn(&MotionScore) -> Option<f64>,
);

/// Terms in the order of reports.
const TERMS: [TermDefinition; 8] = [
    (
        "limbs",
        "°",
        |w| &mut w.limbs,
        |score| mean(score.limbs.iter().map(|limb| limb.angle.mean)),
    ),
    (
        "ends",
        "%",
        |w| &mut w.ends,
        |score| mean(score.ends.iter().map(|end| end.error.mean)).map(|share| 100.0 * share),
    ),
    (
        "sliding",
        "cm/s",
        |w| &mut w.sliding,
        |score| {
            score
                .feet
                .as_ref()
                .map(|feet| 100.0 * feet.sliding_speed.mean)
        },
    ),
    (
        "penetration",
        "mm",
        |w| &mut w.penetration,
        |score| Some(1e3 * score.penetration.depth.mean),
    ),
    (
        "lost_contacts",
        "%",
        |w| &mut w.lost_contacts,
        |score| {
            let feet = score.feet.as_ref().filter(|feet| feet.of_subject)?;
            let share = feet.lost_contacts.len() as f64 / feet.contacts.max(1) as f64;
            Some(100.0 * share)
        },
    ),
    (
        "jerk",
        "10 m/s³",
        |w| &mut w.jerk,
        |score| {
            let subject = score.jerk.subject_ends.map_or(0.0, |subject| subject.mean);
            Some((score.jerk.ends.mean - subject).max(0.0) / 10.0)
        },
    ),
    (
        "limits",
        "%",
        |w| &mut w.limits,
        |score| Some(100.0 * score.limits.share),
    ),
    (
        "collisions",
        "%",
        |w| &mut w.collisions,
        |score| score.collisions.map(|collisions| 100.0 * collisions.share),
    ),
];

impl ScoreWeights {
    /// Names of the weights.
    pub fn names() -> impl Iterator<Item = &'static str> {
        TERMS.iter().map(|(name, ..)| *name)
    }

    /// Sets the weight of a term.
    ///
    /// # Errors
    /// Returns an error that lists the valid names for an unknown name, or an error for a weight that is negative or
    /// not finite.
    pub fn set(&mut self, name: &str, weight: f64) -> Result<(), ScoreError> {
        let unknown = || UnknownName::new("weight", name, Self::names());
        let (name, _, of_term, _) = TERMS
            .iter()
            .find(|term| term.0 == name)
            .ok_or_else(unknown)?;
        BadOption::check(name, weight, NOT_NEGATIVE)?;
        *of_term(self) = weight;
        Ok(())
    }

    /// Returns the terms of the figures that exist.
    pub(super) fn terms(mut self, score: &MotionScore) -> Vec<ScoreTerm> {
        let terms = TERMS.iter().filter_map(|(name, unit, of_term, of_score)| {
            let (value, weight) = (of_score(score)?, *of_term(&mut self));
            Some(ScoreTerm {
                name: (*name).to_owned(),
                value,
                unit: (*unit).to_owned(),
                weight,
                points: value * weight,
            })
        });
        terms.collect()
    }
}

/// Mean of values; `None` without values.
fn mean(values: impl ExactSizeIterator<Item = f64>) -> Option<f64> {
    let count = values.len();
    (count > 0).then(|| values.sum::<f64>() / count as f64)
}
