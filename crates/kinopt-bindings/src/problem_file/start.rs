//! Start configurations and the choice among solutions.

use std::str::FromStr;

use kinopt::arm::Search;

use super::number_list::{self, Numbers};

/// Default distance between distinct solutions, in radians (or metres) of joint distance.
const DISTINCT_DISTANCE: f64 = 0.5;

/// Start configuration of a search.
#[derive(Clone, Debug, Default)]
pub enum Start {
    /// Start of the arm or model.
    #[default]
    Default,
    /// Rest configuration.
    Rest,
    /// Crouched configuration above held frames.
    Bent,
    /// Random configuration.
    Random,
    /// Configuration.
    Numbers(Numbers),
}

impl FromStr for Start {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "default" => Ok(Self::Default),
            "rest" => Ok(Self::Rest),
            "bent" => Ok(Self::Bent),
            "random" => Ok(Self::Random),
            numbers => match numbers.parse() {
                Ok(numbers) => Ok(Self::Numbers(numbers)),
                Err(problem) if begins_with_number(numbers) => Err(problem),
                Err(_) => Err(
                    "expected `default`, `rest`, `bent`, `random` or the configuration's numbers"
                        .into(),
                ),
            },
        }
    }
}

impl Start {
    /// Start of an option, with its unit of angles.
    pub fn typed(&self, degrees: bool) -> Self {
        match self {
            Self::Numbers(numbers) => Self::Numbers(numbers.typed(degrees)),
            word => word.clone(),
        }
    }
}

fn begins_with_number(text: &str) -> bool {
    let word = text.split([',', ' ']).next().unwrap_or("");
    number_list::number(word).is_ok()
}

/// Parses a choice among solutions: `start`, `first`, `nearest`, `distinct:K` or `distinct:K,D`.
pub fn search(text: &str) -> Result<Search, String> {
    match text {
        "start" => return Ok(Search::Start),
        "first" => return Ok(Search::First),
        "nearest" => return Ok(Search::Nearest),
        _ => {}
    }
    let Some(numbers) = text.strip_prefix("distinct:") else {
        return Err("expected start, first, nearest or distinct:K".to_owned());
    };
    let (k, distance) = match numbers.split_once(',') {
        Some((k, distance)) => (k, number_list::not_negative(distance)?),
        None => (numbers, DISTINCT_DISTANCE),
    };
    match k.parse() {
        Ok(k) if k > 0 => Ok(Search::Distinct { k, distance }),
        _ => Err(format!(
            "`{k}` is not a number of solutions; expected 1 or more"
        )),
    }
}
